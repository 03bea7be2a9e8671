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
#include "report/evidence/sweep_data.hpp"

namespace armwright {
namespace {

using nlohmann::json;

// Cases enough to tell the speeds apart, and few enough to wait for.
constexpr int kMostSweepCases = 100;

json make_failures(const RecordedRun& run, const std::string& word,
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
    failures.push_back({{"case", i},
                        {"error", finite_or_null(errors[i])},
                        {"reason", reason},
                        {"command", word.empty() ? "" : run.make_evaluate_command(word, words)}});
  }
  return failures;
}

json make_parameters(const RecordedRun& run, const std::vector<ShownDesign>& designs) {
  const TrackingConfig& config = run.tracking()->config();
  const ProblemDescription& description = run.problem->problem->description();
  const ControllerRow& controller = find_controller(config.start.controller);
  // Where a variable counts as being at its bound.
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

json make_result_rows(const std::vector<ShownDesign>& designs) {
  json rows = json::array();
  for (const ShownDesign& design : designs) {
    if (design.results.empty()) {
      continue;
    }
    const ErrorSummary summary = summarize_cases(design.results);
    rows.push_back({{"design", design.named.id},
                    {"mean_m", finite_or_null(summary.mean)},
                    {"median_m", finite_or_null(summary.median)},
                    {"p95_m", finite_or_null(summary.percentile_95)},
                    {"worst_m", finite_or_null(summary.worst)},
                    {"failures", summary.failures},
                    {"cases", summary.cases},
                    {"total_torque_n_m", calc_total_effort(design.named.design)},
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
        design.word.empty()
            ? ""
            : run.make_evaluate_command(design.word, {"--test-set", sets.test, "--cases",
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

// A design with a speed of its own moves at that, whatever the task's is: it cannot be swept.
std::vector<const ShownDesign*> choose_swept(const std::vector<ShownDesign>& designs) {
  std::vector<const ShownDesign*> swept;
  for (const ShownDesign& design : designs) {
    if (design.named.id != "base" && !design.named.design.speed_m_per_s) {
      swept.push_back(&design);
    }
  }
  return swept;
}

SweepRequest make_sweep_request(const RecordedRun& run,
                                const std::vector<const ShownDesign*>& swept) {
  constexpr double kFirst_m_per_s = 0.5;
  constexpr double kStep_m_per_s = 0.25;
  constexpr int kSpeeds = 11;
  constexpr double kThesis_m_per_s = 1.5;
  // Of tasks at quite another speed than the thesis's the same multiples.
  const double speed_m_per_s = run.tracking()->config().task.speed_m_per_s;
  const double scale = speed_m_per_s < kFirst_m_per_s || speed_m_per_s > 2 * kThesis_m_per_s
                           ? speed_m_per_s / kThesis_m_per_s
                           : 1;
  SweepRequest request;
  std::vector<std::string> values;
  for (int i = 0; i < kSpeeds; ++i) {
    request.speeds_m_per_s.push_back(scale * (kFirst_m_per_s + kStep_m_per_s * i));
    values.push_back(format_exact(request.speeds_m_per_s.back()));
  }
  const CaseSets& sets = run.problem->sets;
  request.set = sets.test;
  request.cases = static_cast<std::uint64_t>(std::min(sets.test_cases, kMostSweepCases));
  if (!run.problem_words.empty() && !swept.empty() && !swept.front()->word.empty()) {
    std::vector<std::string> words = {"armwright", "sweep"};
    words.insert(words.end(), run.problem_words.begin() + 1, run.problem_words.end());
    words.insert(words.end(), {"--design", swept.front()->word, "--parameter", "task.speed_m_per_s",
                               "--values", join(values, ","), "--test-set", sets.test, "--cases",
                               fmt::format("{}", request.cases)});
    request.command = quote_command(words);
  }
  return request;
}

bool has_own_times(const RecordedRun& run) {
  const auto& path = run.tracking()->config().path;
  return path && path->continuous;
}

json make_sweep(const RecordedRun& run, const std::vector<ShownDesign>& designs,
                PageSimulator& simulator, std::vector<std::string>& notes) {
  if (has_own_times(run)) {
    notes.push_back(
        "The path is gone through at times of its own: there is no sweep over the "
        "speed.");
    return nullptr;
  }
  const auto swept = choose_swept(designs);
  std::vector<std::string> own_speed;
  for (const ShownDesign& design : designs) {
    if (design.named.design.speed_m_per_s && design.named.id != "base") {
      own_speed.push_back(sanitize(design.named.name));
    }
  }
  if (!own_speed.empty()) {
    notes.push_back(
        fmt::format("Designs with a speed of their own move at that, whatever the task's is: the "
                    "sweep over the speed leaves out {}.",
                    join(own_speed, ", ")));
  }
  if (swept.empty()) {
    return nullptr;
  }
  std::vector<NamedDesign> named;
  for (const ShownDesign* design : swept) {
    named.push_back(design->named);
  }
  return make_speed_sweep(simulator, *run.tracking(), make_sweep_request(run, swept), named);
}

}  // namespace

json make_test_errors(const RecordedRun& run, const std::vector<ShownDesign>& designs) {
  if (!run.result || !run.result->winner) {
    return nullptr;
  }
  const RunResult& result = *run.result;
  const double failure_error = get_failure_error(result);
  json list = json::array();
  const auto add = [&](const std::string& name, const std::string& word,
                       const std::vector<double>& errors,
                       const std::vector<TrackingResult>& results) {
    list.push_back({{"name", name},
                    {"errors", finite_or_null(errors)},
                    {"failures", make_failures(run, word, errors, results, failure_error)}});
  };
  const std::vector<TrackingResult> none;
  // Of the winner what was recorded, which is what the run's result stands for.
  const bool has_designs = !designs.empty();
  add("winner", has_designs ? designs.front().word : "", result.test.case_errors,
      has_designs ? designs.front().results : none);
  for (std::size_t i = 1; i < designs.size(); ++i) {
    if (!designs[i].results.empty()) {
      add(designs[i].named.name, designs[i].word, get_case_errors(designs[i].results),
          designs[i].results);
    }
  }
  const TrackingProblem* tracking = run.tracking();
  return {
      {"set", result.test_set},
      {"quantity", make_quantity(result.tracking ? Quantity{"error", "m"} : get_target(result))},
      {"engine", tracking != nullptr ? tracking->config().engines.judging_name : ""},
      {"failure_error", finite_or_null(failure_error)},
      {"designs", std::move(list)}};
}

std::uint64_t count_sweep_cases(const RecordedRun& run, const std::vector<ShownDesign>& designs) {
  const auto swept = choose_swept(designs);
  if (has_own_times(run)) {
    return 0;
  }
  const SweepRequest request = make_sweep_request(run, swept);
  return request.speeds_m_per_s.size() * request.cases * swept.size();
}

json make_arm_evidence(const RecordedRun& run, const std::vector<ShownDesign>& designs,
                       PageSimulator* simulator, std::vector<std::string>& notes) {
  json list = json::array();
  for (const ShownDesign& design : designs) {
    list.push_back(make_design_info(design.named));
  }
  json sweep = nullptr;
  if (simulator != nullptr) {
    sweep = make_sweep(run, designs, *simulator, notes);
  }
  // Of the winner's own speed, if it has one.
  const TrackingProblem& tracking = *run.tracking();
  const TrackingTask task =
      designs.empty() ? tracking.config().task : tracking.make_task(designs.front().named.design);
  return {{"designs", std::move(list)},           {"parameters", make_parameters(run, designs)},
          {"results", make_result_rows(designs)}, {"response", make_response(run, designs)},
          {"signals", make_signals(task, true)},  {"sweep", std::move(sweep)}};
}

}  // namespace armwright
