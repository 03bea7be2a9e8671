#include "cli/views/study_view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "base/text.hpp"
#include "cli/terminal/format.hpp"
#include "cli/terminal/table.hpp"
#include "cli/views/result_view.hpp"
#include "study/analysis/final_check.hpp"
#include "study/analysis/study_tables.hpp"
#include "study/analysis/verdict.hpp"
#include "study/statistics/power.hpp"

namespace armwright {
namespace {

std::string format_value(double value, const Quantity& quantity) {
  return std::isfinite(value) ? format_quantity(value, quantity.unit) : "-";
}

std::string list_labels(const StudyPlan& plan, bool baselines) {
  std::vector<std::string> labels;
  for (const StudyOptimizer& optimizer : plan.optimizers) {
    if (optimizer.baseline == baselines) {
      labels.push_back(optimizer.label);
    }
  }
  return join(labels, ", ");
}

// Returns the value without its unit, for a column that shows the unit already.
std::string format_number(double value, const Quantity& quantity) {
  const std::string text = format_value(value, quantity);
  return text.substr(0, text.find(' '));
}

std::string describe_check(const std::optional<FinalCheck>& check, const Quantity& quantity) {
  if (!check) {
    return "-";
  }
  const std::string value = format_value(check->value, quantity);
  return check->errors.failures == 0
             ? value
             : fmt::format("{}, {} of {} fail", value, check->errors.failures, check->errors.cases);
}

// Returns the comparison with the problem's leader: A12 and p.
std::string describe_against_leader(const ProblemResult& problem, std::size_t optimizer) {
  const std::size_t leader = problem.order.front();
  if (optimizer == leader || problem.pairs.empty()) {
    return "";
  }
  const PairResult& pair = find_pair(problem.pairs, leader, optimizer);
  const double a12 = pair.a == leader ? pair.a12 : 1 - pair.a12;
  const char* mark = pair.is_won_by(leader) ? " *" : pair.is_significant() ? " **" : "";
  return fmt::format("{:.2f}, p {}{}", a12, format_p(pair.p_holm), mark);
}

std::string describe_problem(const StudyPlan& plan, const ProblemResult& problem,
                             const Style& style) {
  const bool has_final = std::ranges::any_of(
      problem.optimizers, [](const OptimizerResult& one) { return one.final_check.has_value(); });
  const bool has_cost = std::isfinite(problem.best_known) && !problem.has_front;
  std::vector<Column> columns = {{"optimizer", false}, {"median"},   {"quartiles"},
                                 {"mean rank"},        {"no value"}, {"A12, p"}};
  const bool has_igd = std::ranges::any_of(
      problem.optimizers, [](const OptimizerResult& one) { return !one.igd_plus.empty(); });
  if (has_igd) {
    columns.push_back({"IGD+"});
  }
  if (problem.margin.optimum) {
    columns.push_back({"success"});
  }
  if (has_cost) {
    columns.push_back({"cases to 1 %"});
  }
  const bool some_fail = std::ranges::any_of(problem.optimizers, [](const OptimizerResult& one) {
    return std::ranges::any_of(one.failure_shares, [](double share) { return share > 0; });
  });
  if (some_fail) {
    columns.push_back({"cases failed"});
  }
  if (has_final) {
    columns.push_back({"best on " + plan.final_engine});
  }
  Table table(columns);
  for (const std::size_t o : problem.order) {
    const OptimizerResult& one = problem.optimizers[o];
    std::vector<std::string> row = {
        plan.optimizers[o].label + (plan.optimizers[o].baseline ? " (baseline)" : ""),
        format_value(one.spread.median, problem.quantity),
        std::isfinite(one.spread.lower_quartile)
            ? format_number(one.spread.lower_quartile, problem.quantity) + " to " +
                  format_number(one.spread.upper_quartile, problem.quantity)
            : "-",
        fmt::format("{:.2f}", one.mean_rank),
        one.infinite == 0 ? "" : fmt::format("{}", one.infinite),
        describe_against_leader(problem, o)};
    if (has_igd) {
      row.push_back(one.igd_plus.empty() ? "-"
                                         : fmt::format("{:.3g}", calc_spread(one.igd_plus).median));
    }
    if (problem.margin.optimum) {
      row.push_back(fmt::format("{}/{}", one.successes, one.values.size()));
    }
    if (has_cost) {
      const double expected = one.running_times[1].expected;
      row.push_back(std::isfinite(expected) ? fmt::format("{:.0f}", expected) : "-");
    }
    if (some_fail) {
      row.push_back(std::isfinite(one.mean_failure_share)
                        ? fmt::format("{:.2g} %", 100 * one.mean_failure_share)
                        : "-");
    }
    if (has_final) {
      row.push_back(describe_check(one.final_check, problem.quantity));
    }
    table.add_row(std::move(row));
  }
  std::string text =
      style.bold(problem.label) +
      fmt::format("  {} on the test set, {} each\n", problem.quantity.name,
                  format_count(static_cast<unsigned long long>(plan.replicates), "run")) +
      table.format(style, 2);
  if (problem.friedman) {
    text += fmt::format("  Friedman test (Iman-Davenport): F = {:.3g}, p {}\n", problem.friedman->f,
                        format_p(problem.friedman->get_p()));
  }
  return text + "\n";
}

std::string format_cases(double cases) {
  return std::isfinite(cases) ? fmt::format("{:.0f}", cases) : "inf";
}

std::string format_ratio(double ratio) {
  return std::isfinite(ratio) ? fmt::format("{:.2g}", ratio) : "inf";
}

std::string describe_targets(const StudyPlan& plan, const StudyProblem& problem,
                             const ProblemResult& result, const Style& style) {
  std::string text;
  for (std::size_t t = 0; t < result.fixed_targets.size(); ++t) {
    std::vector<Column> columns = {
        {"optimizer", false}, {"runs"}, {"kept"}, {"expected cases"}, {"95 %"}};
    if (!plan.reference.empty()) {
      columns.push_back({"times " + plan.reference});
      columns.push_back({"95 %"});
    }
    Table table(columns);
    std::vector<std::size_t> order = result.order;
    std::ranges::stable_sort(
        order, {}, [&](std::size_t o) { return result.optimizers[o].target_times[t].expected; });
    for (const std::size_t o : order) {
      const TargetTime& time = result.optimizers[o].target_times[t];
      const auto format_interval = [](const Interval& interval, auto format) {
        return format(interval.lower) + " to " + format(interval.upper);
      };
      const bool ever = std::isfinite(time.expected);
      std::vector<std::string> row = {
          plan.optimizers[o].label, fmt::format("{}/{}", time.reached, time.trials.size()),
          std::to_string(time.kept), ever ? format_cases(time.expected) : "-",
          ever ? format_interval(time.interval, format_cases) : "-"};
      if (!plan.reference.empty()) {
        const bool compared = time.ratio && time.ratio->ratio;
        row.push_back(compared ? format_ratio(*time.ratio->ratio) : "-");
        row.push_back(compared ? format_interval(time.ratio->interval, format_ratio) : "-");
      }
      table.add_row(std::move(row));
    }
    text += style.bold(result.label) +
            fmt::format("  to the target {}\n",
                        describe_target(problem, plan.targets[result.fixed_targets[t]])) +
            table.format(style, 2) + "\n";
  }
  return text;
}

// Returns the labels of the optimizers without a schedule of their own, by the schedule that they
// get on problems whose schedule is "own".
std::map<std::string, std::vector<std::string>> group_own_schedules(const StudyPlan& plan) {
  std::map<std::string, std::vector<std::string>> groups;
  for (const StudyOptimizer& optimizer : plan.optimizers) {
    if (!optimizer.schedule) {
      groups[to_text(optimizer.own_schedule)].push_back(optimizer.label);
    }
  }
  return groups;
}

std::string describe_ranking(const StudyPlan& plan, const StudyResult& result, const Style& style) {
  Table table({{"optimizer", false}, {"mean rank"}});
  const Ranking& ranking = result.overall.ranking.full;
  for (const std::size_t o : ranking.order) {
    table.add_row({plan.optimizers[o].label, fmt::format("{:.2f}", ranking.mean_ranks[o])});
  }
  return style.bold("Over the problems") + "  ranks of the medians\n" + table.format(style, 2) +
         "\n";
}

// Returns where the best winner of each problem is, with the command that shows it.
std::string describe_best_winners(const StudyPlan& plan, const StudyResult& result,
                                  const std::filesystem::path& folder, const Session& session) {
  std::string text;
  for (std::size_t p = 0; p < plan.problems.size(); ++p) {
    Cell best{.problem = p};
    double best_value = std::numeric_limits<double>::infinity();
    for (const CellOutcome& cell : result.cells) {
      if (cell.problem == plan.problems[p].label && cell.value < best_value) {
        const auto optimizer =
            std::ranges::find(plan.optimizers, cell.optimizer, &StudyOptimizer::label);
        best.optimizer = static_cast<std::size_t>(optimizer - plan.optimizers.begin());
        best.replicate = cell.replicate;
        best_value = cell.value;
      }
    }
    if (std::isfinite(best_value)) {
      const std::string command =
          quote_own_command(session, {"show", (folder / make_cell_path(plan, best)).string()});
      text += fmt::format("Best winner of {}: {}\n", plan.problems[p].label, command);
    }
  }
  return text;
}

}  // namespace

std::string describe_plan(const StudyPlan& plan) {
  Table table({{"", false}, {"", false, true}});
  for (const StudyProblem& problem : plan.problems) {
    const std::vector<std::string> chosen = list_chosen_settings(problem);
    const std::string settings = chosen.empty() ? "" : " (" + join(chosen, ", ") + ")";
    table.add_row(
        {"problem",
         fmt::format("{}: schedule {}, {}{}", problem.label, describe_schedule(problem),
                     format_count(static_cast<unsigned long long>(problem.loaded.sets.test_cases),
                                  "test case"),
                     settings)});
  }
  table.add_row({"optimizers", list_labels(plan, false)});
  for (const StudyOptimizer& optimizer : plan.optimizers) {
    if (!optimizer.row.input_hashes.empty() && optimizer.label != optimizer.name) {
      table.add_row({"plugin", fmt::format("{}: {}", optimizer.label, optimizer.name)});
    }
  }
  if (std::ranges::any_of(plan.problems, &StudyProblem::own_schedules)) {
    for (const auto& [schedule, labels] : group_own_schedules(plan)) {
      table.add_row({"schedule " + schedule, join(labels, ", ")});
    }
  }
  for (const StudyOptimizer& optimizer : plan.optimizers) {
    std::vector<std::string> own = optimizer.settings;
    if (optimizer.schedule) {
      own.insert(own.begin(), "schedule " + to_text(*optimizer.schedule));
    }
    if (!own.empty()) {
      table.add_row({"method", fmt::format("{}: {}", optimizer.label, join(own, ", "))});
    }
  }
  for (const StudyTarget& target : plan.targets) {
    for (const std::string& label : target.problems) {
      const auto problem = std::ranges::find(plan.problems, label, &StudyProblem::label);
      table.add_row({"target", fmt::format("{} on {}", describe_target(*problem, target), label)});
    }
  }
  if (!plan.reference.empty()) {
    table.add_row({"reference", plan.reference});
  }
  const std::string baselines = list_labels(plan, true);
  if (!baselines.empty()) {
    table.add_row({"baselines", baselines});
  } else if (!plan.baselines) {
    table.add_row({"baselines", "left out on request"});
  }
  table.add_row(
      {"each",
       fmt::format("{}, budget {}",
                   format_count(static_cast<unsigned long long>(plan.replicates), "replicate"),
                   format_count(static_cast<unsigned long long>(plan.budget), "simulated case"))});
  table.add_row({"paired", fmt::format("start and training cases of a replicate are the same for "
                                       "all optimizers; study seed {}",
                                       plan.seed)});
  return table.format(Style(false), 0, get_text_width(Stream::error));
}

std::string describe_power(const StudyPlan& plan) {
  const std::size_t optimizers = plan.optimizers.size();
  if (optimizers < 2) {
    return "";
  }
  const std::size_t tests = optimizers * (optimizers - 1) / 2;
  const std::string design = fmt::format("{} replicates and {} {} of optimizers per problem",
                                         plan.replicates, tests, tests == 1 ? "pair" : "pairs");
  const int needed = find_needed_pairs(kMediumA12, tests);
  if (!can_be_significant(plan.replicates, tests)) {
    return fmt::format(
        "warning: with {} no difference, however clear, is significant after Holm's correction.\n"
        "{} replicates are the fewest that can decide a pair; {} find a medium difference (A12 = "
        "{:.2f}) with probability {:.1f}.\n",
        design, find_fewest_pairs(tests), needed, kMediumA12, kPower);
  }
  return fmt::format(
      "With {}, a difference from A12 = {:.2f} on is found with probability {:.1f}, after Holm's "
      "correction.\nA medium difference (A12 = {:.2f}) is found with probability {:.2f}; {} "
      "replicates find it with probability {:.1f}.\n",
      design, find_detectable_a12(plan.replicates, tests), kPower, kMediumA12,
      calc_power(plan.replicates, kMediumA12, tests), needed, kPower);
}

std::string describe_cost(const StudyPlan& plan, double expected_s, unsigned jobs) {
  const StudyCost cost = calc_cost(plan);
  std::string text = fmt::format(
      "{} cells; at most {} simulated cases: training {}, validation {}, test {}\n", cost.cells,
      cost.training + cost.validation + cost.test, cost.training, cost.validation, cost.test);
  if (expected_s > 0) {
    text += fmt::format(
        "about {} with --jobs {} (measured on a few simulations; optimizers with much "
        "computation of their own take longer)\n",
        format_duration(expected_s), jobs);
  }
  return text;
}

std::string describe_study(const StudyPlan& plan, const StudyResult& result,
                           const std::filesystem::path& folder, const Session& session) {
  const Style style = make_style(Stream::out, session.color);
  std::string text;
  for (std::size_t p = 0; p < result.problems.size(); ++p) {
    text += describe_problem(plan, result.problems[p], style);
    text += describe_targets(plan, plan.problems[p], result.problems[p], style);
  }
  if (plan.problems.size() > 1) {
    text += describe_ranking(plan, result, style);
  }
  text += style.bold("Verdict") + "\n";
  for (const std::string& sentence : describe_verdict(plan, result)) {
    for (const std::string& line : wrap_words(sentence, get_text_width(Stream::out) - 2)) {
      text += "  " + line + "\n";
    }
  }
  const bool has_arm = std::ranges::any_of(
      plan.problems, [](const StudyProblem& one) { return one.loaded.tracking() != nullptr; });
  return text +
         fmt::format(
             "\nA12: share of the pairs of runs in which the first optimizer of the table is "
             "better "
             "than this one.\np: p-value of the paired difference (Wilcoxon, after Holm); * below "
             "{}; ** below it, and this one is\nbetter than the first. Success: runs within the "
             "problem's resolution of the optimum. Cases to 1 %: expected\nnumber, with restarts, "
             "until 1 % of the way from the start to the best known value is left. Cases\nfailed: "
             "mean share of test cases {}.\nTables: {}\n",
             kSignificance, has_arm ? "with an error above 100 mm" : "without a number",
             sanitize((folder / "tables").string())) +
         describe_best_winners(plan, result, folder, session);
}

int end_study(const StudyPlan& plan, const std::filesystem::path& folder, unsigned jobs,
              bool as_json, Session& session, ProgressBar& bar) {
  StudyResult result = analyze_study(plan, folder);
  if (!add_final_checks(plan, folder, jobs, session.stop, bar, result)) {
    bar.clear();
    return end_stopped(session, session.command_line);
  }
  bar.clear();
  write_study_tables(plan, result, folder);
  if (as_json) {
    write_stdout(to_json(plan, result));
  } else {
    write_stdout(describe_study(plan, result, folder, session) +
                 describe_reading(folder, session, make_style(Stream::out, session.color)));
  }
  const bool failed = std::ranges::any_of(
      result.cells, [](const CellOutcome& cell) { return !cell.failure.empty(); });
  return failed || !result.missing.empty() ? exit_code::kFailed : exit_code::kDone;
}

}  // namespace armwright
