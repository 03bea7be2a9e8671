// All that a tracking problem is made of, as a problem's file says it.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "problems/interface/problem.hpp"
#include "problems/tracking/perturbation.hpp"
#include "problems/tracking/requirement.hpp"
#include "problems/tracking/tracking_objective.hpp"
#include "sim/tracking/physics_engine.hpp"
#include "sim/tracking/tracking.hpp"

namespace armwright {

// The engines of a problem. Training may use another engine, or another precision, than validation,
// test and every evaluation of a given design.
struct EnginePair {
  std::shared_ptr<const PhysicsEngine> training;
  std::shared_ptr<const PhysicsEngine> judging;  // may be the same
  std::string training_name;
  std::string judging_name;

  const PhysicsEngine& get(CaseRole role) const {
    return role == CaseRole::training ? *training : *judging;
  }
};

// One number of the design that is optimized.
struct DesignParameter {
  enum class Kind { gain, effort_min, effort_max, length_scale, section_scale, speed };
  std::size_t joint = 0;  // not of the speed
  Kind kind = Kind::gain;
  std::size_t gain = 0;  // which one, for a gain
};

// What variables.start says where the design is to be made from the robot
// (problems/robot_proposal.hpp), and what commands call a problem's start whatever it is.
inline constexpr const char* kProposedStart = "proposed";
inline constexpr const char* kStartDesign = "start";

struct TrackingConfig {
  std::string name;
  std::string summary;
  RobotModel robot;
  double mass_scale = 1;  // what its masses were multiplied by when it was loaded
  TrackingTask task;
  WorkspaceSphere workspace;
  std::optional<TestCase> path;  // in place of cases generated in the workspace
  EnginePair engines;            // both must be there
  double cutoff_error_m = 1.0;   // training only
  TrackingObjective objective;
  Perturbation perturbation;
  ArmDesign start;
  std::vector<DesignParameter> parameters;
  double bounds_factor = 100;
  bool within_effort_limits = false;  // variables end at the limits of the robot's joints
  double length_bounds_factor = 1.5;
  double section_bounds_factor = 2;
  double speed_bounds_factor = 2;
  double torque_per_mass_n_m_per_kg = 0;  // of the motors; 0: they weigh nothing
  std::vector<Requirement> requirements;
};

}  // namespace armwright
