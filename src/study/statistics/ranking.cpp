#include "study/statistics/ranking.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <stdexcept>

#include "study/statistics/values.hpp"

namespace armwright {
namespace {

using Set = std::vector<std::size_t>;  // in ascending order

class Search {
 public:
  Search(std::vector<std::vector<bool>> joined, std::size_t most)
      : joined_(std::move(joined)), most_(most) {}

  // Returns false as soon as there are more than `most` sets.
  bool extend(Set& clique, Set candidates, Set excluded) {
    if (candidates.empty()) {
      if (excluded.empty() && clique.size() > 1) {
        found_.push_back(clique);
        std::ranges::sort(found_.back());
      }
      return found_.size() <= most_;
    }
    const std::size_t pivot = choose_pivot(candidates, excluded);
    for (const std::size_t next : Set(candidates)) {
      if (joined_[pivot][next]) {
        continue;  // found with the pivot, or with a candidate that is not joined to the pivot
      }
      clique.push_back(next);
      const bool goes_on =
          extend(clique, keep_joined(candidates, next), keep_joined(excluded, next));
      clique.pop_back();
      if (!goes_on) {
        return false;
      }
      std::erase(candidates, next);
      excluded.push_back(next);
    }
    return true;
  }

  std::vector<Set> take_found() {
    std::ranges::sort(found_);
    return std::move(found_);
  }

 private:
  Set keep_joined(const Set& set, std::size_t to) const {
    Set kept;
    std::ranges::copy_if(set, std::back_inserter(kept),
                         [&](std::size_t one) { return joined_[to][one]; });
    return kept;
  }

  // Returns the element that is joined to the most candidates: these need no branch of their own.
  std::size_t choose_pivot(const Set& candidates, const Set& excluded) const {
    std::size_t pivot = candidates.front();
    std::size_t most = 0;
    for (const Set* set : {&candidates, &excluded}) {
      for (const std::size_t one : *set) {
        const std::size_t joined = keep_joined(candidates, one).size();
        if (joined > most) {
          pivot = one;
          most = joined;
        }
      }
    }
    return pivot;
  }

  std::vector<std::vector<bool>> joined_;
  std::size_t most_;
  std::vector<Set> found_;
};

}  // namespace

std::vector<double> calc_ranks(std::span<const double> values) {
  check_values(values, "ranks");
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t i) { return values[i]; });
  std::vector<double> ranks(values.size());
  for (std::size_t first = 0; first < order.size();) {
    std::size_t end = first;
    while (end < order.size() && values[order[end]] == values[order[first]]) {
      ++end;
    }
    // The mean of the ranks first + 1, ..., end is a whole number or a half, so it is exact.
    const double rank = static_cast<double>(first + 1 + end) / 2;
    for (; first < end; ++first) {
      ranks[order[first]] = rank;
    }
  }
  return ranks;
}

double calc_tie_term(std::span<const double> values) {
  check_values(values, "ties");
  std::vector<double> sorted(values.begin(), values.end());
  std::ranges::sort(sorted);
  double sum = 0;
  for (auto first = sorted.begin(); first != sorted.end();) {
    const auto end = std::upper_bound(first, sorted.end(), *first);
    const auto tied = static_cast<double>(end - first);
    sum += tied * tied * tied - tied;
    first = end;
  }
  return sum;
}

Ranking calc_ranking(std::span<const std::vector<double>> medians) {
  const std::size_t optimizers = check_table(medians, "ranking");
  Ranking ranking;
  ranking.mean_ranks.resize(optimizers, 0);
  for (const std::vector<double>& problem : medians) {
    const std::vector<double> ranks = calc_ranks(problem);
    for (std::size_t i = 0; i < optimizers; ++i) {
      ranking.mean_ranks[i] += ranks[i];
    }
  }
  // The sums are exact, so equally good optimizers have equal means.
  for (double& rank : ranking.mean_ranks) {
    rank /= static_cast<double>(medians.size());
  }
  ranking.order.resize(optimizers);
  std::iota(ranking.order.begin(), ranking.order.end(), std::size_t{0});
  std::ranges::stable_sort(ranking.order, {}, [&](std::size_t i) { return ranking.mean_ranks[i]; });
  const double best = ranking.mean_ranks[ranking.order.front()];
  std::ranges::copy_if(ranking.order, std::back_inserter(ranking.leaders),
                       [&](std::size_t i) { return ranking.mean_ranks[i] == best; });
  return ranking;
}

RankingStability calc_ranking_stability(std::span<const std::vector<double>> medians) {
  RankingStability stability;
  stability.full = calc_ranking(medians);
  for (std::size_t problem = 0; problem < medians.size() && medians.size() > 1; ++problem) {
    std::vector<std::vector<double>> rest(medians.begin(), medians.end());
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(problem));
    RankingWithout without;
    without.problem = problem;
    without.ranking = calc_ranking(rest);
    without.tau = calc_kendall_tau(stability.full.mean_ranks, without.ranking.mean_ranks);
    without.leader_changes = without.ranking.leaders != stability.full.leaders;
    stability.without.push_back(std::move(without));
  }
  return stability;
}

double calc_kendall_tau(std::span<const double> a, std::span<const double> b) {
  check_pairs(a, b, "Kendall's tau");
  double balance = 0;
  double different_a = 0;
  double different_b = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const int sign_a = (a[i] > a[j]) - (a[i] < a[j]);
      const int sign_b = (b[i] > b[j]) - (b[i] < b[j]);
      balance += sign_a * sign_b;
      different_a += sign_a * sign_a;
      different_b += sign_b * sign_b;
    }
  }
  if (different_a == 0 || different_b == 0) {
    return different_a == different_b ? 1 : 0;
  }
  return balance / std::sqrt(different_a * different_b);
}

std::optional<std::vector<std::vector<std::size_t>>> find_cliques(
    std::size_t count, std::span<const std::pair<std::size_t, std::size_t>> told_apart,
    std::size_t most) {
  std::vector<std::vector<bool>> joined(count, std::vector<bool>(count, true));
  Set all;
  for (std::size_t i = 0; i < count; ++i) {
    joined[i][i] = false;
    all.push_back(i);
  }
  for (const auto& [a, b] : told_apart) {
    if (a >= count || b >= count || a == b) {
      throw std::invalid_argument(
          "a pair told apart must have two different numbers below the count");
    }
    joined[a][b] = joined[b][a] = false;
  }
  Search search(std::move(joined), most);
  Set clique;
  if (!search.extend(clique, all, {})) {
    return std::nullopt;
  }
  return search.take_found();
}

}  // namespace armwright
