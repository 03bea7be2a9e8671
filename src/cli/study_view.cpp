#include "cli/study_view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/text.hpp"
#include "cli/format.hpp"
#include "cli/table.hpp"
#include "study/compare/verdict.hpp"

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

// The same without its unit, for a column where that stands already.
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

// The comparison with the problem's leader in a few characters.
std::string describe_against_leader(const ProblemResult& problem, std::size_t optimizer) {
  const std::size_t leader = problem.order.front();
  if (optimizer == leader) {
    return "";
  }
  const auto pair = std::ranges::find_if(problem.pairs, [&](const PairResult& one) {
    return std::minmax(one.a, one.b) == std::minmax(leader, optimizer);
  });
  const double a12 = pair->a == leader ? pair->a12 : 1 - pair->a12;
  return fmt::format("{:.2f}, p {}{}", a12, format_p(pair->p_holm),
                     pair->is_beaten_by(leader) ? " *" : "");
}

std::string describe_problem(const StudyPlan& plan, const ProblemResult& problem,
                             const Style& style) {
  const bool has_final = std::ranges::any_of(
      problem.optimizers, [](const OptimizerResult& one) { return one.final_check.has_value(); });
  const bool has_cost = std::isfinite(problem.best_known) && !problem.has_front;
  std::vector<Column> columns = {{"optimizer", false}, {"median"},   {"quartiles"},
                                 {"mean rank"},        {"no value"}, {"A12, p"}};
  if (has_cost) {
    columns.push_back({"cases to 1 %"});
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
    if (has_cost) {
      const double expected = one.running_times[1].expected;
      row.push_back(std::isfinite(expected) ? fmt::format("{:.0f}", expected) : "-");
    }
    if (has_final) {
      row.push_back(describe_check(one.final_check, problem.quantity));
    }
    table.add_row(std::move(row));
  }
  std::string text =
      style.bold(problem.label) +
      fmt::format("  {} on the test set, {} runs each\n", problem.quantity.name, plan.replicates) +
      table.format(style, 2);
  if (problem.friedman) {
    text += fmt::format("  Friedman test (Iman-Davenport): F = {:.3g}, p {}\n", problem.friedman->f,
                        format_p(problem.friedman->f_p_value));
  }
  return text + "\n";
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

}  // namespace

std::string describe_plan(const StudyPlan& plan) {
  Table table({{"", false}, {"", false, true}});
  for (const StudyProblem& problem : plan.problems) {
    const std::string settings =
        problem.settings.empty() ? "" : " (" + join(problem.settings, ", ") + ")";
    table.add_row({"problem", fmt::format("{}: schedule {}, {} test cases{}", problem.label,
                                          to_text(problem.schedule), problem.loaded.sets.test_cases,
                                          settings)});
  }
  table.add_row({"optimizers", list_labels(plan, false)});
  const std::string baselines = list_labels(plan, true);
  if (!baselines.empty()) {
    table.add_row({"baselines", baselines});
  } else if (!plan.baselines) {
    table.add_row({"baselines", "left out on request"});
  }
  table.add_row({"each", fmt::format("{} replicates, budget {} simulated cases", plan.replicates,
                                     plan.budget)});
  table.add_row({"paired", fmt::format("start and training cases of a replicate are the same for "
                                       "all optimizers; study seed {}",
                                       plan.seed)});
  return table.format(Style(false), 0, get_text_width(Stream::error));
}

std::string describe_cost(const StudyPlan& plan, double expected_s, unsigned jobs) {
  const StudyCost cost = calc_cost(plan);
  std::string text = fmt::format(
      "{} cells; at most {} simulated cases: training {}, validation {}, test {}\n", cost.cells,
      cost.training + cost.validation + cost.test, cost.training, cost.validation, cost.test);
  if (expected_s > 0) {
    text += fmt::format(
        "about {} with --jobs {} (measured on a few simulations; optimizers that think long "
        "take longer)\n",
        format_duration(expected_s), jobs);
  }
  return text;
}

std::string describe_study(const StudyPlan& plan, const StudyResult& result,
                           const std::filesystem::path& folder, const Style& style) {
  std::string text;
  for (const ProblemResult& problem : result.problems) {
    text += describe_problem(plan, problem, style);
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
  return text + fmt::format(
                    "\nA12: how often a run of the table's first is better than one of this "
                    "optimizer's. p: of the\ndifference in pairs (Wilcoxon, after Holm); * below "
                    "{}. Cases to 1 %: expected, with restarts,\nuntil 1 % of the way from the "
                    "start to the best known is left.\nTables: {}\n",
                    kSignificance, sanitize((folder / "tables").string()));
}

}  // namespace armwright
