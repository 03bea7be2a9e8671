// The Kolmogorov-Smirnov statistic against the uniform distribution on [0, 1], scaled by the square
// root of the sample size.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace armwright {

// A correct sample exceeds this with probability 2 exp(-2 * 1.95^2) = 0.001 (asymptotic
// distribution; Smirnov 1948). Seeds are fixed, so a test that passes passes always.
constexpr double kKolmogorovSmirnovBound = 1.95;

inline double calc_kolmogorov_smirnov(std::vector<double> sample) {
  std::ranges::sort(sample);
  const auto count = static_cast<double>(sample.size());
  double distance = 0;
  for (std::size_t i = 0; i < sample.size(); ++i) {
    const auto below = static_cast<double>(i);
    distance = std::max({distance, sample[i] - below / count, (below + 1) / count - sample[i]});
  }
  return distance * std::sqrt(count);
}

}  // namespace armwright
