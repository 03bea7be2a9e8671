// Ranks of values, rankings of optimizers over problems, and groups of optimizers that cannot be
// told apart. Smaller values are better. All functions throw std::invalid_argument for NaN and
// -infinity.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace armwright {

// Returns ranks from 1, the smallest value first. Equal values, also infinities, share the mean of
// the ranks that they take up together. Source: Kendall, M. G. 1945, The treatment of ties in
// ranking problems, Biometrika 33(3).
std::vector<double> calc_ranks(std::span<const double> values);

// Returns the sum of t^3 - t over the groups of t equal values: the amount by which ties reduce the
// spread of ranks. The sum is exact for up to 200 000 values.
double calc_tie_term(std::span<const double> values);

struct Ranking {
  std::vector<double> mean_ranks;    // of each optimizer over the problems; 1 is best
  std::vector<std::size_t> order;    // optimizers by mean rank; equal ones in the table's order
  std::vector<std::size_t> leaders;  // optimizers with the smallest mean rank, in the table's order
};

// Ranks the optimizers on each problem; medians[p][o] is the median result of optimizer o on
// problem p. Equal medians share ranks. Also throws std::invalid_argument for an empty table and
// for rows of different lengths.
Ranking calc_ranking(std::span<const std::vector<double>> medians);

struct RankingWithout {
  std::size_t problem = 0;  // the problem that is left out
  Ranking ranking;
  double tau = 1;               // Kendall's tau-b of its mean ranks and those over all problems
  bool leader_changes = false;  // `leaders` differ from those over all problems in any way
};

// Shows whether a ranking depends on a single problem.
struct RankingStability {
  Ranking full;
  std::vector<RankingWithout> without;  // one per problem; empty if there is only one problem
};

// Ranks over all problems and without each of them. Throws as calc_ranking().
RankingStability calc_ranking_stability(std::span<const std::vector<double>> medians);

// Returns Kendall's tau-b: (concordant - discordant pairs) / sqrt(pairs not tied in a * pairs not
// tied in b). 1 is the same order, -1 the reverse. If all pairs are tied in a or in b it is not
// defined; the result is then 1 if they are tied in both, else 0. Source: Kendall, M. G. 1945, The
// treatment of ties in ranking problems, Biometrika 33(3). Also throws std::invalid_argument for
// different lengths.
double calc_kendall_tau(std::span<const double> a, std::span<const double> b);

// Returns the groups of a critical-difference diagram: the largest sets of two or more of the
// numbers 0, ..., count - 1 that contain no pair of `told_apart` (pairs may be in any order). Each
// set is in ascending order, and the sets are in lexicographic order. A number may be in several
// sets, because being indistinguishable is not transitive. The sets are the maximal cliques of a
// graph, of which there can be 3^(count/3); returns nothing if there are more than `most`. Source:
// Bron, C. and Kerbosch, J. 1973, Algorithm 457: finding all cliques of an undirected graph, CACM
// 16(9), with the pivot of Tomita, E., Tanaka, A. and Takahashi, H. 2006, Theoretical Computer
// Science 363(1). Throws std::invalid_argument for a pair of equal numbers or of one not below
// `count`.
std::optional<std::vector<std::vector<std::size_t>>> find_cliques(
    std::size_t count, std::span<const std::pair<std::size_t, std::size_t>> told_apart,
    std::size_t most);

}  // namespace armwright
