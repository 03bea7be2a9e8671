#include "sim/tracking/reference_signal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "base/error.hpp"
#include "base/text.hpp"

namespace armwright {
namespace {

void require_positive(std::string_view what, double value, std::string_view unit) {
  if (!(value > 0) || !std::isfinite(value)) {
    throw Error(ErrorKind::usage,
                fmt::format("reference signal: {} is {} {}; it must be finite and > 0", what,
                            format_exact(value), unit));
  }
}

}  // namespace

const std::vector<std::string>& signal_names() {
  static const std::vector<std::string> names = {"step", "ramp", "trapezoid", "triangular",
                                                 "complex"};
  return names;
}

SignalShape find_signal(const std::string& name) {
  const auto& names = signal_names();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) {
    throw Error(ErrorKind::usage, describe_unknown("reference signal", name, names));
  }
  return static_cast<SignalShape>(found - names.begin());
}

targets::SignalCurve make_signal_curve(SignalShape shape, double distance_m, double speed_m_per_s,
                                       double acceleration_m_per_s2) {
  targets::SignalCurve curve;
  curve.shape = shape;
  curve.distance_m = distance_m;
  curve.speed_m_per_s = speed_m_per_s;
  curve.duration_s = distance_m / speed_m_per_s;
  require_positive("the distance", distance_m, "m");
  require_positive("the speed", speed_m_per_s, "m/s");
  require_positive("the duration (distance / speed)", curve.duration_s, "s");
  if (curve.shape == SignalShape::trapezoid) {
    require_positive("the acceleration", acceleration_m_per_s2, "m/s^2");
    // Solves ds = a t_a (t_m - t_a) for t_a, in the form that does not cancel if a is large.
    const double rest_s2 =
        curve.duration_s * curve.duration_s - 4 * distance_m / acceleration_m_per_s2;
    if (rest_s2 >= 0) {
      curve.acceleration_m_per_s2 = acceleration_m_per_s2;
      curve.ramp_up_s =
          2 * distance_m / acceleration_m_per_s2 / (curve.duration_s + std::sqrt(rest_s2));
    } else {
      curve.shape = SignalShape::triangular;
    }
  }
  if (curve.shape == SignalShape::triangular) {
    curve.acceleration_m_per_s2 = 4 * speed_m_per_s / curve.duration_s;
  }
  return curve;
}

}  // namespace armwright
