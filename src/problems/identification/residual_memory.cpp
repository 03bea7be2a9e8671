#include "problems/identification/residual_memory.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace armwright {
namespace {

// The power gain of white noise by the filter of log_samples.hpp, forwards and backwards, is that of
// an ideal one with this share of its cut-off: the integral of 1 / (1 + x^8)^2 from 0 on.
const double kNoiseBand = 7.0 / 8 * (std::numbers::pi / 8) / std::sin(std::numbers::pi / 8);

}  // namespace

double calc_correlation(std::span<const double> values, std::size_t lag) {
  double sum = 0, squares = 0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    squares += values[k] * values[k];
    sum += k >= lag ? values[k] * values[k - lag] : 0;
  }
  return squares > 0 ? sum / squares : 0;
}

double count_dependent(std::span<const double> values, double period_s, double cutoff_hz) {
  const double filtered = cutoff_hz > 0 ? 1 / (2 * kNoiseBand * cutoff_hz * period_s) : 1;
  double sum = 1;
  const auto longest =
      static_cast<std::size_t>(kLongestMemory * static_cast<double>(values.size()));
  for (std::size_t lag = 1; lag < longest; ++lag) {
    const double correlation = calc_correlation(values, lag);
    if (correlation <= 0) {
      break;
    }
    sum += 2 * correlation;
  }
  return std::max({1.0, filtered, sum});
}

}  // namespace armwright
