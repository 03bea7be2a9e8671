// The drives of an arm's joints: what the controllers command, and the numbers of the drives' inner
// loops (sim/dynamics/drive_loop.hpp has their equations).
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "sim/controllers/controller.hpp"

namespace armwright {

namespace articulated {
struct CommandClock;
}

const std::vector<std::string>& control_interface_names();  // in the order of the enum

struct ArmDrives {
  // With `effort` the controllers command the motors themselves, and all else is unused.
  ControlInterface interface = ControlInterface::effort;
  double bandwidth_rad_per_s = 0;  // w
  double delay_s = 0;              // from a command to its effect
  double resolution_rad = 0;       // of measured positions of revolute joints; 0: they are exact
  double resolution_m = 0;         // likewise of prismatic joints

  // Returns whether the drives have inner loops.
  bool has_loops() const { return interface != ControlInterface::effort; }
  // Returns whether the loops measure positions of finite resolution.
  bool has_resolution() const { return has_loops() && (resolution_rad > 0 || resolution_m > 0); }
  // Returns how long a drive takes to follow a command, roughly: delay_s + 1 / w; 0 without loops.
  double calc_lag_s() const;
  // Returns the drives' clock at the start of a case. The delay is rounded to whole substeps.
  articulated::CommandClock make_clock(double control_period_s, int substeps) const;
  // Returns the limits of a joint's command: the effort limits, the joint's speed limits, or none
  // for positions.
  EffortLimits get_command_limits(const Joint& joint, const EffortLimits& efforts) const;
  // Calls set(field, number) for the numbers of a joint's drive at the start of a case that are not
  // 0, but not for the effort limits. The fields are those of DriveField, followed by the commands.
  // `holding` is the effort that holds the joint at its position `start`.
  void set_numbers(const Joint& joint, double holding, double start,
                   const articulated::CommandClock& clock,
                   const std::function<void(int field, double number)>& set) const;
};

// Throws Error{usage} if the controller commands something else than the drives take.
void check_interface(const ControllerRow& controller, const ArmDrives& drives);

}  // namespace armwright
