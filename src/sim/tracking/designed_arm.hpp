// The arm and the task of a design: what an ArmDesign changes beside controllers and limits.
//
// Stretching. The link that a joint moves becomes L times as long, along the unit vector d from its
// joint to the next one (or to the tip), and its section S times as large. It is then sqrt(S) times
// as wide in every direction perpendicular to d. Each of its points r moves to
//   A r,  A = sqrt(S) 1 + (L - sqrt(S)) d d'.
// At the same density, with K the second moments about the centre of mass (integral of r r' dm),
//   mass            becomes det A = L S times as large
//   centre of mass  becomes A com
//   K               becomes L S A K A', and the inertia is tr(K) 1 - K
// The next joint, and everything that it carries, moves with the link's end and is not turned.
//
// Tubes. A link that the design makes a tube (tube.hpp) is one with nothing else on it, L times as
// long as the nominal link. S must be 1.
//
// The capsules that stand for links (arm_clearance.hpp) get ends A r and the radius max(L, sqrt(S))
// times as large, so that they still hold the shapes. That of a tube is the tube with round ends.
//
// Motors. A motor of torque per mass k weighs tau / k, with tau the larger of its joint's two
// effort limits. It is a point mass at its joint's origin, carried by the link before. The motor of
// joint 1 stands on the base and moves nothing. Motors are added to the masses that the robot's
// file has.
#pragma once

#include <memory>

#include "sim/kinematics/arm_clearance.hpp"
#include "sim/robot/robot_model.hpp"
#include "sim/tracking/design.hpp"
#include "sim/tracking/task.hpp"

namespace armwright {

// Returns the model with one link stretched. Throws Error{usage} unless both scales are finite and
// > 0, and Error{bad_data} if the next joint or the tip lies in the link's own joint: the link then
// has no direction.
RobotModel stretch_link(RobotModel model, std::size_t link, double length_scale,
                        double section_scale);

// Returns the arm of a design, without load. `torque_per_mass_n_m_per_kg` is that of the motors;
// with 0 they weigh nothing. `material` is that of tubes. Throws what stretch_link() throws.
RobotModel make_robot(const RobotModel& nominal, const ArmDesign& design,
                      double torque_per_mass_n_m_per_kg, const TubeMaterial& material = {});
// Returns the task with the design's speed, if the design has one.
TrackingTask make_task(TrackingTask nominal, const ArmDesign& design);

// Returns the clearance of the design's arm. `nominal` is that of the nominal one, `robot`.
std::shared_ptr<const ArmClearance> make_clearance(const ArmClearance& nominal,
                                                   const RobotModel& robot,
                                                   const ArmDesign& design);

// Return whether the design changes the size of any link, and whether it makes any link a tube.
bool is_stretched(const ArmDesign& design);
bool has_tubes(const ArmDesign& design);
// Returns the deflection (m) of a design all of whose links are tubes, with a point mass at the tip.
double calc_deflection_m(const RobotModel& nominal, const ArmDesign& design,
                         const TubeMaterial& material, double payload_kg, double gravity_m_per_s2);
// Returns the mass of all links but the base.
double calc_moving_mass_kg(const RobotModel& model);

}  // namespace armwright
