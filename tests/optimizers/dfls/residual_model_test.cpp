#include "optimizers/dfls/residual_model.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>

#include "base/random.hpp"

namespace armwright {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

struct LinearResiduals {
  MatrixXd slopes;
  VectorXd shift;

  ResidualSample sample(const VectorXd& place) const {
    const VectorXd residuals = slopes * place + shift;
    return {place, residuals, residuals.squaredNorm()};
  }
};

MatrixXd draw_matrix(RandomStream& random, Index rows, Index columns) {
  MatrixXd matrix(rows, columns);
  for (Index i = 0; i < rows; ++i) {
    for (Index k = 0; k < columns; ++k) {
      matrix(i, k) = random.normal();
    }
  }
  return matrix;
}

class ResidualModelOfALinearFunction : public testing::Test {
 protected:
  // n = 4 variables, 6 residuals
  std::vector<ResidualSample> draw_samples(std::size_t count) {
    std::vector<ResidualSample> samples;
    for (std::size_t i = 0; i < count; ++i) {
      samples.push_back(function_.sample(draw_matrix(random_, 4, 1)));
    }
    return samples;
  }

  RandomStream random_{"test/residual-model", 1};
  LinearResiduals function_{draw_matrix(random_, 6, 4), draw_matrix(random_, 6, 1)};
};

TEST_F(ResidualModelOfALinearFunction, IsExactWithOnePointMoreThanVariables) {
  const ResidualModel model(draw_samples(5), MatrixXd::Zero(6, 4), false);
  EXPECT_TRUE(model.is_full());
  EXPECT_LT((model.calc_jacobian() - function_.slopes).norm(), 1e-12 * function_.slopes.norm());
  for (const ResidualSample& one : draw_samples(20)) {
    EXPECT_GE(model.centre().square_sum + 1e-9, 0);
    const VectorXd predicted =
        model.centre().residuals + model.calc_jacobian() * (one.place - model.centre().place);
    EXPECT_LT((predicted - one.residuals).norm(), 1e-10);
  }
}

TEST_F(ResidualModelOfALinearFunction, AgreesWithFewPointsAndKeepsTheRest) {
  const MatrixXd before = draw_matrix(random_, 6, 4);
  const std::vector<ResidualSample> samples = draw_samples(3);
  const ResidualModel model(samples, before, false);
  EXPECT_FALSE(model.is_full());
  for (const ResidualSample& one : samples) {
    const VectorXd predicted =
        model.centre().residuals + model.calc_jacobian() * (one.place - model.centre().place);
    EXPECT_LT((predicted - one.residuals).norm(), 1e-12);
  }
  const VectorXd missing = model.find_missing_direction();
  EXPECT_NEAR(missing.norm(), 1, 1e-12);
  for (const ResidualSample& one : samples) {
    EXPECT_NEAR(missing.dot(one.place - model.centre().place), 0, 1e-12);
  }
  EXPECT_LT((model.calc_jacobian() * missing - before * missing).norm(), 1e-12);
}

TEST_F(ResidualModelOfALinearFunction, ABetterPointBecomesTheCentreAndTheBestNeverLeaves) {
  ResidualModel model(draw_samples(5), MatrixXd::Zero(6, 4), false);
  for (ResidualSample& one : draw_samples(200)) {
    const double best = std::min(model.centre().square_sum, one.square_sum);
    model.include(std::move(one), 0.5);
    EXPECT_EQ(model.centre().square_sum, best);
    EXPECT_TRUE(model.is_full());
    EXPECT_LT((model.calc_jacobian() - function_.slopes).norm(), 1e-6);
  }
}

TEST_F(ResidualModelOfALinearFunction, LagrangeGradientsAreOneAtTheirPointAndZeroAtTheOthers) {
  const std::vector<ResidualSample> samples = draw_samples(5);
  const ResidualModel model(samples, MatrixXd::Zero(6, 4), false);
  for (std::size_t k = 0; k < samples.size(); ++k) {
    if (samples[k].place == model.centre().place) {
      continue;
    }
    const VectorXd gradient = model.calc_lagrange_gradient(k);
    for (std::size_t other = 0; other < samples.size(); ++other) {
      EXPECT_NEAR(gradient.dot(samples[other].place - model.centre().place), other == k ? 1 : 0,
                  1e-11);
    }
  }
}

// r = c exp(g' x): one positive, one negative, and a linear one that changes its sign.
ResidualSample sample_power_laws(const VectorXd& place) {
  const VectorXd residuals{
      {2 * std::exp(place[0] - 2 * place[1]), -0.5 * std::exp(3 * place[1]), place[0] - place[1]}};
  return {place, residuals, residuals.squaredNorm()};
}

std::vector<ResidualSample> sample_power_laws_about_zero(double radius) {
  return {sample_power_laws(VectorXd::Zero(2)), sample_power_laws(radius * VectorXd::Unit(2, 0)),
          sample_power_laws(radius * VectorXd::Unit(2, 1)),
          sample_power_laws(-radius * VectorXd::Ones(2))};
}

TEST(ResidualModel, IsExactForPowerLawsAndForWhatChangesItsSign) {
  std::vector<ResidualSample> samples = sample_power_laws_about_zero(0.3);
  samples.pop_back();
  const ResidualModel model(samples, MatrixXd::Zero(3, 2), true);
  const VectorXd step{{0.7, -1.1}};
  const VectorXd expected = sample_power_laws(model.centre().place + step).residuals;
  EXPECT_LT((model.predict(step) - expected).norm(), 1e-12 * expected.norm());
  // The derivatives at the centre.
  const double h = 1e-6;
  for (Index k = 0; k < 2; ++k) {
    const VectorXd up = model.predict(h * VectorXd::Unit(2, k));
    const VectorXd down = model.predict(-h * VectorXd::Unit(2, k));
    EXPECT_LT((model.calc_jacobian().col(k) - (up - down) / (2 * h)).norm(), 1e-8);
  }
  // Without power laws, the same points give a straight line.
  const ResidualModel linear(samples, MatrixXd::Zero(3, 2), false);
  EXPECT_GT((linear.predict(step) - expected).norm(), 0.1);
}

TEST(ResidualModel, TheStepOfPowerLawsIsTheMinimumWithinTheRadius) {
  std::vector<ResidualSample> samples = sample_power_laws_about_zero(0.3);
  samples.pop_back();
  const ResidualModel model(samples, MatrixXd::Zero(3, 2), true);
  for (const double radius : {0.05, 0.5, 5.0}) {
    const StepBox box{VectorXd::Constant(2, -3), VectorXd::Constant(2, 0.8)};
    const VectorXd step = model.find_step(box, radius);
    EXPECT_LE(step.norm(), radius * (1 + 1e-12));
    double best = model.centre().square_sum;  // on a grid
    for (double x = -3; x <= 0.8; x += 0.01) {
      for (double y = -3; y <= 0.8; y += 0.01) {
        const VectorXd other{{x, y}};
        if (other.norm() <= radius) {
          best = std::min(best, model.predict(other).squaredNorm());
        }
      }
    }
    const double reduction = model.centre().square_sum - best;
    EXPECT_LT(model.predict(step).squaredNorm(), best + 2e-3 * reduction) << radius;
  }
}

TEST(ResidualModel, KeepsItsSlopesWhenCasesAreAdded) {
  // One case of two residuals, r = c exp(x_0) and c x_1, and a shared one, exp(x_0).
  const auto sample = [](const VectorXd& place, std::initializer_list<double> factors) {
    VectorXd residuals(2 * std::ssize(factors) + 1);
    Index row = 0;
    for (const double c : factors) {
      residuals[row++] = c * std::exp(place[0]) / std::sqrt(static_cast<double>(factors.size()));
      residuals[row++] = c * place[1] / std::sqrt(static_cast<double>(factors.size()));
    }
    residuals[row] = std::exp(place[0]);
    return ResidualSample{place, residuals, residuals.squaredNorm()};
  };
  const VectorXd origin = VectorXd::Zero(2);
  const ResidualModel old({sample(origin, {1.0}), sample(VectorXd::Unit(2, 0), {1.0}),
                           sample(VectorXd::Unit(2, 1), {1.0})},
                          MatrixXd::Zero(3, 2), true);
  const auto more =
      ResidualModel::extend(old, sample(old.centre().place, {1.0, 1.0, 1.0, 1.0}), 1, 4);
  ASSERT_TRUE(more);
  const VectorXd step{{0.4, 0.3}};
  EXPECT_LT(
      (more->predict(step) - sample(old.centre().place + step, {1.0, 1.0, 1.0, 1.0}).residuals)
          .norm(),
      1e-12);
  // Residuals that are not in the order of the cases have no place.
  EXPECT_FALSE(ResidualModel::extend(old, sample(origin, {1.0, 1.0, 1.0}), 1, 4));
  EXPECT_FALSE(ResidualModel::extend(old, sample(origin, {1.0}), 1, 2));
}

TEST_F(ResidualModelOfALinearFunction, DistantPointsLeaveFirst) {
  std::vector<ResidualSample> samples{function_.sample(VectorXd::Zero(4))};
  for (Index i = 0; i < 4; ++i) {
    samples.push_back(function_.sample(VectorXd::Unit(4, i) * (i == 2 ? 100 : 0.1)));
  }
  // The centre must be the origin, whatever the sums are.
  for (std::size_t i = 1; i < samples.size(); ++i) {
    samples[i].square_sum = samples[0].square_sum + 1;
  }
  ResidualModel model(samples, MatrixXd::Zero(6, 4), false);
  EXPECT_EQ(model.find_furthest().index, 3U);
  EXPECT_EQ(model.find_furthest().length, 100);
  ResidualSample near = function_.sample(VectorXd::Constant(4, 0.05));
  near.square_sum = samples[0].square_sum + 1;
  model.include(near, 0.1);
  EXPECT_LT(model.find_furthest().length, 0.2);
}

}  // namespace
}  // namespace armwright
