// Plants that differ from the nominal one, drawn per test case: the table [perturbation] of a
// problem. Plant k of a set of cases is a pure function of (name of the plants' set, name of the
// cases' set, k). Each of its numbers has a fixed place in the random stream, so switching one kind
// of perturbation on does not change the others.
//
// With U uniform in [0, 1), N standard normal, each drawn anew for every number:
//   mass_relative x        each moving link's mass and inertia tensor times 1 + x (2 U - 1)
//   load_kg [l, u]         the load is l + (u - l) U and replaces the task's
//   viscous, coulomb       of each joint b = B U, c = C U (sim/tracking/plant_variation.hpp)
//   friction shares        the same U: the joint's plant (sim/robot/joint_plant.hpp) gets viscous
//                          friction share x effort x U more, and Coulomb friction likewise. The
//                          effort is the larger effort limit of the problem's start
//   friction_relative x    the joint's friction in the plant (d, c, s_t and o) times 1 + x (2 U - 1)
//   armature_relative x    the joint's armature times 1 + x (2 U - 1)
//   stiffness_relative x   the joint's stiffness and damping times 1 + x (2 U - 1)
//   quantisation_rad       the same in every plant
//   delay_s d              d U, rounded to whole substeps of the physics
//   torque_ripple r        of each joint a = r U, its phase 2 pi U
//   effort_limit_sigma s   both effort limits of each joint times exp(-s |N|)
//   gain_sigma s           each gain times exp(s N)
//   fitted                 the parameters that an identification fitted are drawn from their
//                          distribution, or are those of one of its corners, in turn
//                          (sim/identification/fitted_plant.hpp); the other changes come after that
// Inverse kinematics and targets are those of the nominal arm. The total torque counts the effort
// limits of the unperturbed design.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "problems/interface/problem.hpp"
#include "sim/identification/fitted_plant.hpp"
#include "sim/tracking/design.hpp"
#include "sim/tracking/plant_variation.hpp"
#include "sim/tracking/task.hpp"
#include "sim/tracking/tracking_setup.hpp"

namespace armwright {

// The ranges and spreads that plants are drawn from.
struct Perturbation {
  // The roles of the cases that have perturbed plants; `judging` is validation and test.
  enum class Where { training, judging, everywhere };
  std::string set = "plant/1";
  Where where = Where::everywhere;
  double mass_relative = 0;
  std::optional<std::pair<double, double>> load_kg;  // nothing: the task's load
  // The lightest and heaviest load as shares of the mass of the moving links. The reader makes
  // load_kg of it. Without it, load_kg has the load in kg, or the load is the task's.
  std::optional<std::pair<double, double>> load_share;
  // One number per joint; empty: no friction.
  std::vector<double> viscous_friction_n_m_s_per_rad, coulomb_friction_n_m;
  double friction_transition_rad_per_s = 0.05;
  // Largest viscous friction (at 1 rad/s or 1 m/s) and Coulomb friction as shares of the effort.
  double viscous_friction_share = 0, coulomb_friction_share = 0;
  std::vector<double> efforts;  // N m or N, one per joint; the reader sets them for the shares
  // Spreads around the plant's own values.
  double friction_relative = 0, armature_relative = 0, stiffness_relative = 0;
  double quantisation_rad = 0;
  double delay_s = 0;
  double torque_ripple_relative = 0;
  int ripple_cycles_per_turn = 12;
  double effort_limit_sigma = 0;
  double gain_sigma = 0;
  enum class Fitted { none, draws, corners };
  Fitted fitted = Fitted::none;
  std::shared_ptr<const FittedPlant> fitted_plant;  // of the robot; set unless `fitted` is none

  bool operator==(const Perturbation&) const = default;
  // Returns true if cases of that role have perturbed plants.
  bool applies_to(CaseRole role) const;
  bool changes_arm() const {
    return mass_relative > 0 || load_kg || changes_joints() || fitted != Fitted::none;
  }
  bool changes_joints() const;  // a part of JointPlant
  bool changes_loop() const;    // a part of PlantVariation
  bool changes_design() const { return effort_limit_sigma > 0 || gain_sigma > 0; }
  bool changes_anything() const { return changes_arm() || changes_loop() || changes_design(); }
};

// One perturbed plant.
struct Plant {
  std::vector<double> mass_factors;               // one per moving link
  std::optional<double> load_kg;                  // nothing: the task's load
  std::vector<double> limit_factors;              // one per joint
  std::vector<std::vector<double>> gain_factors;  // kMostGains per joint
  std::vector<double> viscous, coulomb;           // added friction, one number per joint
  std::vector<double> friction_factors, armature_factors, stiffness_factors;  // one per joint
  std::optional<PlantVariation> variation;
  std::shared_ptr<const FittedPlant> fitted_plant;  // null: the nominal parameters
  std::vector<double> fitted_values;                // one per parameter of `fitted_plant`
  // The problem's own arm and task with this plant's masses and load. Nothing if both are nominal.
  // TrackingInputs sets it.
  std::optional<TrackingSetup> setup;

  static constexpr std::size_t kMostGains = 18;  // per joint

  // Returns the arm with this plant's masses and joints; neither arm has its load.
  RobotModel make_arm(RobotModel nominal) const;
  // Returns the task with this plant's load.
  TrackingTask make_task(TrackingTask nominal) const;
  // Changes a design's gains and effort limits into those that this plant has. The change is
  // linear, so it is right for directions in the design space too. Throws std::logic_error if a
  // joint has more than kMostGains gains.
  void change_design(ArmDesign& design) const;
  // Returns the memory that the plant takes, rounded up generously.
  std::size_t size_bytes() const;
};

// Returns plant `number` for the cases of `case_set`, without `setup`. `substep_s` is the length of
// a plant substep.
Plant draw_plant(const Perturbation& perturbation, std::size_t joints, double substep_s,
                 std::string_view case_set, std::uint64_t number);

// Returns in words how the plants of that role's cases differ from each other, "drawn from the fit of
// trajectory-A.csv (38 parameters), masses +-10 %". Empty if all of them have the nominal plant.
std::string describe_plants(const Perturbation& perturbation, CaseRole role);

// Returns the arm of the perturbation's plants whose springs move fastest: each joint has the
// largest stiffness and damping and the smallest armature, each link the smallest mass.
RobotModel make_fastest_arm(RobotModel nominal, const Perturbation& perturbation);

}  // namespace armwright
