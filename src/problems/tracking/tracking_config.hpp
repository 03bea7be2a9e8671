// The parts of a tracking problem as its file gives them, and what follows from them: the decision
// variables with their bounds, and the names and units of objectives, constraints and metrics.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "problems/interface/problem.hpp"
#include "problems/tracking/perturbation.hpp"
#include "problems/tracking/requirement.hpp"
#include "problems/tracking/tracking_objective.hpp"
#include "sim/robot/tube.hpp"
#include "sim/tracking/design.hpp"
#include "sim/tracking/physics_engine.hpp"
#include "sim/tracking/task.hpp"
#include "sim/tracking/test_case.hpp"

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

// A number of the design that is a decision variable.
struct DesignParameter {
  enum class Kind {
    gain,
    effort_min,
    effort_max,
    length_scale,
    section_scale,
    tube_diameter,
    tube_wall,
    speed
  };
  std::size_t joint = 0;  // unused for the speed
  Kind kind = Kind::gain;
  std::size_t gain = 0;  // for a gain: its index among the controller's gains
};

// The value of variables.start that asks for a start made from the robot
// (problems/config/robot_proposal.hpp).
inline constexpr const char* kProposedStart = "proposed";
// The name that commands use for a problem's start, whatever it was made from.
inline constexpr const char* kStartDesign = "start";

// What a training case counts in which the arm loses its target.
//   ordered  Worse than any case in which the arm follows its target, and the worse the earlier the
//            simulation ended: if it ended after the share s of the case's time, every point counts as
//            cutoff_error_m (2 - s). A case that ran to its end with an error above kFailureError_m
//            keeps its error. If a case of a design fails, the objective counts the largest torque,
//            energy, duration, mass and deflection that the bounds allow, so no saving makes up for
//            failing.
//   thesis   As in the thesis (section 5.2.3): the points from the end of the simulation on count as
//            cutoff_error_m, and all other terms count as they are. All fallen arms look alike then,
//            and the one with the weakest motors is the best of them.
enum class FailureRule : std::uint8_t { ordered, thesis };
// Returns the names in the order of the enum.
const std::vector<std::string>& failure_rule_names();

struct TrackingConfig {
  std::string name;
  std::string summary;
  RobotModel robot;
  std::shared_ptr<const FittedPlant> fitted_plant;  // what the plant's file leaves uncertain
  double mass_scale = 1;  // the factor that all masses were multiplied by when the robot was loaded
  PlantScales plant_scales;  // likewise, of the robot's joints
  ArmTubes tubes;            // of which the robot's links are made; a design may have other ones
  TrackingTask task;
  WorkspaceSphere workspace;
  std::optional<TestCase> path;  // replaces the cases that are generated in the workspace
  EnginePair engines;            // both must be set
  double cutoff_error_m = 1.0;   // training only
  FailureRule failure_rule = FailureRule::ordered;
  TrackingObjective objective;
  Perturbation perturbation;
  ArmDesign start;
  bool own_effort_limits = false;  // whether a proposed start has the effort limits of the robot
  std::vector<DesignParameter> parameters;
  double bounds_factor = 100;
  bool within_effort_limits = false;  // limits the bounds of efforts to the robot's effort limits
  double length_bounds_factor = 1.5;
  double section_bounds_factor = 2;
  double speed_bounds_factor = 2;
  double torque_per_mass_n_m_per_kg = 0;  // of the motors; 0: motors have no mass
  std::vector<Requirement> requirements;

  // Returns whether the target never rests: on a path of the user's own without stops.
  bool never_rests() const { return path && path->continuous; }
};

// Returns the number of a design that a parameter stands for. For the speed, the design must have a
// speed of its own.
double& get_parameter(ArmDesign& design, const DesignParameter& parameter);

// Returns true for the two effort limits.
bool is_effort(const DesignParameter& parameter);
// Returns the parameter's factor: its bounds are the start value divided by it and times it. Sizes
// of tubes have bounds of their own instead.
double get_bounds_factor(const TrackingConfig& config, const DesignParameter& parameter);

// Return true if a decision variable changes the links or the speed.
bool changes_links(const TrackingConfig& config);
bool changes_speed(const TrackingConfig& config);

// Returns the distance (m) that the tip moves to each point of a case. Empty for a continuous path,
// which has no moves.
std::vector<double> list_moves_m(const TrackingConfig& config);
// Returns the duration (s) of a case under `task`. The rounding of each move to whole control
// periods is not included.
double calc_case_duration_s(const TrackingConfig& config, const TrackingTask& task);

// Return true if evaluations have the metrics "duration", "moving_mass" and "deflection". Other
// problems do not have them, so that their records stay the same.
bool has_duration_metric(const TrackingConfig& config);
bool has_mass_metric(const TrackingConfig& config);
bool has_deflection_metric(const TrackingConfig& config);

// Throws Error{usage} if a variable has no bounds because it starts at 0, starts beyond the joint's
// effort limit, or spans more than floating-point numbers can hold.
ProblemDescription make_tracking_description(const TrackingConfig& config);

}  // namespace armwright
