// Writes the verdict's sentences about the leader: whom it beats, who beats it, and who cannot be
// told apart from it. The tests of the pairs alone decide; ranks and medians only choose the leader.
#include <fmt/format.h>

#include <algorithm>

#include "base/text.hpp"
#include "study/analysis/verdict.hpp"

namespace armwright {
namespace {

constexpr double kSmallestP = 1e-6;

std::string format_p_value(double p) {
  return fmt::format("{:.2g}", std::max(p, kSmallestP));
}

std::string format_a12(double a12) {
  return fmt::format("{:.2f}", a12);
}

std::string get_label(const StudyPlan& plan, std::size_t optimizer) {
  return plan.optimizers[optimizer].label;
}

// Returns "a beats b and c (A12 0.8 to 0.9, p at most 0.01 after Holm)". `won` are pairs that
// `best` wins.
std::string describe_won(const StudyPlan& plan, std::size_t best,
                         std::span<const PairResult* const> won) {
  std::vector<std::string> names;
  double least_a12 = 1, most_a12 = 0, worst_p = 0;
  for (const PairResult* pair : won) {
    names.push_back(get_label(plan, pair->b));
    least_a12 = std::min(least_a12, pair->a12);
    most_a12 = std::max(most_a12, pair->a12);
    worst_p = std::max(worst_p, pair->p_holm);
  }
  const std::string a12 = format_a12(least_a12) == format_a12(most_a12)
                              ? format_a12(least_a12)
                              : format_a12(least_a12) + " to " + format_a12(most_a12);
  const bool one = won.size() == 1;
  return fmt::format("{} beats {} (A12 {}, p {}{} after Holm)", get_label(plan, best),
                     join_names(names), a12, one ? "" : "at most ",
                     one ? format_p(worst_p) : format_p_value(worst_p));
}

}  // namespace

const PairResult& find_pair(std::span<const PairResult> pairs, std::size_t a, std::size_t b) {
  return *std::ranges::find_if(pairs, [&](const PairResult& pair) {
    return (pair.a == a && pair.b == b) || (pair.a == b && pair.b == a);
  });
}

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

std::vector<std::string> describe_standing(const StudyPlan& plan, const std::string& where,
                                           const std::string& again,
                                           std::span<const std::size_t> order,
                                           std::span<const PairResult> pairs) {
  if (std::ranges::none_of(pairs, &PairResult::is_significant)) {
    return {where + " no two optimizers can be told apart."};
  }
  const std::size_t leader = order.front();
  std::vector<const PairResult*> won;
  std::vector<const PairResult*> lost;
  std::vector<std::string> undecided;
  for (const std::size_t other : order.subspan(1)) {
    const PairResult& pair = find_pair(pairs, leader, other);
    if (!pair.is_significant()) {
      undecided.push_back(get_label(plan, other));
    } else {
      (pair.is_won_by(leader) ? won : lost).push_back(&pair);
    }
  }
  std::vector<std::string> sentences;
  const auto get_where = [&] { return sentences.empty() ? where : again; };
  if (!won.empty()) {
    sentences.push_back(fmt::format("{} {}.", get_where(), describe_won(plan, leader, won)));
  }
  for (const PairResult* pair : lost) {
    sentences.push_back(fmt::format("{} {}, although {} leads the ranking.", get_where(),
                                    describe_won(plan, pair->a, {&pair, 1}),
                                    get_label(plan, leader)));
  }
  if (!undecided.empty()) {
    sentences.push_back(fmt::format("{} {} cannot be told apart from {}.", get_where(),
                                    get_label(plan, leader), join_names(undecided)));
  }
  return sentences;
}

std::vector<std::string> describe_medians(const StudyPlan& plan, const ProblemResult& problem) {
  const std::size_t leader = problem.order.front();
  const auto get_median = [&](std::size_t o) {
    return problem.margin.round(problem.optimizers[o].spread.median);
  };
  std::vector<std::string> sentences;
  for (const PairResult& pair : problem.pairs) {
    const bool has_leader = pair.a == leader || pair.b == leader;
    if (has_leader && pair.is_significant() && get_median(pair.b) < get_median(pair.a)) {
      sentences.push_back(
          fmt::format("The median of {} is better than that of {}, but the pairs of runs decide.",
                      get_label(plan, pair.b), get_label(plan, pair.a)));
    }
  }
  return sentences;
}

}  // namespace armwright
