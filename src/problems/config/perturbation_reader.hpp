// The table [perturbation] of a tracking problem (perturbation.hpp):
//   preset = NAME      a file of the same keys, shipped in configs/perturbations or given by its
//                      path; keys beside it go before its own
//   set = "plant/ID"   the plants' set
//   apply_to           "training", "judging" (validation, test and every evaluation of a given
//                      design) or "everywhere"
//   mass_relative, load_kg, viscous_friction_n_m_s_per_rad, coulomb_friction_n_m,
//   friction_transition_rad_per_s, quantisation_rad, delay_s, torque_ripple_relative,
//   ripple_cycles_per_turn, effort_limit_sigma, gain_sigma
// An empty list is none: of load_kg, the task's own.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/config.hpp"
#include "problems/tracking/perturbation.hpp"

namespace armwright {

struct ReadPerturbation {
  Perturbation perturbation;
  std::optional<std::filesystem::path> preset;  // the file that was read
  // KEY=VALUE texts that say what the preset said, without it.
  std::vector<std::string> settled;
};

// A preset by itself: the name of a shipped file, or a path. Error{usage} names file, line and key.
Perturbation load_perturbation(const std::string& preset, std::size_t joints);

// All keys as KEY=VALUE texts: in place of whatever a problem's table says.
std::vector<std::string> make_overrides(const Perturbation& perturbation);

// Error{usage} names file, line and key.
ReadPerturbation read_perturbation(const ConfigTable& table, std::size_t joints);

}  // namespace armwright
