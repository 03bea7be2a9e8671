// The lanes of the numeric inverse kinematics against the scalar solver of version 1.0.
#include "sim/kinematics/posture_solver.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "base/random.hpp"
#include "sim/generated_arm.hpp"
#include "sim/kinematics/numeric_kinematics.hpp"
#include "sim/simd/simd_level.hpp"
#include "sim/support.hpp"
#include "sim/tracking/tracking_setup.hpp"

namespace armwright {
namespace {

using Approach = NumericKinematics::Approach;

// Both solvers make the same iterations. Their rounding differs: the scalar one adds mu^2, at least
// 1e-9 of the largest (J^T J)_ii, to the diagonal, so that rounding by 1.1e-16 changes free motion
// by up to 2e-7 of its length. Motions here are shorter than 4e-3.
constexpr double kAgreement = 1e-9;

constexpr ToolOrientation kOrientations[] = {ToolOrientation::free, ToolOrientation::pointing,
                                             ToolOrientation::pose};

ToolTask make_tilted_tool(ToolOrientation orientation) {
  ToolTask tool;
  tool.orientation = orientation;
  tool.axis = Eigen::Vector3d(0.1, 0.3, 0.9).normalized();
  return tool;
}

// Returns a chain of `joints` joints about x, y and z in turn; every fourth one slides.
RobotModel make_long_arm(int joints) {
  RobotModel robot = parse_urdf(make_arm_urdf(4), "generated");
  const Joint model = robot.joints.front();
  const Link link = robot.links.back();
  robot.joints.clear();
  robot.links.clear();
  for (int i = 0; i < joints; ++i) {
    Joint joint = model;
    joint.name = "joint_" + std::to_string(i);
    joint.axis = Eigen::Vector3d::Unit(i % 3);
    joint.origin = Eigen::Translation3d(0.02 * (i % 2), 0.1, 0.05 * (i % 3)) *
                   Eigen::AngleAxisd(0.3 * (i % 5), Eigen::Vector3d(1, 2, 3).normalized());
    joint.kind = i % 4 == 3 ? JointKind::prismatic : JointKind::revolute;
    joint.lower = joint.kind == JointKind::prismatic ? -0.2 : -2;
    joint.upper = joint.kind == JointKind::prismatic ? 0.3 : 1.5;
    robot.joints.push_back(joint);
    robot.links.push_back(link);
  }
  return robot;
}

std::vector<RobotModel> make_arms() {
  std::vector<RobotModel> arms;
  for (const char* name : {"arm7", "irb4600_six", "planar2"}) {
    arms.push_back(load_urdf(std::string(ARMWRIGHT_CONFIGS "/robots/") + name + ".urdf"));
  }
  for (int i = 0; i < kGeneratedArms; ++i) {
    arms.push_back(parse_urdf(make_arm_urdf(i), "generated"));
  }
  arms.push_back(make_long_arm(5));
  arms.push_back(make_long_arm(NumericKinematics::kMostJoints));
  return arms;
}

// Calls check(arm, tool, number) for every arm and every orientation that suits it.
template <class Check>
void for_each_task(const Check& check) {
  const std::vector<RobotModel> arms = make_arms();
  int number = 0;
  for (const RobotModel& arm : arms) {
    for (const ToolOrientation orientation : kOrientations) {
      const ToolTask tool = make_tilted_tool(orientation);
      if (NumericKinematics(arm, tool, {}, true).suits_task()) {
        SCOPED_TRACE(fmt::format("{} with {} joints, orientation {}", arm.name, arm.joint_count(),
                                 static_cast<int>(orientation)));
        check(arm, tool, number++);
      }
    }
  }
}

// Steps of at most `way` (rad or m) from random postures, which are at the ends of ranges where
// `at_ends`.
std::vector<Approach> make_steps(const NumericKinematics& kinematics, const RobotModel& arm,
                                 RandomStream& random, int count, double way, bool at_ends) {
  std::vector<Approach> steps;
  for (int i = 0; i < count; ++i) {
    Approach step = kinematics.make_following();
    std::vector<double> q = kinematics.draw_posture(random);
    std::vector<double> to = q;
    for (std::size_t joint = 0; joint < q.size(); ++joint) {
      if (at_ends && random.uniform(0, 1) < 0.4) {
        q[joint] = random.uniform(0, 1) < 0.5 ? arm.joints[joint].lower : arm.joints[joint].upper;
      }
      to[joint] = q[joint] + random.uniform(-way, way);
      step.q[static_cast<Eigen::Index>(joint)] = q[joint];
      step.wish[static_cast<Eigen::Index>(joint)] = random.uniform(-way, way) / 4;
    }
    step.target = kinematics.calc_pose(to);
    steps.push_back(step);
  }
  return steps;
}

void solve_all(const NumericKinematics& kinematics, std::vector<Approach>& steps) {
  std::vector<Approach*> all;
  for (Approach& step : steps) {
    all.push_back(&step);
  }
  kinematics.approach(all);
}

bool have_same_bits(const Approach& a, const Approach& b) {
  return a.reached == b.reached &&
         (!a.reached || std::memcmp(a.q.data(), b.q.data(),
                                    static_cast<std::size_t>(a.q.size()) * sizeof(double)) == 0);
}

bool are_finite(const RobotModel& arm) {
  return std::ranges::all_of(arm.joints, [](const Joint& joint) {
    return std::isfinite(joint.lower) && std::isfinite(joint.upper);
  });
}

// Compares the solvers on steps of one path.
void expect_agreement(double way, bool at_ends) {
  int reached = 0, held = 0;
  for_each_task([&](const RobotModel& arm, const ToolTask& tool, int number) {
    if (at_ends && !are_finite(arm)) {
      return;
    }
    const NumericKinematics lanes(arm, tool, {}, true);
    const NumericKinematics scalar(arm, tool, {}, true, NumericSolver::scalar);
    RandomStream random("test/postures", static_cast<std::uint64_t>(number));
    std::vector<Approach> ours = make_steps(lanes, arm, random, 21, way, at_ends);
    std::erase_if(ours, [&](const Approach& step) {  // bad postures magnify rounding
      return lanes.calc_dexterity({step.q.data(), arm.joint_count()}) < 0.03;
    });
    std::vector<Approach> theirs = ours;
    solve_all(lanes, ours);
    solve_all(scalar, theirs);
    for (std::size_t i = 0; i < ours.size(); ++i) {
      ASSERT_EQ(ours[i].reached, theirs[i].reached) << "step " << i;
      if (!ours[i].reached) {
        continue;
      }
      ++reached;
      EXPECT_LT((ours[i].q - theirs[i].q).cwiseAbs().maxCoeff(), kAgreement) << "step " << i;
      for (std::size_t joint = 0; joint < arm.joint_count(); ++joint) {
        const double q = ours[i].q[static_cast<Eigen::Index>(joint)];
        EXPECT_GE(q, arm.joints[joint].lower);
        EXPECT_LE(q, arm.joints[joint].upper);
        held += q == arm.joints[joint].lower || q == arm.joints[joint].upper ? 1 : 0;
      }
    }
  });
  EXPECT_GT(reached, 100);
  if (at_ends) {
    EXPECT_GT(held, 20) << "no joint was held at the end of its range";
  }
}

TEST(PostureSolver, StepsOfAPathAreThoseOfTheScalarSolver) {
  expect_agreement(2e-3, false);
}

TEST(PostureSolver, JointsAtTheEndsOfTheirRangesAreHeldAsByTheScalarSolver) {
  expect_agreement(1e-3, true);
}

// A lift below a seven-joint arm: both can move the tool up, and the slower the lift is, the less it
// does.
TEST(PostureSolver, OfJointsThatCanDoTheSameTheSlowOneMovesLess) {
  RobotModel arm = load_urdf(ARMWRIGHT_CONFIGS "/robots/arm7.urdf");
  Joint lift = arm.joints.front();
  lift.kind = JointKind::prismatic;
  lift.axis = Eigen::Vector3d::UnitZ();
  lift.lower = -1;
  lift.upper = 1;
  arm.joints.insert(arm.joints.begin(), lift);
  arm.links.insert(arm.links.begin(), arm.links.front());
  ToolTask tool;
  tool.orientation = ToolOrientation::pose;
  const std::vector<double> start = {0, 0.2, 0.6, 0.1, 1.2, 0.3, 0.8, 0.1};
  const auto find_share_of_lift = [&](double speed_m_per_s) {
    arm.joints.front().speed_limit = speed_m_per_s;
    const NumericKinematics kinematics(arm, tool, {}, true);
    std::vector<double> q = start;
    ToolPose target = kinematics.calc_pose(q);
    target.position_m.z() += 1e-3;
    EXPECT_TRUE(kinematics.follow(target, std::vector<double>(q.size(), 0), q));
    return q[0] / 1e-3;
  };
  double turning_rad_per_s = 0;
  for (std::size_t i = 1; i < arm.joint_count(); ++i) {
    turning_rad_per_s += arm.joints[i].speed_limit / static_cast<double>(arm.joint_count() - 1);
  }
  const double as_1_m = find_share_of_lift(turning_rad_per_s);
  const double slow = find_share_of_lift(turning_rad_per_s / 16);
  // The least norm: shares in proportion to s^2 a lift of unit s, and c of the other joints.
  EXPECT_LT(slow, 0.2);
  EXPECT_NEAR((1 / slow - 1) / (1 / as_1_m - 1), 16 * 16, 1);
}

// One iteration from any posture to any other, with errors of any angle up to a half turn. The
// damping is then large, so rounding is not magnified: a step is at most 0.3.
TEST(PostureSolver, TheFirstIterationIsThatOfTheScalarSolverForAnyTurn) {
  int large_turns = 0;
  for_each_task([&](const RobotModel& arm, const ToolTask& tool, int number) {
    for (const bool within_limits : {false, true}) {
      const NumericKinematics lanes(arm, tool, {}, within_limits);
      const NumericKinematics scalar(arm, tool, {}, within_limits, NumericSolver::scalar);
      RandomStream random("test/postures/far", static_cast<std::uint64_t>(number));
      std::vector<Approach> ours;
      for (int i = 0; i < 40; ++i) {
        Approach step = lanes.make_following();
        const std::vector<double> q = lanes.draw_posture(random);
        std::ranges::copy(q, step.q.data());
        step.target = lanes.calc_pose(lanes.draw_posture(random));
        step.iterations = 1;
        step.longest_step = 0.3;
        const Eigen::Matrix3d turn = step.target.turn * lanes.calc_pose(q).turn.transpose();
        large_turns += turn.trace() < 0 ? 1 : 0;
        ours.push_back(step);
      }
      std::vector<Approach> theirs = ours;
      solve_all(lanes, ours);
      solve_all(scalar, theirs);
      for (std::size_t i = 0; i < ours.size(); ++i) {
        EXPECT_LT((ours[i].q - theirs[i].q).cwiseAbs().maxCoeff(), 1e-10) << "step " << i;
      }
    }
  });
  EXPECT_GT(large_turns, 100);
}

TEST(PostureSolver, SolutionsAreAtTheTarget) {
  for_each_task([&](const RobotModel& arm, const ToolTask& tool, int number) {
    const NumericKinematics lanes(arm, tool, {}, true);
    RandomStream random("test/postures/target", static_cast<std::uint64_t>(number));
    for (const double way : {1e-8, 1e-4, 0.05}) {  // the first ones need one iteration
      std::vector<Approach> steps = make_steps(lanes, arm, random, 16, way, false);
      solve_all(lanes, steps);
      for (const Approach& step : steps) {
        if (step.reached) {
          // The tolerance is 1e-10 of an arm's length, and no arm here is longer than 5 m.
          EXPECT_LT(lanes.calc_distance(step.target, {step.q.data(), arm.joint_count()}), 5e-10);
        }
      }
    }
  });
}

TEST(PostureSolver, WhatIsOutOfReachIsNotReached) {
  for_each_task([&](const RobotModel& arm, const ToolTask& tool, int number) {
    const NumericKinematics lanes(arm, tool, {}, true);
    RandomStream random("test/postures/far", static_cast<std::uint64_t>(number));
    std::vector<Approach> steps = make_steps(lanes, arm, random, 9, 1e-3, false);
    steps[3].target.position_m = {100, 0, 0};
    steps[8].target.position_m = {0, std::nan(""), 0};
    std::vector<Approach> others = steps;
    solve_all(lanes, steps);
    EXPECT_FALSE(steps[3].reached);
    EXPECT_FALSE(steps[8].reached);
    // The other lanes do not notice.
    others[3] = others[0];
    others[8] = others[0];
    solve_all(lanes, others);
    for (const std::size_t i : {0, 1, 2, 4, 5, 6, 7}) {
      EXPECT_TRUE(have_same_bits(steps[i], others[i])) << "step " << i;
    }
  });
}

// Sets an environment variable as long as this object lives.
class Environment {
 public:
  explicit Environment(const std::string& level) {
    if (const char* const before = std::getenv(kName)) {
      before_ = before;
    }
    setenv(kName, level.c_str(), 1);
  }
  ~Environment() { before_.empty() ? unsetenv(kName) : setenv(kName, before_.c_str(), 1); }
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;

 private:
  static constexpr const char* kName = "ARMWRIGHT_SIMD";
  std::string before_;
};

TEST(PostureSolver, EveryLevelHasTheSameBitsAloneAndBesideOthers) {
  for_each_task([&](const RobotModel& arm, const ToolTask& tool, int number) {
    RandomStream random("test/postures/levels", static_cast<std::uint64_t>(number));
    const NumericKinematics best(arm, tool, {}, true);
    std::vector<Approach> steps = make_steps(best, arm, random, 11, 0.02, false);
    const std::vector<Approach> more = make_steps(best, arm, random, 10, 0.5, are_finite(arm));
    steps.insert(steps.end(), more.begin(), more.end());
    std::vector<Approach> expected = steps;
    {
      const Environment scalar("scalar");
      solve_all(NumericKinematics(arm, tool, {}, true), expected);
    }
    for (const std::string& level : supported_simd_names()) {
      const Environment environment(level);
      const NumericKinematics kinematics(arm, tool, {}, true);
      std::vector<Approach> together = steps;
      solve_all(kinematics, together);
      for (std::size_t i = 0; i < steps.size(); ++i) {
        std::vector<Approach> alone = {steps[i]};
        solve_all(kinematics, alone);
        EXPECT_TRUE(have_same_bits(together[i], expected[i])) << level << ", step " << i;
        EXPECT_TRUE(have_same_bits(alone[0], expected[i])) << level << ", step " << i << " alone";
      }
    }
  });
}

// Target tables of whole cases: more cases than lanes, some of them out of reach.
TEST(PostureSolver, TargetTablesAreThoseOfTheScalarSolver) {
  int unreachable = 0;
  for (const char* name : {"arm7", "irb4600_six"}) {
    const RobotModel arm = load_urdf(std::string(ARMWRIGHT_CONFIGS "/robots/") + name + ".urdf");
    TrackingTask task;
    task.kinematics = KinematicsChoice::numeric;
    task.tool.orientation = ToolOrientation::pose;
    task.limits = LimitPolicy::warn;
    task.speed_m_per_s = 0.3;
    const NumericKinematics kinematics(arm, task.tool, {}, true);
    RandomStream random("test/postures/home");
    double best = 0;
    for (int i = 0; i < 100; ++i) {
      const std::vector<double> q = kinematics.draw_posture(random);
      if (kinematics.calc_dexterity(q) > best) {
        best = kinematics.calc_dexterity(q);
        task.home = q;
      }
    }
    const ToolPose pose = kinematics.calc_pose(task.home);
    task.tool.turn = pose.turn;
    std::vector<TestCase> cases;
    for (std::uint64_t i = 0; i < 11; ++i) {
      WorkspaceSphere sphere;
      sphere.centre_m = pose.position_m;
      sphere.radius_m = i % 4 == 3 ? 2.5 : 0.05;
      sphere.shortest_move_m = sphere.radius_m / 16;
      sphere.points = 3 + static_cast<int>(i % 3);
      cases.push_back(make_test_case("test/postures", i, sphere));
    }
    task.solver = NumericSolver::scalar;
    const std::vector<TargetTable> expected = TrackingSetup(arm, task).make_targets(cases);
    task.solver = NumericSolver::lanes;
    const TrackingSetup setup(arm, task);
    const std::vector<TargetTable> tables = setup.make_targets(cases);
    for (std::size_t i = 0; i < cases.size(); ++i) {
      SCOPED_TRACE(fmt::format("{}, case {}", name, i));
      unreachable += tables[i].unreachable.empty() ? 0 : 1;
      EXPECT_EQ(tables[i].unreachable, expected[i].unreachable);
      ASSERT_EQ(tables[i].joint_positions.size(), expected[i].joint_positions.size());
      double farthest = 0;
      for (std::size_t k = 0; k < tables[i].joint_positions.size(); ++k) {
        farthest = std::max(
            farthest, std::abs(tables[i].joint_positions[k] - expected[i].joint_positions[k]));
      }
      EXPECT_LT(farthest, kAgreement);
      const TargetTable alone = setup.make_targets(cases[i]);
      EXPECT_EQ(alone.joint_positions, tables[i].joint_positions);
      EXPECT_EQ(alone.start_positions, tables[i].start_positions);
      EXPECT_EQ(alone.unreachable, tables[i].unreachable);
    }
  }
  EXPECT_GT(unreachable, 0);
}

}  // namespace
}  // namespace armwright
