#include "sim/tracking/design.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/text.hpp"

namespace armwright {

double calc_largest_effort(const JointDrive& joint) {
  return std::max(-joint.limits.min, joint.limits.max);
}

double calc_total_effort(const ArmDesign& design) {
  double total = 0;
  for (const JointDrive& joint : design.joints) {
    total += calc_largest_effort(joint);
  }
  return total;
}

EffortTotals calc_effort_totals(const ArmDesign& design, const RobotModel& robot) {
  EffortTotals totals;
  for (std::size_t i = 0; i < design.joints.size(); ++i) {
    std::optional<double>& total =
        robot.joints[i].kind == JointKind::revolute ? totals.torque_n_m : totals.force_n;
    total = total.value_or(0) + calc_largest_effort(design.joints[i]);
  }
  return totals;
}

namespace {

bool is_without_effort(const JointDrive& drive) {
  return drive.limits.min == 0 && drive.limits.max == 0 &&
         std::ranges::all_of(drive.gains, [](double gain) { return gain == 0; });
}

}  // namespace

void check_unactuated(const ArmDesign& design, const RobotModel& robot) {
  for (std::size_t i = 0; i < design.joints.size(); ++i) {
    if (robot.joints[i].plant.unactuated && !is_without_effort(design.joints[i])) {
      throw Error(ErrorKind::usage,
                  fmt::format("joint '{}' is unactuated, so it has no controller; the design must "
                              "have 0 for all its gains and both effort limits",
                              sanitize(robot.joints[i].name)));
    }
  }
}

ArmDesign convert_design(const ArmDesign& design, std::string_view controller, double period_s,
                         double lag_s) {
  if (design.controller == controller) {
    return design;
  }
  const ControllerRow& row = find_controller(controller);
  if (design.controller != "pid") {
    throw Error(ErrorKind::usage,
                fmt::format("the start design is for controller '{}'; only a design for 'pid' can "
                            "be converted to '{}'; name another start",
                            design.controller, row.name));
  }
  ArmDesign converted = design;  // links, limits and speed stay
  converted.controller = row.name;
  for (std::size_t joint = 0; joint < design.joints.size(); ++joint) {
    const JointDrive& pid = design.joints[joint];
    JointDrive& drive = converted.joints[joint];
    drive.gains.assign(row.gains.size(), 0.0);
    if (is_without_effort(pid)) {
      continue;
    }
    row.convert({pid.gains.at(0), pid.gains.at(1), pid.gains.at(2), calc_largest_effort(pid),
                 period_s, lag_s},
                drive.gains.data());
    for (std::size_t gain = 0; gain < drive.gains.size(); ++gain) {
      if (!std::isfinite(drive.gains[gain])) {
        throw Error(
            ErrorKind::usage,
            fmt::format("joint {} of the start cannot be converted to '{}': its PID has p = {}, "
                        "i = {}, d = {} and an effort limit of {} N m, so {} would be {}; "
                        "name another start",
                        joint + 1, row.name, pid.gains[0], pid.gains[1], pid.gains[2],
                        calc_largest_effort(pid), row.gains[gain].key, drive.gains[gain]));
      }
    }
  }
  return converted;
}

}  // namespace armwright
