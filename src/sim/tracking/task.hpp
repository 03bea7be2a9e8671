// The tracking task: how the target moves, how fast the controllers sample, and the physics. It
// holds everything that is the same for every design and every test case.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/controllers/law_types.hpp"
#include "sim/kinematics/arm_clearance.hpp"
#include "sim/kinematics/numeric_kinematics.hpp"
#include "sim/kinematics/targets.hpp"
#include "sim/kinematics/tool_task.hpp"
#include "sim/robot/robot_model.hpp"
#include "sim/tracking/arm_drives.hpp"

namespace armwright {

struct PhysicsSettings {
  double gravity_m_per_s2 = 9.80665;
  // Plant steps per control period; the command is held. The published gains need exactly 1.
  int substeps = 1;
  // ODE only: share of a joint's position error that one step corrects (thesis: damping 1/25 s).
  double erp = 0.25;
  double cfm = 0;  // ODE only: constraint softness
};

// The inverse kinematics: the closed form of a palletiser (kinematics.hpp) or damped least squares
// (numeric_kinematics.hpp). `automatic` takes the closed form if it suits the robot and the task
// leaves the tool's orientation free.
enum class KinematicsChoice { automatic, palletiser, numeric };
const std::vector<std::string>& kinematics_names();  // in the order of the enum

// How a target's path has to respect the joints' ranges, the joints' speed limits, singularities,
// the floor and obstacles (path_check.hpp).
//   ignore   the path may violate any of them, as in the thesis
//   warn     inverse kinematics keeps the joints in their ranges
//   enforce  likewise; a case whose path violates any of them is not simulated
enum class LimitPolicy { ignore, warn, enforce };
const std::vector<std::string>& limit_policy_names();  // in the order of the enum

// The effort that the integrals of the controllers hold when these are enabled, at the start of a
// test case.
//   empty    nothing, as in version 1.0: the arm sags until they have filled
//   gravity  the arm in its first posture (TargetTable::holding_effort)
enum class ControlStart { empty, gravity };
const std::vector<std::string>& control_start_names();  // in the order of the enum

struct TrackingTask {
  SignalShape signal = SignalShape::complex;
  double speed_m_per_s = 1.5;  // v, nominal average speed
  // Moves shorter than this are slowed down by the factor distance / limit. 0: no move is.
  double distance_limit_m = 0.9;
  double trapezoid_acceleration_m_per_s2 = 15;
  double rest_s = 0.5;
  double control_period_s = 0.01;  // h
  ArmDrives drives;
  bool count_first_point = false;
  bool ik_bug = false;
  double load_kg = 0;
  std::optional<LoadBody> load_body;  // nothing: the load is a steel block (add_load())
  KinematicsChoice kinematics = KinematicsChoice::automatic;
  NumericSolver solver = NumericSolver::lanes;
  LimitPolicy limits = LimitPolicy::ignore;
  // The height in the world below which no link may be (floor_clearance.hpp). Nothing: no floor.
  std::optional<double> floor_m;
  // The obstacles and links from which the links stay `clearance_m` away or more. Null: there are none.
  std::shared_ptr<const ArmClearance> clearance;
  double clearance_m = 0;
  ToolTask tool;
  // Joint positions (rad or m) from which numeric kinematics search. Empty: middles of the ranges.
  std::vector<double> home;
  FeedForward feed_forward = FeedForward::none;  // the efforts that target tables hold
  ControlStart control_start = ControlStart::empty;
  PhysicsSettings physics;
};

}  // namespace armwright
