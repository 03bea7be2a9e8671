// Measures of the tip's response on motions whose measures are known in closed form.
#include "sim/tracking/response.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <numbers>

namespace armwright {
namespace {

using Eigen::Vector3d;
using testing::ElementsAre;

constexpr double kSamplePeriod_s = 0.01;
const Vector3d kFrom_m(1.2, -0.4, 0.7);
const Vector3d kWay_m(0.3, 0.6, -0.6);  // 0.9 m long
constexpr double kLength_m = 0.9;

// Returns a table with one move of `moving` periods, then `resting` periods of rest.
TargetTable make_table(int moving, int resting, const Vector3d& way_m = kWay_m) {
  Segment segment;
  segment.from_m = kFrom_m;
  segment.to_m = kFrom_m + way_m;
  segment.steps = moving + resting;
  segment.window_start = std::max(0, moving - 1);
  segment.duration_s = moving * kSamplePeriod_s;
  TargetTable table;
  table.steps = segment.steps;
  table.segments = {segment};
  table.joints = 2;
  return table;
}

// Returns the tip's positions from two functions of time: the share of the move that is covered,
// and the distance beside the move, at right angles.
TipMove make_motion(const TargetTable& table, const std::function<double(double)>& along,
                    double beside_m = 0) {
  const Vector3d beside = beside_m * kWay_m.cross(Vector3d::UnitZ()).normalized();
  std::vector<Vector3d> tips_m;
  for (int k = 1; k <= table.steps; ++k) {
    tips_m.push_back(kFrom_m + along(k * kSamplePeriod_s) * kWay_m + beside);
  }
  return find_tip_move(table, 0, tips_m, kSamplePeriod_s).value();
}

// The step response of 1 / (s^2 / w^2 + 2 z s / w + 1), underdamped.
std::function<double(double)> make_second_order(double damping, double w_rad_per_s) {
  const double root = std::sqrt(1 - damping * damping);
  return [=](double t_s) {
    const double phase = w_rad_per_s * root * t_s;
    return 1 - std::exp(-damping * w_rad_per_s * t_s) *
                   (std::cos(phase) + damping / root * std::sin(phase));
  };
}

TEST(Response, OfASecondOrderStepHasTheTextbooksOvershoot) {
  const TargetTable table = make_table(10, 190);
  for (const double damping : {0.2, 0.5, 0.7}) {
    const double w = 12;
    const double expected =
        std::exp(-std::numbers::pi * damping / std::sqrt(1 - damping * damping));
    // The peak is missed by at most |s''| h^2 / 8, and |s''| <= w^2 there.
    const double tolerance = w * w * kSamplePeriod_s * kSamplePeriod_s / 8;
    EXPECT_NEAR(calc_overshoot(make_motion(table, make_second_order(damping, w))), expected,
                tolerance)
        << damping;
  }
}

TEST(Response, OfAFirstOrderStepHasTheTextbooksTimes) {
  const double tau_s = 0.15;
  const TargetTable table = make_table(10, 190);
  const TipMove move = make_motion(table, [&](double t_s) { return 1 - std::exp(-t_s / tau_s); });
  // Chords of a curve with |s''| <= 1 / tau^2 s': each crossing is off by less than h^2 / (8 tau).
  const double tolerance_s = 2 * kSamplePeriod_s * kSamplePeriod_s / (8 * tau_s);
  EXPECT_EQ(calc_overshoot(move), 0);
  EXPECT_NEAR(calc_rise_time_s(move), tau_s * std::log(9), tolerance_s);
  for (const double share : {0.02, 0.05}) {
    EXPECT_NEAR(calc_settling_time_s(move, share * kLength_m), tau_s * std::log(1 / share) - 0.1,
                tolerance_s)
        << share;
  }
}

TEST(Response, SettlesOnlyWhenItStaysInside) {
  // Inside the band from 0.2 s, outside again from 0.5 to 0.6 s, then inside until the end.
  const TipMove move = make_motion(make_table(10, 90), [](double t_s) {
    return t_s < 0.195 ? 0.5 : t_s > 0.495 && t_s < 0.605 ? 1.1 : 1.0;
  });
  // Between 0.60 s (90 mm off) and 0.61 s (none): 10 mm is reached 8/9 of a period later.
  EXPECT_NEAR(calc_settling_time_s(move, 0.01), 0.6 + 8.0 / 9 * kSamplePeriod_s - 0.1, 1e-12);
  EXPECT_NEAR(calc_settling_time_s(move, 0.1), 0.19 + kSamplePeriod_s * (0.45 - 0.1) / 0.45 - 0.1,
              1e-12);
  EXPECT_NEAR(calc_overshoot(move), 0.1, 1e-12);
}

TEST(Response, WhatIsBesideTheMoveHindersSettlingAlone) {
  const TargetTable table = make_table(10, 40);
  const auto arrive = [](double t_s) { return std::min(1.0, t_s / 0.1); };
  const TipMove move = make_motion(table, arrive, 0.02);
  EXPECT_EQ(calc_overshoot(move), 0);
  EXPECT_NEAR(calc_rise_time_s(move), 0.08, 1e-12);
  EXPECT_NEAR(calc_settling_time_s(move, 0.019), 0.4, 1e-12);  // the whole rest: it never settles
  EXPECT_EQ(calc_settling_time_s(move, 0.021), 0);
}

TEST(Response, ATipThatNeverArrivesCountsAllTheTimeItHad) {
  const TipMove move = make_motion(make_table(10, 40), [](double) { return 0.89; });
  EXPECT_NEAR(calc_rise_time_s(move), 0.5, 1e-12);
  EXPECT_NEAR(calc_settling_time_s(move, 0.01), 0.4, 1e-12);
  const TipMove gone = make_motion(make_table(10, 40), [](double t_s) { return -t_s; });
  EXPECT_NEAR(calc_rise_time_s(gone), 0.5, 1e-12);
  EXPECT_EQ(calc_overshoot(gone), 0);
}

TEST(Response, ATipThatIsThereAtOnceHasNoTimes) {
  const TipMove move = make_motion(make_table(10, 40), [](double) { return 1.0; });
  EXPECT_NEAR(calc_rise_time_s(move), 0.8 * kSamplePeriod_s, 1e-12);  // within the first period
  EXPECT_EQ(calc_settling_time_s(move, 1e-6), 0);
}

TEST(Response, OnlyMovesHaveOne) {
  EXPECT_TRUE(is_move(make_table(2, 3).segments[0]));
  EXPECT_FALSE(is_move(make_table(1, 3).segments[0]));  // ends within the first period
  EXPECT_FALSE(is_move(make_table(0, 1).segments[0]));  // a sample of a path
  EXPECT_FALSE(is_move(make_table(10, 40, Vector3d::Zero()).segments[0]));
  EXPECT_FALSE(is_move(make_table(10, 40, Vector3d(0, 0.0009, 0)).segments[0]));
  EXPECT_TRUE(is_move(make_table(10, 40, Vector3d(0, 0.0011, 0)).segments[0]));
  const std::vector<Vector3d> too_few(49, kFrom_m);
  EXPECT_FALSE(find_tip_move(make_table(10, 40), 0, too_few, kSamplePeriod_s));
}

// Two segments: a move of 3 periods with a rest of 2, then a move of 2 with a rest of 3. The last
// period of each move ends with the target's arrival, so it counts as rest.
class MovingTip : public testing::Test {
 protected:
  MovingTip() {
    Segment second = make_table(2, 3).segments[0];
    second.first_step = table_.steps;
    table_.steps += second.steps;
    table_.segments.push_back(second);
  }
  TargetTable table_ = make_table(3, 2);
  std::vector<double> errors_m_ = {0.1, 0.4, 0.7, 0.2, 0.1, 0.03, 0.5, 0.6, 0.01, 0.02};
};

TEST_F(MovingTip, CountsMovesFromTheFirstCountedPointOn) {
  const auto later = measure_motion({}, table_, errors_m_).summarize();
  EXPECT_DOUBLE_EQ(later->moving_rms_m, 0.03);
  EXPECT_EQ(later->moving_peak_m, 0.03);
  EXPECT_EQ(later->start_up_m, 0.7);  // the move and the rest of the first segment
  TrackingTask all;
  all.count_first_point = true;
  const auto both = measure_motion(all, table_, errors_m_).summarize();
  EXPECT_DOUBLE_EQ(both->moving_rms_m, std::sqrt((0.01 + 0.16 + 0.0009) / 3));
  EXPECT_EQ(both->moving_peak_m, 0.4);
  EXPECT_EQ(both->start_up_m, 0.7);
}

TEST_F(MovingTip, OfSeveralCasesIsThatOfAllTheirPeriods) {
  MotionErrors sum = measure_motion({}, table_, errors_m_);
  std::vector<double> other = errors_m_;
  other[0] = 0.9;
  other[5] = 0.05;
  sum.add(measure_motion({}, table_, other));
  const auto summary = sum.summarize();
  EXPECT_DOUBLE_EQ(summary->moving_rms_m, std::sqrt((0.0009 + 0.0025) / 2));
  EXPECT_EQ(summary->moving_peak_m, 0.05);
  EXPECT_EQ(summary->start_up_m, 0.9);
  EXPECT_FALSE(MotionErrors().summarize());
}

TEST_F(MovingTip, OfAContinuousPathHasAllSamplesAndNoStart) {
  table_.segments.clear();
  table_.steps = 0;
  for (int k = 0; k < 4; ++k) {
    Segment sample = make_table(0, 1).segments[0];
    sample.is_sample = true;
    sample.first_step = table_.steps++;
    table_.segments.push_back(sample);
  }
  TrackingTask task;
  task.count_first_point = true;
  const std::vector<double> errors_m = {0.5, 0.1, 0.1, 0.3};
  const auto summary = measure_motion(task, table_, errors_m).summarize();
  EXPECT_DOUBLE_EQ(summary->moving_rms_m, 0.3);
  EXPECT_EQ(summary->moving_peak_m, 0.5);
  EXPECT_FALSE(summary->start_up_m);
}

TEST(Response, ALaterMoveBeginsWhereTheTipWas) {
  TargetTable table = make_table(10, 40);
  Segment back = table.segments[0];
  std::swap(back.from_m, back.to_m);
  back.first_step = 50;
  table.segments.push_back(back);
  std::vector<Vector3d> tips_m(50, kFrom_m + 1.01 * kWay_m);
  tips_m.resize(100, kFrom_m);
  const TipMove move = find_tip_move(table, 1, tips_m, kSamplePeriod_s).value();
  ASSERT_EQ(move.along_m.size(), 51u);
  EXPECT_NEAR(move.along_m[0], -0.01 * kLength_m, 1e-12);
  EXPECT_NEAR(move.along_m[1], kLength_m, 1e-12);
}

TEST(JointSpeeds, AreTheLargestOfAnyStepTheShortWayRound) {
  RobotModel robot;
  robot.joints.resize(2);
  robot.joints[1].kind = JointKind::prismatic;
  TargetTable table = make_table(1, 2);
  table.start_positions = {3.1, 0};
  TrackingResult result;
  // The first joint turns by 0.083 rad past pi. The second one slides by 7 m, which is not wrapped.
  result.joint_positions = {-3.1, 7, -3.09, 7.01, -3.08, 7.0};
  EXPECT_THAT(calc_joint_speeds(robot, table, result, kSamplePeriod_s),
              ElementsAre(testing::DoubleNear((2 * std::numbers::pi - 6.2) / kSamplePeriod_s, 1e-9),
                          testing::DoubleNear(700, 1e-9)));
  result.joint_positions = {};
  EXPECT_THAT(calc_joint_speeds(robot, table, result, kSamplePeriod_s), ElementsAre(0, 0));
}

// A joint at constant jerk J from rest, q = J t^3 / 6: the third differences are J once three samples
// lie after the start, and J / 6 and 5 J / 6 in the first two periods, where the arm still rested.
TEST(JerkIntegral, OfAConstantJerkIsItsSquareTimesTheTime) {
  RobotModel robot;
  robot.joints.resize(1);
  TargetTable table = make_table(1, 2);
  table.joints = 1;
  table.start_positions = {0.25};
  TrackingResult result;
  constexpr double kJerk = 3;
  constexpr int kSteps = 50;
  for (int k = 1; k <= kSteps; ++k) {
    result.joint_positions.push_back(0.25 + kJerk * std::pow(k * kSamplePeriod_s, 3) / 6);
  }
  EXPECT_NEAR(calc_jerk_integral(robot, table, result, kSamplePeriod_s),
              kJerk * kJerk * kSamplePeriod_s * (kSteps - 2 + (1.0 + 25.0) / 36), 1e-6);
  result.joint_positions.assign(10, 0.25);
  EXPECT_EQ(calc_jerk_integral(robot, table, result, kSamplePeriod_s), 0);
}

}  // namespace
}  // namespace armwright
