// Reads what stands between the motors and the links of a compiled MJCF file.

#ifdef ARMWRIGHT_WITH_MUJOCO

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "sim/robot/mjcf_parts.hpp"

namespace armwright {
namespace {

struct EffortRange {
  double least = -kNoMjcfLimit, most = kNoMjcfLimit;

  void cut(double one, double other) {
    least = std::max(least, std::min(one, other));
    most = std::min(most, std::max(one, other));
  }
};

// Returns the efforts that an actuator can exert on its joint. A motor's force is its control times
// a constant. The force of a servo has no other bounds than its own.
EffortRange find_range(const mjModel& m, int actuator) {
  EffortRange force;
  if (m.actuator_forcelimited[actuator] != 0) {
    force.cut(m.actuator_forcerange[2 * actuator], m.actuator_forcerange[2 * actuator + 1]);
  }
  const bool is_motor = m.actuator_gaintype[actuator] == mjGAIN_FIXED &&
                        m.actuator_biastype[actuator] == mjBIAS_NONE &&
                        m.actuator_dyntype[actuator] != mjDYN_INTEGRATOR;
  if (is_motor && m.actuator_ctrllimited[actuator] != 0) {
    const double gain = m.actuator_gainprm[mjNGAIN * actuator];
    force.cut(gain * m.actuator_ctrlrange[2 * actuator],
              gain * m.actuator_ctrlrange[2 * actuator + 1]);
  }
  const double gear = m.actuator_gear[6 * actuator];
  if (gear == 0) {
    return {0, 0};
  }
  EffortRange effort;
  effort.cut(gear * force.least, gear * force.most);
  return effort;
}

}  // namespace

double find_effort_limit(const CompiledMjcf& mjcf, int joint, std::vector<std::string>& notes) {
  const mjModel& m = *mjcf.model;
  EffortRange sum{0, 0};
  bool is_driven = false;
  for (int actuator = 0; actuator < m.nu; ++actuator) {
    const int kind = m.actuator_trntype[actuator];
    if ((kind == mjTRN_JOINT || kind == mjTRN_JOINTINPARENT) &&
        m.actuator_trnid[2 * actuator] == joint) {
      const EffortRange range = find_range(m, actuator);
      sum.least += range.least;
      sum.most += range.most;
      is_driven = true;
    }
  }
  if (!is_driven) {
    sum = {};
  }
  // prepare_mjcf() passes actuatorfrcrange through the library as the joint's own data.
  if (m.nuser_jnt >= 2) {
    const mjtNum* const range = m.jnt_user + m.nuser_jnt * joint;
    if (range[0] < range[1]) {
      sum.cut(range[0], range[1]);
    }
  }
  if (sum.least == -sum.most) {
    return sum.most > 0 ? sum.most : kNoMjcfLimit;
  }
  const double smaller = std::min(-sum.least, sum.most);
  const double limit = smaller > 0 ? smaller : std::max(-sum.least, sum.most);
  notes.push_back(
      fmt::format("the actuators of joint '{}' exert {:.6g} to {:.6g} {}: its effort "
                  "limit is {:.6g}",
                  mjcf.joint_name(joint), sum.least, sum.most,
                  m.jnt_type[joint] == mjJNT_SLIDE ? "N" : "N m", limit));
  return limit;
}

JointPlant read_plant(const CompiledMjcf& mjcf, int id, const Joint& joint) {
  const mjModel& m = *mjcf.model;
  const int dof = m.jnt_dofadr[id];
  JointPlant plant;
  plant.armature = m.dof_armature[dof];
  plant.viscous = m.dof_damping[dof];
  plant.coulomb = m.dof_frictionloss[dof];
  const double stiffness = m.jnt_stiffness[id];
  for (const auto& [what, value] :
       {std::pair("armature", plant.armature), std::pair("damping", plant.viscous),
        std::pair("frictionloss", plant.coulomb), std::pair("stiffness", stiffness)}) {
    if (!std::isfinite(value) || value < 0) {
      mjcf.fail_joint(id, fmt::format("{} is {}; it must be finite and >= 0", what, value));
    }
  }
  if (stiffness == 0) {
    return plant;
  }
  // A counterbalance is straight between two points, so a linear spring is exact on the range.
  const bool is_bounded = std::isfinite(joint.lower) && joint.upper > joint.lower;
  if (!is_bounded ||
      (joint.kind == JointKind::revolute && joint.upper - joint.lower > 2 * std::numbers::pi)) {
    mjcf.fail_joint(
        id, fmt::format("has a spring (stiffness {:g}) and {}; a spring is simulated "
                        "over a finite range of at most one turn: give the joint such "
                        "a range, or set its stiffness to 0",
                        stiffness, is_bounded ? "a range of more than one turn" : "no range"));
  }
  const double rest = m.qpos_spring[m.jnt_qposadr[id]];
  plant.counterbalance = {joint.lower,
                          joint.upper,
                          {-stiffness * (joint.lower - rest), -stiffness * (joint.upper - rest)}};
  return plant;
}

}  // namespace armwright

#endif
