// The models of turbo against formulas written out here, and against finite differences.
#include "optimizers/turbo/gaussian_process.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "base/decompositions.hpp"
#include "optimizers/turbo/box_descent.hpp"

namespace armwright {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Rasmussen and Williams 2006, equation 4.17 with nu = 5/2.
double calc_matern(double distance, double variance) {
  const double r = std::sqrt(5.0) * distance;
  return variance * (1 + r + r * r / 3) * std::exp(-r);
}

// Two variables, of which the second is a category of two words: three features.
constexpr double kLength = 0.7;
constexpr double kCategoryLength = 1.3;
constexpr double kVariance = 1.5;
constexpr double kNoise = 0.04;

GaussianProcess make_process() {
  GaussianProcess process({0, 1, 1});
  process.set_hyperparameters((VectorXd(4) << std::log(kLength), std::log(kCategoryLength),
                               std::log(kVariance), std::log(kNoise))
                                  .finished());
  return process;
}

MatrixXd make_features(std::initializer_list<std::pair<double, int>> places) {
  MatrixXd features = MatrixXd::Zero(3, static_cast<Eigen::Index>(places.size()));
  Eigen::Index k = 0;
  for (const auto& [share, word] : places) {
    features(0, k) = share;
    features(1 + word, k++) = std::sqrt(0.5);
  }
  return features;
}

double calc_kernel(std::pair<double, int> a, std::pair<double, int> b) {
  const double share = (a.first - b.first) / kLength;
  const double word = a.second == b.second ? 0 : 1 / kCategoryLength;
  return calc_matern(std::hypot(share, word), kVariance);
}

// Equations 2.25 and 2.26 of the source at three places, with the mean by generalised least squares.
struct HandMade {
  double mean = 0;
  double variance = 0;
};
HandMade calc_posterior(const std::vector<std::pair<double, int>>& places, const VectorXd& values,
                        std::pair<double, int> at) {
  Eigen::Matrix3d covariance;
  Eigen::Vector3d across;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      covariance(i, j) = calc_kernel(places[i], places[j]) + (i == j ? kNoise : 0);
    }
    across[i] = calc_kernel(places[i], at);
  }
  const Eigen::Matrix3d inverse = covariance.inverse();
  const Eigen::Vector3d ones = Eigen::Vector3d::Ones();
  const double mean = ones.dot(inverse * values) / ones.dot(inverse * ones);
  return {.mean = mean + across.dot(inverse * (values - mean * ones)),
          .variance = kVariance - across.dot(inverse * across)};
}

const std::vector<std::pair<double, int>> kPlaces = {{0.1, 0}, {0.6, 1}, {0.9, 0}};

TEST(GaussianProcess, PosteriorIsThatOfTheFormulasAtThreePlaces) {
  const VectorXd values = (VectorXd(3) << 1.2, -0.5, 0.4).finished();
  GaussianProcess process = make_process();
  process.condition(make_features({{0.1, 0}, {0.6, 1}, {0.9, 0}}), values);
  RandomStream random("test/gaussian_process");
  constexpr int kSamples = 3000;
  for (const auto& at : {std::pair{0.3, 0}, std::pair{0.3, 1}, std::pair{2.0, 0}}) {
    const HandMade expected = calc_posterior(kPlaces, values, at);
    const MatrixXd features = make_features({at});
    EXPECT_NEAR(process.mean().calc_values(features)[0], expected.mean, 1e-13);
    double sum = 0;
    double squares = 0;
    for (int i = 0; i < kSamples; ++i) {
      const double value = process.draw_sample(random).calc_values(features)[0] - expected.mean;
      sum += value;
      squares += value * value;
    }
    // Four standard errors of the mean, and of the variance of numbers that are close to normal.
    EXPECT_NEAR(sum / kSamples, 0, 4 * std::sqrt(expected.variance / kSamples));
    EXPECT_NEAR(squares / kSamples, expected.variance,
                4 * expected.variance * std::sqrt(2.0 / kSamples));
  }
}

TEST(GaussianProcess, LikelihoodIsThatOfTheFormulaUpToAConstant) {
  const MatrixXd features = make_features({{0.1, 0}, {0.6, 1}, {0.9, 0}});
  const VectorXd values = (VectorXd(3) << 1.2, -0.5, 0.4).finished();
  const GaussianProcess process = make_process();
  VectorXd gradient;
  // The difference between two vectors of values has no constant, and the priors cancel.
  const double difference =
      process.calc_log_posterior(features, values, process.hyperparameters(), gradient) -
      process.calc_log_posterior(features, VectorXd::Zero(3), process.hyperparameters(), gradient);
  Eigen::Matrix3d covariance;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      covariance(i, j) = calc_kernel(kPlaces[i], kPlaces[j]) + (i == j ? kNoise : 0);
    }
  }
  const Eigen::Matrix3d inverse = covariance.inverse();
  const Eigen::Vector3d ones = Eigen::Vector3d::Ones();
  const VectorXd centred = values.array() - ones.dot(inverse * values) / ones.dot(inverse * ones);
  EXPECT_NEAR(difference, -0.5 * centred.dot(inverse * centred), 1e-12);
}

MatrixXd draw_features(Eigen::Index places, RandomStream& random) {
  MatrixXd features = MatrixXd::Zero(3, places);
  for (Eigen::Index k = 0; k < places; ++k) {
    features(0, k) = random.uniform();
    features(1 + static_cast<Eigen::Index>(random.below(2)), k) = std::sqrt(0.5);
  }
  return features;
}

TEST(GaussianProcess, GradientOfTheLikelihoodIsThatOfDifferences) {
  RandomStream random("test/gaussian_process/gradient");
  const MatrixXd features = draw_features(12, random);
  VectorXd values(12);
  for (double& value : values) {
    value = random.normal();
  }
  const GaussianProcess process = make_process();
  VectorXd gradient;
  process.calc_log_posterior(features, values, process.hyperparameters(), gradient);
  for (Eigen::Index i = 0; i < 4; ++i) {
    constexpr double kStep = 1e-4;
    VectorXd unused;
    const VectorXd shift = kStep * VectorXd::Unit(4, i);
    const double slope =
        (process.calc_log_posterior(features, values, process.hyperparameters() + shift, unused) -
         process.calc_log_posterior(features, values, process.hyperparameters() - shift, unused)) /
        (2 * kStep);
    // kStep^2 times a sixth of the third derivative. That is about 700 for the first length scale:
    // every derivative of an exponential of the gradient, -161, has its size.
    EXPECT_NEAR(gradient[i], slope, 5e-6) << "hyperparameter " << i;
  }
}

TEST(GaussianProcess, KernelIsPositiveDefiniteWithHardlyAnyNoise) {
  RandomStream random("test/gaussian_process/definite");
  MatrixXd features(4, 150);
  for (double& entry : features.reshaped()) {
    entry = random.uniform();
  }
  GaussianProcess process({0, 1, 2, 3});
  VectorXd hyperparameters = VectorXd::Zero(6);
  hyperparameters[5] = std::log(1e-9);
  process.set_hyperparameters(hyperparameters);
  process.condition(features, VectorXd::Zero(150));
  EXPECT_EQ(process.hyperparameters(), hyperparameters) << "it needed more noise";
}

TEST(GaussianProcess, AddedPlacesGiveWhatAllPlacesAtOnceGive) {
  RandomStream random("test/gaussian_process/extend");
  const MatrixXd features = draw_features(30, random);
  VectorXd values(30);
  for (double& value : values) {
    value = random.normal();
  }
  GaussianProcess grown = make_process();
  for (const Eigen::Index count : {20, 21, 21, 30}) {
    grown.condition(features.leftCols(count), values.head(count));
  }
  GaussianProcess whole = make_process();
  whole.condition(features, values);
  const MatrixXd elsewhere = draw_features(10, random);
  const VectorXd gaps = grown.mean().calc_values(elsewhere) - whole.mean().calc_values(elsewhere);
  EXPECT_LT(gaps.lpNorm<Eigen::Infinity>(), 1e-11);  // the condition number is below 30 / kNoise
  grown.condition(elsewhere, values.head(10));       // other places: nothing of the factor may stay
  whole = make_process();
  whole.condition(elsewhere, values.head(10));
  EXPECT_EQ(grown.mean().calc_values(features), whole.mean().calc_values(features));
}

TEST(GaussianProcess, EqualPlacesWithoutNoiseGetNoiseInsteadOfAnError) {
  GaussianProcess process({0});
  process.set_hyperparameters((VectorXd(3) << 0, 0, std::log(1e-300)).finished());
  process.condition(MatrixXd::Constant(1, 5, 0.5), VectorXd::LinSpaced(5, -1, 1));
  // The added noise is 1e-12 of the variance or more. Rounding errors of 1e-16, over that.
  EXPECT_NEAR(process.mean().calc_values(MatrixXd::Constant(1, 1, 0.5))[0], 0, 1e-3);
}

TEST(GaussianProcess, FittedHyperparametersAreBetterAndFindTheNoise) {
  RandomStream random("test/gaussian_process/fit");
  MatrixXd features(2, 60);
  for (double& entry : features.reshaped()) {
    entry = random.uniform();
  }
  // Only the first variable matters.
  VectorXd clean(60);
  VectorXd noisy(60);
  for (Eigen::Index k = 0; k < 60; ++k) {
    clean[k] = 1.4 * std::sin(6 * features(0, k));
    noisy[k] = clean[k] + 0.5 * random.normal();
  }
  GaussianProcess process({0, 1});
  VectorXd gradient;
  const double before =
      process.calc_log_posterior(features, clean, process.hyperparameters(), gradient);
  process.fit(features, clean, 50);
  EXPECT_GT(process.calc_log_posterior(features, clean, process.hyperparameters(), gradient),
            before + 1);
  EXPECT_GT(process.hyperparameters()[1], process.hyperparameters()[0] + 1);
  EXPECT_LT(process.hyperparameters()[3], process.hyperparameters()[2] + std::log(1e-3));
  process.fit(features, noisy, 50);
  // 0.25, with the standard error of a variance from 60 values, and a few of them spent on the fit.
  EXPECT_NEAR(process.hyperparameters()[3], std::log(0.25), 4 * std::sqrt(2.0 / 60));
}

TEST(GaussianProcess, GradientsOfItsFunctionsAreThoseOfDifferences) {
  RandomStream random("test/gaussian_process/slopes");
  GaussianProcess process = make_process();
  process.condition(make_features({{0.1, 0}, {0.6, 1}, {0.9, 0}}),
                    (VectorXd(3) << 1.2, -0.5, 0.4).finished());
  const VectorXd at = make_features({{0.35, 0}}).col(0);
  for (const ProcessFunction& function : {process.mean(), process.draw_sample(random)}) {
    VectorXd gradient;
    EXPECT_NEAR(function.calc_gradient(at, gradient), function.calc_values(at)[0], 1e-12);
    for (Eigen::Index f = 0; f < 3; ++f) {
      constexpr double kStep = 1e-5;
      const VectorXd shift = kStep * VectorXd::Unit(3, f);
      const double slope =
          (function.calc_values(at + shift)[0] - function.calc_values(at - shift)[0]) / (2 * kStep);
      EXPECT_NEAR(gradient[f], slope, 1e-6);  // kStep^2 times third derivatives of at most 1e3
    }
  }
}

TEST(BoxDescent, FindsTheMinimumOnTheBoundsAndInside) {
  const Box box{VectorXd::Constant(3, -1), VectorXd::Constant(3, 1)};
  VectorXd x = VectorXd::Zero(3);
  const double least = descend_in_box(
      [](const VectorXd& at, VectorXd& gradient) {
        const VectorXd gap = at - (VectorXd(3) << 2, -3, 0.25).finished();
        gradient = 2 * gap;
        return gap.squaredNorm();
      },
      box, 50, x);
  EXPECT_NEAR((x - (VectorXd(3) << 1, -1, 0.25).finished()).norm(), 0, 1e-6);
  EXPECT_NEAR(least, 5, 1e-9);
}

TEST(BoxDescent, FollowsABentValleyAndAvoidsPlacesWithoutAValue) {
  // Rosenbrock's function, which does not exist above x = 1.5.
  const Box box{VectorXd::Constant(2, -2), VectorXd::Constant(2, 2)};
  VectorXd x = (VectorXd(2) << -1.2, 1).finished();
  descend_in_box(
      [](const VectorXd& at, VectorXd& gradient) {
        const double valley = at[1] - at[0] * at[0];
        gradient =
            (VectorXd(2) << -400 * valley * at[0] - 2 * (1 - at[0]), 200 * valley).finished();
        return at[0] > 1.5 ? NAN : 100 * valley * valley + (1 - at[0]) * (1 - at[0]);
      },
      box, 200, x);
  EXPECT_NEAR((x - VectorXd::Ones(2)).norm(), 0, 1e-3);
}

}  // namespace
}  // namespace armwright
