#include "study/analysis/verdict.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "base/text.hpp"

namespace armwright {
namespace {

const PairResult& find_pair(std::span<const PairResult> pairs, std::size_t a, std::size_t b) {
  return *std::ranges::find_if(pairs, [&](const PairResult& pair) {
    return (pair.a == a && pair.b == b) || (pair.a == b && pair.b == a);
  });
}

constexpr double kSmallestP = 1e-6;

std::string format_p_value(double p) {
  return fmt::format("{:.2g}", std::max(p, kSmallestP));
}

std::string format_a12(double a12) {
  return fmt::format("{:.2f}", a12);
}

// The optimizers that the first one in the order beats, and those that do not differ significantly
// from it.
struct Standing {
  std::vector<const PairResult*> beaten;
  std::vector<std::size_t> equal;
};

Standing find_standing(std::span<const PairResult> pairs, std::span<const std::size_t> order) {
  Standing standing;
  for (std::size_t i = 1; i < order.size(); ++i) {
    const PairResult& pair = find_pair(pairs, order[0], order[i]);
    if (pair.is_beaten_by(order[0])) {
      standing.beaten.push_back(&pair);
    } else {
      standing.equal.push_back(order[i]);
    }
  }
  return standing;
}

std::string describe_beaten(const StudyPlan& plan, std::size_t best,
                            std::span<const PairResult* const> beaten) {
  std::vector<std::string> names;
  double least_a12 = 1, most_a12 = 0, worst_p = 0;
  for (const PairResult* pair : beaten) {
    const std::size_t other = pair->a == best ? pair->b : pair->a;
    const double a12 = pair->a == best ? pair->a12 : 1 - pair->a12;
    names.push_back(plan.optimizers[other].label);
    least_a12 = std::min(least_a12, a12);
    most_a12 = std::max(most_a12, a12);
    worst_p = std::max(worst_p, pair->p_holm);
  }
  const std::string a12 = format_a12(least_a12) == format_a12(most_a12)
                              ? format_a12(least_a12)
                              : format_a12(least_a12) + " to " + format_a12(most_a12);
  const bool one = beaten.size() == 1;
  return fmt::format("{} beats {} (A12 {}, p {}{} after Holm)", plan.optimizers[best].label,
                     join_names(names), a12, one ? "" : "at most ",
                     one ? format_p(worst_p) : format_p_value(worst_p));
}

// Returns "at 5000 simulations", the budget of every optimizer.
std::string describe_budget(const StudyPlan& plan) {
  return fmt::format("at {} simulations", plan.budget);
}

// Returns whether the largest possible difference is significant after Holm's correction over so
// many tests.
bool can_be_significant(std::ptrdiff_t pairs_of_values, std::size_t tests) {
  const double least_p = std::ldexp(2.0, -static_cast<int>(pairs_of_values));
  return least_p * static_cast<double>(tests) < kSignificance;
}

// Returns the fewest replicates with which the largest possible difference is significant.
int calc_fewest_replicates(std::size_t pairs) {
  int replicates = kFewestPairs;
  while (!can_be_significant(replicates, pairs)) {
    ++replicates;
  }
  return replicates;
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
  if (plan.replicates < kFewestPairs) {
    return {
        fmt::format("{} nothing can be concluded: there are {} replicates, and of fewer than "
                    "{} no outcome is significant.",
                    where, plan.replicates, kFewestPairs)};
  }
  if (!can_be_significant(plan.replicates, problem.pairs.size())) {
    return {
        fmt::format("{} nothing can be concluded: with {} replicates and {} pairs of optimizers "
                    "no difference, however clear, is significant after Holm's correction; {} "
                    "replicates would do.",
                    where, plan.replicates, problem.pairs.size(),
                    calc_fewest_replicates(problem.pairs.size()))};
  }
  const std::size_t best = problem.order.front();
  const Standing standing = find_standing(problem.pairs, problem.order);
  std::vector<std::string> equal;
  for (const std::size_t i : standing.equal) {
    equal.push_back(plan.optimizers[i].label);
  }
  std::vector<std::string> sentences;
  if (!standing.beaten.empty()) {
    sentences.push_back(fmt::format("{} {}.", where, describe_beaten(plan, best, standing.beaten)));
  }
  if (std::ranges::none_of(problem.pairs, &PairResult::is_significant)) {
    sentences.push_back(where + " no two optimizers can be told apart.");
  } else if (!equal.empty()) {
    sentences.push_back(fmt::format("{} {} cannot be told apart from {}.",
                                    standing.beaten.empty() ? where : "On " + problem.label,
                                    plan.optimizers[best].label, join_names(equal)));
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
  if (std::ranges::none_of(problem.failure_pairs, &PairResult::is_significant)) {
    return {where + " no two optimizers can be told apart."};
  }
  std::vector<std::size_t> order(problem.optimizers.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t o) {
    const OptimizerResult& one = problem.optimizers[o];
    return std::pair(one.failure_spread.median, one.mean_failure_share);
  });
  const Standing standing = find_standing(problem.failure_pairs, order);
  if (standing.beaten.empty()) {
    return {fmt::format("{} {} fails least, but beats none of the others.", where,
                        plan.optimizers[order.front()].label)};
  }
  return {fmt::format("{} {}.", where, describe_beaten(plan, order.front(), standing.beaten))};
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
  const auto changes = std::ranges::count_if(
      stability.without, [](const RankingWithout& one) { return one.leader_changes; });
  sentences.push_back(fmt::format(
      "Over the {} problems {} {} the best mean rank ({:.2f} of {}); leaving one problem out, that "
      "changes in {} of {} cases.",
      plan.problems.size(), join_names(leaders), leaders.size() == 1 ? "has" : "share",
      stability.full.mean_ranks[stability.full.leaders.front()], plan.optimizers.size(), changes,
      stability.without.size()));
  if (std::ssize(plan.problems) < kFewestPairs) {
    sentences.push_back(
        fmt::format("That is no more than a description: of {} problems, fewer than {}, nothing "
                    "can be concluded about others.",
                    plan.problems.size(), kFewestPairs));
    return sentences;
  }
  if (!can_be_significant(std::ssize(plan.problems), result.overall.pairs.size())) {
    sentences.push_back(
        fmt::format("That is no more than a description: with {} problems and {} "
                    "pairs of optimizers no difference is significant after Holm's "
                    "correction.",
                    plan.problems.size(), result.overall.pairs.size()));
    return sentences;
  }
  const std::size_t best = stability.full.order.front();
  const Standing standing = find_standing(result.overall.pairs, stability.full.order);
  sentences.push_back(
      standing.beaten.empty()
          ? fmt::format("Over problems {} cannot be told apart from any other.",
                        plan.optimizers[best].label)
          : fmt::format("Over problems {}.", describe_beaten(plan, best, standing.beaten)));
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
  if (!plan.baselines) {
    sentences.push_back(
        "The baselines (random search and a local search) were left out on request: whether any "
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

std::string join_names(std::vector<std::string> names) {
  if (names.size() < 2) {
    return names.empty() ? "" : names.front();
  }
  const std::string last = names.back();
  names.pop_back();
  return join(names, ", ") + " and " + last;
}

std::string format_p(double p) {
  return p < kSmallestP ? "< 1e-06" : "= " + format_p_value(p);
}

std::vector<std::string> describe_verdict(const StudyPlan& plan, const StudyResult& result) {
  std::vector<std::string> verdict;
  const auto add = [&](const std::vector<std::string>& sentences) {
    verdict.insert(verdict.end(), sentences.begin(), sentences.end());
  };
  for (const ProblemResult& problem : result.problems) {
    add(describe_problem(plan, problem, result.missing));
    add(describe_failures(plan, problem));
    add(describe_target_verdict(
        plan, *std::ranges::find(plan.problems, problem.label, &StudyProblem::label), problem));
  }
  add(describe_overall(plan, result));
  add(describe_limits(plan, result));
  add(describe_methods(plan, result));
  return verdict;
}

}  // namespace armwright
