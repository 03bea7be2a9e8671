#include "study/analysis/pair_comparison.hpp"

#include <utility>

namespace armwright {
namespace {

PairResult compare_pair(std::size_t o, std::size_t p, std::span<const std::vector<double>> values,
                        std::span<const std::vector<double>> rounded,
                        const PairEquality& is_equal) {
  std::vector<double> of_p = values[p];
  for (std::size_t i = 0; i < of_p.size(); ++i) {
    of_p[i] = is_equal(o, p, i) ? values[o][i] : of_p[i];
  }
  PairResult pair;
  pair.a = o;
  pair.b = p;
  pair.test = calc_signed_rank_test(values[o], of_p);
  pair.wins = count_wins(values[o], of_p);
  pair.a12 = calc_a12(rounded[o], rounded[p]);
  const double lead = pair.test.negative_rank_sum - pair.test.positive_rank_sum;
  if (lead < 0 || (lead == 0 && pair.a12 < 0.5)) {
    std::swap(pair.a, pair.b);
    std::swap(pair.test.negative_rank_sum, pair.test.positive_rank_sum);
    std::swap(pair.wins.wins, pair.wins.losses);
    pair.a12 = calc_a12(rounded[p], rounded[o]);
  }
  return pair;
}

}  // namespace

std::vector<std::vector<double>> round_values(std::span<const std::vector<double>> values,
                                              const Margin& margin) {
  std::vector<std::vector<double>> rounded;
  for (const std::vector<double>& row : values) {
    rounded.emplace_back();
    for (const double value : row) {
      rounded.back().push_back(margin.round(value));
    }
  }
  return rounded;
}

std::vector<std::vector<double>> make_blocks(std::span<const std::vector<double>> values) {
  std::vector<std::vector<double>> blocks(values.front().size());
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    for (const std::vector<double>& its_values : values) {
      blocks[i].push_back(its_values[i]);
    }
  }
  return blocks;
}

std::vector<PairResult> compare_pairs(std::span<const std::vector<double>> values,
                                      const Margin& margin) {
  return compare_pairs(values, round_values(values, margin),
                       [&](std::size_t o, std::size_t p, std::size_t i) {
                         return margin.is_equal(values[o][i], values[p][i]);
                       });
}

std::vector<PairResult> compare_pairs(std::span<const std::vector<double>> values,
                                      std::span<const std::vector<double>> rounded,
                                      const PairEquality& is_equal) {
  std::vector<PairResult> pairs;
  std::vector<double> p_values;
  for (std::size_t o = 0; o < values.size(); ++o) {
    for (std::size_t p = o + 1; p < values.size(); ++p) {
      pairs.push_back(compare_pair(o, p, values, rounded, is_equal));
      p_values.push_back(pairs.back().test.p_value);
    }
  }
  const auto adjusted = adjust_holm(p_values);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    pairs[i].p_holm = adjusted[i];
  }
  return pairs;
}

}  // namespace armwright
