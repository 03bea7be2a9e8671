// Compares the measures of the health card with closed forms: sines, clamped signals, places in a
// range.
#include "report/evidence/health.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace armwright {
namespace {

constexpr double kPeriod_s = 0.01;
// The transform adds up 1000 numbers of rounding error 1e-16 each.
constexpr double kRounding = 1e-12;

// Returns an offset and a sine of the given frequency, sampled for `count` periods.
std::vector<double> make_sine(double amplitude, double frequency_hz, std::size_t count,
                              double offset = 0) {
  std::vector<double> values(count);
  for (std::size_t k = 0; k < count; ++k) {
    const double t_s = static_cast<double>(k) * kPeriod_s;
    values[k] = offset + amplitude * std::sin(2 * std::numbers::pi * frequency_hz * t_s + 0.3);
  }
  return values;
}

TEST(Health, ASineAboveTheFloorHasItsRootMeanSquareAndFrequency) {
  const auto ripple = calc_ripple(make_sine(70, 23.5, 1000, 400), kPeriod_s);
  ASSERT_TRUE(ripple);
  EXPECT_NEAR(ripple->rms, 70 / std::numbers::sqrt2, 70 * kRounding);
  EXPECT_NEAR(ripple->frequency_hz, 23.5, kRounding);
}

TEST(Health, SinesAtAndBelowTheFloorDoNotCount) {
  for (const double frequency_hz : {0.1, 3.0, 9.9, kRippleFloor_hz}) {
    const auto ripple = calc_ripple(make_sine(70, frequency_hz, 1000, 400), kPeriod_s);
    ASSERT_TRUE(ripple);
    EXPECT_NEAR(ripple->rms, 0, 400 * kRounding) << frequency_hz;
  }
  const auto above = calc_ripple(make_sine(70, 10.1, 1000), kPeriod_s);
  EXPECT_NEAR(above->rms, 70 / std::numbers::sqrt2, 70 * kRounding);
}

TEST(Health, RipplesAddUpAsPowersAndTheLargestIsDominant) {
  auto values = make_sine(3, 17, 1000);
  const auto larger = make_sine(4, 31, 1000);
  const auto slow = make_sine(1000, 2, 1000);
  for (std::size_t k = 0; k < values.size(); ++k) {
    values[k] += larger[k] + slow[k];
  }
  const auto ripple = calc_ripple(values, kPeriod_s);
  EXPECT_NEAR(ripple->rms, 5 / std::numbers::sqrt2, 1000 * kRounding);
  EXPECT_NEAR(ripple->frequency_hz, 31, kRounding);
}

TEST(Health, AnEffortThatAlternatesEveryPeriodHasItsAmplitude) {
  std::vector<double> values(300);
  for (std::size_t k = 0; k < values.size(); ++k) {
    values[k] = k % 2 == 0 ? 12 : -12;
  }
  const auto ripple = calc_ripple(values, kPeriod_s);
  EXPECT_NEAR(ripple->rms, 12, 12 * kRounding);
  EXPECT_NEAR(ripple->frequency_hz, 50, kRounding);
}

TEST(Health, LeavesOutTheEndOfALengthWithALargePrimeFactor) {
  auto values = make_sine(70, 20, 1009);  // a prime; 1000 are used
  values.back() = 1e6;
  EXPECT_NEAR(calc_ripple(values, kPeriod_s)->rms, 70 / std::numbers::sqrt2, 70 * kRounding);
}

TEST(Health, HasNoRippleWhereNoneCanBeSeen) {
  EXPECT_FALSE(calc_ripple({}, kPeriod_s));
  EXPECT_FALSE(calc_ripple(make_sine(1, 20, 99), kPeriod_s));
  EXPECT_TRUE(calc_ripple(make_sine(1, 20, 100), kPeriod_s));
  EXPECT_FALSE(calc_ripple(make_sine(1, 20, 100), 0.05));  // up to 10 Hz
  auto broken = make_sine(1, 20, 200);
  broken[7] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(calc_ripple(broken, kPeriod_s));
}

TEST(Health, SaturationIsTheShareOfAllPeriods) {
  TrackingResult one;
  one.steps = 100;
  one.saturated_share = {0.5, 0};
  TrackingResult longer;
  longer.steps = 300;
  longer.saturated_share = {0.1, 0.2};
  const TrackingResult unreachable;
  const std::vector<TrackingResult> results = {unreachable, one, longer};
  const auto shares = calc_saturation(results);
  ASSERT_EQ(shares.size(), 2u);
  EXPECT_DOUBLE_EQ(shares[0], (50 + 30) / 400.0);
  EXPECT_DOUBLE_EQ(shares[1], 60 / 400.0);
  EXPECT_TRUE(calc_saturation(std::span(results).first(1)).empty());
}

TEST(Health, GradesFromEachLimitOn) {
  EXPECT_EQ(grade(0.0099, kSaturationLimits), HealthGrade::good);
  EXPECT_EQ(grade(0.01, kSaturationLimits), HealthGrade::watch);
  EXPECT_EQ(grade(0.05, kSaturationLimits), HealthGrade::bad);
  EXPECT_EQ(grade(0.049, kRippleLimits), HealthGrade::good);
  EXPECT_EQ(grade(0.05, kRippleLimits), HealthGrade::watch);
  EXPECT_EQ(grade(0.2, kRippleLimits), HealthGrade::bad);
}

TEST(Health, EffortIsComparedWithTheLimitOnItsSide) {
  const std::vector<double> efforts = {-30, 10, 80};
  EXPECT_DOUBLE_EQ(*calc_used_effort(efforts, -40, 100), 0.8);
  EXPECT_DOUBLE_EQ(*calc_used_effort(efforts, -30, 100), 1);
  EXPECT_DOUBLE_EQ(*calc_used_effort(efforts, 0, 160), 0.5);
  EXPECT_FALSE(calc_used_effort({}, -40, 100));
}

TEST(Health, DistanceToABoundIsAShareOfTheScaledRange) {
  DecisionVariable variable{
      .name = "p", .unit = "", .lower = 10, .upper = 110, .start = 50, .scale = Scale::linear};
  EXPECT_NEAR(calc_bound_distance(variable, 11)->distance, 0.01, kRounding);
  EXPECT_FALSE(calc_bound_distance(variable, 11)->is_upper);
  EXPECT_NEAR(calc_bound_distance(variable, 105)->distance, 0.05, kRounding);
  EXPECT_TRUE(calc_bound_distance(variable, 105)->is_upper);
  // Two decades; a negative range begins with its largest magnitude.
  variable = {.name = "effort_min",
              .unit = "",
              .lower = -1000,
              .upper = -10,
              .start = -100,
              .scale = Scale::logarithmic};
  EXPECT_NEAR(calc_bound_distance(variable, -100)->distance, 0.5, kRounding);
  EXPECT_NEAR(calc_bound_distance(variable, -10 * std::pow(10, 0.02))->distance, 0.01, kRounding);
  EXPECT_TRUE(calc_bound_distance(variable, -11)->is_upper);
  EXPECT_EQ(calc_bound_distance(variable, -1000)->distance, 0);
  variable.upper = variable.lower;
  EXPECT_FALSE(calc_bound_distance(variable, -1000));
}

TEST(Health, PlacesAreSortedByTheirDistanceToABound) {
  const std::vector<DecisionVariable> variables = {
      {.name = "middle", .unit = "", .lower = 0, .upper = 10},
      {.name = "near", .unit = "", .lower = 0, .upper = 10},
      {.name = "fixed", .unit = "", .lower = 1, .upper = 1},
      {.name = "word",
       .unit = "",
       .upper = 2,
       .type = VariableType::category,
       .choices = {"a", "b", "c"}},
      {.name = "flag", .unit = "", .upper = 1, .type = VariableType::integer},
      {.name = "count", .unit = "", .upper = 9, .type = VariableType::integer}};
  const auto places = list_bound_places(variables, std::vector<double>{5, 9.9, 1, 2, 1, 9});
  ASSERT_EQ(places.size(), 3);
  EXPECT_EQ(places[0].variable, 5);
  EXPECT_EQ(places[0].to.distance, 0);
  EXPECT_EQ(places[1].variable, 1);
  EXPECT_TRUE(places[1].to.is_upper);
  EXPECT_EQ(places[2].variable, 0);
}

}  // namespace
}  // namespace armwright
