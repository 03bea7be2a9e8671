#include "study/statistics/bootstrap.hpp"

#include <stdexcept>
#include <vector>

#include "base/random.hpp"
#include "study/statistics/spread.hpp"
#include "study/statistics/values.hpp"

namespace armwright {

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

}  // namespace armwright
