// Optimizers ranked over problems, and whether the order hangs on a single problem.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace armwright {

struct Ranking {
  std::vector<double> mean_ranks;  // of each optimizer over the problems; 1 is best
  std::vector<std::size_t> order;  // optimizers by mean rank; of equal ones, the first in the table
  std::vector<std::size_t> leaders;  // those with the smallest mean rank, in the table's order
};

// medians[p][o]: the median result of optimizer o on problem p, smaller being better; ranked on
// each problem, ties sharing ranks. Throws std::invalid_argument for an empty or ragged table, NaN
// and -infinity.
Ranking calc_ranking(std::span<const std::vector<double>> medians);

struct RankingWithout {
  std::size_t problem = 0;  // the one left out
  Ranking ranking;
  double tau = 1;               // Kendall's tau-b of its mean ranks and those over all problems
  bool leader_changes = false;  // `leaders` are not the same, be it that one joins or drops out
};

struct RankingStability {
  Ranking full;
  std::vector<RankingWithout> without;  // one a problem; none if there is only one
};

// Throws as calc_ranking.
RankingStability calc_ranking_stability(std::span<const std::vector<double>> medians);

// Kendall's tau-b: (concordant - discordant pairs) / sqrt(pairs not tied in a * pairs not tied in
// b). 1 is the same order, -1 the reverse. Where all are tied in one of them it is not defined: 1
// here if they are in both, else 0. Source: Kendall, M. G. 1945, The treatment of ties in ranking
// problems, Biometrika 33(3). Throws std::invalid_argument for unequal lengths, NaN and -infinity.
double calc_kendall_tau(std::span<const double> a, std::span<const double> b);

}  // namespace armwright
