#include "study/statistics/summary.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "problems/tracking/tracking_problem.hpp"

namespace armwright {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

TEST(Summary, OfNothingHasNoNumbers) {
  const ErrorSummary summary = summarize({}, kFailureError_m);
  EXPECT_EQ(summary.cases, 0U);
  EXPECT_EQ(summary.without_number, 0U);
  EXPECT_EQ(summary.failures, 0U);
  EXPECT_FALSE(summary.mean);
  EXPECT_FALSE(summary.median);
  EXPECT_FALSE(summary.percentile_95);
  EXPECT_FALSE(summary.worst);
}

TEST(Summary, OfOneCaseIsThatCase) {
  const ErrorSummary summary = summarize(std::vector{0.0625}, kFailureError_m);
  EXPECT_EQ(summary.cases, 1U);
  EXPECT_EQ(summary.mean, 0.0625);
  EXPECT_EQ(summary.median, 0.0625);
  EXPECT_EQ(summary.percentile_95, 0.0625);
  EXPECT_EQ(summary.worst, 0.0625);
}

TEST(Summary, OddNumberHasItsMiddleAsMedian) {
  const ErrorSummary summary =
      summarize(std::vector{0.5, 0.125, 4.0, 0.25, 0.375}, kFailureError_m);
  EXPECT_EQ(summary.mean, 1.05);  // 5.25 / 5, the sum exact
  EXPECT_EQ(summary.median, 0.375);
  // Position 0.95 (5 - 1) = 3.8 from 0: between 0.5 and 4, four fifths of the way.
  EXPECT_NEAR(*summary.percentile_95, 3.3, 1e-15 * 10);
  EXPECT_EQ(summary.worst, 4);
}

TEST(Summary, EvenNumberHasTheMeanOfTheMiddleTwoAsMedian) {
  const ErrorSummary summary = summarize(std::vector{8.0, 1.0, 2.0, 4.0}, kFailureError_m);
  EXPECT_EQ(summary.mean, 3.75);
  EXPECT_EQ(summary.median, 3);
  // Position 0.95 (4 - 1) = 2.85: between 4 and 8.
  EXPECT_NEAR(*summary.percentile_95, 7.4, 1e-14);
  EXPECT_EQ(summary.worst, 8);
}

TEST(Summary, PercentileThatFallsOnACaseIsThatCase) {
  std::vector<double> errors;
  for (int i = 0; i <= 100; ++i) {
    errors.push_back((i * 37) % 101);  // 0 to 100 in disorder
  }
  const ErrorSummary summary = summarize(errors, kFailureError_m);
  // 0.95 x 100 rounds to 95 or its neighbour in double precision; the neighbours' share is 1e-14.
  EXPECT_NEAR(*summary.percentile_95, 95, 1e-12);
  EXPECT_EQ(summary.median, 50);
  EXPECT_EQ(summary.mean, 50);
}

TEST(Summary, FailuresAreCountedAboveTheLimitOnly) {
  const ErrorSummary summary =
      summarize(std::vector{kFailureError_m, std::nextafter(kFailureError_m, 1),
                            std::nextafter(kFailureError_m, 0), 3.0, kNone},
                kFailureError_m);
  EXPECT_EQ(summary.cases, 5U);
  EXPECT_EQ(summary.without_number, 1U);
  EXPECT_EQ(summary.failures, 3U);  // the one just above, the 3 m, the one without a number
}

TEST(Summary, CaseWithoutNumberCountsAsTheLargestOfAll) {
  const ErrorSummary summary = summarize(std::vector{kNone, 1.0, 3.0, 2.0, kNone}, kFailureError_m);
  EXPECT_EQ(summary.cases, 5U);
  EXPECT_EQ(summary.without_number, 2U);
  EXPECT_EQ(summary.failures, 5U);
  EXPECT_EQ(summary.mean, 2);    // of the three that have one
  EXPECT_EQ(summary.median, 3);  // 1 2 3 - -
  EXPECT_FALSE(summary.percentile_95);
  EXPECT_FALSE(summary.worst);
}

TEST(Summary, MedianNeedsBothItsNeighbours) {
  // 1 2 | - -: the median lies between 2 and a case without a number, so there is none.
  const ErrorSummary half = summarize(std::vector{1.0, kNone, 2.0, kNone}, kFailureError_m);
  EXPECT_EQ(half.mean, 1.5);
  EXPECT_FALSE(half.median);
  // 1 2 3 -: the median lies between 2 and 3.
  EXPECT_EQ(summarize(std::vector{3.0, 1.0, kNone, 2.0}, kFailureError_m).median, 2.5);
  // 1 - -: more than half of the cases have no number.
  EXPECT_FALSE(summarize(std::vector{kNone, 1.0, kNone}, kFailureError_m).median);
}

TEST(Summary, PercentileToleratesWhatLiesAboveIt) {
  // 41 cases, one without a number: position 0.95 x 40 = 38, whose neighbour 39 still has one.
  std::vector<double> errors(40);
  for (std::size_t i = 0; i < errors.size(); ++i) {
    errors[i] = static_cast<double>(i);
  }
  errors.push_back(kNone);
  EXPECT_NEAR(*summarize(errors, kFailureError_m).percentile_95, 38, 1e-12);
  EXPECT_FALSE(summarize(errors, kFailureError_m).worst);
}

TEST(Summary, AllWithoutNumberLeavesTheCountsOnly) {
  const ErrorSummary summary = summarize(std::vector{kNone, kNone, kNone}, kFailureError_m);
  EXPECT_EQ(summary.cases, 3U);
  EXPECT_EQ(summary.without_number, 3U);
  EXPECT_EQ(summary.failures, 3U);
  EXPECT_FALSE(summary.mean);
  EXPECT_FALSE(summary.median);
  EXPECT_FALSE(summary.percentile_95);
  EXPECT_FALSE(summary.worst);
}

TEST(Summary, OrderDoesNotMatter) {
  std::vector<double> errors = {0.25, kNone, 0.5, 4, 0.125, 0.0625};  // sums of these are exact
  const ErrorSummary first = summarize(errors, kFailureError_m);
  for (int turn = 0; turn < 6; ++turn) {
    std::rotate(errors.begin(), errors.begin() + 1, errors.end());
    const ErrorSummary turned = summarize(errors, kFailureError_m);
    EXPECT_EQ(turned.mean, first.mean);
    EXPECT_EQ(turned.median, first.median);
    EXPECT_EQ(turned.percentile_95, first.percentile_95);
    EXPECT_EQ(turned.failures, first.failures);
  }
  EXPECT_EQ(first.median, 0.375);
}

}  // namespace
}  // namespace armwright
