// Progress that `armwright watch` shows: rates from observations at given times.
#include "report/page/progress_meter.hpp"

#include <gtest/gtest.h>

namespace armwright {
namespace {

TEST(RateEstimate, NothingIsKnownFromOneObservation) {
  RateEstimate rate;
  EXPECT_FALSE(rate.calc_per_second());
  EXPECT_FALSE(rate.calc_left_s());
  rate.add(0, 500, 500, 1000);
  EXPECT_FALSE(rate.calc_per_second());
  EXPECT_FALSE(rate.calc_left_s());
}

TEST(RateEstimate, CountsOnlyWhatWasDoneSinceTheFirstObservation) {
  RateEstimate rate;
  rate.add(10, 500, 500, 1000);
  rate.add(20, 600, 550, 1000);
  EXPECT_EQ(rate.calc_per_second(), 10);  // 100 simulations in 10 s
  EXPECT_EQ(rate.calc_left_s(), 90);      // 450 at 5 per second
}

TEST(RateEstimate, ThroughputIsThatOfTheLastMinute) {
  RateEstimate rate;
  for (int second = 0; second <= 200; second += 20) {
    rate.add(second, second <= 100 ? 10.0 * second : 1000 + 2.0 * (second - 100), second, 400);
  }
  EXPECT_EQ(rate.calc_per_second(), 2);
  EXPECT_EQ(rate.calc_left_s(), 200);  // the work goes on at one per second
}

TEST(RateEstimate, NothingIsLeftToEstimateWhenNothingHappens) {
  RateEstimate rate;
  rate.add(0, 0, 0, 100);
  rate.add(10, 50, 50, 100);
  rate.add(71, 50, 50, 100);
  EXPECT_FALSE(rate.calc_per_second());  // the last minute has one observation
  EXPECT_FALSE(rate.calc_left_s());
  rate.add(80, 50, 50, 100);
  EXPECT_EQ(rate.calc_per_second(), 0);
  EXPECT_FALSE(rate.calc_left_s());
}

}  // namespace
}  // namespace armwright
