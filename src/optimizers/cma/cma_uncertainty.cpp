#include "optimizers/cma/cma_uncertainty.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <numeric>

namespace armwright {
namespace {

constexpr double kTheta = 0.2;

double calc_limit(double rank, std::size_t population) {
  std::vector<double> distances;
  for (std::size_t i = 1; i < 2 * population; ++i) {
    distances.push_back(std::abs(static_cast<double>(i) - rank));
  }
  std::ranges::sort(distances);
  const double place = 0.5 * kTheta * static_cast<double>(distances.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const double part = place - static_cast<double>(below);
  const std::size_t above = std::min(below + 1, distances.size() - 1);
  return (1 - part) * distances[below] + part * distances[above];
}

}  // namespace

UncertaintyMeasure measure_uncertainty(std::span<const double> values,
                                       std::span<const double> again) {
  assert(again.size() <= values.size());
  const std::size_t population = values.size();
  std::vector<double> all(values.begin(), values.end());
  all.insert(all.end(), again.begin(), again.end());
  all.insert(all.end(), values.begin() + static_cast<std::ptrdiff_t>(again.size()), values.end());
  std::vector<double> sorted = all;
  std::ranges::sort(sorted);
  const auto rank = [&](std::size_t place) {  // from 1
    return static_cast<double>(1 + (std::ranges::lower_bound(sorted, all[place]) - sorted.begin()));
  };

  UncertaintyMeasure measure;
  for (std::size_t i = 0; i < again.size(); ++i) {
    const double before = rank(i);
    const double after = rank(population + i);
    const double change = std::max(0.0, std::abs(after - before) - 1);
    measure.s += 2 * change - calc_limit(after - (after > before ? 1 : 0), population) -
                 calc_limit(before - (before > after ? 1 : 0), population);
  }
  if (!again.empty()) {
    measure.s /= static_cast<double>(again.size());
  }
  measure.ranking.resize(population);
  std::iota(measure.ranking.begin(), measure.ranking.end(), std::size_t{0});
  std::ranges::stable_sort(measure.ranking, {},
                           [&](std::size_t i) { return rank(i) + rank(population + i); });
  return measure;
}

}  // namespace armwright
