#include "study/summary.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace armwright {
namespace {

// The q-quantile by linear interpolation between order statistics (Hyndman and Fan 1996, type 7).
std::optional<double> calc_quantile(const std::vector<double>& sorted, double q) {
  const double position = q * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(position);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  const double share = position - static_cast<double>(below);
  const double value =
      share == 0 ? sorted[below] : sorted[below] + share * (sorted[above] - sorted[below]);
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

}  // namespace

ErrorSummary summarize(std::span<const double> errors, double failure_error) {
  ErrorSummary summary;
  summary.cases = errors.size();
  std::vector<double> sorted;
  double sum = 0;
  for (const double error : errors) {
    if (std::isnan(error)) {
      ++summary.without_number;
      ++summary.failures;
      sorted.push_back(std::numeric_limits<double>::infinity());
      continue;
    }
    sum += error;
    summary.failures += error > failure_error ? 1 : 0;
    sorted.push_back(error);
  }
  if (summary.without_number == summary.cases) {
    return summary;
  }
  std::sort(sorted.begin(), sorted.end());
  summary.mean = sum / static_cast<double>(summary.cases - summary.without_number);
  summary.median = calc_quantile(sorted, 0.5);
  summary.percentile_95 = calc_quantile(sorted, 0.95);
  if (summary.without_number == 0) {
    summary.worst = sorted.back();
  }
  return summary;
}

}  // namespace armwright
