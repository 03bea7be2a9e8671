#include "sim/controller.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/text.hpp"
#include "sim/kinematics.hpp"

namespace armwright {
namespace {

void require_finite(const char* key, double value) {
  if (!std::isfinite(value)) {
    throw Error(ErrorKind::usage,
                fmt::format("controller 'pid': {} is {}; it must be finite", key, value));
  }
}

std::unique_ptr<Controller> make_pid(std::span<const double> gains, EffortLimits limits) {
  if (gains.size() != 3) {
    throw Error(ErrorKind::usage,
                fmt::format("controller 'pid': {} gains are given; it takes exactly 3: p, i, d",
                            gains.size()));
  }
  return std::make_unique<PidController>(gains[0], gains[1], gains[2], limits);
}

}  // namespace

PidController::PidController(double p_n_m_per_rad, double i_n_m_per_rad_s, double d_n_m_s_per_rad,
                             EffortLimits limits)
    : p_(p_n_m_per_rad), i_(i_n_m_per_rad_s), d_(d_n_m_s_per_rad), limits_(limits) {
  require_finite("p_n_m_per_rad", p_);
  require_finite("i_n_m_per_rad_s", i_);
  require_finite("d_n_m_s_per_rad", d_);
  if (!(limits_.min_n_m <= limits_.max_n_m)) {
    throw Error(ErrorKind::usage,
                fmt::format("controller 'pid': the effort limits are {} to {} N m; the lower must "
                            "not exceed the upper",
                            limits_.min_n_m, limits_.max_n_m));
  }
}

double PidController::step(double setpoint_rad, double measurement_rad, double dt_s) {
  const double error_rad = wrap_angle(setpoint_rad - measurement_rad);
  if (!saturated_) {
    integral_rad_s_ += error_rad * dt_s;
  }
  const double rate_rad_per_s = first_ ? 0 : (error_rad - previous_error_rad_) / dt_s;
  const double wanted_n_m = p_ * error_rad + i_ * integral_rad_s_ + d_ * rate_rad_per_s;
  saturated_ = wanted_n_m < limits_.min_n_m || wanted_n_m > limits_.max_n_m;
  previous_error_rad_ = error_rad;
  first_ = false;
  return std::clamp(wanted_n_m, limits_.min_n_m, limits_.max_n_m);
}

void PidController::reset() {
  integral_rad_s_ = 0;
  previous_error_rad_ = 0;
  first_ = true;
  saturated_ = false;
}

const std::vector<ControllerRow>& controller_table() {
  static const std::vector<ControllerRow> table = {
      {"pid",
       "discrete PID with clamped effort; does not integrate after a clamped step",
       {{"p", "p_n_m_per_rad", "N m/rad"},
        {"i", "i_n_m_per_rad_s", "N m/(rad s)"},
        {"d", "d_n_m_s_per_rad", "N m s/rad"}},
       make_pid},
  };
  return table;
}

std::vector<std::string> controller_names() {
  std::vector<std::string> names;
  for (const ControllerRow& row : controller_table()) {
    names.push_back(row.name);
  }
  return names;
}

const ControllerRow& find_controller(std::string_view name) {
  for (const ControllerRow& row : controller_table()) {
    if (row.name == name) {
      return row;
    }
  }
  throw Error(ErrorKind::usage, describe_unknown("controller", name, controller_names()));
}

}  // namespace armwright
