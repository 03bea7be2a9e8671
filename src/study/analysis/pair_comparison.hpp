// Compares two optimizers by their paired values.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "study/statistics/margin.hpp"
#include "study/statistics/significance.hpp"

namespace armwright {

// The comparison of two optimizers. `a` is the better one by the test: the ranks of the pairs that
// it wins have the larger sum. If the sums are equal, `a` has the larger A12; if that is equal too,
// it comes first in the plan. So a significant pair always means that `a` is better.
struct PairResult {
  std::size_t a = 0;  // index of an optimizer
  std::size_t b = 0;
  SignedRankTest test;
  double p_holm = 1;
  double a12 = 0.5;  // probability that a run of a is better than a run of b; may be below 1/2
  WinTieLoss wins;   // pairs within the margin are ties
  bool is_significant() const {
    return test.pairs + test.zeros >= kFewestPairs && p_holm < kSignificance;
  }
  // Returns whether this optimizer is significantly better than the other one.
  bool is_won_by(std::size_t optimizer) const { return is_significant() && optimizer == a; }
};

// Compares every two optimizers, with Holm's correction over all pairs. values[o][i] and
// values[p][i] form a pair. Pairs within the margin do not differ; A12 uses rounded values.
std::vector<PairResult> compare_pairs(std::span<const std::vector<double>> values,
                                      const Margin& margin = {});

// Returns whether the values of the optimizers `o` and `p` in pair `i` count as equal.
using PairEquality = std::function<bool(std::size_t o, std::size_t p, std::size_t i)>;
// As above, for pairs that have different margins. A12 uses `rounded`.
std::vector<PairResult> compare_pairs(std::span<const std::vector<double>> values,
                                      std::span<const std::vector<double>> rounded,
                                      const PairEquality& is_equal);

// Returns every value as Margin::round() does.
std::vector<std::vector<double>> round_values(std::span<const std::vector<double>> values,
                                              const Margin& margin);
// Returns one row per pair and one column per optimizer, as ranks and Friedman's test need them.
std::vector<std::vector<double>> make_blocks(std::span<const std::vector<double>> values);

}  // namespace armwright
