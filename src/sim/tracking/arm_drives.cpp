#include "sim/tracking/arm_drives.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "base/error.hpp"
#include "base/text.hpp"
#include "sim/dynamics/drive_loop.hpp"

namespace armwright {
const std::vector<std::string>& control_interface_names() {
  static const std::vector<std::string> names = {"effort", "velocity", "position"};
  return names;
}

articulated::CommandClock ArmDrives::make_clock(double control_period_s, int substeps) const {
  return {.substeps = substeps,
          .delay = static_cast<int>(std::lround(delay_s * substeps / control_period_s)),
          .positions = interface == ControlInterface::position};
}

double ArmDrives::calc_lag_s() const {
  return has_loops() ? delay_s + 1 / bandwidth_rad_per_s : 0;
}

EffortLimits ArmDrives::get_command_limits(const Joint& joint, const EffortLimits& efforts) const {
  switch (interface) {
    case ControlInterface::effort:
      break;
    case ControlInterface::velocity:
      return {-joint.speed_limit, joint.speed_limit};
    case ControlInterface::position:
      return {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  }
  return efforts;
}

void check_interface(const ControllerRow& controller, const ArmDrives& drives) {
  if (controller.interface == drives.interface) {
    return;
  }
  const auto name = [](ControlInterface interface) {
    return control_interface_names()[static_cast<std::size_t>(interface)];
  };
  std::vector<std::string> others;
  for (const ControllerRow& row : controller_table()) {
    if (row.interface == drives.interface) {
      others.push_back(row.name);
    }
  }
  throw Error(
      ErrorKind::usage,
      fmt::format("controller '{}' needs control.interface = \"{}\", and it is \"{}\", whose "
                  "controllers are {}; change either",
                  controller.name, name(controller.interface), name(drives.interface),
                  join(others, ", ")));
}

void ArmDrives::set_numbers(const Joint& joint, double holding, double start,
                            const articulated::CommandClock& clock,
                            const std::function<void(int field, double number)>& set) const {
  using namespace articulated;
  set(kBandwidth, bandwidth_rad_per_s);
  set(kSpeedLimit, joint.speed_limit);
  set(kResolution, joint.kind == JointKind::revolute ? resolution_rad : resolution_m);
  set(kIntegralEffort, holding);
  set(kIntegralFree, 1);
  set(kSetpoint, start);
  for (int slot = 0; clock.positions && slot < clock.slots(); ++slot) {
    set(kDriveFields + slot, start);
  }
}

}  // namespace armwright
