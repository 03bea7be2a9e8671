// Plants that differ from the one that a design was made for, drawn like test cases: the table
// [perturbation] of a problem. Plant k of a set of cases is a pure function of (name of the plants'
// set, name of the cases' set, k); it depends on nothing else, and each of its numbers comes from
// its own place in the stream, so that switching one kind on leaves the others as they were.
//
// With U uniform in [0, 1), N standard normal, each drawn anew for every number:
//   mass_relative x        each moving link's mass and inertia tensor times 1 + x (2 U - 1)
//   load_kg [l, u]         the load is l + (u - l) U, instead of the task's
//   viscous, coulomb       of each joint b = B U, c = C U (sim/plant_variation.hpp)
//   quantisation_rad       the same in every plant
//   delay_s d              d U, rounded to whole plant substeps
//   torque_ripple r        of each joint a = r U, its phase 2 pi U
//   effort_limit_sigma s   both effort limits of each joint times exp(-s |N|)
//   gain_sigma s           each gain times exp(s N)
// Inverse kinematics and targets are those of the nominal arm; torque that is counted is that of
// the design's own limits.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "problems/interface/problem.hpp"
#include "sim/tracking/design.hpp"
#include "sim/tracking/plant_variation.hpp"
#include "sim/tracking/task.hpp"

namespace armwright {

struct Perturbation {
  enum class Where { training, judging, everywhere };
  std::string set = "plant/1";
  Where where = Where::everywhere;
  double mass_relative = 0;
  std::optional<std::pair<double, double>> load_kg;  // nothing: the task's own
  std::vector<double> viscous_friction_n_m_s_per_rad, coulomb_friction_n_m;  // empty: none
  double friction_transition_rad_per_s = 0.05;
  double quantisation_rad = 0;
  double delay_s = 0;
  double torque_ripple_relative = 0;
  int ripple_cycles_per_turn = 12;
  double effort_limit_sigma = 0;
  double gain_sigma = 0;

  bool operator==(const Perturbation&) const = default;
  bool applies_to(CaseRole role) const;
  bool changes_arm() const { return mass_relative > 0 || load_kg; }
  bool changes_loop() const;  // anything of PlantVariation
  bool changes_design() const { return effort_limit_sigma > 0 || gain_sigma > 0; }
  bool changes_anything() const { return changes_arm() || changes_loop() || changes_design(); }
};

// One plant.
struct Plant {
  std::vector<double> mass_factors;  // one a moving link
  std::optional<double> load_kg;
  std::vector<double> limit_factors;              // one a joint
  std::vector<std::vector<double>> gain_factors;  // of each joint, kMostGains of them
  std::optional<PlantVariation> variation;

  static constexpr std::size_t kMostGains = 16;  // of one joint

  // The arm without its load, and the task with the plant's.
  RobotModel make_arm(RobotModel nominal) const;
  TrackingTask make_task(TrackingTask nominal) const;
  // What the controllers of this plant turn a design into; linear, so that it holds for changes of
  // a design as well. std::logic_error for more than kMostGains gains.
  void change_design(ArmDesign& design) const;
};

// The lists of friction are empty or have one number a joint.
Plant draw_plant(const Perturbation& perturbation, std::size_t joints, double substep_s,
                 std::string_view case_set, std::uint64_t number);

}  // namespace armwright
