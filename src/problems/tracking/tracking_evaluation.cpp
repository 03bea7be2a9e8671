// Makes the evaluations of the tracking problem from its simulated cases, and the bounds and penalties
// that optimizers get in their place.

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "problems/interface/add_outcome.hpp"
#include "problems/tracking/tracking_problem.hpp"
#include "sim/robot/tube.hpp"
#include "sim/tracking/designed_arm.hpp"

namespace armwright {

Evaluation TrackingProblem::aggregate(std::span<const double> x,
                                      std::span<const CaseOutcome> outcomes) const {
  Evaluation evaluation;
  const std::size_t joints = config_.robot.joint_count();
  double energy_sum_j = 0;
  double saturation_sum = 0;
  double duration_sum_s = 0;
  std::vector<double> peak_efforts(joints);
  std::vector<double> rms_effort_sums(joints);
  double failures = 0;
  double lost = 0;  // failures, and cases with a small error that diverged on their last points
  bool counts_worst = false;
  std::vector<double> errors_m;
  for (const CaseOutcome& outcome : outcomes) {
    if (!add_outcome(outcome, evaluation)) {
      ++failures;
      ++lost;
      continue;
    }
    errors_m.push_back(outcome.error);
    const bool failed = outcome.error > kFailureError_m;
    failures += failed ? 1 : 0;
    lost += failed || outcome.status == EvaluationStatus::diverged ? 1 : 0;
    counts_worst = counts_worst || outcome.metrics[case_metrics::kFailed] > 0;
    duration_sum_s += outcome.metrics[case_metrics::kDuration];
    energy_sum_j += outcome.metrics[case_metrics::kEnergy];
    saturation_sum += outcome.metrics[case_metrics::kSaturatedShare];
    for (std::size_t i = 0; i < joints; ++i) {
      peak_efforts[i] = std::max(peak_efforts[i], outcome.metrics[case_metrics::peak_effort(i)]);
      rms_effort_sums[i] += outcome.metrics[case_metrics::rms_effort(i)];
    }
  }
  if (errors_m.empty()) {
    return evaluation;
  }
  const auto numbers = static_cast<double>(errors_m.size());
  const TrackingObjective& objective = config_.objective;
  const ArmDesign design = make_design(x);
  const double mean_error = std::accumulate(errors_m.begin(), errors_m.end(), 0.0) / numbers;
  ObjectiveTerms terms;
  terms.error_m =
      calc_error_statistic(objective, errors_m, lost / static_cast<double>(outcomes.size()));
  terms.torque_n_m = calc_total_effort(design);
  terms.energy_j = energy_sum_j / numbers;
  terms.duration_s = duration_sum_s / numbers;
  terms.peak_torque_n_m = std::accumulate(peak_efforts.begin(), peak_efforts.end(), 0.0);
  terms.rms_torque_n_m =
      std::accumulate(rms_effort_sums.begin(), rms_effort_sums.end(), 0.0) / numbers;
  if (has_mass_metric(config_)) {
    terms.moving_mass_kg = calc_moving_mass_kg(make_robot(design)) + config_.task.load_kg;
  }
  if (has_deflection_metric(config_)) {
    terms.deflection_m = calc_deflection_m(design);
  }
  terms.required = calc_worst_required(outcomes, case_metrics::first_requirement(joints),
                                       config_.requirements.size());
  ObjectiveTerms counted = terms;
  if (counts_worst) {
    counted = worst_terms_;
    counted.error_m = terms.error_m;
    counted.required = terms.required;  // at least those of a case that ends early at its end
    for (std::size_t i = 0; i < counted.required.size(); ++i) {
      counted.required[i] =
          std::max(counted.required[i], kWorstRatio * config_.requirements[i].limit);
    }
  }
  evaluation.objectives = calc_objectives(objective, counted);
  evaluation.constraint_values = calc_constraints(objective, counted);
  if (const auto& limit_m = config_.tubes.deflection_limit_m) {
    evaluation.constraint_values.push_back(counted.deflection_m / *limit_m - 1);
  }
  append_constraints(config_.requirements, counted.required, evaluation.constraint_values);
  // A case with an error has residuals if they were asked for and the case was not abandoned.
  const bool has_residuals =
      description_.has_residuals && std::ranges::all_of(outcomes, [](const CaseOutcome& outcome) {
        return !outcome.has_error || !outcome.residuals.empty();
      });
  if (has_residuals) {
    evaluation.residuals =
        calc_residuals(objective, counts_worst ? strongest_ : design, counted, outcomes, numbers);
    evaluation.jacobian =
        calc_jacobian(objective, design, directions_, outcomes, evaluation.residuals);
    if (counts_worst && !evaluation.jacobian.empty()) {  // the largest torque does not change
      std::size_t points = 0;
      for (const CaseOutcome& outcome : outcomes) {
        points += outcome.residuals.size();
      }
      const auto first = static_cast<std::ptrdiff_t>(points * directions_.size());
      std::fill(evaluation.jacobian.begin() + first, evaluation.jacobian.end(), 0.0);
    }
  }
  evaluation.metrics = {mean_error, terms.torque_n_m, failures, terms.energy_j,
                        saturation_sum / numbers};
  if (has_duration_metric(config_)) {
    evaluation.metrics.push_back(terms.duration_s);
  }
  if (has_mass_metric(config_)) {
    evaluation.metrics.push_back(terms.moving_mass_kg);
  }
  if (has_deflection_metric(config_)) {
    evaluation.metrics.push_back(terms.deflection_m);
  }
  for (std::size_t i = 0; i < joints; ++i) {
    evaluation.metrics.push_back(peak_efforts[i]);
    evaluation.metrics.push_back(rms_effort_sums[i] / numbers);
  }
  evaluation.metrics.insert(evaluation.metrics.end(), terms.required.begin(), terms.required.end());
  return evaluation;
}

std::vector<double> TrackingProblem::calc_case_objectives(std::span<const double> x,
                                                          const Evaluation& evaluation) const {
  ObjectiveTerms terms;
  for (std::size_t i = 0; i < evaluation.metrics.size(); ++i) {
    const std::string& name = description_.metrics[i].name;
    const double value = evaluation.metrics[i];
    if (name == "energy") {
      terms.energy_j = value;
    } else if (name == "duration") {
      terms.duration_s = value;
    } else if (name == "moving_mass") {
      terms.moving_mass_kg = value;
    } else if (name == "deflection") {
      terms.deflection_m = value;
    } else if (name.ends_with(".peak_effort")) {
      terms.peak_torque_n_m += value;
    } else if (name.ends_with(".rms_effort")) {
      terms.rms_torque_n_m += value;
    } else if (name.starts_with("requirement.")) {
      terms.required.push_back(value);
    }
  }
  terms.torque_n_m = calc_total_effort(make_design(x));
  std::vector<double> objectives;
  for (const double error_m : evaluation.case_errors) {
    terms.error_m = error_m;
    objectives.push_back(
        std::isnan(error_m) ? error_m
                            : calc_scalar(description_, calc_objectives(config_.objective, terms)));
  }
  return objectives;
}

std::optional<double> TrackingProblem::calc_lower_bound(std::span<const double> x,
                                                        std::span<const CaseOutcome> outcomes,
                                                        std::size_t cases) const {
  if (description_.objectives.size() > 1 || !description_.constraints.empty()) {
    return std::nullopt;
  }
  // Errors and costs are never negative. So no further case makes an objective smaller than a
  // perfect case without any cost does.
  CaseOutcome perfect;
  perfect.metrics.assign(
      case_metrics::first_requirement(config_.robot.joint_count()) + config_.requirements.size(),
      0.0);
  std::vector<CaseOutcome> all(cases, perfect);
  std::ranges::copy(outcomes, all.begin());
  const Evaluation evaluation = aggregate(x, all);
  return evaluation.objectives.empty() ? -std::numeric_limits<double>::infinity()
                                       : evaluation.objectives.front();
}

ArmDesign TrackingProblem::make_strongest_design() const {
  ArmDesign strongest = config_.start;
  for (const DesignParameter& parameter : config_.parameters) {
    if (is_effort(parameter)) {
      get_parameter(strongest, parameter) *= config_.bounds_factor;
    }
  }
  return strongest;
}

ObjectiveTerms TrackingProblem::make_worst_terms() const {
  // The energy is that of the largest torque over one turn of every joint per move. The mass is that
  // of the largest arm, and the deflection is the arm's length.
  TrackingTask slowest = make_task(config_.start);
  if (changes_speed(config_)) {
    slowest.speed_m_per_s /= config_.speed_bounds_factor;
  }
  ObjectiveTerms terms;
  terms.torque_n_m = calc_total_effort(strongest_);
  terms.energy_j = terms.torque_n_m * 2 * std::numbers::pi * config_.workspace.points;
  terms.duration_s = calc_case_duration_s(config_, slowest);
  terms.peak_torque_n_m = terms.rms_torque_n_m = terms.torque_n_m;
  if (has_mass_metric(config_)) {
    ArmDesign largest = config_.start;
    for (std::size_t i = 0; i < config_.parameters.size(); ++i) {
      const DecisionVariable& variable = description_.variables[i];
      get_parameter(largest, config_.parameters[i]) =
          is_effort(config_.parameters[i]) && variable.upper < 0 ? variable.lower : variable.upper;
    }
    terms.moving_mass_kg = calc_moving_mass_kg(make_robot(largest)) + config_.task.load_kg;
  }
  for (std::size_t link = 0; link < config_.tubes.tubes.size(); ++link) {
    terms.deflection_m += get_link_length_m(config_.robot, link);
  }
  return terms;
}

std::vector<double> TrackingProblem::penalty_objectives() const {
  // The error is ten times that of a design that is cut off at the first point of every case. The
  // torque is ten times the largest if only torque is minimised. A requirement counts more than the
  // worst training case.
  const TrackingObjective& objective = config_.objective;
  ObjectiveTerms terms = worst_terms_;
  terms.error_m = 10 * config_.cutoff_error_m;
  if (objective.statistic == TrackingObjective::Statistic::mean_with_failures) {
    terms.error_m += 10 * objective.failure_penalty_m;
  }
  if (objective.kind == TrackingObjective::Kind::torque_with_error_limit) {
    terms.torque_n_m *= 10;
  }
  for (const Requirement& requirement : config_.requirements) {
    terms.required.push_back(2 * kWorstRatio * requirement.limit);
  }
  return calc_objectives(objective, terms);
}

}  // namespace armwright
