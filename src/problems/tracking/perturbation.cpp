#include "problems/tracking/perturbation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <stdexcept>

#include "base/random.hpp"
#include "base/text.hpp"

namespace armwright {
namespace {

constexpr std::size_t kFirstGains = 16;  // per joint, whose factors version 1.0 drew

bool has_any(const std::vector<double>& sizes) {
  return std::ranges::any_of(sizes, [](double size) { return size > 0; });
}

double get_size(const std::vector<double>& sizes, std::size_t joint) {
  return sizes.empty() ? 0 : sizes[joint];
}

}  // namespace

bool Perturbation::applies_to(CaseRole role) const {
  return changes_anything() &&
         (where == Where::everywhere || (where == Where::training) == (role == CaseRole::training));
}

bool Perturbation::changes_loop() const {
  return has_any(viscous_friction_n_m_s_per_rad) || has_any(coulomb_friction_n_m) ||
         quantisation_rad > 0 || delay_s > 0 || torque_ripple_relative > 0;
}

bool Perturbation::changes_joints() const {
  return viscous_friction_share > 0 || coulomb_friction_share > 0 || friction_relative > 0 ||
         armature_relative > 0 || stiffness_relative > 0;
}

RobotModel Plant::make_arm(RobotModel nominal) const {
  if (fitted_plant) {
    set_parameters(nominal, fitted_plant->parameters, fitted_values);
  }
  for (std::size_t i = 0; i < nominal.links.size(); ++i) {
    nominal.links[i].inertial.mass_kg *= mass_factors[i];
    nominal.links[i].inertial.inertia_kg_m2 *= mass_factors[i];
    JointPlant& plant = nominal.joints[i].plant;
    scale_friction(plant, friction_factors[i]);
    plant.viscous += viscous[i];
    plant.coulomb += coulomb[i];
    plant.armature *= armature_factors[i];
    scale_stiffness(plant, stiffness_factors[i]);
  }
  return nominal;
}

TrackingTask Plant::make_task(TrackingTask nominal) const {
  nominal.load_kg = load_kg.value_or(nominal.load_kg);
  return nominal;
}

void Plant::change_design(ArmDesign& design) const {
  for (std::size_t i = 0; i < design.joints.size(); ++i) {
    JointDrive& joint = design.joints[i];
    if (joint.gains.size() > kMostGains) {
      throw std::logic_error(fmt::format("a plant knows {} gains a joint, not {}",
                                         std::size_t{kMostGains}, joint.gains.size()));
    }
    for (std::size_t k = 0; k < joint.gains.size(); ++k) {
      joint.gains[k] *= gain_factors[i][k];
    }
    joint.limits.min *= limit_factors[i];
    joint.limits.max *= limit_factors[i];
  }
}

std::size_t Plant::size_bytes() const {
  // An estimate that is rather too large. In each form of the arm, a joint has about fifty numbers,
  // a name and its factors.
  constexpr std::size_t kJoint_bytes = 4096;
  std::size_t size = sizeof *this + mass_factors.size() * kJoint_bytes;
  if (setup) {
    for (const Joint& joint : setup->robot().joints) {
      size += 4 * sizeof(double) * joint.plant.counterbalance.efforts.size();
    }
  }
  return size;
}

Plant draw_plant(const Perturbation& perturbation, std::size_t joints, double substep_s,
                 std::string_view case_set, std::uint64_t number) {
  const Perturbation& p = perturbation;
  RandomStream random(fmt::format("{} for {}", p.set, case_set), number);
  Plant plant;
  const double load_share = random.uniform();
  const double delay_share = random.uniform();
  PlantVariation variation;
  for (std::size_t i = 0; i < joints; ++i) {
    plant.mass_factors.push_back(1 + p.mass_relative * (2 * random.uniform() - 1));
    const double viscous_share = random.uniform();
    const double coulomb_share = random.uniform();
    const double effort = get_size(p.efforts, i);
    variation.viscous_friction.push_back(get_size(p.viscous_friction_n_m_s_per_rad, i) *
                                         viscous_share);
    variation.coulomb_friction.push_back(get_size(p.coulomb_friction_n_m, i) * coulomb_share);
    plant.viscous.push_back(p.viscous_friction_share * effort * viscous_share);
    plant.coulomb.push_back(p.coulomb_friction_share * effort * coulomb_share);
    variation.torque_ripple.push_back(p.torque_ripple_relative * random.uniform());
    variation.ripple_phase_rad.push_back(2 * std::numbers::pi * random.uniform());
  }
  // A normal number takes an unknown count of numbers from the stream, so these come last.
  for (std::size_t i = 0; i < joints; ++i) {
    plant.limit_factors.push_back(std::exp(-p.effort_limit_sigma * std::abs(random.normal())));
  }
  for (std::size_t i = 0; i < joints; ++i) {
    std::vector<double>& factors = plant.gain_factors.emplace_back();
    for (std::size_t k = 0; k < kFirstGains; ++k) {
      factors.push_back(std::exp(p.gain_sigma * random.normal()));
    }
  }
  // Version 1.0 ended here, so these come after all others.
  for (std::size_t i = 0; i < joints; ++i) {
    plant.friction_factors.push_back(1 + p.friction_relative * (2 * random.uniform() - 1));
    plant.armature_factors.push_back(1 + p.armature_relative * (2 * random.uniform() - 1));
    plant.stiffness_factors.push_back(1 + p.stiffness_relative * (2 * random.uniform() - 1));
  }
  if (p.fitted != Perturbation::Fitted::none) {
    plant.fitted_plant = p.fitted_plant;
    plant.fitted_values = p.fitted == Perturbation::Fitted::draws
                              ? p.fitted_plant->draw(random)
                              : p.fitted_plant->get_corner(number);
  }
  // Controllers with more gains came later.
  for (std::vector<double>& factors : plant.gain_factors) {
    while (factors.size() < Plant::kMostGains) {
      factors.push_back(std::exp(p.gain_sigma * random.normal()));
    }
  }
  if (p.load_kg) {
    const auto [lower, upper] = *p.load_kg;
    plant.load_kg = lower + (upper - lower) * load_share;
  }
  if (p.changes_loop()) {
    variation.friction_transition_rate = p.friction_transition_rad_per_s;
    variation.quantum = p.quantisation_rad;
    variation.delay_substeps = static_cast<int>(std::lround(p.delay_s * delay_share / substep_s));
    variation.ripple_cycles_per_turn = p.ripple_cycles_per_turn;
    plant.variation = std::move(variation);
  }
  return plant;
}

std::string describe_plants(const Perturbation& p, CaseRole role) {
  if (!p.applies_to(role)) {
    return "";
  }
  std::vector<std::string> parts;
  const auto add = [&](const char* what, double size, double factor, const char* unit) {
    if (size > 0) {
      parts.push_back(fmt::format("{} {:.3g} {}", what, factor * size, unit));
    }
  };
  if (p.fitted != Perturbation::Fitted::none) {
    std::vector<std::string> logs;
    for (const std::string& log : p.fitted_plant->logs) {
      const std::filesystem::path file = log.substr(0, log.rfind(' '));  // without its hash
      logs.push_back(sanitize(file.filename().string()));
    }
    parts.push_back(fmt::format(
        "{} the fit of {} ({} parameters)",
        p.fitted == Perturbation::Fitted::draws ? "drawn from" : "corners of",
        logs.empty() ? "an unnamed log" : join(logs, ", "), p.fitted_plant->parameters.size()));
  }
  add("masses +-", p.mass_relative, 100, "%");
  if (p.load_kg) {
    parts.push_back(fmt::format("load {:.4g} to {:.4g} kg", p.load_kg->first, p.load_kg->second));
  }
  add("friction +-", p.friction_relative, 100, "%");
  add("armatures +-", p.armature_relative, 100, "%");
  add("stiffness +-", p.stiffness_relative, 100, "%");
  if (has_any(p.viscous_friction_n_m_s_per_rad) || has_any(p.coulomb_friction_n_m)) {
    parts.emplace_back("friction added at the joints");
  }
  add("viscous friction up to", p.viscous_friction_share, 100, "% of the effort");
  add("Coulomb friction up to", p.coulomb_friction_share, 100, "% of the effort");
  add("encoder steps of", p.quantisation_rad, 1, "rad");
  add("delay up to", p.delay_s, 1000, "ms");
  add("torque ripple up to", p.torque_ripple_relative, 100, "%");
  add("effort limits reduced, sigma", p.effort_limit_sigma, 100, "%");
  add("gains off, sigma", p.gain_sigma, 100, "%");
  return join(parts, ", ");
}

RobotModel make_fastest_arm(RobotModel nominal, const Perturbation& p) {
  return scale_plants(scale_masses(std::move(nominal), 1 - p.mass_relative),
                      {.armature = 1 - p.armature_relative, .stiffness = 1 + p.stiffness_relative});
}

}  // namespace armwright
