#include "study/statistics/summary.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "study/statistics/spread.hpp"

namespace armwright {
namespace {

// Beside an infinity there is no number to interpolate to.
std::optional<double> find_finite_quantile(std::span<const double> values, double p) {
  const double value = calc_quantile(values, p);
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

}  // namespace

ErrorSummary summarize(std::span<const double> errors, double failure_error) {
  ErrorSummary summary;
  summary.cases = errors.size();
  std::vector<double> numbers;
  double sum = 0;
  for (const double error : errors) {
    if (std::isnan(error)) {
      ++summary.without_number;
      ++summary.failures;
      numbers.push_back(std::numeric_limits<double>::infinity());
      continue;
    }
    sum += error;
    summary.failures += error > failure_error ? 1 : 0;
    numbers.push_back(error);
  }
  if (summary.without_number == summary.cases) {
    return summary;
  }
  summary.mean = sum / static_cast<double>(summary.cases - summary.without_number);
  summary.median = find_finite_quantile(numbers, 0.5);
  summary.percentile_95 = find_finite_quantile(numbers, 0.95);
  if (summary.without_number == 0) {
    summary.worst = *std::ranges::max_element(numbers);
  }
  return summary;
}

}  // namespace armwright
