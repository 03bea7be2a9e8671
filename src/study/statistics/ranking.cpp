#include "study/statistics/ranking.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>

#include "study/statistics/ranks.hpp"
#include "study/statistics/values.hpp"

namespace armwright {

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
  // The sums are exact, so that optimizers as good as each other have equal means.
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

}  // namespace armwright
