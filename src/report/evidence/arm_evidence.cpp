#include "report/evidence/arm_evidence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/text.hpp"
#include "problems/tracking/tracking_config.hpp"
#include "report/evidence/distance_response.hpp"
#include "report/evidence/page_json.hpp"
#include "report/evidence/signals.hpp"

namespace armwright {
namespace {

using nlohmann::json;

json make_failures(const RecordedRun& run, const std::string& argument,
                   const std::vector<double>& errors, const std::vector<TrackingResult>& results,
                   double failure_error) {
  json failures = json::array();
  for (std::size_t i = 0; i < errors.size(); ++i) {
    if (errors[i] <= failure_error) {
      continue;
    }
    std::string reason = "the tip lost its target";
    if (std::isnan(errors[i])) {
      reason = results.empty() ? "no number" : results[i].reason;
    }
    const std::vector<std::string> words = {"--test-set", run.problem ? run.problem->sets.test : "",
                                            "--cases", fmt::format("{}", i + 1)};
    failures.push_back(
        {{"case", i},
         {"error", finite_or_null(errors[i])},
         {"reason", reason},
         {"command", argument.empty() ? "" : run.make_evaluate_command(argument, words)}});
  }
  return failures;
}

json make_parameters(const RecordedRun& run, const std::vector<ShownDesign>& designs) {
  const TrackingConfig& config = run.tracking()->config();
  const ProblemDescription& description = run.problem->problem->description();
  const ControllerRow& controller = find_controller(config.start.controller);
  // A variable this close to its bound, relative to the bound, counts as being at the bound.
  constexpr double kShare = 1e-6;
  json list = json::array();
  const auto add = [&](const DesignParameter& parameter, const std::string& name,
                       const std::string& unit) {
    const auto is_it = [&](const DesignParameter& other) {
      return other.joint == parameter.joint && other.kind == parameter.kind &&
             (parameter.kind != DesignParameter::Kind::gain || other.gain == parameter.gain);
    };
    const auto found = std::ranges::find_if(config.parameters, is_it);
    const bool is_variable = found != config.parameters.end();
    json values = json::array();
    std::string at_bound;
    for (const ShownDesign& design : designs) {
      ArmDesign copy = design.named.design;
      const bool is_same_controller = copy.controller == config.start.controller ||
                                      parameter.kind != DesignParameter::Kind::gain;
      const double value = is_same_controller ? get_parameter(copy, parameter)
                                              : std::numeric_limits<double>::quiet_NaN();
      values.push_back(finite_or_null(value));
      if (design.named.id == "winner" && is_variable) {
        const DecisionVariable& variable =
            description.variables[static_cast<std::size_t>(found - config.parameters.begin())];
        const auto is_at = [&](double bound) {
          return std::abs(value - bound) <= kShare * std::abs(bound);
        };
        at_bound = is_at(variable.lower) ? "lower" : is_at(variable.upper) ? "upper" : "";
      }
    }
    list.push_back({{"name", name},
                    {"unit", unit},
                    {"is_variable", is_variable},
                    {"at_bound", at_bound},
                    {"values", std::move(values)}});
  };
  for (std::size_t joint = 0; joint < config.robot.joint_count(); ++joint) {
    const std::string& name = config.robot.joints[joint].name;
    for (std::size_t gain = 0; gain < controller.gains.size(); ++gain) {
      add({joint, DesignParameter::Kind::gain, gain}, name + "." + controller.gains[gain].name,
          controller.gains[gain].unit);
    }
    add({joint, DesignParameter::Kind::effort_min, 0}, name + ".effort_min", "N m");
    add({joint, DesignParameter::Kind::effort_max, 0}, name + ".effort_max", "N m");
  }
  return list;
}

json make_result_rows(const RobotModel& robot, const std::vector<ShownDesign>& designs) {
  json rows = json::array();
  for (const ShownDesign& design : designs) {
    if (design.results.empty()) {
      continue;
    }
    const ErrorSummary summary = summarize_cases(design.results);
    const EffortTotals efforts = calc_effort_totals(design.named.design, robot);
    rows.push_back({{"design", design.named.id},
                    {"source", design.source},
                    {"mean_m", finite_or_null(summary.mean)},
                    {"median_m", finite_or_null(summary.median)},
                    {"p95_m", finite_or_null(summary.percentile_95)},
                    {"worst_m", finite_or_null(summary.worst)},
                    {"failures", summary.failures},
                    {"cases", summary.cases},
                    {"total_torque_n_m", finite_or_null(efforts.torque_n_m)},
                    {"total_force_n", finite_or_null(efforts.force_n)},
                    {"published_mean_m", finite_or_null(design.published_mean_m)},
                    {"published_torque_n_m", finite_or_null(design.published_torque_n_m)},
                    {"where", design.where}});
  }
  return rows;
}

json make_response(const RecordedRun& run, const std::vector<ShownDesign>& designs) {
  const CaseSets& sets = run.problem->sets;
  json series = json::array();
  const bool has_moves = !list_moves_m(run.tracking()->config()).empty();
  for (const ShownDesign& design : designs) {
    if (design.results.empty() || !has_moves) {
      continue;
    }
    const std::string command =
        design.argument.empty()
            ? ""
            : run.make_evaluate_command(design.argument, {"--test-set", sets.test, "--cases",
                                                          fmt::format("{}", sets.test_cases)});
    series.push_back(make_response_series(*run.tracking(), design.named.name, design.results,
                                          design.published_mean_m, command));
  }
  std::string remark = fmt::format(
      "Means over the cases of {} with a number, and the standard error of the mean.", sets.test);
  if (!run.tracking()->config().task.count_first_point) {
    remark += " The first point does not count in a case's error.";
  }
  return make_distance_response(
      *run.tracking(),
      {"distance-response", "Error against the distance of the move", "", std::move(remark)},
      std::move(series));
}

}  // namespace

json make_test_errors(const RecordedRun& run, const std::vector<ShownDesign>& designs) {
  if (!run.result || !run.result->winner) {
    return nullptr;
  }
  const RunResult& result = *run.result;
  const double failure_error = get_failure_error(result);
  json list = json::array();
  const auto add = [&](const std::string& name, const std::string& argument,
                       const std::vector<double>& errors,
                       const std::vector<TrackingResult>& results) {
    list.push_back({{"name", name},
                    {"errors", finite_or_null(errors)},
                    {"failures", make_failures(run, argument, errors, results, failure_error)}});
  };
  const std::vector<TrackingResult> none;
  // The winner's errors are the recorded ones, because the run's result was made of them.
  const bool has_designs = !designs.empty();
  add("winner", has_designs ? designs.front().argument : "", result.test.case_errors,
      has_designs ? designs.front().results : none);
  for (std::size_t i = 1; i < designs.size(); ++i) {
    if (!designs[i].results.empty()) {
      add(designs[i].named.name, designs[i].argument, get_case_errors(designs[i].results),
          designs[i].results);
    }
  }
  const TrackingProblem* tracking = run.tracking();
  return {{"set", result.test_set},
          {"quantity",
           run.make_quantity(result.tracking ? Quantity{"error", "m"} : get_target(result))},
          {"engine", tracking != nullptr ? tracking->config().engines.judging_name : ""},
          {"failure_error", finite_or_null(failure_error)},
          {"designs", std::move(list)}};
}

json make_arm_evidence(const RecordedRun& run, const std::vector<ShownDesign>& designs,
                       PageSimulator* simulator, std::vector<std::string>& notes) {
  const TrackingProblem& tracking = *run.tracking();
  const RobotModel& robot = tracking.config().robot;
  json list = json::array();
  for (const ShownDesign& design : designs) {
    list.push_back(make_design_info(design.named, robot));
  }
  json sweep = nullptr;
  json health = nullptr;
  if (simulator != nullptr) {
    health = make_health(run, designs.front(), *simulator);
    sweep = make_speed_sweep(run, designs, *simulator, notes);
  }
  // The signals have the winner's own speed, if it has one.
  const TrackingTask task =
      designs.empty() ? tracking.config().task : tracking.make_task(designs.front().named.design);
  return {{"designs", std::move(list)},
          {"parameters", make_parameters(run, designs)},
          {"results", make_result_rows(robot, designs)},
          {"response", make_response(run, designs)},
          {"signals", make_signals(task, true)},
          {"sweep", std::move(sweep)},
          {"health", std::move(health)}};
}

}  // namespace armwright
