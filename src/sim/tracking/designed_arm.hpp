// The arm and the task of a design: what an ArmDesign changes beside controllers and limits.
//
// Stretching. The link that a joint moves becomes L times as long, along the vector d from its
// joint to the next one (or to the tip), and its section S times as large, that is sqrt(S) times as
// wide in every direction across d: each of its points r goes to
//   A r,  A = sqrt(S) 1 + (L - sqrt(S)) d d'.
// At the same density its mass becomes det A = L S times as large, its centre of mass A com, its
// second moments about it K = integral of r r' dm become L S A K A', and its inertia
// tr(K) 1 - K. The next joint and what it carries move with the link's end and are not turned.
//
// Motors. A motor of torque per mass k weighs tau / k, tau the larger of its joint's two limits. It
// is a point mass at its joint's origin that the link before carries; that of joint 1 stands on the
// base and moves nothing. Motors come on top of the masses that the robot's file has.
#pragma once

#include "sim/tracking/tracking.hpp"

namespace armwright {

// Error{usage} unless both scales are finite and > 0; Error{bad_data} if the next joint or the tip
// lies in the link's own joint, which leaves no direction.
RobotModel stretch_link(RobotModel model, std::size_t link, double length_scale,
                        double section_scale);

// The arm of a design, without load. `torque_per_mass_n_m_per_kg` of its motors; 0: they weigh
// nothing.
RobotModel make_robot(const RobotModel& nominal, const ArmDesign& design,
                      double torque_per_mass_n_m_per_kg);
TrackingTask make_task(TrackingTask nominal, const ArmDesign& design);

// Whether stretched links make it another arm than the robot's.
bool is_stretched(const ArmDesign& design);
double calc_moving_mass_kg(const RobotModel& model);  // of all links but the base

}  // namespace armwright
