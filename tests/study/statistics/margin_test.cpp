#include "study/statistics/margin.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "study/statistics/support.hpp"

namespace armwright {
namespace {

TEST(Margin, WithoutAResolutionEveryDifferenceCounts) {
  const Margin margin;
  EXPECT_FALSE(margin.is_equal(1e-300, 2e-300));
  EXPECT_TRUE(margin.is_equal(kInf, kInf));
  EXPECT_EQ(margin.round(1e-300), 1e-300);
  EXPECT_EQ(margin.round(-0.1), -0.1);
}

TEST(Margin, DifferencesWithinTheResolutionAreNone) {
  const Margin margin{.resolution = 0.25};
  EXPECT_TRUE(margin.is_equal(1, 1.25));
  EXPECT_TRUE(margin.is_equal(1.25, 1));
  EXPECT_FALSE(margin.is_equal(1, 1.375));
  EXPECT_FALSE(margin.is_equal(1, kInf));
  EXPECT_TRUE(margin.is_equal(kInf, kInf));
}

TEST(Margin, RoundsToMultiples) {
  const Margin margin{.resolution = 0.25};
  EXPECT_EQ(margin.round(1.1), 1);
  EXPECT_EQ(margin.round(1.2), 1.25);
  EXPECT_EQ(margin.round(-1.1), -1);
  EXPECT_EQ(margin.round(kInf), kInf);
  EXPECT_EQ(margin.round(1e300), 1e300);  // a finite value never becomes a failure
}

TEST(Margin, CountsMultiplesFromTheOptimumAndJoinsAllSuccesses) {
  const Margin margin{.resolution = 0.25, .optimum = -44.1};
  EXPECT_EQ(margin.round(-44.1), -44.1);
  EXPECT_EQ(margin.round(-43.9), -44.1);
  EXPECT_EQ(margin.round(-44.2), -44.1);  // rounding noise below the optimum
  EXPECT_EQ(margin.round(-43.8), -44.1 + 0.25);
  EXPECT_TRUE(margin.is_success(-43.9));
  EXPECT_FALSE(margin.is_success(-43.8));
  EXPECT_FALSE(margin.is_success(kInf));
}

TEST(Margin, AppliesBeforeTheLogarithm) {
  const Margin margin{.resolution = 1e-6, .logarithm = true};
  EXPECT_TRUE(margin.is_equal(std::log(1e-9), std::log(9e-7)));
  EXPECT_FALSE(margin.is_equal(std::log(1e-4), std::log(1.02e-4)));
  EXPECT_EQ(margin.round(std::log(1e-9)), 0);
  EXPECT_NEAR(margin.round(std::log(1.2e-5)), 1.2e-5, 1e-15);
  EXPECT_TRUE(margin.is_success(std::log(1e-9)));
  EXPECT_TRUE(std::isfinite(margin.round(800)));
}

}  // namespace
}  // namespace armwright
