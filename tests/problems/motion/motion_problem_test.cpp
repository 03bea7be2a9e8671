#include "problems/motion/motion_problem.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "base/error.hpp"
#include "problems/config/problem_loader.hpp"
#include "sim/dynamics/arm_equations.hpp"

namespace armwright {
namespace {

using ::testing::HasSubstr;

constexpr double kDegree_rad = std::numbers::pi / 180;

const MotionProblem& get_motion(const LoadedProblem& loaded) {
  return dynamic_cast<const MotionProblem&>(*loaded.problem);
}

std::size_t find_metric(const ProblemDescription& problem, const std::string& name) {
  for (std::size_t i = 0; i < problem.metrics.size(); ++i) {
    if (problem.metrics[i].name == name) {
      return i;
    }
  }
  ADD_FAILURE() << "no metric " << name;
  return 0;
}

Evaluation judge(const LoadedProblem& loaded, const std::vector<double>& x) {
  return loaded.problem->evaluate(x, {.role = CaseRole::test, .set = "test/1", .numbers = {0}});
}

// A PUMA 560 on a quintic move, as in the oracle: g = 9.80665, no friction.
LoadedProblem load_puma_move(const std::string& plant = "puma560.plant.toml") {
  return load_problem(
      "saravanan-puma",
      std::vector<std::string>{"motion.point=[{joints=[0,0,0,0,0,0]}, "
                               "{joints=[1.5707963267948966, 0.7853981633974483, "
                               "-1.5707963267948966, 0.7853981633974483, "
                               "0.7853981633974483, 1.5707963267948966]}]",
                               "motion.curve=rest", "motion.samples=401", "obstacle=[]",
                               "motion.clearance_m=0", "motion.self_clearance=true",
                               "robot.plant=\"" + plant + "\""});
}

TEST(Gasparetto, LeastDurationIsFeasibleAndNothingBelowItIs) {
  const LoadedProblem loaded = load_problem("gasparetto");
  std::vector<double> x = {0.72771, 2.16044, 2.95972, 1.79609, 0.88700};
  const Evaluation at = judge(loaded, x);
  EXPECT_NEAR(at.objectives.at(0), 8.530954, 1e-5);
  // The intervals have five decimals; at g = 1e-6 the duration changes by less than 1e-5.
  EXPECT_LT(calc_violation(at.constraint_values), 3e-5);
  for (double& interval : x) {
    interval *= 0.999;
  }
  EXPECT_GT(calc_violation(judge(loaded, x).constraint_values), 1e-3);
  EXPECT_EQ(loaded.problem->description().constraints.size(), 18u);
  EXPECT_EQ(loaded.problem->description().constraints[0].name, "joint_1.speed");
}

TEST(Puma560, GravityEffortsAndInertiasAreThePublishedOnes) {
  const LoadedProblem loaded = load_problem("saravanan-puma");
  RobotModel robot = get_motion(loaded).config().robot;
  const articulated::ChainModel chain(robot, 9.81);
  articulated::ArmEquations equations(chain);
  const double q[] = {0, 45 * kDegree_rad, 180 * kDegree_rad, 0, 45 * kDegree_rad, 0};
  const std::vector<double> rest(6, 0);
  equations.set(q, rest);
  const double gravity[] = {0, 31.63988, 6.03514, 0, 0.0282528, 0};
  const double inertia[] = {3.6594, 4.4137, 0.9378, 0.1925, 0.1713, 0.1941};
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(equations.bias(i), gravity[i], 1e-5) << i;
    // The printed diagonal is that of the source's tensor of link 3, whose moment about the joint's
    // axis is larger by 0.086 - 0.0785 wherever link 3 turns about it.
    const double more = i == 1 || i == 2 ? 0.086 - 0.0785 : 0;
    EXPECT_NEAR(equations.mass(i, i) + robot.joints[i].plant.armature + more, inertia[i], 6e-5)
        << i;
  }
}

TEST(Puma560, QuinticMoveTakesTheOraclesEnergy) {
  const LoadedProblem loaded = load_puma_move();
  const ProblemDescription& description = loaded.problem->description();
  const std::size_t energy = find_metric(description, "energy");
  // The oracle's three digits; its samples are those of 401 even times, too.
  EXPECT_NEAR(judge(loaded, {1}).metrics[energy], 53.648, 1e-3);
  EXPECT_NEAR(judge(loaded, {2}).metrics[energy], 34.782, 1e-3);
  const Evaluation least = judge(loaded, {0.614642});
  EXPECT_NEAR(least.metrics[energy], 95.402, 1e-3);
  for (std::size_t i = 0; i < description.constraints.size(); ++i) {
    if (description.constraints[i].name == "joint_1.effort") {
      EXPECT_NEAR(least.constraint_values[i], 0, 3e-6);  // the limit decides the time
    }
  }
  const LoadedProblem bare = load_puma_move("");
  EXPECT_NEAR(judge(bare, {0.552223}).metrics[energy], 91.079, 1e-3);
  EXPECT_NEAR(judge(bare, {1}).metrics[energy], 47.674, 1e-3);
}

// An obstacle that no link can reach changes no bit of objectives and constraints but its own.
TEST(Saravanan, ObstaclesOutOfReachChangeNothing) {
  const std::vector<std::string> far = {
      "obstacle=[{name=\"far\", kind=\"sphere\", centre_m=[9,9,9], radius_m=0.1}]"};
  const std::vector<std::string> none = {"obstacle=[]", "motion.self_clearance=true",
                                         "motion.clearance_m=0"};
  const LoadedProblem with = load_problem("saravanan-puma", far);
  const LoadedProblem without = load_problem("saravanan-puma", none);
  const std::vector<double> x = list_starts(with.problem->description().variables);
  const Evaluation a = judge(with, x), b = judge(without, x);
  EXPECT_EQ(a.objectives, b.objectives);
  ASSERT_EQ(a.constraint_values.size(), b.constraint_values.size());
  EXPECT_TRUE(std::equal(a.constraint_values.begin(), a.constraint_values.end() - 1,
                         b.constraint_values.begin()));
  EXPECT_LT(a.constraint_values.back(), 0);
}

TEST(Shiakolas, CheckPointAndOptimumAreTheOracles) {
  const LoadedProblem loaded = load_problem("shiakolas");
  const ProblemDescription& description = loaded.problem->description();
  const std::size_t deflection = find_metric(description, "deflection");
  // Per link: length, diameter, wall.
  const Evaluation check = judge(loaded, {0.5, 0.06, 0.003, 0.5, 0.05, 0.003});
  EXPECT_NEAR(check.objectives.at(0), 5.823368, 5e-7);
  EXPECT_NEAR(1000 * check.metrics[deflection], 0.571975, 5e-7);
  const Evaluation best = judge(loaded, {0.68447, 0.07430, 0.001, 0.3, 0.02628, 0.001});
  EXPECT_NEAR(best.objectives.at(0), 4.390420, 2e-4);  // five decimals of the optimum
  EXPECT_NEAR(1000 * best.metrics[deflection], 1, 1e-3);
}

TEST(MotionProblem, BoundOnTheSamePathIsBelowThePlannedDuration) {
  const LoadedProblem loaded = load_puma_move();
  std::string reason;
  const auto plan = get_motion(loaded).assess(std::vector<double>{2.0}, 201, reason);
  ASSERT_TRUE(plan) << reason;
  const std::optional<double> least_s = get_motion(loaded).calc_bound(*plan);
  ASSERT_TRUE(least_s);
  EXPECT_LT(*least_s, 1.5364);  // what the quintic needs within the speed limits
  EXPECT_GT(*least_s, std::numbers::pi / 2 / 1.917);  // joint 1 at its largest speed
}

// The bound of a spline that meets its limits is below its duration, though it rests at its ends.
TEST(MotionProblem, BoundOfASplineWithinItsLimitsIsBelowItsDuration) {
  const LoadedProblem loaded = load_problem("gasparetto");
  std::string reason;
  const auto plan = get_motion(loaded).assess(
      std::vector<double>{0.72771, 2.16044, 2.95972, 1.79609, 0.88700}, 201, reason);
  ASSERT_TRUE(plan) << reason;
  const std::optional<double> least_s = get_motion(loaded).calc_bound(*plan);
  ASSERT_TRUE(least_s);
  EXPECT_LT(*least_s, 8.530954);
  EXPECT_GT(*least_s, 4);  // far above half of it, as accelerations are near their limits
}

TEST(MotionProblem, RecordsEveryJointsMotionAndEffort) {
  const LoadedProblem loaded = load_problem("gasparetto");
  const CaseRecord record =
      loaded.problem->record_case(list_starts(loaded.problem->description().variables), {}, 0);
  EXPECT_EQ(record.abscissa_values.size(), 51u);
  ASSERT_EQ(record.series.size(), 30u);
  EXPECT_EQ(record.series[0].quantity.name, "joint_1 position");
  EXPECT_EQ(record.series[3].quantity.unit, "rad/s3");
}

struct BadMotion {
  std::string name, problem;
  std::vector<std::string> overrides;
  std::string message;
};

class BadMotionTest : public ::testing::TestWithParam<BadMotion> {};

TEST_P(BadMotionTest, IsRefusedBeforeAnythingRuns) {
  const BadMotion& bad = GetParam();
  try {
    load_problem(bad.problem, bad.overrides);
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr(bad.message));
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, BadMotionTest,
    ::testing::Values(
        BadMotion{"OutOfRange",
                  "saravanan-puma",
                  {"motion.point=[{joints=[0,0,0,0,0,0]},{joints=[0,0,2,0,0,0]}]"},
                  "point 2: joint 'joint_3' is at 2, its range is -3.92699 to 0.785398"},
        BadMotion{"SamePoint",
                  "saravanan-puma",
                  {"motion.point=[{joints=[0,0,0,0,0,0]},{joints=[0,0,0,0,0,0]}]"},
                  "point 2 is the same as point 1"},
        BadMotion{"LimitOfZero", "gasparetto", {"motion.jerk_limits=[0]"}, "motion.jerk_limits"},
        BadMotion{
            "ObstacleAtTheStart",
            "saravanan-puma",
            {"obstacle=[{name=\"wall\",kind=\"box\",centre_m=[0.4,-0.15,0],edges_m=[0.2,0.2,0."
             "2]}]"},
            "the obstacle 'wall' are"},
        BadMotion{"TooWeakToHold",
                  "saravanan-puma",
                  {"motion.effort_limits=[97,20,89,24,20,21]"},
                  "to hold the arm at rest there, its limit is 20"},
        BadMotion{"FrontOfOne",
                  "gasparetto",
                  {"objective.kind=front", "objective.quantities=[\"jerk\"]"},
                  "a front needs at least two quantities"},
        BadMotion{"UnknownQuantity",
                  "gasparetto",
                  {"objective.quantities=[\"durations\"]"},
                  "'durations'"},
        BadMotion{"ThickWall",
                  "shiakolas",
                  {"tubes.wall_m=[0.04,0.003]"},
                  "thicker than the radius of its tube, 0.03 m"},
        BadMotion{"ThickWallBound",
                  "shiakolas",
                  {"tubes.wall_bounds_m=[0.001,0.02]"},
                  "thicker than the radius of its tube, 0.01 m"},
        BadMotion{"Unreachable",
                  "shiakolas",
                  {"tubes.length_bounds_m=[0.3,0.31]",
                   "motion.point=[{tool_m=[2,0,0]},{tool_m=[0.3,"
                   "0.7,0]}]"},
                  "point 1: the arm cannot reach the tool's position (2, 0, 0) m"},
        BadMotion{"FreeEnd",
                  "gasparetto",
                  {"motion.point=[{free=true},{joints=[0,0,0,0,0,0]}]"},
                  "the first and the last point cannot be free"},
        BadMotion{
            "WrongIntervals", "gasparetto", {"motion.intervals_s=[1,2]"}, "it must hold 5 numbers"},
        BadMotion{"NothingToClear",
                  "gasparetto",
                  {"motion.clearance_m=0.1"},
                  "there is nothing to be clear of"},
        BadMotion{"TwoKindsOfPoint",
                  "gasparetto",
                  {"motion.point=[{joints=[0,0,0,0,0,0],free=true},{joints=[1,0,0,0,0,0]}]"},
                  "exactly one of joints, tool_m and free"}),
    [](const auto& its) { return its.param.name; });

}  // namespace
}  // namespace armwright
