#include "report/evidence/health.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <unsupported/Eigen/FFT>

namespace armwright {
namespace {

// Returns the largest number up to `most` without prime factors above 5. The transform of such a
// length is fast. `most` must be positive.
std::size_t find_smooth_length(std::size_t most) {
  for (std::size_t length = most;; --length) {
    std::size_t rest = length;
    for (const std::size_t factor : {2, 3, 5}) {
      while (rest % factor == 0) {
        rest /= factor;
      }
    }
    if (rest == 1) {
      return length;
    }
  }
}

}  // namespace

const char* to_string(HealthGrade grade) {
  switch (grade) {
    case HealthGrade::good:
      return "good";
    case HealthGrade::watch:
      return "watch";
    case HealthGrade::bad:
      break;
  }
  return "bad";
}

HealthGrade grade(double share, const HealthLimits& limits) {
  return share >= limits.bad     ? HealthGrade::bad
         : share >= limits.watch ? HealthGrade::watch
                                 : HealthGrade::good;
}

std::vector<double> calc_saturation(std::span<const TrackingResult> results) {
  std::vector<double> shares;
  double periods = 0;
  for (const TrackingResult& result : results) {
    shares.resize(std::max(shares.size(), result.saturated_share.size()));
    if (result.steps > 0 && !result.saturated_share.empty()) {
      periods += result.steps;
      for (std::size_t i = 0; i < result.saturated_share.size(); ++i) {
        shares[i] += result.steps * result.saturated_share[i];
      }
    }
  }
  if (periods == 0) {
    return {};
  }
  for (double& share : shares) {
    share /= periods;
  }
  return shares;
}

std::optional<Ripple> calc_ripple(std::span<const double> efforts, double period_s) {
  constexpr double kShortest_s = 1;
  // Rounding may put a frequency that equals the floor just above it.
  constexpr double kFloor_hz = kRippleFloor_hz * (1 + 1e-9);
  const bool is_finite = std::ranges::all_of(efforts, [](double u) { return std::isfinite(u); });
  const double duration_s = static_cast<double>(efforts.size()) * period_s;
  if (!is_finite || duration_s < kShortest_s || 0.5 / period_s <= kFloor_hz) {
    return std::nullopt;
  }
  const std::size_t length = find_smooth_length(efforts.size());
  const auto used = efforts.first(length);
  const std::vector<double> signal(used.begin(), used.end());
  std::vector<std::complex<double>> lines;
  Eigen::FFT<double>().fwd(lines, signal);
  const auto count = static_cast<double>(length);
  Ripple ripple;
  double sum = 0;
  double largest = 0;
  for (std::size_t m = 1; 2 * m <= length; ++m) {
    const double frequency_hz = static_cast<double>(m) / (count * period_s);
    if (frequency_hz <= kFloor_hz) {
      continue;
    }
    const double power = (2 * m == length ? 1 : 2) * std::norm(lines[m]);
    sum += power;
    if (power > largest) {
      largest = power;
      ripple.frequency_hz = frequency_hz;
    }
  }
  ripple.rms = std::sqrt(sum) / count;
  return ripple;
}

std::optional<double> calc_used_effort(std::span<const double> efforts, double min, double max) {
  if (efforts.empty()) {
    return std::nullopt;
  }
  double used = 0;
  for (const double effort : efforts) {
    const double limit = effort < 0 ? min : max;
    if (limit != 0) {
      used = std::max(used, effort / limit);
    }
  }
  return used;
}

std::optional<BoundDistance> calc_bound_distance(const DecisionVariable& variable, double x) {
  const double lower = variable.lower;
  const double upper = variable.upper;
  if (lower == upper) {
    return std::nullopt;
  }
  const double place = variable.scale == Scale::logarithmic
                           ? std::log(x / lower) / std::log(upper / lower)
                           : (x - lower) / (upper - lower);
  return BoundDistance{.distance = std::min(place, 1 - place), .is_upper = place > 0.5};
}

std::vector<VariablePlace> list_bound_places(std::span<const DecisionVariable> variables,
                                             std::span<const double> x) {
  std::vector<VariablePlace> places;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const DecisionVariable& variable = variables[i];
    const bool has_two_values =
        variable.type == VariableType::integer && variable.upper - variable.lower < 2;
    if (variable.type == VariableType::category || has_two_values) {
      continue;
    }
    if (const auto distance = calc_bound_distance(variable, x[i])) {
      places.push_back({i, *distance});
    }
  }
  std::ranges::stable_sort(places, {}, [](const VariablePlace& one) { return one.to.distance; });
  return places;
}

}  // namespace armwright
