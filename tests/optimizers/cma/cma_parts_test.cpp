// What CMA-ES is made of, each part by itself: parameters, distribution, box, termination,
// uncertainty. Whole runs: cmaes_test.cpp.
#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <numeric>

#include "optimizers/cma/cma_box.hpp"
#include "optimizers/cma/cma_distribution.hpp"
#include "optimizers/cma/cma_termination.hpp"
#include "optimizers/cma/cma_uncertainty.hpp"

namespace armwright {
namespace {

using testing::DoubleNear;
using testing::Each;
using testing::ElementsAre;

double sum(std::span<const double> values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

using Function = std::function<double(std::span<const double>)>;

std::vector<std::size_t> rank_by(const std::vector<std::vector<double>>& points,
                                 const Function& function) {
  std::vector<double> values;
  for (const std::vector<double>& point : points) {
    values.push_back(function(point));
  }
  std::vector<std::size_t> ranking(points.size());
  std::iota(ranking.begin(), ranking.end(), std::size_t{0});
  std::ranges::stable_sort(ranking, {}, [&](std::size_t i) { return values[i]; });
  return ranking;
}

// --- the parameters

// What pycma prints for n = 20 (documentation of CMAParameters): Hansen's own implementation.
TEST(CmaParameters, AreThoseThatTheAuthorsImplementationPrintsFor20Variables) {
  const CmaParameters p = make_cma_parameters(20, {});
  EXPECT_EQ(p.population, 12u);
  EXPECT_EQ(p.mu, 6u);
  EXPECT_NEAR(p.c_1, 0.00437235, 1e-8);
  EXPECT_NEAR(p.c_c, 0.171767, 1e-6);
  EXPECT_NEAR(p.c_mu, 0.00921656, 1e-8);
  const auto near = [](double value) { return DoubleNear(value, 1e-9); };
  EXPECT_THAT(p.weights,
              ElementsAre(near(0.4024029428), near(0.2533890840), near(0.1662215645),
                          near(0.1043752252), DoubleNear(0.05640347757, 1e-9), near(0.01720770576),
                          near(-0.05018713636), near(-0.1406167894), near(-0.2203813963),
                          near(-0.2917332686), near(-0.3562788884), near(-0.4152044225)));
}

// By hand from table 1 of the tutorial.
TEST(CmaParameters, FollowTheFormulasFor10Variables) {
  const CmaParameters p = make_cma_parameters(10, {});
  EXPECT_EQ(p.population, 10u);  // 4 + floor(6.9)
  EXPECT_EQ(p.mu, 5u);
  double raw_sum = 0;
  double raw_squares = 0;
  for (int i = 1; i <= 5; ++i) {
    raw_sum += std::log(5.5 / i);
    raw_squares += std::pow(std::log(5.5 / i), 2);
  }
  const double mu_eff = raw_sum * raw_sum / raw_squares;
  EXPECT_NEAR(mu_eff, 3.167, 1e-3);
  EXPECT_NEAR(p.mu_eff, mu_eff, 1e-12);
  EXPECT_NEAR(p.weights[0], std::log(5.5) / raw_sum, 1e-12);
  EXPECT_NEAR(p.c_sigma, (mu_eff + 2) / (15 + mu_eff), 1e-12);
  EXPECT_NEAR(p.d_sigma, 1 + p.c_sigma, 1e-12);  // mu_eff is too small for the second term
  EXPECT_NEAR(p.c_c, (4 + mu_eff / 10) / (14 + mu_eff / 5), 1e-12);
  EXPECT_NEAR(p.c_1, 2 / (11.3 * 11.3 + mu_eff), 1e-12);
  EXPECT_NEAR(p.c_mu, 2 * (mu_eff + 1 / mu_eff - 1.75) / (144 + mu_eff), 1e-12);
  EXPECT_NEAR(p.expected_norm, std::sqrt(10.0) * (1 - 1.0 / 40 + 1.0 / 2100), 1e-12);
  EXPECT_EQ(p.decomposition_interval, 1);
}

TEST(CmaParameters, WeightsSumToOneAboveAndBalanceTheDecayBelow) {
  for (const std::size_t n : {1, 2, 5, 10, 40}) {
    for (const std::size_t population : {0, 2, 3, 7, 50, 1000}) {
      const CmaParameters p = make_cma_parameters(n, {.population = population});
      const std::span<const double> weights = p.weights;
      ASSERT_EQ(weights.size(), p.population);
      EXPECT_NEAR(sum(weights.first(p.mu)), 1, 1e-12);
      EXPECT_TRUE(std::ranges::is_sorted(weights, std::greater<>{}));
      EXPECT_GT(weights[p.mu - 1], 0);
      EXPECT_LE(weights[p.mu], 1e-15);
      // C keeps a positive share whatever the sample: 1 - c_1 - c_mu sum w - n c_mu |w-| >= 0
      const double negative = -sum(weights.subspan(p.mu));
      EXPECT_GE(1 - p.c_1 - p.c_mu * (1 - negative) - static_cast<double>(n) * p.c_mu * negative,
                -1e-12);
      EXPECT_LE(p.c_1 + p.c_mu, 1 + 1e-12);
    }
  }
}

TEST(CmaParameters, TheDefaultWeightsLeaveTheVarianceAlone) {
  const CmaParameters p = make_cma_parameters(10, {});
  EXPECT_NEAR(p.c_1 + p.c_mu * sum(p.weights), 0, 1e-12);  // no decay of C
}

TEST(CmaParameters, GivenOnesAreTaken) {
  const CmaParameters p = make_cma_parameters(10, {.population = 20,
                                                   .mu = 3,
                                                   .active = false,
                                                   .c_1 = 0.1,
                                                   .c_mu = 0.2,
                                                   .c_sigma = 0.3,
                                                   .d_sigma = 2,
                                                   .c_c = 0.4});
  EXPECT_EQ(p.population, 20u);
  EXPECT_EQ(p.mu, 3u);
  EXPECT_EQ(sum(std::span(p.weights).subspan(3)), 0);
  EXPECT_NEAR(p.weights[0] / p.weights[1], std::log(3.5) / std::log(1.75), 1e-12);
  EXPECT_THAT((std::vector{p.c_1, p.c_mu, p.c_sigma, p.d_sigma, p.c_c}),
              ElementsAre(0.1, 0.2, 0.3, 2, 0.4));
}

// --- the distribution

TEST(CmaDistribution, SamplesWithTheMeanAndTheDeviationItWasGiven) {
  CmaDistribution distribution(make_cma_parameters(2, {.population = 40000}),
                               std::vector<double>{3, -1}, 0.5);
  RandomStream random("test/cma");
  double mean = 0;
  double square = 0;
  double product = 0;
  for (const std::vector<double>& x : distribution.sample(random)) {
    mean += x[0] / 40000;
    square += (x[0] - 3) * (x[0] - 3) / 40000;
    product += (x[0] - 3) * (x[1] + 1) / 40000;
  }
  // five standard errors of 40000 draws
  EXPECT_NEAR(mean, 3, 5 * 0.5 / 200);
  EXPECT_NEAR(square, 0.25, 5 * 0.25 * std::sqrt(2.0) / 200);
  EXPECT_NEAR(product, 0, 5 * 0.25 / 200);
}

// One update of one variable, by hand: every formula of the header on numbers.
// The distribution is N(0, I) here, so that the points are the steps z themselves.
TEST(CmaDistribution, DrawsAsManyStepsAtRightAnglesAsThereAreVariables) {
  const auto calc_largest_cosine = [](bool orthogonal, std::size_t first, std::size_t last) {
    RandomStream random("test", 3);
    CmaDistribution distribution(
        make_cma_parameters(5, {.population = 12, .orthogonal = orthogonal}),
        std::vector<double>(5, 0.0), 1);
    const std::vector<std::vector<double>>& z = distribution.sample(random);
    const auto dot = [&](std::size_t a, std::size_t b) {
      return std::inner_product(z[a].begin(), z[a].end(), z[b].begin(), 0.0);
    };
    double largest = 0;
    for (std::size_t a = first; a < last; ++a) {
      for (std::size_t b = first; b < a; ++b) {
        largest = std::max(largest, std::abs(dot(a, b)) / std::sqrt(dot(a, a) * dot(b, b)));
      }
    }
    return largest;
  };
  EXPECT_LT(calc_largest_cosine(true, 0, 5), 1e-12);
  EXPECT_LT(calc_largest_cosine(true, 5, 10), 1e-12);
  EXPECT_LT(calc_largest_cosine(true, 10, 12), 1e-12);
  EXPECT_GT(calc_largest_cosine(true, 0, 6), 0.1);  // six in five dimensions cannot be
  EXPECT_GT(calc_largest_cosine(false, 0, 5), 0.1);
}

// Turning must leave every single step normal: mean 0, variance 1 in every coordinate, and squared
// lengths with the mean n and the variance 2n of chi-squared, also for the last of a block, of
// which least is left. 3000 generations; bounds of five standard errors.
TEST(CmaDistribution, StepsAtRightAnglesAreStillNormal) {
  constexpr int kGenerations = 3000;
  constexpr std::size_t kDimension = 4;
  RandomStream random("test", 4);
  CmaDistribution distribution(make_cma_parameters(kDimension, {.population = 4}),
                               std::vector<double>(kDimension, 0.0), 1);
  for (const std::size_t individual : {std::size_t{0}, std::size_t{3}}) {
    std::vector<double> means(kDimension);
    std::vector<double> squares(kDimension);
    double lengths = 0;
    double lengths_squared = 0;
    for (int g = 0; g < kGenerations; ++g) {
      const std::vector<double>& z = distribution.sample(random)[individual];
      double length = 0;
      for (std::size_t i = 0; i < kDimension; ++i) {
        means[i] += z[i] / kGenerations;
        squares[i] += z[i] * z[i] / kGenerations;
        length += z[i] * z[i];
      }
      lengths += length / kGenerations;
      lengths_squared += length * length / kGenerations;
    }
    const double root = std::sqrt(kGenerations);
    EXPECT_THAT(means, Each(DoubleNear(0, 5 / root)));
    EXPECT_THAT(squares, Each(DoubleNear(1, 5 * std::sqrt(2) / root)));
    EXPECT_NEAR(lengths, 4, 5 * std::sqrt(8) / root);
    EXPECT_NEAR(lengths_squared, 24, 5 * std::sqrt(1344) / root);  // E l^2 and Var l^2, l chi2(4)
  }
}

TEST(CmaDistribution, OneUpdateIsThatOfTheEquations) {
  CmaDistribution distribution(make_cma_parameters(1, {}), std::vector<double>{2.0}, 0.5);
  const CmaParameters& p = distribution.parameters();
  RandomStream random("test/cma");
  const auto points = distribution.sample(random);
  const auto ranking =
      rank_by(points, [](std::span<const double> x) { return std::abs(x[0] - 2.1); });
  distribution.update(ranking);

  double mean_y = 0;
  double rank_mu = 0;
  for (std::size_t i = 0; i < ranking.size(); ++i) {
    const double y = (points[ranking[i]][0] - 2) / 0.5;
    mean_y += i < p.mu ? p.weights[i] * y : 0;
    rank_mu += p.weights[i] >= 0 ? p.weights[i] * y * y : p.weights[i];  // n / |y|^2 y y' = 1
  }
  EXPECT_NEAR(distribution.mean()[0], 2 + 0.5 * mean_y, 1e-12);
  const double path_s = std::sqrt(p.c_sigma * (2 - p.c_sigma) * p.mu_eff) * mean_y;
  EXPECT_NEAR(distribution.sigma(),
              0.5 * std::exp(p.c_sigma / p.d_sigma * (std::abs(path_s) / p.expected_norm - 1)),
              1e-12);
  const double path_c = std::sqrt(p.c_c * (2 - p.c_c) * p.mu_eff) * mean_y;
  EXPECT_NEAR(distribution.covariance_path()[0], path_c, 1e-12);
  EXPECT_NEAR(distribution.covariance(0, 0),
              1 - p.c_1 - p.c_mu * sum(p.weights) + p.c_1 * path_c * path_c + p.c_mu * rank_mu,
              1e-12);
}

TEST(CmaDistribution, LearnsTheInverseHessian) {
  CmaDistribution distribution(make_cma_parameters(2, {}), std::vector<double>{1, 1}, 0.3);
  RandomStream random("test/cma");
  const auto function = [](std::span<const double> x) {  // turned by 45 degrees, axes 1 : 100
    return std::pow(x[0] + x[1], 2) + 1e4 * std::pow(x[0] - x[1], 2);
  };
  for (int i = 0; i < 200; ++i) {
    distribution.update(rank_by(distribution.sample(random), function));
  }
  const double correlation =
      distribution.covariance(0, 1) /
      std::sqrt(distribution.covariance(0, 0) * distribution.covariance(1, 1));
  EXPECT_GT(correlation, 0.9);
  const double ratio = distribution.longest_axis() / distribution.shortest_axis();
  EXPECT_GT(ratio, 30);
  EXPECT_LT(ratio, 300);
}

TEST(CmaDistribution, StaysPositiveDefiniteWhateverTheRanking) {
  CmaDistribution distribution(make_cma_parameters(5, {.population = 60}),
                               std::vector<double>(5, 0.0), 1);
  RandomStream random("test/cma");
  const auto worst = [](std::span<const double> x) { return -std::abs(x[0]) - 1e-6 * x[1]; };
  for (int i = 0; i < 40; ++i) {
    distribution.update(rank_by(distribution.sample(random), worst));
    ASSERT_GT(distribution.shortest_axis(), 0);
    ASSERT_LT(distribution.longest_axis() / distribution.shortest_axis(), 1e9) << i;
  }
}

// --- the box

TEST(CmaBox, TheMapIsContinuousOntoTheBoxAndInvertible) {
  double previous = calc_share_in_box(-3);
  for (double u = -3; u < 4; u += 1e-3) {
    const double share = calc_share_in_box(u);
    ASSERT_GE(share, 0);
    ASSERT_LE(share, 1);
    ASSERT_LE(std::abs(share - previous), 1.0001e-3) << u;  // its slope is at most one
    previous = share;
  }
  for (const double share : {0.0, 0.001, 0.05, 0.3, 0.95, 0.9999, 1.0}) {
    EXPECT_NEAR(calc_share_in_box(calc_preimage_of_share(share)), share, 1e-15);
  }
  EXPECT_EQ(calc_share_in_box(0.4), 0.4);
  EXPECT_EQ(calc_share_in_box(-0.05), 0);
  EXPECT_NEAR(calc_share_in_box(1.05), 1, 1e-15);
}

// --- termination

TEST(CmaTermination, SaysWhy) {
  const CmaParameters parameters = make_cma_parameters(3, {});
  RandomStream random("test/cma");
  const auto run = [&](double sigma, const std::function<double(std::span<const double>)>& function,
                       const CmaTolerances& tolerances) {
    CmaDistribution distribution(parameters, std::vector<double>(3, 0.5), sigma);
    CmaTermination termination(parameters, tolerances, sigma);
    for (int i = 0; i < 10000; ++i) {
      std::vector<double> values;
      const auto ranking = rank_by(distribution.sample(random), [&](std::span<const double> point) {
        values.push_back(function(point));
        return values.back();
      });
      std::ranges::sort(values);
      distribution.update(ranking);
      const CmaEnd end = termination.check(distribution, values);
      if (end != CmaEnd::none) {
        return end;
      }
    }
    return CmaEnd::none;
  };
  const auto bowl = [](std::span<const double> x) {
    return x[0] * x[0] + x[1] * x[1] + x[2] * x[2];
  };
  const CmaTolerances none{.function = 0, .step = 0};
  EXPECT_EQ(run(0.1, bowl, {.function = 1e-12, .step = 0}), CmaEnd::tol_hist_fun);
  EXPECT_EQ(run(0.1, bowl, {.function = 0, .step = 1e-6}), CmaEnd::tol_x);
  EXPECT_EQ(run(
                0.1, [](std::span<const double>) { return 1.0; }, none),
            CmaEnd::equal_values);
  EXPECT_EQ(run(
                0.1, [](std::span<const double> x) { return -x[0]; }, none),
            CmaEnd::tol_x_up);
  EXPECT_EQ(
      run(
          0.1,
          [](std::span<const double> x) { return 1e30 * x[0] * x[0] + x[1] * x[1] + x[2] * x[2]; },
          none),
      CmaEnd::condition_cov);
  RandomStream noise("test/noise");
  EXPECT_EQ(run(
                0.1, [&](std::span<const double>) { return noise.uniform(); }, none),
            CmaEnd::stagnation);
}

// --- uncertainty

TEST(CmaUncertainty, UnchangedValuesAreNoNoise) {
  const std::vector<double> values = {3, 1, 2, 5, 4};
  const UncertaintyMeasure measure = measure_uncertainty(values, std::vector<double>{3, 1});
  EXPECT_LT(measure.s, 0);
  EXPECT_THAT(measure.ranking, ElementsAre(1, 2, 0, 4, 3));
}

TEST(CmaUncertainty, LargeChangesAreNoise) {
  // The first was best and is last on the second try, the second the other way round.
  const std::vector<double> values = {1, 10, 2, 3, 4, 5};
  const UncertaintyMeasure measure = measure_uncertainty(values, std::vector<double>{11, 0});
  EXPECT_GT(measure.s, 5);
  EXPECT_EQ(measure.ranking.front(), 2u);  // neither of the two
}

}  // namespace
}  // namespace armwright
