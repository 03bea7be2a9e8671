// Tests of the whole engine `articulated`: it agrees with one arm in the tracking loop and with the
// engine `ode`, and simulations end early as they should.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "sim/articulated_runs.hpp"
#include "sim/engines/articulated/articulated_arm.hpp"
#include "sim/tracking/tracking_loop.hpp"

namespace armwright {
namespace {

using namespace articulated_test;
using testing::Each;
using testing::MatchesRegex;

TrackingResult simulate_in_loop(const TrackingSetup& setup, const TrackingJob& job) {
  ArticulatedArm arm(setup.robot(), job.targets->start_positions, setup.task().physics);
  return TrackingLoop(setup, job).run(arm);
}

void expect_near(const std::vector<double>& a, const std::vector<double>& b, double relative) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_NEAR(a[i], b[i], relative * std::abs(b[i])) << i;
  }
}

// Compares all measures; counts must be equal.
void expect_close(const TrackingResult& a, const TrackingResult& b, double relative) {
  EXPECT_EQ(a.status, b.status) << a.reason << " / " << b.reason;
  EXPECT_EQ(a.steps, b.steps);
  expect_near(a.point_error_m, b.point_error_m, relative);
  EXPECT_NEAR(a.mean_error_m, b.mean_error_m, relative * b.mean_error_m);
  expect_near(a.peak_effort, b.peak_effort, relative);
  expect_near(a.rms_effort, b.rms_effort, relative);
  EXPECT_EQ(a.saturated_share, b.saturated_share);
  EXPECT_NEAR(a.energy_j, b.energy_j, relative * b.energy_j);
}

struct Published {
  const char* name;
  TrackingTask task;
  const ArmDesign& design;
};
const std::vector<Published> kPublished{{"A.10 on its task", make_e6_task(), kTableA10},
                                        {"A.5 on its task", {}, kTableA5}};

// `cases` test cases of one design on its task.
struct CaseRun {
  CaseRun(const Published& one, std::uint64_t cases, int points = 25)
      : setup(load_irb4600(), one.task) {
    for (std::uint64_t number = 0; number < cases; ++number) {
      tables.push_back(setup.make_targets(make_case(number, points)));
    }
    for (const TargetTable& table : tables) {
      jobs.push_back(make_job(one.design, table));
    }
  }
  std::vector<TrackingResult> simulate(const PhysicsEngine& engine) const {
    return engine.simulate(setup, jobs);
  }
  TrackingSetup setup;
  std::vector<TargetTable> tables;
  std::vector<TrackingJob> jobs;
};

// Rounding errors are 1e-16 m or rad, and these designs do not magnify them much. The position
// errors are 1e-5 m and more.
TEST(ArticulatedEngine, LevelsAgreeWithEachOtherAndWithOneArmInTheLoop) {
  for (const Published& one : kPublished) {
    const CaseRun run(one, 20);
    std::vector<TrackingResult> expected;
    for (const TrackingJob& job : run.jobs) {
      expected.push_back(simulate_in_loop(run.setup, job));
      ASSERT_EQ(expected.back().status, SimulationStatus::ok) << expected.back().reason;
    }
    for (const EngineOptions& options : make_double_options()) {
      const auto results = run.simulate(*make_articulated(options));
      ASSERT_EQ(results.size(), expected.size());
      for (std::size_t i = 0; i < results.size(); ++i) {
        SCOPED_TRACE(testing::Message() << one.name << ", " << describe(options) << ", case " << i);
        expect_close(results[i], expected[i], 1e-9);
      }
    }
  }
}

// The engines differ in how they hold joints together: ODE's links move along tangents. The project
// requires agreement of the mean to one per cent; single cases differ more.
TEST(ArticulatedEngine, AgreesWithOde) {
  for (const Published& one : kPublished) {
    SCOPED_TRACE(one.name);
    const CaseRun run(one, 50);
    const auto results = run.simulate(*make_articulated());
    const auto reference = run.simulate(*make_engine("ode"));
    const double mean_m = calc_mean_m(reference);
    EXPECT_NEAR(calc_mean_m(results), mean_m, 0.01 * mean_m);
    for (std::size_t i = 0; i < results.size(); ++i) {
      EXPECT_EQ(results[i].steps, reference[i].steps) << i;
      EXPECT_NEAR(results[i].mean_error_m, reference[i].mean_error_m,
                  0.05 * reference[i].mean_error_m)
          << i;
      EXPECT_NEAR(results[i].energy_j, reference[i].energy_j, 0.01 * reference[i].energy_j) << i;
    }
  }
}

TEST(ArticulatedEngine, SinglePrecisionHasTheMeanErrorOfDouble) {
  const CaseRun run(kPublished[0], 100);
  const double mean_m = calc_mean_m(run.simulate(*make_articulated()));
  for (EngineOptions options : make_double_options()) {
    options.precision = Precision::single;
    EXPECT_NEAR(calc_mean_m(run.simulate(*make_articulated(options))), mean_m, 1e-3 * mean_m)
        << describe(options);
  }
}

TEST(ArticulatedEngine, RecordsWhatTheLoopRecords) {
  const CaseRun run(kPublished[0], 2, 4);
  for (TrackingJob job : run.jobs) {
    job.recording = {true, true};
    const TrackingResult expected = simulate_in_loop(run.setup, job);
    const TrackingResult found = simulate_alone(*make_articulated(), run.setup, job);
    ASSERT_EQ(found.trajectory.size(), expected.trajectory.size());
    ASSERT_EQ(found.error_series_m.size(), expected.error_series_m.size());
    for (std::size_t k = 0; k < found.trajectory.size(); ++k) {
      const TrajectorySample &a = found.trajectory[k], &b = expected.trajectory[k];
      EXPECT_NEAR(a.time_s, b.time_s, 1e-12);
      EXPECT_EQ(a.target_q, b.target_q);
      EXPECT_EQ(a.target_m, b.target_m);
      EXPECT_LT((a.tip_m - b.tip_m).norm(), 1e-10);
      EXPECT_NEAR(found.error_series_m[k], expected.error_series_m[k], 1e-10);
      for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_NEAR(a.q[i], b.q[i], 1e-10);
        EXPECT_NEAR(a.effort[i], b.effort[i], 1e-3);  // gains of up to 3e6 N m/rad
      }
    }
  }
}

void expect_finite(const TrackingResult& result) {
  const auto check = [](const std::vector<double>& numbers) {
    return std::all_of(numbers.begin(), numbers.end(),
                       [](double number) { return std::isfinite(number); });
  };
  EXPECT_TRUE(check(result.point_error_m));
  EXPECT_TRUE(check(result.peak_effort));
  EXPECT_TRUE(check(result.rms_effort));
  EXPECT_TRUE(check(result.saturated_share));
  EXPECT_TRUE(check(result.error_series_m));
  EXPECT_TRUE(std::isfinite(result.mean_error_m));
  EXPECT_TRUE(std::isfinite(result.energy_j));
  for (const TrajectorySample& sample : result.trajectory) {
    EXPECT_TRUE(check(sample.q) && check(sample.effort) && sample.tip_m.allFinite());
  }
}

// Divergence ends as with one arm alone, and all numbers are finite. The second design gives its
// first joint the largest double as efforts, so that the first step overflows.
TEST(ArticulatedEngine, ADivergenceIsAStatusWithAReasonAndFiniteNumbers) {
  constexpr double kLargest = std::numeric_limits<double>::max();
  ArmDesign overflowing = kTableA5;
  overflowing.joints[0] = {{1, 0, 0}, {kLargest, kLargest}};
  const CaseRun run(kPublished[1], 1, 4);
  for (const ArmDesign& design : {kExploding, overflowing}) {
    for (const double cutoff_m : {kNever, 0.75}) {
      const TrackingJob job = make_job(design, run.tables[0], cutoff_m, {true, true});
      const TrackingResult expected = simulate_in_loop(run.setup, job);
      for (const EngineOptions& options : make_all_options()) {
        SCOPED_TRACE(describe(options));
        const TrackingResult found = simulate_alone(*make_articulated(options), run.setup, job);
        EXPECT_EQ(found.status, SimulationStatus::diverged);
        EXPECT_THAT(
            found.reason,
            MatchesRegex("diverged at 0\\.[0-9]+ s, on the way to point 1: joint [1-4] "
                         "\\(joint_[1-4]\\): (it is at .* rad and moves at .* rad/s|its position "
                         "or speed is not a finite number)"));
        expect_finite(found);
        EXPECT_EQ(found.point_error_m.size(), cutoff_m == kNever ? 0U : 4U);
        EXPECT_THAT(found.point_error_m, Each(cutoff_m));
        EXPECT_EQ(found.mean_error_m, cutoff_m == kNever ? 0 : cutoff_m);
        EXPECT_EQ(found.trajectory.size(), static_cast<std::size_t>(found.steps));
        if (options.precision == Precision::double_) {
          EXPECT_EQ(found.steps, expected.steps);
        }
      }
    }
  }
  const auto found =
      simulate_alone(*make_articulated(), run.setup, make_job(kExploding, run.tables[0]));
  EXPECT_THAT(found.reason, testing::HasSubstr("joint 4 (joint_4)"));
}

// Cut-offs at early and late points, and in a case that is never cut off.
TEST(ArticulatedEngine, CutsOffWhereTheLoopDoes) {
  const CaseRun run({"", make_e6_task(), kTableA1}, 8, 6);
  std::vector<TrackingJob> jobs;
  std::vector<TrackingResult> expected;
  for (const TrackingJob& job : run.jobs) {
    const TrackingResult whole = simulate_in_loop(run.setup, job);
    ASSERT_EQ(whole.status, SimulationStatus::ok) << whole.reason;
    for (const double error_m : whole.point_error_m) {
      jobs.push_back(job);
      jobs.back().cutoff_m = 0.999 * error_m;
      expected.push_back(simulate_in_loop(run.setup, jobs.back()));
    }
    jobs.push_back(job);
    jobs.back().cutoff_m = 1;
    expected.push_back(whole);
  }
  std::vector<bool> seen(6);
  for (const EngineOptions& options : make_double_options()) {
    const auto results = make_articulated(options)->simulate(run.setup, jobs);
    for (std::size_t i = 0; i < jobs.size(); ++i) {
      SCOPED_TRACE(testing::Message() << describe(options) << ", job " << i);
      expect_close(results[i], expected[i], 1e-9);
      EXPECT_EQ(results[i].reason, expected[i].reason);
      const auto first = std::find(results[i].point_error_m.begin(), results[i].point_error_m.end(),
                                   jobs[i].cutoff_m);
      if (results[i].status == SimulationStatus::cut_off) {
        seen.at(static_cast<std::size_t>(first - results[i].point_error_m.begin())) = true;
      }
    }
  }
  EXPECT_GE(std::count(seen.begin(), seen.end(), true), 3);
}

// Returns the bound that is exceeded from point k on: the sum of the errors of the points that
// count, up to k, divided by the number of all points that count.
TEST(ArticulatedEngine, AbandonsAfterThePointThatMakesItCertain) {
  for (const bool count_first : {false, true}) {
    TrackingTask task = make_e6_task();
    task.count_first_point = count_first;
    const CaseRun run({"", task, kTableA1}, 3, 6);
    const std::size_t first = count_first ? 0 : 1;
    for (const EngineOptions& options : make_double_options()) {
      const auto engine = make_articulated(options);
      const auto whole = run.simulate(*engine);
      std::vector<TrackingJob> jobs;
      for (const TrackingJob& job : run.jobs) {
        double sum_m = 0;
        for (std::size_t k = first; k < 6; ++k) {
          sum_m += whole[jobs.size() / (6 - first)].point_error_m[k];
          jobs.push_back(job);
          jobs.back().abandon_above_m = 0.9999 * sum_m / static_cast<double>(6 - first);
        }
      }
      const auto results = engine->simulate(run.setup, jobs);
      for (std::size_t i = 0; i < jobs.size(); ++i) {
        SCOPED_TRACE(testing::Message() << describe(options) << ", job " << i);
        const TrackingResult& complete = whole[i / (6 - first)];
        const std::size_t done = first + i % (6 - first) + 1;  // points simulated
        if (done == 6) {                                       // nothing is left to abandon
          expect_identical(results[i], complete);
          continue;
        }
        EXPECT_EQ(results[i].status, SimulationStatus::abandoned);
        const TrackingResult in_loop = simulate_in_loop(run.setup, jobs[i]);
        expect_close(results[i], in_loop, 1e-9);
        EXPECT_EQ(results[i].reason, in_loop.reason);
        EXPECT_THAT(results[i].reason, MatchesRegex("abandoned after point " +
                                                    std::to_string(done) + " \\([0-9.]+ s\\): .*"));
        EXPECT_EQ(results[i].point_error_m,
                  std::vector<double>(
                      complete.point_error_m.begin(),
                      complete.point_error_m.begin() + static_cast<std::ptrdiff_t>(done)));
        EXPECT_EQ(results[i].steps, run.tables[0].segments[done].first_step);
        EXPECT_GT(results[i].mean_error_m, jobs[i].abandon_above_m);
        EXPECT_LT(results[i].mean_error_m, complete.mean_error_m);
        expect_finite(results[i]);
      }
    }
  }
}

}  // namespace
}  // namespace armwright
