// Links, motors and the speed as parts of a design: from the problem's file to its simulations.
#include <gmock/gmock.h>

#include <cmath>
#include <fstream>

#include "problems/load_tracking.hpp"
#include "problems/problem_folder.hpp"
#include "sim/tracking/designed_arm.hpp"

namespace armwright {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;

std::vector<std::string> with_lanes(std::vector<std::string> overrides) {
  overrides.emplace_back("physics.engine=articulated");
  return overrides;
}

const std::string kLinks = R"(variables.optimize=["length_scale", "section_scale"])";
const std::string kSpeed = R"(variables.task=["speed"])";
const std::string kMotors = "motors.torque_per_mass_n_m_per_kg=100";

const CaseBlock kTraining{CaseRole::training, "train/1", {0, 1}};

TEST(DesignVariables, SayWhichSettingWidensTheirBounds) {
  const auto problem = load_tracking(
      "q1-complex", {R"(variables.optimize=["p", "section_scale", "length_scale"])", kSpeed});
  const auto& variables = problem->description().variables;
  EXPECT_EQ(variables[0].upper_widening, "--set variables.bounds_factor=1000 (it is 100)");
  EXPECT_EQ(variables[1].lower_widening, "--set variables.length_bounds_factor=3 (it is 1.5)");
  EXPECT_EQ(variables[2].upper_widening, "--set variables.section_bounds_factor=4 (it is 2)");
  EXPECT_EQ(variables[12].lower_widening, "--set variables.speed_bounds_factor=4 (it is 2)");
}

TEST(DesignVariables, HaveNamesUnitsAndSpansOfTheirOwn) {
  const auto problem =
      load_tracking("q1-complex", {R"(variables.optimize=["p", "section_scale", "length_scale"])",
                                   kSpeed, "variables.length_bounds_factor=1.25"});
  const auto& variables = problem->description().variables;
  ASSERT_THAT(variables, SizeIs(4 * 3 + 1));
  EXPECT_EQ(variables[4].name, "joint_2.length_scale");
  EXPECT_EQ(variables[4].unit, "1");
  EXPECT_EQ(variables[4].lower, 0.8);
  EXPECT_EQ(variables[4].start, 1);
  EXPECT_EQ(variables[4].upper, 1.25);
  EXPECT_EQ(variables[5].name, "joint_2.section_scale");
  EXPECT_EQ(variables[5].lower, 0.5);
  EXPECT_EQ(variables[5].upper, 2);
  EXPECT_EQ(variables[12].name, "task.speed");
  EXPECT_EQ(variables[12].unit, "m/s");
  EXPECT_EQ(variables[12].lower, 0.75);
  EXPECT_EQ(variables[12].start, 1.5);
  EXPECT_EQ(variables[12].upper, 3);
  for (const DecisionVariable& variable : variables) {
    EXPECT_EQ(variable.scale, Scale::logarithmic);
  }
  std::vector<double> x = get_start(*problem);
  x[4] = 1.125;
  x[5] = 0.75;
  x[12] = 2;
  const ArmDesign design = problem->make_design(x);
  EXPECT_EQ(design.joints[1].length_scale, 1.125);
  EXPECT_EQ(design.joints[1].section_scale, 0.75);
  EXPECT_EQ(design.joints[0].length_scale, 1);
  EXPECT_EQ(design.speed_m_per_s, 2);
  EXPECT_EQ(problem->make_vector(design), x);
  // A design without speed moves at the task's.
  EXPECT_EQ(problem->make_vector(load_design("table-a5").design).back(), 1.5);
}

TEST(DesignVariables, TakeTheDerivativesAwayAndSayWhy) {
  const auto advise = [](const std::vector<std::string>& overrides) {
    const auto problem = load_tracking("q1-complex", with_lanes(overrides));
    EXPECT_TRUE(problem->description().has_residuals);
    EXPECT_FALSE(problem->description().has_jacobian);
    return problem->description().jacobian_advice;
  };
  EXPECT_THAT(advise({kLinks}), HasSubstr("leave length_scale, section_scale, "
                                          "tube_diameter, tube_wall and speed out"));
  EXPECT_THAT(advise({kSpeed}), HasSubstr("leave length_scale, section_scale, "
                                          "tube_diameter, tube_wall and speed out"));
  EXPECT_THAT(advise({kMotors}), HasSubstr("leave [motors] out"));
  EXPECT_TRUE(load_tracking("q1-complex", with_lanes({kMotors, R"(variables.optimize=["p"])"}))
                  ->description()
                  .has_jacobian);
}

// Segment k takes ceil((max(ds_k, limit) / v + rest) / h) periods.
TEST(SpeedVariable, ChangesTheDurationOfACaseAsComputed) {
  const auto problem =
      load_tracking("q1-complex", with_lanes({R"(variables.optimize=["p"])", kSpeed}));
  std::vector<double> x = get_start(*problem);
  for (const double speed_m_per_s : {0.9, 1.5, 2.8}) {
    x.back() = speed_m_per_s;
    const Evaluation evaluation = problem->evaluate(x, kTraining);
    double periods = 0;
    for (int k = 1; k <= 25; ++k) {
      const double move_m = problem->config().workspace.calc_move_m(k);
      periods += std::ceil((std::max(move_m, 0.9) / speed_m_per_s + 0.5) / 0.01 - 1e-9);
    }
    EXPECT_NEAR(get_metric(*problem, evaluation, "duration"), periods * 0.01, 1e-10);
    // What the task's own speed makes of it, to the last bit.
    const auto fixed = load_tracking(
        "q1-complex", with_lanes({"task.speed_m_per_s=" + std::to_string(speed_m_per_s)}));
    EXPECT_EQ(fixed->evaluate(get_start(*fixed), kTraining).case_errors, evaluation.case_errors);
  }
}

// Neither neighbours in the lanes nor other candidates' targets get into a design's result.
TEST(DesignVariables, ABatchOfArmsIsEachArmAlone) {
  const auto problem = load_tracking(
      "q1-complex", with_lanes({R"(variables.optimize=["p", "length_scale", "section_scale"])",
                                kSpeed, kMotors}));
  std::vector<std::vector<double>> candidates(5, get_start(*problem));
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    candidates[i][4] = 1 + 0.02 * static_cast<double>(i);
    candidates[i][8] = 1.3 - 0.1 * static_cast<double>(i);
    candidates[i].back() = i < 2 ? 1.5 : 1.5 + 0.1 * static_cast<double>(i);
  }
  std::vector<CaseJob> jobs;
  for (const std::uint64_t number : kTraining.numbers) {
    for (const auto& x : candidates) {
      jobs.push_back({.x = x, .block = &kTraining, .number = number});
    }
  }
  const auto together = problem->simulate(jobs);
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    const auto alone = problem->simulate(std::span(&jobs[i], 1));
    EXPECT_EQ(together[i].error, alone[0].error);
    EXPECT_EQ(together[i].metrics, alone[0].metrics);
    EXPECT_NE(together[i].error, together[(i + 1) % candidates.size()].error);
  }
}

ArmDesign make_other_arm(const std::string& controllers) {
  ArmDesign design = load_design(controllers).design;
  design.joints[1].length_scale = 1.1;
  design.joints[1].section_scale = 0.8;
  design.joints[2].length_scale = 0.95;
  design.joints[3].section_scale = 1.5;
  design.speed_m_per_s = 1.25;
  return design;
}

// As on the arm as it is (engines_agree_test.cpp).
TEST(DesignedArm, EnginesAgreeOnIt) {
  const ArmDesign design = make_other_arm("table-a5");
  std::vector<double> means;
  for (const std::string engine : {"ode", "articulated"}) {
    const auto problem =
        load_tracking("q1-complex", {"physics.engine=" + engine, kMotors, "task.ik_bug=false"});
    double mean = 0;
    for (const TrackingResult& result :
         problem->track(design, problem->get_set("test/2"), 0, 8, {})) {
      EXPECT_EQ(result.status, SimulationStatus::ok) << result.reason;
      mean += result.mean_error_m / 8;
    }
    means.push_back(mean);
  }
  EXPECT_NEAR(means[1] / means[0], 1, 0.01);
  EXPECT_NE(means[0], means[1]);
}

// A design's file is all that is needed: the problem has none of its fields as variables.
TEST(DesignedArm, IsTrackedByWhatItsFileSays) {
  const auto problem = load_tracking("q1-complex", with_lanes({}));
  const TestSet set = problem->get_set("test/2");
  const ArmDesign plain = load_design("table-a5").design;
  const double plain_m = problem->track(plain, set, 0).mean_error_m;
  ArmDesign longer = plain;
  longer.joints[2].length_scale = 1.05;
  EXPECT_NE(problem->track(longer, set, 0).mean_error_m, plain_m);
  ArmDesign faster = plain;
  faster.speed_m_per_s = 3;
  EXPECT_LT(problem->track(faster, set, 0).steps, problem->track(plain, set, 0).steps);
  faster.speed_m_per_s = 1.5;  // the task's
  EXPECT_EQ(problem->track(faster, set, 0).mean_error_m, plain_m);
  // The recorded targets are those of its own arm: the tip is where the error says.
  const TrackingResult recorded = problem->track(make_other_arm("table-a5"), set, 0,
                                                 {.error_series = true, .trajectory = true});
  ASSERT_FALSE(recorded.trajectory.empty());
  const auto setup = problem->get_setup(make_other_arm("table-a5"));
  const TrajectorySample& sample = recorded.trajectory[500];
  EXPECT_LT((calc_tip_position(setup->robot(), sample.q) - sample.tip_m).norm(), 1e-12);
  EXPECT_LT((calc_tip_position(setup->robot(), sample.target_q) - sample.target_m).norm(), 0.1)
      << "0.12 m to the side is the error in the inverse kinematics of Q1";
}

TEST(DesignedArm, MovingMassIsThatOfLinksMotorsAndLoad) {
  const auto problem =
      load_tracking("q1-complex", with_lanes({kLinks, kMotors, "task.load_kg=20"}));
  std::vector<double> x = get_start(*problem);
  const double links_kg = 112.9 + 266.3 + 545.6 + 13.8;
  const double motors_kg = (45000 + 20000 + 200) / 100.0;
  EXPECT_NEAR(get_metric(*problem, problem->evaluate(x, kTraining), "moving_mass"),
              links_kg + motors_kg + 20, 1e-9);
  x[2] = 1.2;  // joint 2
  x[3] = 0.75;
  EXPECT_NEAR(get_metric(*problem, problem->evaluate(x, kTraining), "moving_mass"),
              links_kg + 266.3 * (1.2 * 0.75 - 1) + motors_kg + 20, 1e-9);
}

// The arm of 1.095 / 1.5 and 1.28 / 1.5 m does not come to 2.139 m from its shoulder.
TEST(DesignedArm, OutOfReachIsAsBadAsCutOffInTrainingAndNoNumberElsewhere) {
  const auto problem = load_tracking("q1-complex", with_lanes({kLinks}));
  std::vector<double> x = get_start(*problem);
  x[2] = x[4] = 1 / 1.5;
  const Evaluation training = problem->evaluate(x, kTraining);
  EXPECT_EQ(training.status, EvaluationStatus::unreachable);
  EXPECT_THAT(training.reason, HasSubstr("is out of reach: the wrist would be"));
  EXPECT_THAT(training.case_errors, ElementsAre(2, 2));
  EXPECT_THAT(training.objectives, ElementsAre(2));
  EXPECT_EQ(training.metrics.at(2), 2);  // failures
  const CaseBlock test{CaseRole::test, "test/2", {0, 1}};
  const Evaluation judged = problem->evaluate(x, test);
  EXPECT_EQ(judged.status, EvaluationStatus::unreachable);
  EXPECT_EQ(judged.failed_cases, 2);
  EXPECT_THAT(judged.objectives, SizeIs(0));
}

TEST(DesignedArm, ItsFileReadsBackBitForBit) {
  DesignFile file = load_design("table-a5");
  file.design = make_other_arm("table-a5");
  file.design.joints[0].length_scale = 1 / 3.0;
  const ProblemFolder folder;
  folder.write("d.toml", to_toml(file));
  const ArmDesign read = load_design(folder.path("d.toml")).design;
  EXPECT_EQ(read.speed_m_per_s, 1.25);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(read.joints[i].length_scale, file.design.joints[i].length_scale);
    EXPECT_EQ(read.joints[i].section_scale, file.design.joints[i].section_scale);
  }
  const DesignFile plain = load_design("table-a5");
  EXPECT_EQ(plain.design.speed_m_per_s, std::nullopt);
  EXPECT_THAT(to_toml(plain), testing::Not(HasSubstr("scale")));
  EXPECT_THAT(to_toml(plain), testing::Not(HasSubstr("speed")));
}

TEST(DesignVariables, BadInputIsRefusedWithPlaceAndAdvice) {
  const ProblemFolder folder;
  EXPECT_EQ(folder.refusal_of("extends = \"base\"\n[variables]\ntask = ['load']"),
            "p.toml:3: variables.task is ['load']; the task has one variable; write [\"speed\"] or "
            "leave it out");
  EXPECT_EQ(folder.refusal_of("extends = \"base\"\n[variables]\nlength_bounds_factor = 1"),
            "p.toml:3: variables.length_bounds_factor is 1; it must be a finite number > 1 and <= "
            "100");
  EXPECT_EQ(
      folder.refusal_of("extends = \"base\"\n[motors]\ntorque_per_mass_n_m_per_kg = -1"),
      "p.toml:3: motors.torque_per_mass_n_m_per_kg is -1; it must be a finite number >= 0 and "
      "<= 1000000000");
  EXPECT_EQ(folder.refusal_of_design(make_joint() + "length_scale = 0\n"),
            "d.toml:7: joint[0].length_scale is 0; it must be a finite number >= 0.01 and <= 100");
  EXPECT_EQ(folder.refusal_of_design("speed_m_per_s = -1\n" + make_joint()),
            "d.toml:1: speed_m_per_s is -1; it must be a finite number >= 0.01 and <= 100");
  // 5.18 m of moves above 0.9 m and 21 of 0.9 m, at 1 mm/s.
  EXPECT_EQ(folder.refusal_of("extends = \"base\"\n[task]\nspeed_m_per_s = 0.01\nrest_s = 0\n"
                              "[control]\nperiod_s = 1e-3\n[variables]\ntask = ['speed']\n"
                              "speed_bounds_factor = 10"),
            "p.toml:9: variables.speed_bounds_factor is 10; a test case at the slowest speed would "
            "take 2.41e+07 control periods, possible are 1e+07; lower speed_bounds_factor");
}

}  // namespace
}  // namespace armwright
