// How long residuals repeat: by the filter that they passed, and by what a model does not explain.
#pragma once

#include <cstddef>
#include <span>

namespace armwright {

// A sum over autocorrelations ends at the latest after this share of a motion.
inline constexpr double kLongestMemory = 0.2;

// Returns the autocorrelation at `lag` of numbers whose mean is 0.
double calc_correlation(std::span<const double> values, std::size_t lag);

// Returns how many samples of a signal of this period tell as much as an independent one: 1 and twice
// the sum of the autocorrelations before the first that is not above 0, at least what the logs' filter
// makes of white noise. `cutoff_hz` is 0 without a filter.
double count_dependent(std::span<const double> values, double period_s, double cutoff_hz);

}  // namespace armwright
