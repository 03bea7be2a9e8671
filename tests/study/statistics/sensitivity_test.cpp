// Sobol indices from a model and from a design, against functions whose indices are known.
#include "study/statistics/sensitivity.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "base/random.hpp"

namespace armwright {
namespace {

using Rows = std::vector<std::vector<double>>;

// Points of independent variables with mean 0 and variance 1, uniform.
Rows draw_points(std::size_t count, std::size_t variables, std::uint64_t seed) {
  RandomStream random("test/sensitivity", seed);
  Rows rows(count, std::vector<double>(variables));
  for (std::vector<double>& row : rows) {
    for (double& x : row) {
      x = random.uniform(-std::numbers::sqrt3, std::numbers::sqrt3);
    }
  }
  return rows;
}

// Gives every column exactly the mean 0 and the variance 1.
void standardize(Rows& rows) {
  for (std::size_t i = 0; i < rows.front().size(); ++i) {
    double mean = 0;
    double square = 0;
    for (const std::vector<double>& row : rows) {
      mean += row[i] / static_cast<double>(rows.size());
    }
    for (std::vector<double>& row : rows) {
      row[i] -= mean;
      square += row[i] * row[i] / static_cast<double>(rows.size());
    }
    for (std::vector<double>& row : rows) {
      row[i] /= std::sqrt(square);
    }
  }
}

TEST(Sensitivity, OfAQuadraticIsThatOfItsCoefficients) {
  // f = 2 z_0 + z_1 + 0.5 z_0 z_1, and z_2 does nothing: variances 4, 1 and 0.25 of 5.25.
  Rows points = draw_points(120, 3, 1);
  standardize(points);
  std::vector<double> values;
  for (const std::vector<double>& z : points) {
    values.push_back(100 + 2 * z[0] + z[1] + 0.5 * z[0] * z[1]);
  }
  const auto found = calc_model_sensitivity(points, values, "test");
  ASSERT_TRUE(found);
  EXPECT_EQ(found->terms, ModelTerms::products);
  // The least penalty is 1e-8 of the variance of a term.
  EXPECT_NEAR(found->explained, 1, 1e-6);
  EXPECT_NEAR(found->variables[0].first, 4 / 5.25, 1e-6);
  EXPECT_NEAR(found->variables[0].total, 4.25 / 5.25, 1e-6);
  EXPECT_NEAR(found->variables[1].first, 1 / 5.25, 1e-6);
  EXPECT_NEAR(found->variables[1].total, 1.25 / 5.25, 1e-6);
  EXPECT_NEAR(found->variables[2].total, 0, 1e-6);
  EXPECT_NEAR(found->variables[0].total_interval.upper, 4.25 / 5.25, 1e-5);
}

TEST(Sensitivity, TheModelSaysWhatItCannotExplain) {
  const Rows points = draw_points(100, 5, 2);
  RandomStream random("test/noise");
  std::vector<double> noise(points.size());
  for (double& value : noise) {
    value = random.normal();
  }
  EXPECT_LT(calc_model_sensitivity(points, noise, "test")->explained, 0.1);
  // Half of the variance of these values is noise.
  std::vector<double> half;
  for (std::size_t i = 0; i < points.size(); ++i) {
    half.push_back(points[i][0] + noise[i]);
  }
  EXPECT_NEAR(calc_model_sensitivity(points, half, "test")->explained, 0.5, 0.15);
}

TEST(Sensitivity, TheIntervalsCoverTheTruthUnderNoise) {
  // f = 2 z_0 + z_1 + z_0 z_2, with noise of a sixth of the variance.
  int covered = 0;
  int all = 0;
  const auto count = [&](const Interval& interval, double truth) {
    covered += interval.lower <= truth && truth <= interval.upper ? 1 : 0;
    ++all;
  };
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const Rows points = draw_points(150, 3, seed);
    RandomStream random("test/coverage", seed);
    std::vector<double> values;
    for (const std::vector<double>& z : points) {
      values.push_back(2 * z[0] + z[1] + z[0] * z[2] + random.normal());
    }
    const auto found = calc_model_sensitivity(points, values, "test");
    count(found->variables[0].first_interval, 4.0 / 6);
    count(found->variables[0].total_interval, 5.0 / 6);
    count(found->variables[1].first_interval, 1.0 / 6);
    count(found->variables[2].total_interval, 1.0 / 6);
  }
  // 95 %, less what the moments of 150 points differ from those of the distribution.
  EXPECT_GE(covered, 0.88 * all);
  EXPECT_LE(covered, 0.99 * all);  // longer intervals would say less than the points do
}

TEST(Sensitivity, OfIshigamisFunctionIsWhatIsKnown) {
  // f = sin x_0 + 7 sin^2 x_1 + 0.1 x_2^4 sin x_0 on [-pi, pi]^3. Its variances (Saltelli et al.
  // 2008, Global Sensitivity Analysis, section 4): V_0 = (1 + 0.1 pi^4 / 5)^2 / 2, V_1 = 49 / 8,
  // V_02 = 0.01 pi^8 (1 / 18 - 1 / 50).
  const double pi = std::numbers::pi;
  const double v0 = 0.5 * std::pow(1 + 0.1 * std::pow(pi, 4) / 5, 2);
  const double v1 = 49.0 / 8;
  const double v02 = 0.01 * std::pow(pi, 8) * (1.0 / 18 - 1.0 / 50);
  const double v = v0 + v1 + v02;
  const std::vector<double> lower(3, -pi);
  const std::vector<double> upper(3, pi);
  constexpr std::size_t kRows = 4000;
  std::vector<double> values;
  for (const std::vector<double>& x : make_sensitivity_design(lower, upper, kRows, "test")) {
    values.push_back(std::sin(x[0]) + 7 * std::pow(std::sin(x[1]), 2) +
                     0.1 * std::pow(x[2], 4) * std::sin(x[0]));
  }
  ASSERT_EQ(values.size(), kRows * 5);
  const auto found = calc_design_sensitivity(values, 3, "test");
  ASSERT_TRUE(found);
  // Means of 4000 numbers with deviations of about the variance: 1 / sqrt(4000) = 0.016, twice.
  constexpr double kTolerance = 0.035;
  EXPECT_NEAR((*found)[0].first, v0 / v, kTolerance);
  EXPECT_NEAR((*found)[1].first, v1 / v, kTolerance);
  EXPECT_NEAR((*found)[2].first, 0, kTolerance);
  EXPECT_NEAR((*found)[0].total, (v0 + v02) / v, kTolerance);
  EXPECT_NEAR((*found)[1].total, v1 / v, kTolerance);
  EXPECT_NEAR((*found)[2].total, v02 / v, kTolerance);
  EXPECT_LT((*found)[0].total_interval.lower, (v0 + v02) / v);
  EXPECT_GT((*found)[0].total_interval.upper, (v0 + v02) / v);
}

TEST(Sensitivity, RowsOfADesignWithoutANumberAreLeftOut) {
  const std::vector<double> lower(2, 0);
  const std::vector<double> upper(2, 1);
  std::vector<double> values;
  for (const std::vector<double>& x : make_sensitivity_design(lower, upper, 200, "test")) {
    values.push_back(x[0]);
  }
  values[5] = values[2 * 200 + 7] = std::numeric_limits<double>::quiet_NaN();
  const auto found = calc_design_sensitivity(values, 2, "test");
  EXPECT_NEAR((*found)[0].total, 1, 0.2);
  EXPECT_EQ((*found)[1].total, 0);
  std::fill(values.begin(), values.begin() + 197, std::numeric_limits<double>::quiet_NaN());
  EXPECT_FALSE(calc_design_sensitivity(values, 2, "test"));
}

TEST(Sensitivity, FewPointsAndConstantsGiveNothing) {
  const Rows points = draw_points(30, 2, 3);
  std::vector<double> values(30, 5);
  EXPECT_FALSE(calc_model_sensitivity(points, values, "test"));
  values[3] = 6;
  EXPECT_TRUE(calc_model_sensitivity(points, values, "test"));
  EXPECT_FALSE(
      calc_model_sensitivity(std::span(points).first(7), std::span(values).first(7), "test"));
  EXPECT_FALSE(calc_model_sensitivity(Rows(30, {1, 2}), values, "test"));
  EXPECT_THROW(calc_model_sensitivity(points, std::span(values).first(7), "test"),
               std::invalid_argument);
  values[4] = std::numeric_limits<double>::infinity();
  EXPECT_THROW(calc_model_sensitivity(points, values, "test"), std::invalid_argument);
}

TEST(Sensitivity, AVariableThatDoesNotVaryHasNoShare) {
  Rows points = draw_points(60, 3, 4);
  std::vector<double> values;
  for (std::vector<double>& row : points) {
    row[1] = 7;
    row[2] = row[2] > 0 ? 1 : 0;  // a switch has no square of its own
    values.push_back(row[0] + row[2]);
  }
  const auto found = calc_model_sensitivity(points, values, "test");
  EXPECT_EQ(found->variables[1].total, 0);
  EXPECT_GT(found->variables[2].total, 0.1);
  EXPECT_NEAR(found->explained, 1, 1e-5);
}

}  // namespace
}  // namespace armwright
