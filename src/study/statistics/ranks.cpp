#include "study/statistics/ranks.hpp"

#include <algorithm>
#include <numeric>

#include "study/statistics/values.hpp"

namespace armwright {

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
    // The mean of the ranks first + 1, ..., end: a whole number or a half, and so exact.
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

}  // namespace armwright
