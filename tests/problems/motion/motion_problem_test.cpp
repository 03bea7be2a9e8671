#include "problems/motion/motion_problem.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/temporary_folder.hpp"
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

// The oracle: 0.4143 s with the whole limits, on 200 intervals.
TEST(Line, TakesTheLeastTimeOfTheOracle) {
  const LoadedProblem loaded = load_problem("chaiyaratana-line");
  const MotionProblem& problem = get_motion(loaded);
  std::string reason;
  const auto plan = problem.assess(std::vector<double>{1, 1, 1}, 201, reason);
  ASSERT_TRUE(plan) << reason;
  EXPECT_NEAR(plan->curve.duration_s(), 0.4143, 5e-5);
  // The motion is the line: the efforts between the places stay within the limits, but for what the
  // places leave out, and the tip is on the line and ends where it should.
  const double limits[] = {10, 12, 4};
  for (Eigen::Index joint = 0; joint < 3; ++joint) {
    EXPECT_LT(plan->efforts.col(joint).cwiseAbs().maxCoeff(), 1.01 * limits[joint]) << joint;
  }
  EXPECT_GT(plan->efforts.col(1).cwiseAbs().maxCoeff(), 11.9);
  const Eigen::Vector3d from(1.2, -0.6, 0.4), to(1.2, 0.6, 0.8);
  std::vector<double> q(3);
  for (const double t : plan->times_s) {
    plan->curve.calc(t, 0, q);
    const double r = std::cos(q[1]) + std::cos(q[1] + q[2]);
    const Eigen::Vector3d tip(r * std::cos(q[0]), r * std::sin(q[0]),
                              std::sin(q[1]) + std::sin(q[1] + q[2]));
    EXPECT_LT((tip - from).cross((to - from).normalized()).norm(), 1e-6);
  }
  EXPECT_TRUE(plan->constraints.empty() || *std::ranges::max_element(plan->constraints) <= 0);
  const auto bound_s = problem.calc_bound(*plan);
  ASSERT_TRUE(bound_s);
  EXPECT_NEAR(*bound_s, plan->curve.duration_s(), 1e-3);
}

// Without gravity, k times all limits take 1 / sqrt(k) times the time.
TEST(Line, WithoutGravitySharesScaleTheTimeByTheirRoot) {
  const LoadedProblem loaded =
      load_problem("chaiyaratana-line", std::vector<std::string>{"physics.gravity_m_per_s2=0"});
  const double whole_s = judge(loaded, {1, 1, 1}).objectives.at(0);
  EXPECT_NEAR(whole_s / judge(loaded, {0.64, 0.64, 0.64}).objectives.at(0), 0.8, 1e-9);
  EXPECT_LT(whole_s, 0.3667);
}

TEST(Line, RestsAtThePointsBetween) {
  const LoadedProblem loaded = load_problem(
      "chaiyaratana-line",
      std::vector<std::string>{
          "motion.point=[{tool_m=[1.2,-0.6,0.4]},{tool_m=[1.2,0,0.6]},{tool_m=[1.2,0.6,0.8]}]"});
  std::string reason;
  const auto plan = get_motion(loaded).assess(std::vector<double>{1, 1, 1}, 201, reason);
  ASSERT_TRUE(plan) << reason;
  const double middle_s = plan->curve.knots_s().at(200);
  std::vector<double> rates(3);
  plan->curve.calc(middle_s, 1, rates);
  for (const double rate : rates) {
    EXPECT_NEAR(rate, 0, 1e-9);
  }
  EXPECT_GT(plan->curve.duration_s(), 0.5);
}

TEST(MotionProblem, TakesItsPointsFromAFile) {
  const TemporaryFolder folder;
  write_file_atomically(
      folder.path() / "points.csv",
      "position_1_rad,position_2_rad,position_3_rad,position_4_rad,position_5_rad,position_6_rad"
      "\n0,1,-1,0,0,0\n0.2,1.1,-1.2,0,0,0\n0.3,1,-1,0,0,0\n");
  const auto load = [&](const std::string& points) {
    return load_problem("gasparetto", std::vector<std::string>{"motion.range_limits=false",
                                                               "motion.point=" + points});
  };
  const std::string file = "{file=\"" + (folder.path() / "points.csv").string() + "\"}";
  const LoadedProblem loaded = load("[" + file + ",{free=true},{joints=[0,1,-1.5,0,0,0]}]");
  const auto& points = get_motion(loaded).config().points;
  ASSERT_EQ(points.size(), 5u);
  EXPECT_EQ((*points[1].q)[1], 1.1);
  EXPECT_FALSE(points[3].q);
  EXPECT_TRUE(loaded.input_hashes.contains("points.csv"));
  try {
    load("[" + file + ",{joints=[0.3,1,-1,0,0,0]}]");
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("point 4 is the same as point 3"));
  }
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
                  "exactly one of joints, tool_m, file and free"},
        BadMotion{"LineOfJoints",
                  "chaiyaratana-line",
                  {"motion.point=[{joints=[0,1,-1]},{tool_m=[1.2,0.6,0.8]}]"},
                  "point 1: a line goes from one tool_m to the next"},
        BadMotion{"LineOfNoLength",
                  "chaiyaratana-line",
                  {"motion.point=[{tool_m=[1.2,0.6,0.8]},{tool_m=[1.2,0.6,0.8]}]"},
                  "point 2 is the same as point 1"},
        BadMotion{"LineWithJerk",
                  "chaiyaratana-line",
                  {"objective.quantities=[\"duration\",\"jerk\"]"},
                  "the jerk of a line has no bound"},
        BadMotion{"LineWithJerkLimit",
                  "chaiyaratana-line",
                  {"motion.jerk_limits=[5]"},
                  "its jerk has no bound; leave this out"},
        BadMotion{"LineOutOfReach",
                  "chaiyaratana-line",
                  {"motion.point=[{tool_m=[-1,-0.5,0.5]},{tool_m=[-1,0.5,0.5]}]"},
                  "between points 1 and 2: the arm cannot follow the straight line, it fails at ("},
        BadMotion{"LineThatNoSpeedSuits",
                  "chaiyaratana-line",
                  {"motion.effort_limits=[10,5,4]"},
                  "between points 1 and 2: no speed suits the line at "},
        BadMotion{"LineWithoutEffortLimits",
                  "chaiyaratana-line",
                  {"motion.effort_limits=[]"},
                  "joint 'waist' has no limit, and the line is timed by them"}),
    [](const auto& its) { return its.param.name; });

}  // namespace
}  // namespace armwright
