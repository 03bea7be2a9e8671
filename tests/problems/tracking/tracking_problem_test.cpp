// The tracking problem as an optimizer sees it, without simulation: decision variables, designs and
// the aggregation of evaluations. The case outcomes are written by hand;
// tracking_simulation_test.cpp tests simulated ones.
#include "problems/tracking/tracking_problem.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <map>

#include "base/expect_error.hpp"
#include "base/random.hpp"
#include "problems/config/design_file.hpp"
#include "problems/config/problem_loader.hpp"
#include "problems/load_tracking.hpp"

namespace armwright {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::ElementsAreArray;
using testing::IsEmpty;
using testing::SizeIs;

std::vector<std::string> get_names(const TrackingProblem& problem) {
  std::vector<std::string> names;
  for (const DecisionVariable& variable : problem.description().variables) {
    names.push_back(variable.name);
  }
  return names;
}

// Returns a random design in the box, uniform in the logarithms.
std::vector<double> draw_vector(const TrackingProblem& problem, RandomStream& random) {
  std::vector<double> x;
  for (const DecisionVariable& variable : problem.description().variables) {
    const double factor = problem.config().bounds_factor;
    x.push_back(variable.start * std::pow(factor, random.uniform(-1, 1)));
  }
  return x;
}

TEST(TrackingVariables, AreTheGainsAndLimitsOfEveryJoint) {
  const auto problem = load_tracking("q1-complex");
  const std::vector<double> start = {45000,  150000, 7500,  -20000, 20000,  // thesis, Table A.1
                                     270000, 700000, 30000, -45000, 45000,  //
                                     30000,  100000, 5000,  -20000, 20000,  //
                                     300,    2000,   5,     -200,   200};
  const std::vector<std::string> names = {"p", "i", "d", "effort_min", "effort_max"};
  const std::vector<std::string> units = {"N m/rad", "N m/(rad s)", "N m s/rad", "N m", "N m"};
  const auto& variables = problem->description().variables;
  ASSERT_THAT(variables, SizeIs(20));
  for (std::size_t i = 0; i < variables.size(); ++i) {
    const DecisionVariable& variable = variables[i];
    SCOPED_TRACE(variable.name);
    EXPECT_EQ(variable.name, "joint_" + std::to_string(i / 5 + 1) + "." + names[i % 5]);
    EXPECT_EQ(variable.unit, units[i % 5]);
    EXPECT_EQ(variable.scale, Scale::logarithmic);
    EXPECT_EQ(variable.start, start[i]);
    const double near = start[i] / 100;
    const double far = start[i] * 100;
    EXPECT_EQ(variable.lower, start[i] < 0 ? far : near);
    EXPECT_EQ(variable.upper, start[i] < 0 ? near : far);
  }
}

TEST(TrackingVariables, BoundsFollowTheirFactor) {
  const auto problem = load_tracking("q1-complex", {"variables.bounds_factor=2.5"});
  const DecisionVariable& p = problem->description().variables.at(0);
  EXPECT_EQ(p.lower, 18000);
  EXPECT_EQ(p.upper, 112500);
  const DecisionVariable& effort_min = problem->description().variables.at(3);
  EXPECT_EQ(effort_min.lower, -50000);
  EXPECT_EQ(effort_min.upper, -8000);
}

TEST(TrackingVariables, DescriptionNamesWhatIsMeasured) {
  const auto get_all = [](const std::vector<Quantity>& quantities) {
    std::vector<std::string> texts;
    for (const Quantity& quantity : quantities) {
      texts.push_back(quantity.name + " (" + quantity.unit + ")");
    }
    return texts;
  };
  const auto q1 = load_tracking("q1-complex");
  EXPECT_EQ(q1->description().name, "q1-complex");
  EXPECT_EQ(q1->description().cost_unit, "simulated test case");
  EXPECT_THAT(get_all(q1->description().objectives), ElementsAre("error (m)"));
  EXPECT_THAT(q1->description().constraints, IsEmpty());
  EXPECT_THAT(q1->description().known_optimum, IsEmpty());
  EXPECT_THAT(
      get_all(q1->description().metrics),
      ElementsAre("error (m)", "total_torque (N m)", "failures (1)", "energy (J)",
                  "saturated_share (1)", "joint_1.peak_effort (N m)", "joint_1.rms_effort (N m)",
                  "joint_2.peak_effort (N m)", "joint_2.rms_effort (N m)",
                  "joint_3.peak_effort (N m)", "joint_3.rms_effort (N m)",
                  "joint_4.peak_effort (N m)", "joint_4.rms_effort (N m)"));
  EXPECT_THAT(get_all(load_tracking("q2-e1")->description().objectives),
              ElementsAre("error and torque (1)"));
  const ProblemDescription torque = load_tracking("q2-torque")->description();
  EXPECT_THAT(get_all(torque.objectives), ElementsAre("total torque (N m)"));
  EXPECT_THAT(get_all(torque.constraints), ElementsAre("error / limit - 1 (1)"));
  EXPECT_EQ(torque.limits.at(0).quantity.unit, "m");
  EXPECT_EQ(torque.violation_scale, 100000);
  const ProblemDescription error = load_tracking("q2-error")->description();
  EXPECT_THAT(get_all(error.objectives), ElementsAre("error (m)"));
  EXPECT_THAT(get_all(error.constraints), ElementsAre("total torque / limit - 1 (1)"));
  EXPECT_EQ(error.limits.at(0).quantity.unit, "N m");
  EXPECT_EQ(error.violation_scale, 0.0005);
  EXPECT_EQ(load_tracking("q2-error", {"objective.logarithm=true"})->description().violation_scale,
            1);
}

TEST(TrackingVariables, VectorAndDesignAreTheSameThing) {
  const auto problem = load_tracking("q1-complex");
  RandomStream random("variables", 1);
  for (int trial = 0; trial < 100; ++trial) {
    const std::vector<double> x = draw_vector(*problem, random);
    const ArmDesign design = problem->make_design(x);
    EXPECT_EQ(problem->make_vector(design), x);
    ASSERT_THAT(design.joints, SizeIs(4));
    for (std::size_t joint = 0; joint < 4; ++joint) {
      EXPECT_THAT(design.joints[joint].gains,
                  ElementsAre(x[5 * joint], x[5 * joint + 1], x[5 * joint + 2]));
      EXPECT_EQ(design.joints[joint].limits.min, x[5 * joint + 3]);
      EXPECT_EQ(design.joints[joint].limits.max, x[5 * joint + 4]);
    }
  }
}

TEST(TrackingVariables, WhatIsNoVariableKeepsItsStartValue) {
  // The variables have the order of the design, whatever their order in the file.
  const auto problem =
      load_tracking("q1-complex", {R"(variables.optimize=["effort_max", "d"])",
                                   R"(variables.joint=[{name="joint_4", optimize=[]}, )"
                                   R"({name="joint_2", optimize=["effort_min", "p", "i"]}])"});
  EXPECT_THAT(get_names(*problem),
              ElementsAre("joint_1.d", "joint_1.effort_max", "joint_2.p", "joint_2.i",
                          "joint_2.effort_min", "joint_3.d", "joint_3.effort_max"));
  const ArmDesign design = problem->make_design(std::vector<double>{1, 2, 3, 4, -5, 6, 7});
  EXPECT_THAT(design.joints[0].gains, ElementsAre(45000, 150000, 1));
  EXPECT_EQ(design.joints[0].limits.min, -20000);
  EXPECT_EQ(design.joints[0].limits.max, 2);
  EXPECT_THAT(design.joints[1].gains, ElementsAre(3, 4, 30000));
  EXPECT_EQ(design.joints[1].limits.min, -5);
  EXPECT_EQ(design.joints[1].limits.max, 45000);
  EXPECT_THAT(design.joints[2].gains, ElementsAre(30000, 100000, 6));
  EXPECT_EQ(design.joints[2].limits.min, -20000);
  EXPECT_EQ(design.joints[2].limits.max, 7);
  EXPECT_THAT(design.joints[3].gains, ElementsAre(300, 2000, 5));
  EXPECT_EQ(design.joints[3].limits.min, -200);
  EXPECT_EQ(design.joints[3].limits.max, 200);

  // Only the variables of another design (Table A.10) are used.
  EXPECT_THAT(problem->make_vector(load_design("table-a10").design),
              ElementsAre(10876.1, 7323.93, 2810730, 7338360, -14943.4, 4394.7, 4836.06));
}

TEST(TrackingVariables, OneJointAloneCanBeOptimized) {
  const auto problem = load_tracking(
      "q1-complex",
      {"variables.optimize=[]", R"(variables.joint=[{name="joint_3", optimize=["i"]}])"});
  EXPECT_THAT(get_names(*problem), ElementsAre("joint_3.i"));
}

TEST(TrackingVariables, DesignForAnotherRobotIsRefused) {
  const auto problem = load_tracking("q1-complex");
  ArmDesign design = problem->config().start;
  design.joints.pop_back();
  const std::string message =
      "the design has 3 joints, the robot irb4600_40_255 of problem q1-complex has 4; use a design "
      "made for this robot";
  EXPECT_EQ(usage_error_of([&] { problem->check_design(design); }), message);
  EXPECT_EQ(usage_error_of([&] { problem->make_vector(design); }), message);
  EXPECT_EQ(usage_error_of([&] { problem->track(design, problem->get_set("test/2"), 0); }),
            message);
  TrackingConfig config = problem->config();
  config.start = design;
  EXPECT_EQ(usage_error_of([&] { TrackingProblem broken(config); }), message);
}

TEST(TrackingVariables, VariableWithoutUsableBoundsIsRefused) {
  TrackingConfig config = load_tracking("q1-complex")->config();
  config.start.joints[1].gains[0] = 0;
  EXPECT_EQ(usage_error_of([&] { TrackingProblem broken(config); }),
            "joint_2.p starts at 0, but a variable spans a factor around its start value; give it "
            "another value in the design or leave it out of 'optimize'");
  config.start.joints[1].gains[0] = 1e307;
  EXPECT_EQ(usage_error_of([&] { TrackingProblem broken(config); }),
            "joint_2.p starts at 1e+307 and would span 1e+305 to inf (the start / and x "
            "variables.bounds_factor), which floating-point numbers cannot hold; give it another "
            "value in the design or lower the factor");
  config.start.joints[1].gains[0] = 1e-307;  // a hundredth of it has lost digits
  EXPECT_THAT(usage_error_of([&] { TrackingProblem broken(config); }),
              testing::StartsWith("joint_2.p starts at 1e-307 and would span "));
}

// Returns the outcome of a case of 40 s. The peak efforts of the four joints are 10, 20, 30 and 40
// times `scale`, the RMS efforts 1, 2, 3 and 4 times `scale`.
CaseOutcome make_outcome(double error, double energy, double saturation, double scale) {
  CaseOutcome outcome;
  outcome.error = error;
  outcome.metrics.resize(case_metrics::first_requirement(4));
  outcome.metrics[case_metrics::kEnergy] = energy;
  outcome.metrics[case_metrics::kSaturatedShare] = saturation;
  outcome.metrics[case_metrics::kDuration] = 40;
  for (std::size_t joint = 0; joint < 4; ++joint) {
    const double size = static_cast<double>(joint + 1) * scale;
    outcome.metrics[case_metrics::peak_effort(joint)] = 10 * size;
    outcome.metrics[case_metrics::rms_effort(joint)] = size;
  }
  return outcome;
}

CaseOutcome make_failure(EvaluationStatus status, const std::string& reason) {
  CaseOutcome outcome;
  outcome.status = status;
  outcome.reason = reason;
  outcome.has_error = false;
  return outcome;
}

TEST(TrackingAggregate, ErrorIsTheMeanOverTheCases) {
  const auto problem = load_tracking("q1-complex");
  const std::vector<CaseOutcome> outcomes = {
      make_outcome(0.25, 1, 0, 1), make_outcome(0.5, 1, 0, 1), make_outcome(0.0625, 1, 0, 1)};
  const Evaluation evaluation = problem->aggregate(get_start(*problem), outcomes);
  EXPECT_EQ(evaluation.status, EvaluationStatus::ok);
  EXPECT_EQ(evaluation.reason, "");
  EXPECT_EQ(evaluation.failed_cases, 0);
  EXPECT_THAT(evaluation.objectives, ElementsAre(0.8125 / 3));  // the sum is exact
  EXPECT_THAT(evaluation.case_errors, ElementsAre(0.25, 0.5, 0.0625));
  EXPECT_THAT(evaluation.constraint_values, IsEmpty());
}

TEST(TrackingAggregate, TorqueCountsAsTheFormulaSays) {
  const auto problem = load_tracking("q2-e3");  // w = 5
  const std::vector<CaseOutcome> outcomes = {make_outcome(0.01, 1, 0, 1),
                                             make_outcome(0.03, 1, 0, 1)};
  std::vector<double> x = get_start(*problem);
  // A few roundings of numbers near 4 stay below 1e-14.
  EXPECT_NEAR(problem->aggregate(x, outcomes).objectives.at(0),
              0.02 / 0.0058 + 5 * 85200.0 / 963686, 1e-14);
  x[3] = -90000;  // joint 1: now the lower limit is the larger one; 20000 before
  x[9] = 30000;   // joint 2: the lower one, -45000, is the larger one still
  EXPECT_NEAR(problem->aggregate(x, outcomes).objectives.at(0),
              0.02 / 0.0058 + 5 * 155200.0 / 963686, 1e-14);
  EXPECT_EQ(problem->aggregate(x, outcomes).metrics.at(1), 155200);

  const auto scaled =
      load_tracking("q2-e3", {"objective.torque_weight=0.5", "objective.error_scale_m=0.1",
                              "objective.torque_scale_n_m=1000"});
  EXPECT_NEAR(scaled->aggregate(get_start(*scaled), outcomes).objectives.at(0), 0.2 + 42.6, 1e-13);
  // The torque is a metric even if it does not count in the objective.
  EXPECT_EQ(load_tracking("q1-complex")->aggregate(x, outcomes).metrics.at(1), 155200);
}

TEST(TrackingAggregate, ALimitIsAConstraintInSharesOfItself) {
  const std::vector<CaseOutcome> outcomes = {make_outcome(0.01, 1, 0, 1),
                                             make_outcome(0.03, 1, 0, 1)};
  const auto torque = load_tracking("q2-torque", {"objective.error_limit_m=0.025"});
  const std::vector<double> x = get_start(*torque);
  const Evaluation least_torque = torque->aggregate(x, outcomes);
  EXPECT_THAT(least_torque.objectives, ElementsAre(85200));
  ASSERT_THAT(least_torque.constraint_values, SizeIs(1));
  EXPECT_NEAR(least_torque.constraint_values[0], 0.02 / 0.025 - 1, 1e-15);  // met

  const auto error = load_tracking("q2-error", {"objective.total_torque_limit_n_m=40000"});
  const Evaluation least_error = error->aggregate(x, outcomes);
  EXPECT_THAT(least_error.objectives, ElementsAre(0.02));
  ASSERT_THAT(least_error.constraint_values, SizeIs(1));
  EXPECT_NEAR(least_error.constraint_values[0], 1.13, 1e-15);  // 85200 / 40000 - 1
  EXPECT_FALSE(is_feasible(least_error));
}

TEST(TrackingAggregate, ALimitCountsCasesAsTheObjectiveDoes) {
  const auto problem = load_tracking("q2-torque", {"objective.error_limit_m=0.5"});
  const std::vector<double> x = get_start(*problem);
  CaseOutcome diverged = make_outcome(1, 1, 0, 1);  // with 1 m for every point, as in training
  diverged.status = EvaluationStatus::diverged;
  const CaseOutcome good = make_outcome(0.25, 1, 0, 1);
  EXPECT_THAT(problem->aggregate(x, std::vector{good, diverged}).constraint_values,
              ElementsAre(0.25));
  // A case without an error does not change the constraints. It is counted, and no result with
  // such a case is called feasible.
  const CaseOutcome none = make_failure(EvaluationStatus::unreachable, "out of reach");
  const Evaluation half = problem->aggregate(x, std::vector{good, none});
  EXPECT_THAT(half.constraint_values, ElementsAre(-0.5));
  EXPECT_EQ(half.failed_cases, 1);
  EXPECT_THAT(problem->aggregate(x, std::vector{none}).constraint_values, IsEmpty());
  EXPECT_FALSE(is_feasible(problem->aggregate(x, std::vector{none})));
  CaseOutcome abandoned = good;
  abandoned.status = EvaluationStatus::abandoned;
  EXPECT_FALSE(is_feasible(problem->aggregate(x, std::vector{abandoned})));
}

TEST(TrackingAggregate, WithALimitThereAreNoResiduals) {
  CaseOutcome outcome = make_outcome(0.01, 1, 0, 1);
  outcome.residuals = {0.01, 0.01};
  for (const char* name : {"q2-torque", "q2-error"}) {
    const auto problem = load_tracking(name, {"physics.engine=articulated"});
    EXPECT_FALSE(problem->description().has_residuals);
    EXPECT_FALSE(problem->description().has_jacobian);
    EXPECT_THAT(problem->aggregate(get_start(*problem), std::vector{outcome}).residuals, IsEmpty());
  }
}

TEST(TrackingAggregate, TheLogarithmIsThatOfTheSameNumber) {
  const std::vector<CaseOutcome> outcomes = {make_outcome(0.01, 1, 0, 1)};
  for (const char* name : {"q1-complex", "q2-e3", "q2-torque", "q2-error"}) {
    const auto plain = load_tracking(name);
    const auto logarithmic = load_tracking(name, {"objective.logarithm=true"});
    const std::vector<double> x = get_start(*plain);
    EXPECT_EQ(logarithmic->aggregate(x, outcomes).objectives.at(0),
              std::log(plain->aggregate(x, outcomes).objectives.at(0)));
    EXPECT_EQ(logarithmic->aggregate(x, outcomes).constraint_values,
              plain->aggregate(x, outcomes).constraint_values);
    EXPECT_EQ(logarithmic->penalty_objectives().at(0), std::log(plain->penalty_objectives().at(0)));
    EXPECT_TRUE(std::isfinite(
        logarithmic->aggregate(x, std::vector{make_outcome(0, 1, 0, 1)}).objectives[0]));
  }
}

TEST(TrackingAggregate, TheSquaresOfTheResidualsAddUpToTheObjective) {
  CaseOutcome three = make_outcome(0.02, 1, 0, 1);
  three.residuals = {0.01, 0.02, 0.03};
  CaseOutcome two = make_outcome(0.05, 1, 0, 1);
  two.residuals = {0.04, 0.06};
  const std::vector<CaseOutcome> outcomes = {
      three, make_failure(EvaluationStatus::unreachable, "too far"), two};
  for (const auto& [name, torques] :
       std::map<std::string, std::size_t>{{"q1-complex", 0}, {"q2-e3", 4}, {"q2-pareto", 4}}) {
    SCOPED_TRACE(name);
    const auto problem = load_tracking(name);
    EXPECT_TRUE(problem->description().has_residuals);
    const Evaluation evaluation = problem->aggregate(get_start(*problem), outcomes);
    ASSERT_THAT(evaluation.residuals, SizeIs(5 + torques));
    double sum = 0;
    for (const double r : evaluation.residuals) {
      sum += r * r;
    }
    EXPECT_DOUBLE_EQ(sum, calc_scalar(problem->description(), evaluation.objectives));
  }
}

TEST(TrackingAggregate, MetricsAreMeansExceptPeaksAndCounts) {
  const auto problem = load_tracking("q1-complex");
  const double above = std::nextafter(kFailureError_m, 1);
  const std::vector<CaseOutcome> outcomes = {
      make_outcome(kFailureError_m, 100, 0.25, 1),  // exactly the limit: no failure
      make_outcome(above, 200, 0.5, 3),             // just above the limit: a failure
      make_failure(EvaluationStatus::diverged, "gone"), make_outcome(0.4, 600, 0, 2)};
  const Evaluation evaluation = problem->aggregate(get_start(*problem), outcomes);
  ASSERT_THAT(evaluation.metrics, SizeIs(problem->description().metrics.size()));
  EXPECT_EQ(evaluation.metrics[0], evaluation.objectives.at(0));
  EXPECT_EQ(evaluation.metrics[1], 85200);
  EXPECT_EQ(evaluation.metrics[2], 3);
  EXPECT_EQ(evaluation.failed_cases, 1);
  EXPECT_EQ(evaluation.metrics[3], 300);
  EXPECT_EQ(evaluation.metrics[4], 0.25);
  EXPECT_THAT(std::vector<double>(evaluation.metrics.begin() + 5, evaluation.metrics.end()),
              ElementsAre(30, 2, 60, 4, 90, 6, 120, 8));  // largest peak, mean rms
}

TEST(TrackingAggregate, CasesWithoutNumberAreLeftOutAndCounted) {
  const auto problem = load_tracking("q2-e4");
  const std::vector<CaseOutcome> outcomes = {
      make_outcome(0.25, 1, 0, 1), make_failure(EvaluationStatus::unreachable, "too far"),
      make_outcome(0.75, 1, 0, 1), make_failure(EvaluationStatus::diverged, "joint 1 spins")};
  const Evaluation evaluation = problem->aggregate(get_start(*problem), outcomes);
  EXPECT_EQ(evaluation.status,
            EvaluationStatus::unreachable);  // the status of the first case that is not ok
  EXPECT_EQ(evaluation.reason, "too far");
  EXPECT_EQ(evaluation.failed_cases, 2);
  EXPECT_NEAR(evaluation.objectives.at(0), 0.5 / 0.0058 + 85200.0 / 963686, 1e-12);
  ASSERT_THAT(evaluation.case_errors, SizeIs(4));
  EXPECT_EQ(evaluation.case_errors[0], 0.25);
  EXPECT_TRUE(std::isnan(evaluation.case_errors[1]));
  EXPECT_EQ(evaluation.case_errors[2], 0.75);
  EXPECT_TRUE(std::isnan(evaluation.case_errors[3]));
  EXPECT_THAT(evaluation.metrics, Each(testing::Truly([](double m) { return std::isfinite(m); })));
}

TEST(TrackingAggregate, NoNumberAtAllLeavesObjectivesAndMetricsEmpty) {
  const auto problem = load_tracking("q1-complex");
  const std::vector<CaseOutcome> outcomes = {make_failure(EvaluationStatus::diverged, "first"),
                                             make_failure(EvaluationStatus::unreachable, "second")};
  const Evaluation evaluation = problem->aggregate(get_start(*problem), outcomes);
  EXPECT_EQ(evaluation.status, EvaluationStatus::diverged);
  EXPECT_EQ(evaluation.reason, "first");
  EXPECT_EQ(evaluation.failed_cases, 2);
  EXPECT_THAT(evaluation.objectives, IsEmpty());
  EXPECT_THAT(evaluation.metrics, IsEmpty());
  EXPECT_THAT(evaluation.case_errors, SizeIs(2));
}

// In training, a diverged case has an error. The error of an abandoned case is a lower bound, and
// so are all numbers that are computed from it.
TEST(TrackingAggregate, AnAbandonedCaseMakesABoundOfTheWhole) {
  const auto problem = load_tracking("q2-e3");
  CaseOutcome diverged = make_outcome(1, 1, 0, 1);
  diverged.status = EvaluationStatus::diverged;
  diverged.reason = "diverged at 0.10 s";
  diverged.residuals = {1};
  CaseOutcome abandoned = make_outcome(0.5, 1, 0, 1);
  abandoned.status = EvaluationStatus::abandoned;
  abandoned.reason = "abandoned after point 2";
  CaseOutcome another = abandoned;
  another.reason = "abandoned after point 3";
  const Evaluation evaluation =
      problem->aggregate(get_start(*problem), std::vector{diverged, abandoned, another, diverged});
  EXPECT_EQ(evaluation.status, EvaluationStatus::abandoned);
  EXPECT_EQ(evaluation.reason, "abandoned after point 2");
  EXPECT_EQ(evaluation.failed_cases, 0);
  EXPECT_THAT(evaluation.case_errors, ElementsAre(1, 0.5, 0.5, 1));
  EXPECT_EQ(evaluation.metrics.at(0), 0.75);
  EXPECT_THAT(evaluation.residuals, IsEmpty());
  EXPECT_FALSE(is_feasible(evaluation)) << "nobody may take it for the best";
}

TEST(TrackingAggregate, DivergenceWithANumberKeepsItsStatus) {
  const auto problem = load_tracking("q1-complex");
  CaseOutcome cut_off = make_outcome(1, 1, 0, 1);  // training: its error is the cut-off error
  cut_off.status = EvaluationStatus::diverged;
  cut_off.reason = "diverged at 0.10 s";
  const Evaluation evaluation =
      problem->aggregate(get_start(*problem), std::vector{make_outcome(0.5, 1, 0, 1), cut_off});
  EXPECT_EQ(evaluation.status, EvaluationStatus::diverged);
  EXPECT_EQ(evaluation.reason, "diverged at 0.10 s");
  EXPECT_EQ(evaluation.failed_cases, 0);
  EXPECT_THAT(evaluation.objectives, ElementsAre(0.75));
}

TEST(TrackingPenalty, IsWorseThanAnythingThatTrainingCanGive) {
  for (const std::string name : {"q1-complex", "q2-e1", "q2-e5", "q2-torque", "q2-error"}) {
    for (const std::string cutoff : {"0.1", "1", "50"}) {
      SCOPED_TRACE(name + ", cut-off " + cutoff);
      const auto problem = load_tracking(name, {"training.cutoff_error_m=" + cutoff});
      const std::vector<double> penalty = problem->penalty_objectives();
      ASSERT_THAT(penalty, SizeIs(1));
      EXPECT_TRUE(std::isfinite(penalty[0]));
      // The worst possible numbers: every point at the cut-off error, all motors as strong as the
      // box allows.
      const std::vector<CaseOutcome> worst = {
          make_outcome(problem->config().cutoff_error_m, 1, 1, 1)};
      std::vector<double> strongest;
      for (const DecisionVariable& variable : problem->description().variables) {
        strongest.push_back(variable.start < 0 ? variable.lower : variable.upper);
      }
      EXPECT_GT(penalty[0], problem->aggregate(strongest, worst).objectives.at(0));
      RandomStream random("penalty", 1);
      for (int trial = 0; trial < 100; ++trial) {
        EXPECT_GT(penalty[0],
                  problem->aggregate(draw_vector(*problem, random), worst).objectives.at(0));
      }
    }
  }
}

TEST(TrackingPenalty, HasItsFormula) {
  EXPECT_THAT(load_tracking("q1-complex")->penalty_objectives(), ElementsAre(10));
  EXPECT_THAT(load_tracking("q1-complex", {"training.cutoff_error_m=0.5"})->penalty_objectives(),
              ElementsAre(5));
  EXPECT_NEAR(load_tracking("q2-e2")->penalty_objectives().at(0),
              10 / 0.0058 + 100 * 8520000.0 / 963686, 1e-9);
  // Effort limits that are not variables keep their start values.
  EXPECT_NEAR(load_tracking("q2-e2", {R"(variables.optimize=["p"])"})->penalty_objectives().at(0),
              10 / 0.0058 + 100 * 85200.0 / 963686, 1e-9);
}

}  // namespace
}  // namespace armwright
