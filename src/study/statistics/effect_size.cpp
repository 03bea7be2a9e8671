#include "study/statistics/effect_size.hpp"

#include <stdexcept>

#include "study/statistics/values.hpp"

namespace armwright {

double calc_a12(std::span<const double> a, std::span<const double> b) {
  if (a.empty() || b.empty()) {
    throw std::invalid_argument("A12: there are no values");
  }
  check_values(a, "A12");
  check_values(b, "A12");
  double better = 0;  // in halves and wholes: exact
  for (const double x : a) {
    for (const double y : b) {
      better += x < y ? 1 : (x == y ? 0.5 : 0);
    }
  }
  return better / (static_cast<double>(a.size()) * static_cast<double>(b.size()));
}

WinTieLoss count_wins(std::span<const double> a, std::span<const double> b) {
  check_pairs(a, b, "wins");
  WinTieLoss count;
  for (std::size_t i = 0; i < a.size(); ++i) {
    ++(a[i] < b[i] ? count.wins : (a[i] == b[i] ? count.ties : count.losses));
  }
  return count;
}

}  // namespace armwright
