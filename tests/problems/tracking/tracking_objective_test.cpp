// The arithmetic of objectives, checked by hand; tracking_problem_test.cpp tests whole evaluations.
#include "problems/tracking/tracking_objective.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/expect_error.hpp"
#include "problems/load_tracking.hpp"
#include "problems/problem_folder.hpp"

namespace armwright {
namespace {

using Kind = TrackingObjective::Kind;
using Statistic = TrackingObjective::Statistic;
using Q = TrackingQuantity;
using testing::ElementsAre;
using testing::SizeIs;

WeightedQuantity make_term(Q quantity, double weight, double scale) {
  return {static_cast<std::size_t>(quantity), weight, scale};
}

const std::vector<double> kErrors_m = {0.5, 0.125, 2, 0.25};

double calc_cvar(double share, const std::vector<double>& errors_m = kErrors_m) {
  TrackingObjective objective;
  objective.statistic = Statistic::cvar;
  objective.cvar_share = share;
  return calc_error_statistic(objective, errors_m, 0);
}

double calc_statistic(Statistic statistic, double lost_share) {
  TrackingObjective objective;
  objective.statistic = statistic;
  objective.failure_penalty_m = 8;
  return calc_error_statistic(objective, kErrors_m, lost_share);
}

TEST(ErrorStatistic, IsTheNumberByHand) {
  EXPECT_EQ(calc_statistic(Statistic::mean, 0.5), 0.71875);
  EXPECT_EQ(calc_statistic(Statistic::worst, 0.5), 2);
  EXPECT_EQ(calc_statistic(Statistic::mean_with_failures, 0.5), 4.71875);
  EXPECT_EQ(calc_statistic(Statistic::mean_with_failures, 0), 0.71875);
}

TEST(ErrorStatistic, CvarWeighsTheCaseOnTheBorderByItsPart) {
  EXPECT_EQ(calc_cvar(0.25), 2);                  // one of four
  EXPECT_EQ(calc_cvar(0.5), 1.25);                // (2 + 0.5) / 2
  EXPECT_EQ(calc_cvar(0.375), (2 + 0.25) / 1.5);  // half of the second
  EXPECT_EQ(calc_cvar(0.01), 2);                  // a part of the worst error alone
  EXPECT_EQ(calc_cvar(1), 0.71875);
}

// Rockafellar and Uryasev define the value as the least over a of a + mean(max(0, e - a)) / s. The
// function is convex and piecewise linear, so the minimum lies at one of the errors.
TEST(ErrorStatistic, CvarIsTheMinimumThatDefinesIt) {
  for (int percent = 1; percent <= 100; ++percent) {
    const double share = percent / 100.0;
    double least = INFINITY;
    for (const double a : kErrors_m) {
      double excess = 0;
      for (const double error_m : kErrors_m) {
        excess += std::max(0.0, error_m - a) / static_cast<double>(kErrors_m.size());
      }
      least = std::min(least, a + excess / share);
    }
    EXPECT_NEAR(calc_cvar(share), least, 1e-14) << share;  // a few roundings of numbers up to 2
  }
}

TEST(ErrorStatistic, CvarFallsContinuouslyFromTheWorstToTheMean) {
  double before = calc_statistic(Statistic::worst, 0);
  for (int i = 1; i <= 10000; ++i) {
    const double cvar = calc_cvar(i / 10000.0);
    EXPECT_LE(cvar, before + 1e-14);
    // Its slope is at most (worst - best) / share, and the share is at least 1/4 where the value
    // falls: 1.875 / 0.25 / 10000.
    EXPECT_GE(cvar, before - 7.5e-4);
    before = cvar;
  }
}

// Because no statistic falls if an error rises, lower bounds of errors give a lower bound.
TEST(ErrorStatistic, NeverFallsWhereACaseRises) {
  for (const Statistic statistic :
       {Statistic::mean, Statistic::worst, Statistic::cvar, Statistic::mean_with_failures}) {
    TrackingObjective objective;
    objective.statistic = statistic;
    objective.cvar_share = 0.4;
    for (std::size_t i = 0; i < kErrors_m.size(); ++i) {
      std::vector<double> higher = kErrors_m;
      for (int rise = 0; rise < 30; ++rise) {
        const double before = calc_error_statistic(objective, higher, 0.25);
        higher[i] += 0.1;
        EXPECT_GE(calc_error_statistic(objective, higher, 0.25), before);
      }
    }
  }
}

// 1 um of error, as the objective counts it. A total torque has the same share of its scale.
TEST(Resolution, IsAMicrometreOfErrorInTheUnitOfTheObjective) {
  TrackingObjective objective;
  objective.error_scale_m = 0.004;
  objective.torque_scale_n_m = 8000;
  EXPECT_EQ(calc_resolution(objective), 1e-6);
  objective.logarithm = true;
  EXPECT_EQ(calc_resolution(objective), 1e-6);
  objective.energy_weight = 1;
  EXPECT_DOUBLE_EQ(calc_resolution(objective), 2.5e-4);
  EXPECT_DOUBLE_EQ(calc_resolution({.kind = Kind::error_and_torque, .error_scale_m = 0.004}),
                   2.5e-4);
  TrackingObjective front;
  front.set_front({make_term(Q::error, 1, 0.004), make_term(Q::energy, 1, 1)});
  EXPECT_DOUBLE_EQ(calc_resolution(front), 2.5e-4);
  front.set_front({make_term(Q::torque, 1, 1), make_term(Q::energy, 1, 1)});
  EXPECT_EQ(calc_resolution(front), 0);
  EXPECT_EQ(calc_resolution({.kind = Kind::error_with_torque_limit}), 1e-6);
  objective.kind = Kind::torque_with_error_limit;
  EXPECT_DOUBLE_EQ(calc_resolution(objective), 2);
  EXPECT_EQ(load_tracking("q1-complex")->description().resolution, 1e-6);
}

TEST(ObjectiveTerms, EnergyAndDurationAreAddedInPartsOfTheirScales) {
  TrackingObjective objective;
  objective.error_scale_m = 0.5;
  objective.energy_weight = 3;
  objective.energy_scale_j = 1000;
  objective.duration_weight = 2;
  objective.duration_scale_s = 16;
  objective.torque_weight = 4;
  objective.torque_scale_n_m = 100;
  const ObjectiveTerms terms{.error_m = 0.25, .torque_n_m = 50, .energy_j = 500, .duration_s = 40};
  EXPECT_THAT(calc_objectives(objective, terms), ElementsAre(0.5 + 1.5 + 5));
  EXPECT_EQ(describe_objectives(objective)[0].name, "error, energy and duration");
  EXPECT_EQ(describe_objectives(objective)[0].unit, "1");
  objective.kind = Kind::error_and_torque;
  EXPECT_THAT(calc_objectives(objective, terms), ElementsAre(0.5 + 2 + 1.5 + 5));
  EXPECT_EQ(describe_objectives(objective)[0].name, "error, torque, energy and duration");
  objective.logarithm = true;
  EXPECT_THAT(calc_objectives(objective, terms), ElementsAre(std::log(9.0)));
  objective.energy_weight = 0;
  objective.duration_weight = 0;
  EXPECT_EQ(describe_objectives(objective)[0].name, "ln(error and torque)");
}

CaseOutcome make_case(double error_m, double energy_j, double duration_s) {
  CaseOutcome outcome;
  outcome.error = error_m;
  outcome.residuals = {error_m, error_m};
  outcome.metrics.resize(case_metrics::first_requirement(4));
  outcome.metrics[case_metrics::kEnergy] = energy_j;
  outcome.metrics[case_metrics::kDuration] = duration_s;
  return outcome;
}

TEST(TrackingStatistics, EvaluationsCarryThemAndTheMeanAsMetric) {
  const std::vector<CaseOutcome> outcomes = {make_case(0.02, 1, 40), make_case(0.2, 1, 40),
                                             make_case(0.08, 1, 40)};
  const auto evaluate = [&](const std::vector<std::string>& overrides) {
    const auto problem = load_tracking("q1-complex", overrides);
    EXPECT_FALSE(problem->description().has_residuals);
    const Evaluation evaluation =
        problem->aggregate(problem->make_vector(problem->config().start), outcomes);
    EXPECT_DOUBLE_EQ(evaluation.metrics.at(0), 0.1);
    EXPECT_THAT(evaluation.residuals, SizeIs(0));
    return evaluation.objectives.at(0);
  };
  EXPECT_EQ(evaluate({"objective.statistic=worst"}), 0.2);
  EXPECT_DOUBLE_EQ(evaluate({"objective.statistic=cvar", "objective.cvar_share=0.5"}),
                   (0.2 + 0.5 * 0.08) / 1.5);
  EXPECT_DOUBLE_EQ(
      evaluate({"objective.statistic=mean_with_failures", "objective.failure_penalty_m=6"}),
      0.1 + 6 / 3.0);
}

// A case that diverged on its last points can have a small error; another case has no error.
TEST(TrackingStatistics, EveryLossOfTheTargetIsAFailure) {
  const auto problem = load_tracking(
      "q1-complex", {"objective.statistic=mean_with_failures", "objective.failure_penalty_m=8"});
  CaseOutcome diverged = make_case(0.0625, 1, 40);
  diverged.status = EvaluationStatus::diverged;
  CaseOutcome none;
  none.status = EvaluationStatus::unreachable;
  none.has_error = false;
  const std::vector<CaseOutcome> outcomes = {make_case(0.0625, 1, 40), diverged, none,
                                             make_case(0.0625, 1, 40)};
  const Evaluation evaluation =
      problem->aggregate(problem->make_vector(problem->config().start), outcomes);
  EXPECT_EQ(evaluation.objectives.at(0), 0.0625 + 8 * 0.5);
}

TEST(TrackingStatistics, LimitsAreOfTheSameError) {
  const auto problem =
      load_tracking("q2-torque", {"objective.statistic=worst", "objective.error_limit_m=0.1"});
  EXPECT_EQ(problem->description().limits.at(0).quantity.name, "worst error");
  const std::vector<CaseOutcome> outcomes = {make_case(0.02, 1, 40), make_case(0.2, 1, 40)};
  EXPECT_THAT(
      problem->aggregate(problem->make_vector(problem->config().start), outcomes).constraint_values,
      ElementsAre(1));
}

TEST(TrackingStatistics, TheSquaresOfAllResidualsAddUp) {
  const auto problem =
      load_tracking("q2-e6", {"objective.energy_weight=2", "objective.energy_scale_j=1000",
                              "objective.duration_weight=0.5", "objective.duration_scale_s=10",
                              "physics.engine=articulated"});
  EXPECT_FALSE(problem->description().has_jacobian);
  EXPECT_THAT(problem->description().jacobian_advice, testing::HasSubstr("energy_weight"));
  const std::vector<CaseOutcome> outcomes = {make_case(0.25, 300, 40), make_case(0.5, 500, 40)};
  const Evaluation evaluation =
      problem->aggregate(problem->make_vector(problem->config().start), outcomes);
  ASSERT_THAT(evaluation.residuals, SizeIs(4 + 4 + 2));
  double sum = 0;
  for (const double r : evaluation.residuals) {
    sum += r * r;
  }
  EXPECT_DOUBLE_EQ(sum, evaluation.objectives.at(0));
  EXPECT_DOUBLE_EQ(evaluation.objectives[0], 0.375 / 0.0058 + 85200.0 / 963686 + 0.8 + 2);
  EXPECT_EQ(evaluation.metrics.at(5), 40);
  EXPECT_EQ(problem->description().metrics.at(5).name, "duration");
}

TEST(ObjectiveTable, RefusesWhatCannotBeMeant) {
  const ProblemFolder folder;
  EXPECT_EQ(folder.refusal_of_base_with("[objective]\nstatistic = 'median'"),
            "p.toml:3: unknown objective.statistic 'median'; did you mean 'mean'? Valid: mean, "
            "worst, cvar, "
            "mean_with_failures");
  EXPECT_EQ(folder.refusal_of_base_with("[objective]\nstatistic = 'cvar'\ncvar_share = 0"),
            "p.toml:4: objective.cvar_share is 0; it must be a finite number > 0 and <= 1");
  EXPECT_EQ(folder.refusal_of_base_with("[objective]\nstatistic = 'mean_with_failures'\n"
                                        "failure_penalty_m = -1"),
            "p.toml:4: objective.failure_penalty_m is -1; it must be a finite number > 0 and <= "
            "1000000000000");
  EXPECT_EQ(folder.refusal_of_base_with("[objective]\nenergy_weight = 1"),
            "p.toml:2: objective.energy_scale_j is missing; it must be a finite number > 0 and <= "
            "1000000000000");
  EXPECT_EQ(folder.refusal_of_base_with("[objective]\nkind = 'error_vs_torque'\nenergy_weight = 1\n"
                                        "energy_scale_j = 1"),
            "p.toml:4: objective.energy_weight is 1; only the kinds error and error_and_torque are "
            "sums; choose one of them or leave it out");
}

TEST(Front, HasEachQuantityAsAnObjectiveInTheOrderOfTheFile) {
  TrackingObjective objective;
  objective.set_front({make_term(Q::energy, 2, 100), make_term(Q::error, 4, 0.5),
                       make_term(Q::requirement, 1, 1), make_term(Q::peak_torque, 1, 1),
                       make_term(Q::rms_torque, 1, 1), make_term(Q::moving_mass, 1, 1),
                       make_term(Q::duration, 1, 1), make_term(Q::torque, 1, 1),
                       make_term(Q::deflection, 1, 1)});
  ObjectiveTerms terms{.error_m = 1, .torque_n_m = 2, .energy_j = 3, .duration_s = 4};
  terms.peak_torque_n_m = 5;
  terms.rms_torque_n_m = 6;
  terms.moving_mass_kg = 7;
  terms.required = {8};
  terms.deflection_m = 9;
  EXPECT_THAT(calc_objectives(objective, terms), ElementsAre(3, 1, 8, 5, 6, 7, 4, 2, 9));
  const std::vector<Quantity> required = {{"overshoot", "1"}};
  const std::vector<Quantity> objectives = describe_objectives(objective, required);
  EXPECT_EQ(objectives[0].name, "energy");
  EXPECT_EQ(objectives[2].name, "overshoot");
  EXPECT_FALSE(objective.has_residuals());  // an overshoot has none
  EXPECT_EQ(objective.error_scale_m, 0.125);
  EXPECT_THAT(calc_constraints(objective, terms), testing::IsEmpty());
  objective.error_limit_m = 0.5;
  objective.total_torque_limit_n_m = 4;
  EXPECT_THAT(calc_constraints(objective, terms), ElementsAre(1, -0.5));
}

// Evaluates the start of q2-e6 on two cases, with further overrides.
std::pair<std::shared_ptr<const TrackingProblem>, Evaluation> evaluate_start(
    std::vector<std::string> overrides) {
  overrides.insert(overrides.end(), {"physics.engine=articulated", "workspace.points=4"});
  auto problem = load_tracking("q2-e6", overrides);
  Evaluation evaluation = problem->evaluate(list_starts(problem->description().variables),
                                            {CaseRole::training, "train/1", {0, 1}});
  return {problem, std::move(evaluation)};
}

TEST(Front, OfErrorAndTorqueIsErrorVsTorqueBitByBit) {
  const auto [old_kind, old_one] = evaluate_start({"objective.kind=error_vs_torque"});
  const auto [front, one] =
      evaluate_start({"objective.kind=front", "objective.quantities=[\"error\", \"torque\"]"});
  EXPECT_EQ(one.objectives, old_one.objectives);
  EXPECT_EQ(one.metrics, old_one.metrics);
  EXPECT_EQ(one.residuals, old_one.residuals);
  EXPECT_THAT(one.residuals, testing::Not(testing::IsEmpty()));
  EXPECT_EQ(front->description().objective_weights, old_kind->description().objective_weights);
  EXPECT_EQ(front->penalty_objectives(), old_kind->penalty_objectives());
}

TEST(Front, HasTheMetricsAsObjectives) {
  const auto [problem, one] = evaluate_start(
      {"objective.kind=front", "variables.task=[\"speed\"]",
       "objective.quantities=[\"error\", \"energy\", \"duration\", \"jerk\", \"peak_torque\"]",
       "requirement=[{quantity=\"jerk\", limit_rad2_per_s5=1e5}]", "objective.error_limit_m=0.5"});
  ASSERT_THAT(one.objectives, SizeIs(5));
  const auto metric = [&](const std::string& name) { return get_metric(*problem, one, name); };
  EXPECT_EQ(one.objectives[0], metric("error"));
  EXPECT_EQ(one.objectives[1], metric("energy"));
  EXPECT_EQ(one.objectives[2], metric("duration"));
  EXPECT_EQ(one.objectives[3], metric("requirement.jerk"));
  EXPECT_GT(one.objectives[3], 0);
  double peaks = 0;
  for (const Joint& joint : problem->config().robot.joints) {
    peaks += metric(joint.name + ".peak_effort");
  }
  EXPECT_EQ(one.objectives[4], peaks);
  EXPECT_THAT(one.constraint_values, ElementsAre(one.objectives[0] / 0.5 - 1));
  EXPECT_FALSE(problem->description().has_residuals);
  EXPECT_EQ(problem->description().objective_weights[3], 1 / 1e5);
  const std::vector<double> penalty = problem->penalty_objectives();
  for (std::size_t i = 0; i < penalty.size(); ++i) {
    EXPECT_GT(penalty[i], one.objectives[i]) << i;
  }
}

// The residuals of a front are those of its weighted sum.
TEST(Front, ItsResidualsSquaredAreItsWeightedSum) {
  const auto [problem, one] = evaluate_start(
      {"objective.kind=front", "objective.quantities=[\"energy\", \"error\", \"torque\"]",
       "objective.weights=[3, 0.5, 2]", "objective.scales=[20000, 0.01, 1e6]"});
  double sum = 0;
  for (const double residual : one.residuals) {
    sum += residual * residual;
  }
  ASSERT_GT(sum, 0);
  EXPECT_NEAR(sum, calc_scalar(problem->description(), one.objectives), 1e-9 * sum);
}

TEST(Front, SaysWhatIsWrong) {
  const ProblemFolder folder;
  const auto refuse = [&](const std::string& lines) {
    return folder.refusal_of_base_with("[objective]\nkind = 'front'\n" + lines);
  };
  EXPECT_EQ(refuse("quantities = ['error']"),
            "p.toml:4: objective.quantities is ['error']; a front needs at least two quantities; "
            "for one, choose another objective.kind");
  EXPECT_THAT(refuse("quantities = ['error', 'enrgy']"),
              testing::HasSubstr("unknown quantity 'enrgy'; did you mean 'energy'?"));
  EXPECT_THAT(refuse("quantities = ['error', 'jerk']"),
              testing::HasSubstr("'jerk' is measured for a [[requirement]] only; add one with "
                                 "quantity = \"jerk\""));
  EXPECT_THAT(refuse("quantities = ['error', 'duration']"),
              testing::HasSubstr("'duration' is the same for all designs here; set "
                                 "variables.task = [\"speed\"]"));
  EXPECT_THAT(refuse("quantities = ['error', 'moving_mass']"),
              testing::HasSubstr("'moving_mass' is the same for all designs here"));
  EXPECT_THAT(refuse("quantities = ['error', 'deflection']"),
              testing::HasSubstr("'deflection' is the same for all designs here; give the arm "
                                 "[tubes], and add tube_diameter, tube_wall or length_scale"));
  EXPECT_THAT(refuse("quantities = ['error', 'error']"), testing::HasSubstr("stands there twice"));
  EXPECT_THAT(refuse("quantities = ['error', 'energy']\nscales = [1]"),
              testing::HasSubstr("it must hold 2 numbers, one per quantity"));
  EXPECT_THAT(refuse(""), testing::HasSubstr("objective.quantities is missing"));
}

TEST(TrackingObjective, WhatAStatisticDoesNotReadIsRefused) {
  for (const std::string key : {"cvar_share", "failure_penalty_m"}) {
    EXPECT_THAT(usage_error_of([&] {
                  load_problem("q2-e6", std::vector<std::string>{"objective." + key + "=0.2"});
                }),
                testing::HasSubstr("it does nothing to the mean; set objective.statistic"))
        << key;
  }
}

}  // namespace
}  // namespace armwright
