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

std::unique_ptr<Controller> make_pid(std::span<const double> gains, EffortLimits limits,
                                     JointKind kind) {
  if (gains.size() != 3) {
    throw Error(ErrorKind::usage,
                fmt::format("controller 'pid': {} gains are given; it takes exactly 3: p, i, d",
                            gains.size()));
  }
  return std::make_unique<PidController>(gains[0], gains[1], gains[2], limits, kind);
}

}  // namespace

PidController::PidController(double p_n_m_per_rad, double i_n_m_per_rad_s, double d_n_m_s_per_rad,
                             EffortLimits limits, JointKind kind)
    : p_(p_n_m_per_rad), i_(i_n_m_per_rad_s), d_(d_n_m_s_per_rad), limits_(limits), kind_(kind) {
  require_finite("p_n_m_per_rad", p_);
  require_finite("i_n_m_per_rad_s", i_);
  require_finite("d_n_m_s_per_rad", d_);
  if (!(limits_.min_n_m <= limits_.max_n_m)) {
    throw Error(
        ErrorKind::usage,
        fmt::format("controller 'pid': the effort limits are {} to {} {}; the lower must "
                    "not exceed the upper",
                    limits_.min_n_m, limits_.max_n_m, kind == JointKind::prismatic ? "N" : "N m"));
  }
}

double PidController::step(double setpoint, double measurement, double dt_s) {
  const double error = calc_displacement(kind_, measurement, setpoint);
  if (!saturated_) {
    integral_ += error * dt_s;
  }
  const double rate = first_ ? 0 : (error - previous_error_) / dt_s;
  const double wanted = p_ * error + i_ * integral_ + d_ * rate;
  saturated_ = wanted < limits_.min_n_m || wanted > limits_.max_n_m;
  previous_error_ = error;
  first_ = false;
  return std::clamp(wanted, limits_.min_n_m, limits_.max_n_m);
}

void PidController::reset() {
  integral_ = 0;
  previous_error_ = 0;
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
