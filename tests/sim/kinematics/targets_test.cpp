#include "sim/kinematics/targets.hpp"

#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <cstring>
#include <vector>

#include "base/random.hpp"
#include "sim/simd/simd_level.hpp"
#include "sim/support.hpp"
#include "sim/tracking/reference_signal.hpp"
#include "sim/tracking/tracking_setup.hpp"

namespace armwright {
namespace {

using targets::ElbowUpArm;
using targets::Move;

constexpr double kNone = -99;  // what no angle is

Move make_move(const Eigen::Vector3d& from, const Eigen::Vector3d& to, SignalShape shape,
               double speed_m_per_s = 1.5) {
  Move move;
  const Eigen::Vector3d way = to - from;
  Eigen::Vector3d::Map(move.from_m) = from;
  Eigen::Vector3d::Map(move.to_m) = to;
  Eigen::Vector3d::Map(move.way_m) = way;
  move.curve = make_signal_curve(shape, way.norm(), speed_m_per_s, 15);
  move.period_s = 0.01;
  return move;
}

Eigen::Vector3d draw_point(RandomStream& random, double reach) {
  return {random.uniform(-reach, reach), random.uniform(-reach, reach), random.uniform(-0.5, 2)};
}

constexpr std::array kShapes = {SignalShape::step, SignalShape::ramp, SignalShape::trapezoid,
                                SignalShape::triangular, SignalShape::complex};

struct Solution {
  int reached;
  std::vector<double> angles_rad;  // of the steps reached, then kNone
};
Solution solve(targets::SolveMove* solve_move, const ElbowUpArm& arm, const Move& move, int steps) {
  Solution solution{0, std::vector<double>(static_cast<std::size_t>(4 * steps + 4), kNone)};
  solution.reached = solve_move(arm, move, steps, solution.angles_rad.data());
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(solution.angles_rad[solution.angles_rad.size() - 1 - i], kNone) << "beyond the end";
  }
  std::fill(solution.angles_rad.begin() + 4 * solution.reached, solution.angles_rad.end(), kNone);
  return solution;
}

bool are_same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

std::vector<SimdLevel> supported_levels() {
  std::vector<SimdLevel> levels;
  for (const std::string& name : supported_simd_names()) {
    levels.push_back(parse_simd(name));
  }
  return levels;
}

// Moves of all shapes all around the arm, through its inside and out of its reach, with and without
// the thesis's error. They leave every possible number of steps for the last register.
TEST(Targets, AreTheSameBitsAtEverySimdLevelAndOneByOne) {
  RandomStream random("test/targets/levels");
  const RobotModel robot = load_irb4600();
  const ElbowUpArm arms[] = {ElbowUpKinematics(robot).arm(), ElbowUpKinematics(robot, true).arm()};
  int left_reach = 0;
  for (int i = 0; i < 4000; ++i) {
    const ElbowUpArm& arm = arms[i % 2];
    Eigen::Vector3d from = draw_point(random, 1.2);
    Eigen::Vector3d to = draw_point(random, 2.5);
    if (i % 10 < 2) {  // along the axes, through the headings 0, pi and +-pi/2
      from.y() = to.y() = i % 4 == 0 ? 0.0 : -0.0;
    } else if (i % 10 < 4) {
      from.x() = to.x() = 0;
    }
    const Move move = make_move(from, to, kShapes[static_cast<std::size_t>(i) % kShapes.size()]);
    const int steps = 1 + i % 150;
    const Solution scalar = solve(targets::solve_move_scalar, arm, move, steps);
    std::vector<double> positions(static_cast<std::size_t>(3 * steps));
    targets::calc_positions_scalar(move, steps, positions.data());
    for (const SimdLevel level : supported_levels()) {
      std::vector<double> others(positions.size());
      targets::get_move_functions(level).calc_positions(move, steps, others.data());
      ASSERT_TRUE(are_same_bits(others, positions)) << to_string(level) << ' ' << i;
      const Solution solution =
          solve(targets::get_move_functions(level).solve_move, arm, move, steps);
      ASSERT_EQ(solution.reached, scalar.reached) << to_string(level) << ' ' << i;
      ASSERT_TRUE(are_same_bits(solution.angles_rad, scalar.angles_rad))
          << to_string(level) << ' ' << i;
    }
    for (int step = 0; step < steps && step <= scalar.reached; ++step) {
      Eigen::Vector3d target;
      targets::calc_position(move, step, target.data());
      ASSERT_EQ(
          std::memcmp(target.data(), &positions[static_cast<std::size_t>(3 * step)], sizeof target),
          0);
      std::vector<double> q(4, kNone);
      ASSERT_EQ(targets::solve(arm, target.data(), q.data()), step < scalar.reached);
      ASSERT_EQ(std::memcmp(q.data(), &scalar.angles_rad[static_cast<std::size_t>(4 * step)],
                            4 * sizeof(double)),
                0);
    }
    left_reach += scalar.reached > 0 && scalar.reached < steps ? 1 : 0;
  }
  EXPECT_GT(left_reach, 200) << "hardly a test of where a move leaves the reach";
}

// Compares with the formulas, evaluated with libm's functions in extended precision. Tolerance: a
// relative error of about 4e-16 in the arguments of the angles, which grows with 1 / S if the arm
// is nearly stretched or folded.
TEST(Targets, AnglesAreThoseOfTheTextbook) {
  using Real = long double;
  const ElbowUpArm arm = ElbowUpKinematics(load_irb4600()).arm();
  RandomStream random("test/targets/textbook");
  const Real a = arm.forearm_m, c = arm.upper_arm_m, pi = std::acos(Real{-1});
  int solved = 0, beyond_pi = 0;
  for (int i = 0; i < 100'000; ++i) {
    const Eigen::Vector3d target = draw_point(random, i % 2 == 0 ? 0.3 : 1.6);
    std::array<double, 4> q{};
    if (!targets::solve(arm, target.data(), q.data())) {
      continue;
    }
    const Real f = std::hypot(Real{target.x()}, Real{target.y()}) - Real{arm.shoulder_radius_m};
    const Real e = Real{target.z()} + Real{arm.last_link_m} - Real{arm.shoulder_height_m};
    const Real b = std::hypot(e, f);
    const Real beta = std::acos((b * b + c * c - a * a) / (2 * b * c));
    const Real gamma = std::acos((a * a + c * c - b * b) / (2 * a * c));
    const Real upper = std::atan2(e, f) + beta;
    const Real lower = upper - (pi - gamma);
    const Real q2 = Real{arm.upper_arm_zero_rad} - upper;
    const Real q23 = Real{arm.forearm_zero_rad} - lower;
    const Real q234 = Real{arm.last_link_zero_rad} + pi / 2;
    const std::array<Real, 4> expected = {std::atan2(Real{target.y()}, Real{target.x()}), q2,
                                          q23 - q2, q234 - q23};
    const Real area = a * c * std::sin(gamma);
    for (std::size_t joint = 0; joint < 4; ++joint) {
      ASSERT_NEAR(static_cast<double>(arm.sign[joint] * expected[joint]), q[joint],
                  static_cast<double>(2e-15 + 2e-15 / area))
          << target.transpose() << " joint " << joint + 1;
    }
    ++solved;
    beyond_pi += upper > pi ? 1 : 0;
  }
  EXPECT_GT(solved, 10'000);
  EXPECT_GT(beyond_pi, 100);
}

TEST(Targets, ArriveExactlyAndStay) {
  RandomStream random("test/targets/arrival");
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d to = draw_point(random, 1);
    const Move move =
        make_move(draw_point(random, 1), to, kShapes[static_cast<std::size_t>(i) % 5]);
    for (int step = 0; step < 400; ++step) {
      Eigen::Vector3d target;
      targets::calc_position(move, step, target.data());
      if ((step + 1) * move.period_s >= move.curve.duration_s) {
        ASSERT_EQ(target, to);
      } else if (move.curve.shape != SignalShape::step) {
        ASSERT_GT((target - to).norm(), 0);
      }
    }
  }
}

// A table holds per step the results of its two parts: the target's position and the posture there.
TEST(TargetTable, IsTheKinematicsOfTheTargetsPositions) {
  TestCase test_case;
  test_case.points_m = {{1.4, 0.1, 0.7}, {1.3, 0.2, 1.5}, {1.1, -0.6, 0.9}, {1.1, -0.6, 0.95}};
  for (const SignalShape shape : kShapes) {
    for (const double rest_s : {0.0, 0.5}) {
      TrackingTask task;
      task.signal = shape;
      task.rest_s = rest_s;
      task.ik_bug = shape == SignalShape::ramp;
      const TrackingSetup setup(load_irb4600(), task);
      const ElbowUpKinematics kinematics(load_irb4600(), task.ik_bug);
      const TargetTable table = setup.make_targets(test_case);
      ASSERT_EQ(table.unreachable, "");
      ASSERT_EQ(table.joint_positions.size(), static_cast<std::size_t>(4 * table.steps));
      for (const Segment& segment : table.segments) {
        for (int step = 0; step < segment.steps; ++step) {
          std::array<double, 4> q{};
          ASSERT_TRUE(kinematics.solve(setup.calc_target_position(segment, step), q));
          ASSERT_THAT(table.positions(segment.first_step + step), testing::ElementsAreArray(q))
              << step << " of " << segment.steps;
        }
      }
    }
  }
}

TEST(TargetTable, EndsAtTheFirstTargetOutOfReach) {
  TestCase test_case;
  test_case.points_m = {{1.4, 0, 0.7}, {1.4, 0, 1.2}, {3.4, 0, 1.2}, {1.4, 0, 1.2}};
  TrackingTask task;
  task.signal = SignalShape::ramp;
  const TrackingSetup setup(load_irb4600(), task);
  const ElbowUpKinematics kinematics(load_irb4600());
  const TargetTable table = setup.make_targets(test_case);
  const Segment& segment = table.segments[1];
  std::array<double, 4> q{};
  int step = 0;
  while (kinematics.solve(setup.calc_target_position(segment, step), q)) {
    ++step;
  }
  ASSERT_GT(step, 10);
  EXPECT_EQ(table.unreachable,
            "on the way to point 2: " +
                kinematics.describe_unreachable(setup.calc_target_position(segment, step)));
  EXPECT_EQ(table.joint_positions.size(),
            static_cast<std::size_t>(4 * (segment.first_step + step)));
  EXPECT_THAT(table.positions(segment.first_step + step - 1).front(), 0.0);
}

}  // namespace
}  // namespace armwright
