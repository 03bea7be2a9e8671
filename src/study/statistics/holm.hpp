// Several tests at once: p-values adjusted so that, rejecting those of at most alpha, any true
// hypothesis is rejected with probability alpha at most, however the tests depend on each other.
// Source: Holm, S. 1979, A simple sequentially rejective multiple test procedure, Scandinavian
// Journal of Statistics 6(2). The i-th smallest of m is multiplied by m - i + 1, is never below the
// one before, and never above 1.
#pragma once

#include <span>
#include <vector>

namespace armwright {

// In the order in which they came. Throws std::invalid_argument for what is no probability.
std::vector<double> adjust_holm(std::span<const double> p_values);

}  // namespace armwright
