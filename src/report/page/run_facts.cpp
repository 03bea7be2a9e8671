// Makes the parts of a run's page that state facts: setting, counts, result and requirements.

#include <fmt/format.h>

#include <algorithm>

#include "base/text.hpp"
#include "problems/tracking/requirement_grade.hpp"
#include "report/evidence/page_json.hpp"
#include "report/page/run_parts.hpp"
#include "study/run/json_values.hpp"
#include "study/run/run.hpp"
#include "study/run/run_times.hpp"

namespace armwright {
namespace {

using nlohmann::json;

// Lengths of an arm are shown in millimetres. A problem without an arm keeps its own unit.
std::string format_value(double value, const std::string& unit, bool has_arm) {
  if (unit == "m" && has_arm) {
    return describe_number(1000 * value, "mm");
  }
  return describe_number(value, unit == "1" ? "" : unit, 6);
}

class Facts {
 public:
  explicit Facts(bool has_arm) : has_arm_(has_arm) {}
  void add(const std::string& label, const std::string& value) {
    if (!value.empty()) {
      list_.push_back(make_fact(label, value));
    }
  }
  void add(const std::string& label, const std::optional<double>& value, const std::string& unit) {
    add(label, value ? format_value(*value, unit, has_arm_) : "");
  }
  json take() { return std::move(list_); }

 private:
  bool has_arm_ = false;
  json list_ = json::array();
};

std::string describe_options(const json& options) {
  std::vector<std::string> all;
  for (const auto& [name, value] : options.items()) {
    all.push_back(
        fmt::format("{}={}", name, value.is_string() ? value.get<std::string>() : value.dump()));
  }
  return join(all, ", ");
}

void add_setting(const RecordedRun& run, Facts& facts) {
  const json& settings = run.configuration.at("run");
  facts.add("Problem", run.problem_name);
  if (run.problem) {
    facts.add("Title", run.problem->title);
    facts.add("Variables", fmt::format("{}", run.describe().variables.size()));
  }
  for (const Quantity& objective : run.describe().objectives) {
    facts.add("Objective", objective.unit.empty() || objective.unit == "1"
                               ? objective.name
                               : fmt::format("{} [{}]", objective.name, objective.unit));
  }
  for (const Limit& limit : run.describe().limits) {
    facts.add("Limit", fmt::format("{} at most {}", limit.quantity.name,
                                   format_value(limit.value, limit.quantity.unit, run.has_arm())));
  }
  facts.add("Optimizer", settings.at("optimizer").get<std::string>());
  facts.add("Options", describe_options(settings.at("options")));
  facts.add("Seed", fmt::format("{}", settings.at("seed").get<std::uint64_t>()));
  facts.add("Schedule", to_text(run.schedule));
  facts.add("Racing", settings.value("racing", ""));
  if (const TrackingProblem* tracking = run.tracking()) {
    const EnginePair& engines = tracking->config().engines;
    facts.add("Engine", engines.training_name == engines.judging_name
                            ? engines.judging_name
                            : fmt::format("{} in training, {} in judging", engines.training_name,
                                          engines.judging_name));
    const Perturbation& plants = tracking->config().perturbation;
    facts.add("Plants in training", describe_plants(plants, CaseRole::training));
    facts.add("Plants in judging", describe_plants(plants, CaseRole::test));
  }
}

void add_counts(const RecordedRun& run, Facts& facts) {
  std::uint64_t cases = 0;
  std::uint64_t clipped = 0;
  std::uint64_t lost = 0;
  std::uint64_t failed = 0;
  for (const EvaluationRecord& record : run.journal.training) {
    cases += record.calc_charge();
    clipped += record.clipped ? 1 : 0;
    lost += record.evaluation.status == EvaluationStatus::abandoned ? 1 : 0;
    failed += record.evaluation.objectives.empty() ? 1 : 0;
  }
  facts.add("Budget", fmt::format("{} of {} cases", cases, run.budget));
  facts.add("Evaluations", fmt::format("{}", run.journal.training.size()));
  facts.add("Clipped to the bounds", fmt::format("{}", clipped));
  facts.add("Dropped in races", lost > 0 ? fmt::format("{}", lost) : "");
  facts.add("Evaluations without a number", fmt::format("{}", failed));
}

// Returns the winner's efforts. Results of version 1.0 do not tell sliding joints from turning ones.
EffortTotals find_efforts(const RecordedRun& run) {
  const TrackingProblem* const arm = run.tracking();
  return arm == nullptr
             ? get_effort_totals(*run.result)
             : calc_effort_totals(arm->make_design(run.find_best()), arm->config().robot);
}

// Returns the name of an arm's result. It does not depend on what was measured beside it, so runs of
// all versions can be compared.
std::string name_error(const RecordedRun& run) {
  const TrackingProblem* const arm = run.tracking();
  const bool never_rests = arm != nullptr && arm->config().never_rests();
  return never_rests ? "mean error" : "mean error at rest";
}

void add_result(const RecordedRun& run, Facts& facts) {
  const RunResult& result = *run.result;
  facts.add("End", result.end_reason);
  facts.add("Chosen optimizer", result.choice);
  facts.add("Why the optimizer ended", result.end_detail);
  facts.add("Unused evaluations",
            result.unused_evaluations > 0 ? fmt::format("{}", result.unused_evaluations) : "");
  facts.add("Failure of the optimizer", result.failure);
  facts.add("Designs judged on the validation set", fmt::format("{}", result.judged.size()));
  if (!result.winner) {
    return;
  }
  const ErrorSummary& summary = result.test_summary;
  if (result.tracking) {
    facts.add("Test set", fmt::format("{}, {} cases", result.test_set, summary.cases));
    facts.add("M" + name_error(run).substr(1), summary.mean, "m");
    if (const auto& motion = result.test_motion) {
      facts.add("Error while moving, RMS", motion->moving_rms_m, "m");
      facts.add("Error while moving, peak", motion->moving_peak_m, "m");
      facts.add("Error after start-up, largest", motion->start_up_m, "m");
    }
    facts.add("Published mean error", result.published.error_m, "m");
    facts.add("Published winner, not comparable", result.published.difference);
    facts.add("Median error", summary.median, "m");
    facts.add("95th percentile", summary.percentile_95, "m");
    facts.add("Worst error", summary.worst, "m");
    facts.add("Failures", fmt::format("{}", summary.failures));
    const EffortTotals efforts = find_efforts(run);
    facts.add("Total torque", efforts.torque_n_m, "N m");
    facts.add("Total force", efforts.force_n, "N");
    facts.add("Published total torque", result.published.total_torque_n_m, "N m");
  }
  if (!result.test.objectives.empty()) {
    const Quantity target = get_target(result);
    facts.add(fmt::format("Result: {}", target.name), calc_target(result, result.test),
              target.unit);
  }
  if (!result.constraints.empty()) {
    facts.add("Feasible", is_proven_feasible(result.test) ? "yes" : "no");
  }
}

}  // namespace

json make_run_facts(const RecordedRun& run) {
  Facts facts(run.has_arm());
  add_setting(run, facts);
  add_counts(run, facts);
  if (run.result) {
    add_result(run, facts);
  }
  for (const auto& [key, label] : {std::pair{"version", "Version"}, std::pair{"git", "Commit"},
                                   std::pair{"compiler", "Compiler"}, std::pair{"cpu", "CPU"}}) {
    const auto found = run.build.find(key);
    facts.add(label, found == run.build.end() ? "" : found->second);
  }
  return facts.take();
}

json make_headline(const RecordedRun& run, const History& history) {
  const auto times = find_times(run.folder);
  const std::int64_t cases = history.parts.empty() ? 0 : history.parts.back().cases;
  json headline = {{"faults", run.result ? list_faults(*run.result) : std::vector<std::string>()},
                   {"started", run.started},
                   {"evaluations", run.journal.training.size()},
                   {"cases", cases},
                   {"value", nullptr},
                   {"quantity", nullptr},
                   {"failures", nullptr},
                   {"test_cases", nullptr},
                   {"total_torque_n_m", nullptr},
                   {"total_force_n", nullptr},
                   {"motion", nullptr},
                   {"times", nullptr}};
  if (times) {
    headline["times"] = {{"wall_s", times->wall_s},
                         {"cpu_s", optional_to_json(times->cpu_s)},
                         {"lives", times->lives}};
  }
  if (!run.result || !run.result->winner) {
    return headline;
  }
  const RunResult& result = *run.result;
  if (result.tracking) {
    headline["quantity"] = make_quantity({name_error(run), "m"});
    if (result.test_motion) {
      headline["motion"] = motion_to_json(*result.test_motion);
    }
    headline["value"] = finite_or_null(result.test_summary.mean);
    headline["failures"] = result.test_summary.failures;
    headline["test_cases"] = result.test_summary.cases;
    const EffortTotals efforts = find_efforts(run);
    headline["total_torque_n_m"] = finite_or_null(efforts.torque_n_m);
    headline["total_force_n"] = finite_or_null(efforts.force_n);
  } else if (!result.test.objectives.empty()) {
    headline["quantity"] = run.make_quantity(get_target(result));
    headline["value"] = finite_or_null(calc_target(result, result.test));
  }
  return headline;
}

json make_requirements(const RecordedRun& run) {
  json list = json::array();
  if (!run.result || !run.result->winner) {
    return list;
  }
  for (const JudgedRequirement& judged :
       judge_requirements(run.result->requirements, run.result->test)) {
    const RequiredMetric& requirement = judged.requirement;
    list.push_back({{"quantity", run.make_quantity(requirement.limit.quantity)},
                    {"limit", requirement.limit.value},
                    {"value", judged.value ? finite_or_null(*judged.value) : json(nullptr)},
                    {"grade", to_string(judged.grade)},
                    {"binds", judged.binds},
                    {"is_constraint", requirement.is_constraint}});
  }
  return list;
}

}  // namespace armwright
