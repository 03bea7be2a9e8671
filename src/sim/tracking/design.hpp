// A design: what an optimization chooses. It has one controller with effort limits per joint.
// Optionally it also changes the links and the speed (designed_arm.hpp).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/controllers/controller.hpp"
#include "sim/robot/tube.hpp"

namespace armwright {

struct JointDrive {
  std::vector<double> gains;  // in the order of the controller's ControllerRow::gains
  EffortLimits limits;
  double length_scale = 1;  // of the link that the joint moves
  double section_scale = 1;
  Tube tube = {};  // that the link is; a diameter of 0: it is none, or that of the problem
};

struct ArmDesign {
  std::string controller = "pid";
  std::vector<JointDrive> joints;
  std::optional<double> speed_m_per_s;  // empty: the task's speed
};

// Returns the larger of a joint's two effort limits, max(-min, max), in N m or N.
double calc_largest_effort(const JointDrive& joint);
// Returns the sum of the largest efforts over the joints: the thesis's total torque magnitude. The
// unit is N m if all joints are revolute. Objectives count the efforts of all joints alike, in N m
// and N; EffortTotals is what results show.
double calc_total_effort(const ArmDesign& design);

// The sums of the largest efforts of the joints that turn, and of those that slide.
struct EffortTotals {
  std::optional<double> torque_n_m;  // nothing if no joint turns
  std::optional<double> force_n;     // nothing if no joint slides
};
EffortTotals calc_effort_totals(const ArmDesign& design, const RobotModel& robot);

// Throws Error{usage} if the design has a gain or an effort limit for an unactuated joint.
void check_unactuated(const ArmDesign& design, const RobotModel& robot);

// Returns the design itself if it is for the given controller. From a PID design it makes one for
// that controller: ControllerRow::convert computes the gains, and the rest stays. Throws
// Error{usage} for a design of any other controller, and if a gain is not finite. Joints whose gains
// and limits are all 0 keep gains of 0. `lag_s` is that of
// the arm's drives (ArmDrives::calc_lag_s()).
ArmDesign convert_design(const ArmDesign& design, std::string_view controller, double period_s,
                         double lag_s = 0);

}  // namespace armwright
