// Simulations that are abandoned as soon as their error is certain to exceed a bound.
#include <gmock/gmock.h>

#include <algorithm>

#include "tracking_arms.hpp"

namespace armwright::physics_test {
namespace {

using testing::StartsWith;

struct LimpArm {
  explicit LimpArm(bool count_first_point) {
    TrackingTask task;
    task.count_first_point = count_first_point;
    setup.emplace(load_irb4600(), task);
    targets = setup->make_targets(make_case(0, 6));
    whole = simulate_one(*setup, make_job(kLimp, targets));
  }
  TrackingResult run(double bound_m, double cutoff_m = kNever) const {
    TrackingJob job = make_job(kLimp, targets, cutoff_m);
    job.abandon_above_m = bound_m;
    return simulate_one(*setup, job);
  }
  // Returns the lower bound of the error that is certain after so many points.
  double calc_bound_m(std::size_t points) const {
    const std::size_t first = setup->task().count_first_point ? 0 : 1;
    double sum_m = 0;
    for (std::size_t k = first; k < points; ++k) {
      sum_m += whole.point_error_m[k];
    }
    return sum_m / static_cast<double>(whole.point_error_m.size() - first);
  }

  std::optional<TrackingSetup> setup;
  TargetTable targets;
  TrackingResult whole;
};

TEST(Abandonment, EndsAfterThePointThatMakesItCertain) {
  for (const bool count_first_point : {false, true}) {
    const LimpArm arm(count_first_point);
    ASSERT_EQ(arm.whole.status, SimulationStatus::ok) << arm.whole.reason;
    const std::size_t points = arm.whole.point_error_m.size();
    for (std::size_t done = count_first_point ? 1 : 2; done < points; ++done) {
      SCOPED_TRACE(done);
      // A bound just below the lower bound after `done` points, and above that after one point
      // less.
      const double bound_m = std::nextafter(arm.calc_bound_m(done), 0);
      ASSERT_GT(bound_m, arm.calc_bound_m(done - 1));
      const TrackingResult result = arm.run(bound_m);
      EXPECT_EQ(result.status, SimulationStatus::abandoned);
      EXPECT_THAT(result.reason,
                  StartsWith("abandoned after point " + std::to_string(done) + " ("));
      ASSERT_EQ(result.point_error_m.size(), done);
      EXPECT_TRUE(std::equal(result.point_error_m.begin(), result.point_error_m.end(),
                             arm.whole.point_error_m.begin()));
      EXPECT_EQ(result.mean_error_m, arm.calc_bound_m(done));
      EXPECT_LT(result.steps, arm.whole.steps);
      EXPECT_EQ(result.steps, arm.targets.segments[done].first_step);
    }
  }
}

TEST(Abandonment, WhatIsNotAbandonedIsTheSameToTheLastBit) {
  const LimpArm arm(false);
  const std::size_t points = arm.whole.point_error_m.size();
  expect_identical(arm.run(arm.whole.mean_error_m), arm.whole);  // reached, not exceeded
  // Only the last point exceeds it, so the simulation is complete.
  const double bound_m = arm.calc_bound_m(points - 1);
  ASSERT_GT(arm.whole.mean_error_m, bound_m);
  expect_identical(arm.run(bound_m), arm.whole);
}

TEST(Abandonment, ACutOffComesFirstWhereItIsReachedFirst) {
  const LimpArm arm(true);
  const double cutoff_m = 0.5 * arm.whole.point_error_m[0];
  const TrackingResult cut = arm.run(1e-6, cutoff_m);
  EXPECT_EQ(cut.status, SimulationStatus::cut_off);
  EXPECT_NEAR(cut.mean_error_m, cutoff_m, 1e-14 * cutoff_m);  // the mean of equal numbers
  EXPECT_EQ(arm.run(1e-6, 1e3).status, SimulationStatus::abandoned);
  EXPECT_EQ(arm.run(1e-6, 1e3).point_error_m.size(), 1U) << "nothing is filled in";
}

}  // namespace
}  // namespace armwright::physics_test
