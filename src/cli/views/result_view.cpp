#include "cli/views/result_view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/folder.hpp"
#include "base/folder_checksums.hpp"
#include "base/text.hpp"
#include "cli/terminal/format.hpp"
#include "cli/terminal/session.hpp"
#include "cli/views/requirement_view.hpp"
#include "cli/views/verification.hpp"
#include "problems/config/values_file.hpp"
#include "sim/tracking/designed_arm.hpp"

namespace armwright {
namespace {

struct RunFile {
  const char* name;
  const char* what;
};
constexpr RunFile kRunFiles[] = {
    {"winner.toml", "the winner, for evaluate"},
    {"winner-record.csv", "signals of the winner on the first test case"},
    {"winner-trajectory.csv", "the winner's trajectory on the first test case"},
    {"front.csv", "the designs on the front, with their results on the validation set"},
    {"result.json", "all numbers of this result"},
    {"check.json", "the winner under other conditions"},
    {"convergence.csv", "the best value over the evaluations"},
    {"results.sqlite", "every evaluation, as SQL tables"},
    {"journal", "every evaluation; resuming reads it"},
    {"optimizer.log", "the output of the optimizer"},
    {"times.json", "how long the run took"},
    {"manifest.json", "the configuration, the hashes of the inputs and the build"},
};

std::optional<double> get_metric(const RunResult& result, const std::string& name) {
  const auto found = std::find(result.metric_names.begin(), result.metric_names.end(), name);
  const auto at = static_cast<std::size_t>(found - result.metric_names.begin());
  return at < result.test.metrics.size() ? std::optional(result.test.metrics[at]) : std::nullopt;
}

// Returns whether it is a robot problem, which has errors in metres. A function has only its value.
bool is_tracking(const RunResult& result) {
  return std::find(result.metric_names.begin(), result.metric_names.end(), "total_torque") !=
         result.metric_names.end();
}

// Returns the value of the variable with this index: a whole number, a word, or six digits.
std::string format_variable(const RunResult& result, std::size_t variable, double value) {
  const DecisionVariable* const discrete = find_discrete(result, variable);
  return discrete ? sanitize(format_value(*discrete, value)) : format_significant(value, 6);
}

std::string format_vector(const RunResult& result, const std::vector<double>& x,
                          const Style& style) {
  Table table({{"variable", false}, {"value"}});
  for (std::size_t i = 0; i < x.size(); ++i) {
    table.add_row({sanitize(result.variable_names.at(i)), format_variable(result, i, x[i])});
  }
  return table.format(style, 2);
}

std::string format_values(const RunResult& result, const std::vector<double>& x,
                          const ValuesFile& file, const Style& style) {
  Table table({{"", false}, {""}, {"", false}});
  for (std::size_t i = 0; i < std::min(x.size(), file.variables.size()); ++i) {
    const Quantity& quantity = file.variables[i].quantity;
    table.add_row(
        {sanitize(quantity.name), format_variable(result, i, x[i]), sanitize(quantity.unit)});
  }
  return table.format(style, 2);
}

std::string format_winner(const RunResult& result, const std::filesystem::path& folder,
                          const Style& style) {
  const Candidate& winner = result.judged[*result.winner].candidate;
  std::string origin = winner.recommended ? std::string("recommended by the optimizer")
                                          : fmt::format("evaluation {}", winner.evaluation);
  if (winner.generation > 0) {
    origin += fmt::format(", generation {}", winner.generation);
  }
  const std::string title =
      style.bold("Winner") + fmt::format(" ({}; the best of {} judged on the validation set)\n",
                                         origin, format_count(result.judged.size(), "design"));
  const auto file = folder / "winner.toml";
  if (!path_exists(file)) {
    return title + format_vector(result, winner.x, style);
  }
  FolderChecksums(folder).check("winner.toml");
  if (!result.tracking) {
    return title + format_values(result, winner.x, load_values(file), style);
  }
  return title + format_design(load_design(file.string()), style);
}

void add_target(const RunResult& result, Table& table) {
  const Quantity target = get_target(result);
  table.add_row(
      {sanitize(target.name), format_quantity(calc_target(result, result.test), target.unit)});
}

std::string format_tracking_test(const RunResult& result, const Style& style) {
  Table table = make_summary_table(result.test_summary, result.test_motion);
  add_efforts(get_effort_totals(result), table);
  if (const auto energy = get_metric(result, "energy")) {
    table.add_row({"mean energy", format_quantity(*energy, "J")});
  }
  const Quantity target = get_target(result);
  const bool is_torque = target.name == "total torque";
  if (is_torque && result.sliding_efforts.force_n) {
    // The objective adds the efforts of all joints, in N m and N.
    table.add_row({"sum of both", format_quantity(calc_target(result, result.test), "1")});
  } else if (target.unit != "m" && !is_torque && !result.test.objectives.empty()) {
    add_target(result, table);
  }
  return style.bold(fmt::format("On the test set {}", sanitize(result.test_set))) + "\n" +
         table.format(style, 2);
}

std::string format_function_test(const RunResult& result, const Style& style) {
  Table table({{"", false}, {"", false}});
  if (!result.test.objectives.empty()) {
    add_target(result, table);
  }
  return table.format(style, 2);
}

// Returns the value of a constraint: the limited quantity if the constraint is a limit, otherwise
// g.
std::string format_constraint(const RunResult& result, std::size_t i, double g) {
  if (result.limits.empty()) {
    return format_quantity(g, result.constraints[i].unit) + (g > 0 ? " (violated)" : " (met)");
  }
  const Limit& limit = result.limits[i];
  return fmt::format("{} ({} % {})", format_quantity((1 + g) * limit.value, limit.quantity.unit),
                     format_significant(100 * std::abs(g), 3), g > 0 ? "above" : "below");
}

std::string describe_feasibility(const Evaluation& evaluation) {
  if (is_proven_feasible(evaluation)) {
    return "feasible";
  }
  return evaluation.failed_cases > 0
             ? fmt::format(
                   "not shown: {} without a number",
                   format_count(static_cast<unsigned long long>(evaluation.failed_cases), "case"))
             : "NOT feasible";
}

std::string format_constraints(const RunResult& result, const Style& style) {
  const Evaluation& validation = result.judged[*result.winner].validation;
  Table table({{"", false}, {"at most"}, {"on the validation set"}, {"on the test set"}});
  for (std::size_t i = 0; i < result.constraints.size(); ++i) {
    const auto value = [&](const Evaluation& evaluation) {
      return evaluation.constraint_values.empty()
                 ? std::string("-")
                 : format_constraint(result, i, evaluation.constraint_values.at(i));
    };
    const bool has_limit = !result.limits.empty();
    table.add_row(
        {sanitize(has_limit ? result.limits[i].quantity.name : result.constraints[i].name),
         has_limit ? format_quantity(result.limits[i].value, result.limits[i].quantity.unit) : "0",
         value(validation), value(result.test)});
  }
  table.add_row({"all", "", describe_feasibility(validation), describe_feasibility(result.test)});
  return style.bold("Constraints") + "\n" + table.format(style, 2);
}

// The requirements judged on the test set.
std::string format_winner_requirements(const RunResult& result, const Style& style) {
  std::vector<ShownRequirement> shown;
  for (JudgedRequirement& judged : judge_requirements(result.requirements, result.test)) {
    shown.push_back({.judged = std::move(judged)});
  }
  return format_requirements(shown, style);
}

std::string format_published(const RunResult& result, const Style& style) {
  const PublishedWinner& published = result.published;
  Table table({{"", false}, {"published"}, {"ours"}, {"ratio"}});
  const auto add = [&](const char* name, std::optional<double> theirs, std::optional<double> ours,
                       const char* unit) {
    if (theirs) {
      table.add_row({name, format_quantity(*theirs, unit),
                     ours ? format_quantity(*ours, unit) : "-",
                     ours ? format_significant(*ours / *theirs, 3) : "-"});
    }
  };
  add("mean error", published.error_m, result.test_summary.mean, "m");
  add("total torque", published.total_torque_n_m, get_metric(result, "total_torque"), "N m");
  return style.bold("Beside the published winner") +
         (published.where.empty() ? "" : fmt::format(" ({})", sanitize(published.where))) + "\n" +
         table.format(style, 2);
}

}  // namespace

std::string format_design(const DesignFile& design, const Style& style) {
  const ControllerRow& controller = find_controller(design.design.controller);
  std::vector<Column> columns = {{"joint", false}};
  for (const controllers::Gain& gain : controller.gains) {
    columns.push_back({fmt::format("{} [{}]", gain.name, gain.unit)});
  }
  columns.push_back({"min [N m]"});
  columns.push_back({"max [N m]"});
  const bool stretched = is_stretched(design.design);
  if (stretched) {
    columns.push_back({"length"});
    columns.push_back({"section"});
  }
  const bool tubes = has_tubes(design.design);
  if (tubes) {
    columns.push_back({"diameter [m]"});
    columns.push_back({"wall [m]"});
  }
  Table table(std::move(columns));
  for (std::size_t i = 0; i < design.design.joints.size(); ++i) {
    const JointDrive& joint = design.design.joints[i];
    std::vector<std::string> cells = {sanitize(design.joint_names.at(i))};
    for (const double gain : joint.gains) {
      cells.push_back(format_significant(gain, 6));
    }
    cells.push_back(format_significant(joint.limits.min, 6));
    cells.push_back(format_significant(joint.limits.max, 6));
    if (stretched) {
      cells.push_back(format_significant(joint.length_scale, 4));
      cells.push_back(format_significant(joint.section_scale, 4));
    }
    if (tubes) {
      cells.push_back(format_significant(joint.tube.diameter_m, 4));
      cells.push_back(format_significant(joint.tube.wall_m, 4));
    }
    table.add_row(std::move(cells));
  }
  std::string text = table.format(style, 2);
  if (design.design.speed_m_per_s) {
    text += fmt::format("  speed {} m/s\n", format_significant(*design.design.speed_m_per_s, 4));
  }
  return text;
}

std::string describe_unused(const RunResult& result) {
  const auto unused = static_cast<unsigned long long>(result.unused_evaluations);
  return fmt::format("the optimizer left {} of the budget unused{}",
                     format_count(unused, "evaluation"),
                     result.end_detail.empty() ? "" : ": " + sanitize(result.end_detail));
}

std::string describe_no_winner(const RunResult& result) {
  if (result.counts.evaluations == 0) {
    return "The run ended before its first evaluation, so there is no winner. Either the budget "
           "does "
           "not pay for one design on all cases of the schedule, or the optimizer asked for none.";
  }
  if (result.counts.feasible == 0 && !result.first_failure.empty()) {
    const bool is_too_far = result.first_failure.find("out of reach") != std::string::npos;
    return "No design worked, so there is no winner. The first failed with: " +
           sanitize(result.first_failure) +
           (is_too_far ? ". Make workspace.radius_m smaller, or move workspace.centre_m towards "
                         "the arm"
                       : "");
  }
  if (result.counts.feasible > 0) {
    return "None of the designs that were good in training has a number on the validation set, so "
           "there is no winner.";
  }
  std::string nearest;
  if (result.least_violation && result.limits.size() == 1) {
    const Limit& limit = result.limits.front();
    nearest = fmt::format(
        " The nearest had {} {}, but only {} is allowed.", sanitize(limit.quantity.name),
        format_quantity((1 + *result.least_violation) * limit.value, limit.quantity.unit),
        format_quantity(limit.value, limit.quantity.unit));
  } else if (result.least_violation) {
    nearest = fmt::format(" The nearest violated them by {} in sum.",
                          format_significant(*result.least_violation));
  }
  return "No design met the constraints, so there is no winner." + nearest;
}

std::string describe_result(const RunResult& result, const std::filesystem::path& folder,
                            const Style& style) {
  const RunCounts& counts = result.counts;
  std::string text =
      style.bold(fmt::format("{}: {}, seed {}", sanitize(result.problem),
                             sanitize(shorten_optimizer(result.optimizer)), result.seed));
  text += fmt::format("\n  {} on {}", format_count(counts.evaluations, "evaluation"),
                      format_count(counts.cases, "case"));
  if (counts.generations > 0) {
    text += fmt::format(", {}", format_count(counts.generations, "generation"));
  }
  if (counts.abandoned > 0) {
    text += fmt::format(", {} of them abandoned by racing", counts.abandoned);
  }
  text += fmt::format("; {} failed, {} clipped to the bounds; ended by: {}\n", counts.failed,
                      counts.clipped, sanitize(result.end_reason));
  if (result.unused_evaluations > 0) {
    text += fmt::format("  {}\n", describe_unused(result));
  }
  if (!result.choice.empty()) {
    for (const std::string& line :
         wrap_words(sanitize(result.choice), get_text_width(Stream::out) - 2)) {
      text += fmt::format("  {}\n", line);
    }
  }
  text += "\n";
  if (!result.failure.empty()) {
    text += style.red("The optimizer failed: " + sanitize(result.failure)) +
            "\nIts evaluations until then are kept and judged. The same command tries again from "
            "there.\n\n";
  }
  if (!result.winner) {
    text += style.red(describe_no_winner(result)) + "\n\n";
  } else {
    text += format_winner(result, folder, style) + "\n";
    for (const std::string& fault : list_faults(result)) {
      text += style.red("Do not use this design: " + fault + ".") + "\n";
    }
    text += is_tracking(result) ? format_tracking_test(result, style)
                                : format_function_test(result, style);
    text += "\n";
    if (!result.requirements.empty()) {
      text += format_winner_requirements(result, style) + "\n";
    }
    if (!result.constraints.empty()) {
      text += format_constraints(result, style) + "\n";
    }
    if (result.published.error_m || result.published.total_torque_n_m) {
      text += format_published(result, style) + "\n";
    } else if (!result.published.difference.empty()) {
      text += fmt::format("The published winner ({}) cannot be compared: {}.\n\n",
                          sanitize(result.published.where), sanitize(result.published.difference));
    }
    if (result.tracking) {
      text += describe_check(load_check(folder), style) + "\n";
    }
  }
  Table files({{"", false}, {"", false}});
  for (const RunFile& file : kRunFiles) {
    if (path_exists(folder / file.name)) {
      files.add_row({file.name, file.what});
    }
  }
  return text + style.bold("Files in " + sanitize(folder.string())) + "\n" + files.format(style, 2);
}

std::string make_result_json(const RunResult& result, const std::filesystem::path& folder) {
  const auto check = result.winner ? load_check(folder) : std::nullopt;
  if (!check) {
    return to_json(result);
  }
  nlohmann::json j = nlohmann::json::parse(to_json(result));
  j["winner"]["check"] = nlohmann::json::parse(to_json(*check));
  return j.dump(1) + "\n";
}

std::string describe_judged(const RunResult& result, const Style& style) {
  std::vector<Column> columns = {{"", false},  {"evaluation"}, {"generation"},
                                 {"training"}, {"validation"}, {"failures"}};
  if (!result.constraints.empty()) {
    columns.push_back({"constraints", false});
  }
  Table table(std::move(columns));
  for (std::size_t i = 0; i < result.judged.size(); ++i) {
    const Candidate& candidate = result.judged[i].candidate;
    const Evaluation& validation = result.judged[i].validation;
    const auto value = [&](double objective) {
      return format_quantity(objective, get_target(result).unit);
    };
    std::vector<std::string> cells = {
        result.winner == i ? "winner" : "",
        candidate.recommended ? "recommended" : fmt::format("{}", candidate.evaluation),
        candidate.generation > 0 ? fmt::format("{}", candidate.generation) : "-",
        candidate.recommended ? "-" : value(candidate.training_objective),
        validation.objectives.empty() ? "-" : value(calc_target(result, validation)),
        fmt::format("{} of {}",
                    summarize(validation.case_errors, get_failure_error(result)).failures +
                        result.judged[i].further_failures,
                    validation.case_errors.size() + result.judged[i].further_cases)};
    if (!result.constraints.empty()) {
      cells.push_back(describe_feasibility(validation));
    }
    table.add_row(std::move(cells));
  }
  return style.bold("Judged on the validation set") + "\n" + table.format(style, 2);
}

std::string describe_reading(const std::filesystem::path& folder, const Session& session,
                             const Style& style) {
  return fmt::format("\n{}\n  {}\n  {}\n", style.bold("Next"),
                     quote_own_command(session, {"report", folder.string()}),
                     quote_own_command(session, {"show", folder.string()}));
}

Table make_summary_table(const ErrorSummary& summary, const std::optional<MotionSummary>& motion) {
  const auto mm = [](std::optional<double> error_m) {
    return error_m ? format_mm(error_m) + " mm" : "-";
  };
  Table table({{"", false}, {"", false}});
  // On a continuous path the target does not rest.
  const bool rests = motion && motion->start_up_m;
  table.add_row({rests ? "mean error at rest" : "mean error", mm(summary.mean)});
  table.add_row({"median", mm(summary.median)});
  table.add_row({"95 % below", mm(summary.percentile_95)});
  table.add_row({"worst", mm(summary.worst)});
  table.add_row({"failures", fmt::format("{} of {} ({} without a number)", summary.failures,
                                         summary.cases, summary.without_number)});
  if (motion) {
    table.add_row({"error while moving", fmt::format("RMS {}, peak {}", mm(motion->moving_rms_m),
                                                     mm(motion->moving_peak_m))});
  }
  if (rests) {
    table.add_row({"error after start-up", "up to " + mm(motion->start_up_m)});
  }
  return table;
}

void add_efforts(const EffortTotals& efforts, Table& table) {
  if (efforts.torque_n_m) {
    table.add_row({"total torque", format_quantity(*efforts.torque_n_m, "N m")});
  }
  if (efforts.force_n) {
    table.add_row({"total force", format_quantity(*efforts.force_n, "N")});
  }
}

int get_result_code(const RunResult& result) {
  const bool good = result.failure.empty() && result.winner && list_faults(result).empty();
  return good ? exit_code::kDone : exit_code::kFailed;
}

}  // namespace armwright
