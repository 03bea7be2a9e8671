#include "study/statistics/holm.hpp"

#include <algorithm>
#include <numeric>

#include "study/statistics/values.hpp"

namespace armwright {

std::vector<double> adjust_holm(std::span<const double> p_values) {
  for (const double p : p_values) {
    check_range(p, 0, 1, "Holm's adjustment: a p-value");
  }
  std::vector<std::size_t> order(p_values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t i) { return p_values[i]; });
  std::vector<double> adjusted(p_values.size());
  double largest = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const auto hypotheses = static_cast<double>(order.size() - i);  // those not yet rejected
    largest = std::max(largest, std::min(1.0, hypotheses * p_values[order[i]]));
    adjusted[order[i]] = largest;
  }
  return adjusted;
}

}  // namespace armwright
