// Motions worth recording: the series, its limits, what it tells, and what is refused.
#include <gmock/gmock.h>

#include <Eigen/Core>
#include <cmath>

#include "problems/identification/excitation_problem.hpp"
#include "problems/problem_folder.hpp"
#include "sim/kinematics/kinematics.hpp"

namespace armwright {
namespace {

using testing::HasSubstr;

constexpr double kGravity_m_per_s2 = 9.80665;

RobotModel load_robot(const char* name) {
  return load_urdf(std::string(ARMWRIGHT_CONFIGS "/robots/") + name + ".urdf");
}

ExcitationConfig make_config(const char* robot = "arm7") {
  ExcitationConfig config;
  config.name = "motion";
  config.robot = load_robot(robot);
  config.gravity_m_per_s2 = kGravity_m_per_s2;
  config.groups = {FitGroup::friction, FitGroup::armature};
  return config;
}

std::vector<double> list_starts(const ExcitationProblem& problem) {
  std::vector<double> x;
  for (const DecisionVariable& variable : problem.description().variables) {
    x.push_back(variable.start);
  }
  return x;
}

std::vector<double> draw(const ExcitationProblem& problem, std::uint64_t index) {
  RandomStream random("test/excitation", index);
  std::vector<double> x;
  for (const DecisionVariable& variable : problem.description().variables) {
    x.push_back(random.uniform(variable.lower, variable.upper));
  }
  return x;
}

Evaluation evaluate(const ExcitationProblem& problem, std::span<const double> x) {
  return problem.evaluate(x, {CaseRole::training, "train/1", {0}});
}

TEST(Excitation, HasTheDerivativesOfItsPositions) {
  const ExcitationProblem problem(make_config());
  constexpr Eigen::Index kSamples = 20001;
  const AssessedMotion motion = problem.assess(draw(problem, 1), kSamples);
  const double h = problem.config().duration_s / (kSamples - 1);
  const JointMotion& its = motion.motion;
  // Central differences err by h^2 / 6 times the third derivative. That of a harmonic is w^2 times its
  // rate, and the blending makes it larger by less than w_max^2 = (2 pi 5 / 10)^2 with 60 / blend_s^2.
  const double tolerance = h * h / 6 * (100 + 60) * 10;
  const double scale = 1 + its.accelerations.cwiseAbs().maxCoeff();
  for (Eigen::Index k = 1; k + 1 < kSamples; k += 7) {
    const Eigen::RowVectorXd rate = (its.positions.row(k + 1) - its.positions.row(k - 1)) / (2 * h);
    const Eigen::RowVectorXd acceleration = (its.rates.row(k + 1) - its.rates.row(k - 1)) / (2 * h);
    ASSERT_LT((rate - its.rates.row(k)).cwiseAbs().maxCoeff(), tolerance * scale) << k;
    ASSERT_LT((acceleration - its.accelerations.row(k)).cwiseAbs().maxCoeff(), tolerance * scale)
        << k;
  }
}

TEST(Excitation, BeginsAndEndsAtRestAtTheOffsets) {
  const ExcitationProblem problem(make_config());
  const std::vector<double> x = draw(problem, 2);
  const AssessedMotion motion = problem.assess(x, 101);
  const std::size_t numbers = x.size() / problem.config().robot.joint_count();
  for (const Eigen::Index k : {Eigen::Index{0}, Eigen::Index{100}}) {
    EXPECT_LT(motion.motion.rates.row(k).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_LT(motion.motion.accelerations.row(k).cwiseAbs().maxCoeff(), 1e-12);
    for (std::size_t i = 0; i < problem.config().robot.joint_count(); ++i) {
      EXPECT_DOUBLE_EQ(motion.motion.positions(k, static_cast<Eigen::Index>(i)), x[i * numbers]);
    }
  }
  EXPECT_GT(motion.motion.rates.row(50).cwiseAbs().maxCoeff(), 0.1);
}

TEST(Excitation, StartsWithinAllLimits) {
  for (const char* robot : {"arm7", "irb4600_six", "kr300", "planar2", "arm7_gripper"}) {
    SCOPED_TRACE(robot);
    const ExcitationProblem problem(make_config(robot));
    EXPECT_TRUE(is_feasible(evaluate(problem, list_starts(problem))));
    EXPECT_GT(problem.assess_finely(list_starts(problem)).motion.rates.cwiseAbs().maxCoeff(), 1e-3);
  }
}

TEST(Excitation, JudgesPositionsSpeedsAccelerationsEffortsAndTheFloor) {
  ExcitationConfig config = make_config();
  config.acceleration_limits.assign(7, 0.5);
  config.floor_m = 0;
  const ExcitationProblem problem(config);
  std::vector<double> x = list_starts(problem);
  ASSERT_EQ(problem.description().constraints.size(), 4 * 7 + 1U);
  EXPECT_EQ(problem.description().constraints.back().name, "floor");
  ASSERT_TRUE(is_feasible(evaluate(problem, x)));
  for (std::size_t i = 0; i < x.size(); ++i) {
    x[i] = i % 11 == 0 ? x[i] : 3 * problem.description().variables[i].upper;
  }
  const std::vector<double> g = evaluate(problem, x).constraint_values;
  const auto largest = [&](std::size_t first) {
    return *std::max_element(g.begin() + static_cast<std::ptrdiff_t>(first),
                             g.begin() + static_cast<std::ptrdiff_t>(first + 7));
  };
  for (const std::size_t first : {0U, 7U, 14U}) {
    EXPECT_GT(largest(first), 0.5) << first;
  }
  EXPECT_GT(g.back(), 0);
  const AssessedMotion motion = problem.assess(x, ExcitationProblem::kTrainingSamples);
  EXPECT_NEAR(g[8], motion.speeds[1] / (0.8 * ExcitationProblem::kReserve) - 1, 1e-12);
  EXPECT_NEAR(g[22], motion.efforts_share[1] / (0.8 * ExcitationProblem::kReserve) - 1, 1e-12);
}

TEST(Excitation, ShrinksAMotionUntilItKeepsItsLimitsBetweenTheSamplesToo) {
  const ExcitationProblem problem(make_config());
  std::vector<double> x = list_starts(problem);
  double scale = 1;
  const auto scaled = [&] {
    std::vector<double> larger = x;
    for (std::size_t i = 0; i < x.size(); ++i) {
      larger[i] *= i % 11 == 0 ? 1 : scale;
    }
    return larger;
  };
  while (problem.is_within_limits(problem.assess_finely(scaled()))) {
    scale *= 1.05;
  }
  std::vector<double> larger = scaled();
  const double factor = problem.shrink_to_limits(larger);
  EXPECT_LT(factor, 1);
  EXPECT_GT(factor, 1 / 1.07);
  EXPECT_TRUE(problem.is_within_limits(problem.assess_finely(larger)));
}

TEST(Excitation, LeavesOutWhatNoMotionTells) {
  ExcitationConfig config = make_config("planar2");
  config.groups = {FitGroup::inertial};
  const ExcitationProblem problem(config);
  EXPECT_EQ(problem.parameters().size(), 20U);
  EXPECT_LT(problem.rank(), 20);
  EXPECT_GT(problem.rank(), 2);
  const AssessedMotion motion = problem.assess_finely(draw(problem, 3));
  EXPECT_LT(motion.condition, 1e6);
  EXPECT_FALSE(problem.can_tell(0));
}

TEST(Excitation, HasStandardErrorsThatFallWithTheSquareRootOfTheSamples) {
  const ExcitationProblem problem(make_config());
  const std::vector<double> x = draw(problem, 4);
  const Eigen::VectorXd noise = Eigen::VectorXd::Ones(7);
  const Eigen::VectorXd few = problem.calc_standard_errors(problem.assess(x, 2001), noise);
  const Eigen::VectorXd many = problem.calc_standard_errors(problem.assess(x, 8001), noise);
  for (Eigen::Index i = 0; i < few.size(); ++i) {
    // The sums are those of a smooth function at 2000 and 8000 places; only friction has steps.
    EXPECT_NEAR(few[i] / many[i], 2, 0.02)
        << problem.parameters()[static_cast<std::size_t>(i)].name;
  }
  // A larger motion tells more.
  std::vector<double> smaller = x;
  for (std::size_t i = 0; i < x.size(); ++i) {
    smaller[i] *= i % 11 == 0 ? 1 : 0.5;
  }
  EXPECT_GT(problem.calc_standard_errors(problem.assess(smaller, 2001), noise)[1], few[1]);
}

TEST(Excitation, RepeatsItself) {
  const ExcitationProblem first(make_config()), second(make_config());
  EXPECT_EQ(list_starts(first), list_starts(second));
  const std::vector<double> x = draw(first, 5);
  EXPECT_EQ(evaluate(first, x).objectives, evaluate(second, x).objectives);
  ExcitationConfig other = make_config();
  other.criterion = ExcitationCriterion::condition;
  const ExcitationProblem condition(other);
  EXPECT_DOUBLE_EQ(evaluate(condition, x).objectives[0], std::log10(evaluate(first, x).metrics[0]));
  EXPECT_NE(evaluate(condition, x).objectives, evaluate(first, x).objectives);
}

TEST(Excitation, KeepsClearOfObstacles) {
  const std::string ball = "obstacle=[{kind=\"sphere\",centre_m=[1.2,0.4,1],radius_m=0.2}]";
  const auto load = [](const std::vector<std::string>& overrides) {
    const LoadedProblem loaded = load_problem("excite", overrides);
    return std::dynamic_pointer_cast<const ExcitationProblem>(loaded.problem);
  };
  const auto none = load({}), near = load({ball});
  const std::vector<double> x = list_starts(*near);
  EXPECT_EQ(near->description().constraints.back().name, "obstacles");
  EXPECT_TRUE(is_feasible(evaluate(*near, x)));
  const AssessedMotion motion = near->assess_finely(x);
  EXPECT_GT(motion.gap_m, 0);
  double least_m = 100;
  for (Eigen::Index k = 0; k < motion.times_s.size(); ++k) {
    const Eigen::VectorXd q = motion.motion.positions.row(k);
    const auto poses =
        calc_link_poses(near->config().robot, {q.data(), static_cast<std::size_t>(q.size())});
    least_m = std::min(least_m, near->config().clearance->find_nearest(poses).distance_m);
  }
  EXPECT_EQ(motion.gap_m, least_m);
  EXPECT_EQ(none->description().constraints.size() + 1, near->description().constraints.size());
}

// What load_problem() says of a problem with these settings.
std::string refuse(ErrorKind kind, std::span<const std::string> overrides) {
  return error_of(kind, [&] { load_problem("excite", overrides); });
}

TEST(ExcitationSettings, AreRefusedInWords) {
  const ErrorKind usage = ErrorKind::usage, bad_data = ErrorKind::bad_data;
  const std::tuple<ErrorKind, std::vector<std::string>, const char*> rows[] = {
      {usage,
       {"excitation.fit=['payload']"},
       "the payload is to be fitted, but how heavy it is, is not known even roughly, so that the "
       "motion could overload the arm; state the mass that the robot will carry: --payload KG"},
      {usage,
       {"excitation.fit=['wobble']"},
       "'wobble' cannot be fitted; each must be one of friction"},
      {bad_data,
       {"excitation.fit=['delay']"},
       "there is nothing to fit: no motion of this robot tells"},
      {usage, {"excitation.criterion=best"}, "Valid: condition, d-optimal"},
      {usage,
       {"excitation.floor_m=3"},
       "the arm's first joint is lower, at 0.495 m; the floor must not be"},
      {usage, {"excitation.blend_s=11"}, "it must be at most half of the duration, 10 s"},
      {usage,
       {"excitation.acceleration_limits=[1,2]"},
       "it must hold one number, or 6, one per joint"},
      {bad_data,
       {"excitation.effort_share=0.01"},
       "the limits leave no posture from which a motion could begin: in the best of 500 random "
       "postures"},
      {usage,
       {"excitation.harmonics=0"},
       "excitation.harmonics is 0; it must be an integer from 1 to 20"}};
  for (const auto& [kind, overrides, message] : rows) {
    EXPECT_THAT(refuse(kind, overrides), HasSubstr(message));
  }
}

TEST(ExcitationSettings, NeedARobotWithLimits) {
  const ProblemFolder folder;
  folder.write("arm.urdf", R"(<robot name="arm"><link name="base"/>
<joint name="a" type="continuous"><parent link="base"/><child link="one"/><axis xyz="0 0 1"/></joint>
<link name="one"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="b" type="revolute"><parent link="one"/><child link="two"/><axis xyz="0 1 0"/>
<limit lower="0.5" upper="0.5" velocity="1" effort="0"/></joint>
<link name="two"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
</robot>)");
  const std::string message =
      refuse(ErrorKind::bad_data,
             std::vector<std::string>{"robot.urdf='" + folder.path("arm.urdf") + "'"});
  EXPECT_THAT(message,
              HasSubstr("arm.urdf: no motion can be proposed, as its limits are not known"));
  EXPECT_THAT(message,
              HasSubstr("joint 'a' has no speed limit; write its largest speed as velocity"));
  EXPECT_THAT(message, HasSubstr("joint 'a' has no effort limit; write what its motor can do"));
  EXPECT_THAT(message, HasSubstr("joint 'b' has a range of width 0 (lower and upper are 0.5)"));
  EXPECT_THAT(message, HasSubstr("joint 'b' has no effort limit"));
}

}  // namespace
}  // namespace armwright
