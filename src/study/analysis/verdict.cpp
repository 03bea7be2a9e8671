#include "study/analysis/verdict.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "study/statistics/power.hpp"

namespace armwright {
namespace {

constexpr const char* kConstraintWeight = "constraint_weight";

// Returns "at 5000 simulations", the budget of every optimizer.
std::string describe_budget(const StudyPlan& plan) {
  return fmt::format("at {} simulations", plan.budget);
}

// Says what Friedman's test adds if no pair can be decided or none is significant.
std::vector<std::string> describe_friedman(const std::optional<FriedmanTest>& test) {
  if (!test) {
    return {};
  }
  const std::string p = format_p(test->get_p());
  return {test->get_p() < kSignificance
              ? fmt::format("The optimizers do differ (Friedman's test, p {}), but this test does "
                            "not say which ones.",
                            p)
              : fmt::format("Friedman's test does not show that the optimizers differ at all "
                            "(p {}).",
                            p)};
}

std::vector<std::string> describe_problem(const StudyPlan& plan, const ProblemResult& problem,
                                          std::span<const Cell> missing_cells) {
  const std::string where = fmt::format("On {} {}", problem.label, describe_budget(plan));
  if (plan.optimizers.size() < 2) {
    return {where + " there is nothing to compare: one optimizer took part."};
  }
  const bool missing = std::ranges::any_of(missing_cells, [&](const Cell& cell) {
    return plan.problems[cell.problem].label == problem.label;
  });
  if (missing) {
    return {where + " there is no verdict: not all cells have ended."};
  }
  const bool nothing_found = std::ranges::all_of(
      problem.optimizers,
      [](const OptimizerResult& one) { return one.infinite == std::ssize(one.values); });
  if (nothing_found) {
    return {where + " no optimizer found a design that has a value on the test set."};
  }
  std::vector<std::string> sentences;
  const auto add = [&](const std::vector<std::string>& more) {
    sentences.insert(sentences.end(), more.begin(), more.end());
  };
  if (!can_be_significant(plan.replicates, problem.pairs.size())) {
    add({fmt::format(
        "{} no pair of optimizers can be decided: with {} replicates and {} {} of "
        "optimizers no difference, however clear, is significant after Holm's "
        "correction; {} replicates would do.",
        where, plan.replicates, problem.pairs.size(), problem.pairs.size() == 1 ? "pair" : "pairs",
        find_fewest_pairs(problem.pairs.size()))});
    add(describe_friedman(problem.friedman));
    return sentences;
  }
  add(describe_standing(plan, where, "On " + problem.label, problem.order, problem.pairs));
  add(describe_medians(plan, problem));
  if (std::ranges::none_of(problem.pairs, &PairResult::is_significant)) {
    add(describe_friedman(problem.friedman));
  }
  return sentences;
}

// Compares the shares of failing test cases, in addition to the value that the study compares.
std::vector<std::string> describe_failures(const StudyPlan& plan, const ProblemResult& problem) {
  const bool some_fail = std::ranges::any_of(problem.optimizers, [](const OptimizerResult& one) {
    return std::ranges::any_of(one.failure_shares, [](double share) { return share > 0; });
  });
  if (plan.value == StudyValue::failures || !some_fail || problem.failure_pairs.empty() ||
      !can_be_significant(plan.replicates, problem.failure_pairs.size())) {
    return {};
  }
  const std::string where = fmt::format("On {}, by failed test cases,", problem.label);
  std::vector<std::size_t> order(problem.optimizers.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t o) {
    const OptimizerResult& one = problem.optimizers[o];
    return std::pair(one.failure_mean_rank, one.mean_failure_share);
  });
  return describe_standing(plan, where, where, order, problem.failure_pairs);
}

// Names the optimizers that ended without a feasible winner, and how those that have the option weigh
// violations.
std::vector<std::string> describe_violations(const StudyPlan& plan, const StudyProblem& planned,
                                             const ProblemResult& problem) {
  if (planned.loaded.problem->description().constraints.empty()) {
    return {};
  }
  std::vector<std::string> counts, weights;
  for (std::size_t o = 0; o < problem.optimizers.size(); ++o) {
    const OptimizerResult& one = problem.optimizers[o];
    const StudyOptimizer& optimizer = plan.optimizers[o];
    if (one.unmet == 0) {
      continue;
    }
    counts.push_back(fmt::format("{} ({} of {})", optimizer.label, one.unmet, one.values.size()));
    if (optimizer.parsed.values().contains(kConstraintWeight)) {
      weights.push_back(fmt::format("{} ({})", optimizer.label,
                                    to_text(optimizer.parsed.values().at(kConstraintWeight))));
    }
  }
  if (counts.empty()) {
    return {};
  }
  return {fmt::format(
      "On {}, runs of these optimizers have no winner that meets the constraints on the test set: "
      "{}{}.",
      problem.label, join_names(counts),
      weights.empty()
          ? ""
          : fmt::format("; the option constraint_weight of {} weighs violations against "
                        "the objective (docs/constrained.md)",
                        join_names(weights)))};
}

// Says whether the best mean rank depends on a single problem.
std::string describe_stability(const StudyPlan& plan, const RankingStability& stability) {
  std::vector<std::string> needed;
  for (const RankingWithout& one : stability.without) {
    if (one.leader_changes) {
      needed.push_back(plan.problems[one.problem].label);
    }
  }
  if (needed.empty()) {
    return fmt::format("The lead stays the same whichever one of the {} problems is left out.",
                       plan.problems.size());
  }
  return needed.size() == 1
             ? fmt::format("The lead changes if {} is left out.", needed.front())
             : fmt::format("The lead changes if one of these problems alone is left out: {}.",
                           join_names(needed));
}

std::vector<std::string> describe_overall(const StudyPlan& plan, const StudyResult& result) {
  if (plan.problems.size() < 2 || plan.optimizers.size() < 2 || !result.missing.empty()) {
    return {};
  }
  std::vector<std::string> sentences;
  const RankingStability& stability = result.overall.ranking;
  std::vector<std::string> leaders;
  for (const std::size_t i : stability.full.leaders) {
    leaders.push_back(plan.optimizers[i].label);
  }
  sentences.push_back(
      fmt::format("Over the {} problems {} {} the best mean rank ({:.2f} of {}). {}",
                  plan.problems.size(), join_names(leaders), leaders.size() == 1 ? "has" : "share",
                  stability.full.mean_ranks[stability.full.leaders.front()], plan.optimizers.size(),
                  describe_stability(plan, stability)));
  const auto add = [&](const std::vector<std::string>& more) {
    sentences.insert(sentences.end(), more.begin(), more.end());
  };
  const auto problems = static_cast<int>(plan.problems.size());
  const std::size_t pairs = result.overall.pairs.size();
  if (!can_be_significant(problems, pairs)) {
    sentences.push_back(
        problems < kFewestPairs
            ? fmt::format("These ranks only describe the problems: with {} problems, fewer than "
                          "{}, no pair of optimizers can be decided over problems.",
                          problems, kFewestPairs)
            : fmt::format("These ranks only describe the problems: with {} problems and {} pairs "
                          "of optimizers no difference over problems is significant after Holm's "
                          "correction.",
                          problems, pairs));
    add(describe_friedman(result.overall.friedman));
    return sentences;
  }
  add(describe_standing(plan, "Over problems", "Over problems", stability.full.order,
                        result.overall.pairs));
  if (std::ranges::none_of(result.overall.pairs, &PairResult::is_significant)) {
    add(describe_friedman(result.overall.friedman));
  }
  return sentences;
}

// Lists the methods for which racing is on but has no effect, with the reasons.
std::vector<std::string> describe_raceless(const StudyPlan& plan) {
  std::vector<std::pair<std::string, std::vector<std::string>>> raceless;  // with the reason as key
  for (std::size_t o = 0; o < plan.optimizers.size(); ++o) {
    for (std::size_t p = 0; p < plan.problems.size(); ++p) {
      const Cell cell{p, o, 1};
      const std::string reason = explain_no_race(
          plan.optimizers[o].row, get_problem(plan, cell).racing, get_schedule(plan, cell));
      if (reason.empty()) {
        continue;
      }
      auto found = std::ranges::find(raceless, reason,
                                     &std::pair<std::string, std::vector<std::string>>::first);
      if (found == raceless.end()) {
        found = raceless.insert(found, {reason, {}});
      }
      if (found->second.empty() || found->second.back() != plan.optimizers[o].label) {
        found->second.push_back(plan.optimizers[o].label);
      }
    }
  }
  std::vector<std::string> sentences;
  for (const auto& [reason, labels] : raceless) {
    sentences.push_back(fmt::format("Racing has no effect on {}: {}.", join_names(labels), reason));
  }
  return sentences;
}

// Returns the problems on which more candidates are judged than the plan says, as part of a sentence.
std::string describe_wider_selections(const StudyPlan& plan) {
  std::vector<std::string> problems;
  int most = 0;
  for (const StudyProblem& problem : plan.problems) {
    const Selection selection = choose_selection(plan, problem);
    if (selection.most > plan.selection.most) {
      problems.push_back(problem.label);
      most = selection.most;
    }
  }
  return problems.empty() ? "" : fmt::format(" ({} on {})", most, join_names(problems));
}

std::vector<std::string> describe_limits(const StudyPlan& plan, const StudyResult& result) {
  std::vector<std::string> sentences;
  std::vector<std::string> failed;
  for (std::size_t o = 0; o < plan.optimizers.size(); ++o) {
    int runs = 0;
    for (const ProblemResult& problem : result.problems) {
      runs += problem.optimizers[o].failed;
    }
    if (runs > 0) {
      failed.push_back(
          fmt::format("{} ({} of {} runs)", plan.optimizers[o].label, runs,
                      plan.problems.size() * static_cast<std::size_t>(plan.replicates)));
    }
  }
  if (!failed.empty()) {
    sentences.push_back(
        fmt::format("Failed by a fault of their own, and counted with what they "
                    "had found by then: {}.",
                    join_names(failed)));
  }
  if (!result.missing.empty()) {
    sentences.push_back(fmt::format(
        "{} of {} cells have not ended and {}.", result.missing.size(), list_cells(plan).size(),
        result.missing_left_out ? "are left out" : "count as if they had found nothing"));
  }
  sentences.push_back(
      fmt::format("At most {} candidates of every run are judged on the validation set, "
                  "recommendations included{}.",
                  plan.selection.most, describe_wider_selections(plan)));
  if (!plan.baselines) {
    sentences.push_back(
        "The baselines (the start, random search and a local search) were left out on request: "
        "whether any "
        "of these optimizers is better than those was not asked.");
  }
  const auto methods = std::ranges::count_if(plan.optimizers, [](const StudyOptimizer& one) {
    return one.schedule.has_value() || !one.settings.empty();
  });
  if (methods > 0) {
    sentences.push_back(
        "Methods spend the same budget in ways of their own, or have controllers of their own; "
        "what their designs are worth is measured alike.");
  }
  for (std::string& sentence : describe_raceless(plan)) {
    sentences.push_back(std::move(sentence));
  }
  const auto has = [&](Schedule::Kind kind) {
    return std::ranges::any_of(
        plan.problems, [&](const StudyProblem& problem) { return problem.schedule.kind == kind; });
  };
  if (has(Schedule::Kind::coevolution)) {
    sentences.push_back(
        "Training cases were bred against every optimizer's own designs; budgets buy unequal "
        "numbers of generations.");
  }
  if (has(Schedule::Kind::fresh)) {
    sentences.push_back(
        "Training cases were new in every generation, the same for all optimizers "
        "only generation by generation; budgets buy unequal numbers of "
        "generations.");
  }
  return sentences;
}

}  // namespace

std::vector<std::string> describe_verdict(const StudyPlan& plan, const StudyResult& result) {
  std::vector<std::string> verdict;
  const auto add = [&](const std::vector<std::string>& sentences) {
    verdict.insert(verdict.end(), sentences.begin(), sentences.end());
  };
  for (const ProblemResult& problem : result.problems) {
    add(describe_problem(plan, problem, result.missing));
    const StudyProblem& planned =
        *std::ranges::find(plan.problems, problem.label, &StudyProblem::label);
    add(describe_violations(plan, planned, problem));
    add(describe_failures(plan, problem));
    add(describe_target_verdict(plan, planned, problem));
  }
  add(describe_overall(plan, result));
  add(describe_limits(plan, result));
  add(describe_methods(plan, result));
  return verdict;
}

}  // namespace armwright
