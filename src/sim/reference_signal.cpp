#include "sim/reference_signal.hpp"

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

ReferenceSignal::ReferenceSignal(SignalShape shape, double distance_m, double speed_m_per_s,
                                 double acceleration_m_per_s2)
    : shape_(shape),
      distance_m_(distance_m),
      speed_m_per_s_(speed_m_per_s),
      duration_s_(distance_m / speed_m_per_s) {
  require_positive("the distance", distance_m, "m");
  require_positive("the speed", speed_m_per_s, "m/s");
  require_positive("the duration (distance / speed)", duration_s_, "s");
  if (shape_ == SignalShape::trapezoid) {
    require_positive("the acceleration", acceleration_m_per_s2, "m/s^2");
    // The plateau ds = a t_a (t_m - t_a) solved for t_a, in the form that does not cancel where a
    // is large.
    const double rest_s2 = duration_s_ * duration_s_ - 4 * distance_m_ / acceleration_m_per_s2;
    if (rest_s2 >= 0) {
      acceleration_m_per_s2_ = acceleration_m_per_s2;
      ramp_up_s_ = 2 * distance_m_ / acceleration_m_per_s2 / (duration_s_ + std::sqrt(rest_s2));
    } else {
      shape_ = SignalShape::triangular;
    }
  }
  if (shape_ == SignalShape::triangular) {
    acceleration_m_per_s2_ = 4 * speed_m_per_s_ / duration_s_;
  }
}

double ReferenceSignal::calc_distance(double t_s) const {
  if (t_s >= duration_s_) {
    return distance_m_;
  }
  const double left_s = duration_s_ - t_s;
  const double a = acceleration_m_per_s2_;
  switch (shape_) {
    case SignalShape::step:
      return distance_m_;
    case SignalShape::ramp:
      return speed_m_per_s_ * t_s;  // before t_m it cannot round to above ds
    case SignalShape::trapezoid:
      if (t_s <= ramp_up_s_) {
        return 0.5 * a * t_s * t_s;
      }
      if (left_s <= ramp_up_s_) {
        return distance_m_ - 0.5 * a * left_s * left_s;
      }
      return a * ramp_up_s_ * (t_s - 0.5 * ramp_up_s_);
    case SignalShape::triangular:
      return t_s <= left_s ? 0.5 * a * t_s * t_s : distance_m_ - 0.5 * a * left_s * left_s;
    case SignalShape::complex:
      break;
  }
  // Complex, in x = v t / ds = t / t_m; the speed peaks at x = 0.4, where both pieces give ds / 2.
  const double x = t_s / duration_s_;
  if (x <= 0.4) {
    return distance_m_ * (25.0 / 8.0) * x * x;
  }
  const double left = 1 - x;
  return distance_m_ * (1 - (125.0 / 54.0) * left * left * left);
}

}  // namespace armwright
