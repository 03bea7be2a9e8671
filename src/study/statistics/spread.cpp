#include "study/statistics/spread.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <vector>

#include "study/statistics/values.hpp"

namespace armwright {
namespace {

std::vector<double> sort_values(std::span<const double> values) {
  if (values.empty()) {
    throw std::invalid_argument("quantile: there are no values");
  }
  check_values(values, "quantile");
  std::vector<double> sorted(values.begin(), values.end());
  std::ranges::sort(sorted);
  return sorted;
}

double find_quantile(const std::vector<double>& sorted, double p) {
  check_range(p, 0, 1, "quantile: p");
  const double position = p * static_cast<double>(sorted.size() - 1);
  const auto index = static_cast<std::size_t>(position);
  const double share = position - static_cast<double>(index);
  const double below = sorted[index];
  if (share == 0) {
    return below;
  }
  const double above = sorted[index + 1];
  if (above == std::numeric_limits<double>::infinity()) {
    return above;
  }
  return below + share * (above - below);
}

}  // namespace

double calc_quantile(std::span<const double> values, double p) {
  return find_quantile(sort_values(values), p);
}

Spread calc_spread(std::span<const double> values) {
  const std::vector<double> sorted = sort_values(values);
  return {.median = find_quantile(sorted, 0.5),
          .lower_quartile = find_quantile(sorted, 0.25),
          .upper_quartile = find_quantile(sorted, 0.75)};
}

}  // namespace armwright
