#include "study/statistics/summary.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "base/random.hpp"
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

// Returns nothing if the quantile is infinite: a case without number decides it.
std::optional<double> find_finite_quantile(std::span<const double> values, double p) {
  const double value = calc_quantile(values, p);
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
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

Interval calc_percentile_interval(std::span<const double> resampled, double level) {
  if (!(level > 0 && level < 1)) {
    throw std::invalid_argument("bootstrap: the level must lie between 0 and 1");
  }
  if (resampled.empty()) {
    throw std::invalid_argument("bootstrap: there must be at least one resample");
  }
  return {.lower = calc_quantile(resampled, (1 - level) / 2),
          .upper = calc_quantile(resampled, (1 + level) / 2)};
}

Interval calc_bootstrap_interval(std::span<const double> values, const Statistic& statistic,
                                 double level, int resamples, std::string_view stream) {
  if (values.empty()) {
    throw std::invalid_argument("bootstrap: there are no values");
  }
  check_values(values, "bootstrap");
  RandomStream random(stream);
  std::vector<double> resampled;
  std::vector<double> drawn(values.size());
  for (int resample = 0; resample < resamples; ++resample) {
    for (double& value : drawn) {
      value = values[random.below(values.size())];
    }
    resampled.push_back(statistic(drawn));
  }
  return calc_percentile_interval(resampled, level);
}

Interval calc_median_interval(std::span<const double> values, double level, int resamples,
                              std::string_view stream) {
  return calc_bootstrap_interval(
      values, [](std::span<const double> drawn) { return calc_quantile(drawn, 0.5); }, level,
      resamples, stream);
}

MeanAndError calc_mean_and_error(std::span<const double> values) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  double count = 0;
  double sum = 0;
  for (const double value : values) {
    if (!std::isnan(value)) {
      sum += value;
      ++count;
    }
  }
  if (count == 0) {
    return {kNone, kNone};
  }
  const double mean = sum / count;
  double squares = 0;
  for (const double value : values) {
    if (!std::isnan(value)) {
      squares += (value - mean) * (value - mean);
    }
  }
  return {mean, count > 1 ? std::sqrt(squares / (count - 1) / count) : kNone};
}

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
