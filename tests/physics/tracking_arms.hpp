// The thesis's arm, three of its designs and functions to run them, for tests of whole simulations.
#pragma once

#include <gtest/gtest.h>

#include <initializer_list>
#include <limits>
#include <memory>
#include <numbers>
#include <vector>

#include "sim/engines/engine_table.hpp"
#include "sim/robot/robot_model.hpp"
#include "sim/tracking/simulation.hpp"
#include "sim/tracking/test_case.hpp"

namespace armwright::physics_test {

inline RobotModel load_irb4600() {
  return load_urdf(ARMWRIGHT_CONFIGS "/robots/irb4600_40_255.urdf");
}

struct DriveRow {
  double p, i, d, min_n_m, max_n_m;
};
inline ArmDesign make_design(std::initializer_list<DriveRow> rows) {
  ArmDesign design;
  for (const DriveRow& row : rows) {
    design.joints.push_back({{row.p, row.i, row.d}, {row.min_n_m, row.max_n_m}});
  }
  return design;
}

// Thesis, Tables A.1, A.5 and A.10.
inline const ArmDesign kTableA1 = make_design({{45000, 150000, 7500, -20000, 20000},
                                               {270000, 700000, 30000, -45000, 45000},
                                               {30000, 100000, 5000, -20000, 20000},
                                               {300, 2000, 5, -200, 200}});
inline const ArmDesign kTableA5 = make_design({{976409, 310398, 9536.5, -49684.4, 393380},
                                               {7847550, 14172800, 27433.3, -354273, 336598},
                                               {623523, 5921.86, 5592.14, -214258, 72241.6},
                                               {747.555, 3194.6, 4.01193, -502.821, 1775.12}});
inline const ArmDesign kTableA10 = make_design({{864048, 202279, 10876.1, -7246.87, 7323.93},
                                                {2810730, 7338360, 24059, -14943.4, 12499},
                                                {1531200, 1426490, 4394.7, -5713.1, 4836.06},
                                                {601.378, 13600.6, 3.48375, -946.889, 573.647}});
// The last joint is far beyond the limit of stability (P h^2 / J is about 2e5; the limit is 4) and
// has no effort limits, so its efforts grow without bound.
inline const ArmDesign kExploding = make_design({{45000, 150000, 7500, -20000, 20000},
                                                 {270000, 700000, 30000, -45000, 45000},
                                                 {30000, 100000, 5000, -20000, 20000},
                                                 {1e8, 2000, 5, -1e300, 1e300}});
// A design that is too weak to carry the arm.
inline const ArmDesign kLimp = make_design({{450, 1500, 75, -200, 200},
                                            {2700, 7000, 300, -450, 450},
                                            {300, 1000, 50, -200, 200},
                                            {3, 20, 0.05, -2, 2}});

// Q2's E6: the task of table A.10.
inline TrackingTask make_e6_task() {
  TrackingTask task;
  task.distance_limit_m = 1.6;
  return task;
}

// Returns drives with inner loops of 30 Hz and a delay of 4 ms.
inline ArmDrives make_drives(ControlInterface interface) {
  ArmDrives drives;
  drives.interface = interface;
  drives.bandwidth_rad_per_s = 2 * std::numbers::pi * 30;
  drives.delay_s = 0.004;
  return drives;
}
// Returns E6's task for the controllers of a row of the table.
inline TrackingTask make_e6_task(const ControllerRow& row) {
  TrackingTask task = make_e6_task();
  task.feed_forward = row.feed_forward;
  if (row.interface != ControlInterface::effort) {
    task.physics.substeps = 10;  // the inner loops need them
    task.drives = make_drives(row.interface);
  }
  return task;
}

inline TestCase make_case(std::uint64_t number, int points = 25) {
  WorkspaceSphere sphere;
  sphere.points = points;
  return make_test_case("test/physics", number, sphere);
}

inline constexpr double kNever = std::numeric_limits<double>::infinity();

inline TrackingJob make_job(const ArmDesign& design, const TargetTable& targets,
                            double cutoff_m = kNever, RecordingOptions recording = {}) {
  return {&design, &targets, cutoff_m, recording, kNever};
}

inline TrackingResult simulate_one(const TrackingSetup& setup, const TrackingJob& job) {
  std::vector<TrackingResult> results = make_engine("ode")->simulate(setup, {&job, 1});
  EXPECT_EQ(results.size(), 1u);
  return std::move(results.at(0));
}

// Compares all members of two results, to the last bit.
inline void expect_identical(const TrackingResult& a, const TrackingResult& b) {
  EXPECT_EQ(a.status, b.status);
  EXPECT_EQ(a.reason, b.reason);
  EXPECT_EQ(a.steps, b.steps);
  EXPECT_EQ(a.point_error_m, b.point_error_m);
  EXPECT_EQ(a.mean_error_m, b.mean_error_m);
  EXPECT_EQ(a.peak_effort, b.peak_effort);
  EXPECT_EQ(a.rms_effort, b.rms_effort);
  EXPECT_EQ(a.saturated_share, b.saturated_share);
  EXPECT_EQ(a.energy_j, b.energy_j);
  EXPECT_EQ(a.error_series_m, b.error_series_m);
  ASSERT_EQ(a.trajectory.size(), b.trajectory.size());
  for (std::size_t i = 0; i < a.trajectory.size(); ++i) {
    EXPECT_EQ(a.trajectory[i].time_s, b.trajectory[i].time_s);
    EXPECT_EQ(a.trajectory[i].q, b.trajectory[i].q);
    EXPECT_EQ(a.trajectory[i].target_q, b.trajectory[i].target_q);
    EXPECT_EQ(a.trajectory[i].effort, b.trajectory[i].effort);
    EXPECT_EQ(a.trajectory[i].tip_m, b.trajectory[i].tip_m);
    EXPECT_EQ(a.trajectory[i].target_m, b.trajectory[i].target_m);
  }
}

}  // namespace armwright::physics_test
