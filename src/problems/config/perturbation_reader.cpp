// Reads perturbations of the plant, from files and from the command line.

#include <fmt/format.h>

#include <utility>

#include "base/text.hpp"
#include "problems/config/config_files.hpp"
#include "problems/config/problem_readers.hpp"

namespace armwright {
namespace {

// Single precision still tells apart angles of several turns that differ by this.
constexpr double kFinestQuantum_rad = 1e-6;
constexpr Range kFriction{.lower = 0, .upper = 1e6};

const Setting<std::string> kPlantPreset{
    "preset", "",
    "a shipped preset or a file with the same settings; settings beside it replace those of the "
    "preset"};
const Setting<std::string> kPlantSet{"set", Perturbation{}.set,
                                     "name of the set of plants, plant/ID"};
const Setting<std::string> kPlantApplyTo{
    "apply_to", one_of({"training", "judging", "everywhere"}),  // in the order of the enum
    "everywhere",
    "simulations with perturbed plants; judging: validation, test and every evaluation of a given "
    "design"};
const Setting<double> kPlantMass{"mass_relative",
                                 {.lower = 0, .upper = 0.9},
                                 Perturbation{}.mass_relative,
                                 "mass and inertia of each link differ by at most this share"};
const Setting<std::vector<double>> kPlantLoad{
    "load_kg",
    {.lower = 0, .upper = 1000},
    kNoDefault,
    "the lightest and the heaviest load, two numbers; []: the task's load"};
const Setting<std::vector<double>> kPlantViscousFriction{
    "viscous_friction_n_m_s_per_rad", kFriction, kNoDefault,
    "largest viscous friction, one number per joint; []: none"};
const Setting<std::vector<double>> kPlantCoulombFriction{
    "coulomb_friction_n_m", kFriction, kNoDefault,
    "largest Coulomb friction, one number per joint; []: none"};
const Setting<double> kPlantFrictionTransition{
    "friction_transition_rad_per_s",
    {.lower = 1e-6, .upper = 1e3},
    Perturbation{}.friction_transition_rad_per_s,
    "speed from which on Coulomb friction has its full size"};
const Setting<double> kPlantQuantisation{
    "quantisation_rad",
    {.lower = 0, .upper = 0.1},
    Perturbation{}.quantisation_rad,
    "measured joint positions are multiples of this; 0: they are exact"};
const Setting<double> kPlantDelay{"delay_s",
                                  {.lower = 0, .upper = 0.1},
                                  Perturbation{}.delay_s,
                                  "largest age of measured joint positions"};
const Setting<double> kPlantRipple{"torque_ripple_relative",
                                   {.lower = 0, .upper = 1},
                                   Perturbation{}.torque_ripple_relative,
                                   "largest torque ripple, as a share of the torque"};
const Setting<int> kPlantRippleCycles{"ripple_cycles_per_turn",
                                      {.lower = 1, .upper = 10000},
                                      Perturbation{}.ripple_cycles_per_turn,
                                      "cycles of the torque ripple per turn"};
const Setting<double> kPlantEffortSigma{
    "effort_limit_sigma",
    {.lower = 0, .upper = 2},
    Perturbation{}.effort_limit_sigma,
    "effort limits are multiplied by exp(-this |N|), N normally distributed"};
const Setting<double> kPlantGainSigma{
    "gain_sigma",
    {.lower = 0, .upper = 2},
    Perturbation{}.gain_sigma,
    "gains are multiplied by exp(this N), N normally distributed"};

std::vector<double> read_joints(const ConfigTable& table,
                                const Setting<std::vector<double>>& setting, std::size_t joints,
                                const std::vector<double>& fallback) {
  auto values = table.get_or(setting, fallback);
  if (table.has(setting) && !values.empty() && values.size() != joints) {
    table.refuse(setting, fmt::format("it must hold {} numbers, one a joint, or none", joints));
  }
  return values;
}

std::optional<std::pair<double, double>> read_load(
    const ConfigTable& table, std::optional<std::pair<double, double>> fallback) {
  const auto values = table.find(kPlantLoad);
  if (!values) {
    return fallback;
  }
  if (values->empty()) {
    return {};
  }
  if (values->size() != 2 || values->at(0) > values->at(1)) {
    table.refuse(kPlantLoad, "it must be two numbers, the lightest and the heaviest load, or none");
  }
  return std::pair(values->at(0), values->at(1));
}

std::string get_place(Perturbation::Where where) {
  return kPlantApplyTo.choices()[static_cast<std::size_t>(where)];
}

// Returns `p` with the values of the keys that are there.
Perturbation read_keys(const ConfigTable& table, std::size_t joints, Perturbation p) {
  using Where = Perturbation::Where;
  constexpr std::string_view kSetPrefix = "plant/";
  p.set = table.get_or(kPlantSet, p.set);
  if (!p.set.starts_with(kSetPrefix) || p.set.size() == kSetPrefix.size()) {
    table.refuse(kPlantSet, "a set of plants must be named plant/ID, as in plant/1");
  }
  const std::string where = table.get_or(kPlantApplyTo, get_place(p.where));
  p.where = where == "training"  ? Where::training
            : where == "judging" ? Where::judging
                                 : Where::everywhere;
  p.mass_relative = table.get_or(kPlantMass, p.mass_relative);
  p.load_kg = read_load(table, p.load_kg);
  p.viscous_friction_n_m_s_per_rad =
      read_joints(table, kPlantViscousFriction, joints, p.viscous_friction_n_m_s_per_rad);
  p.coulomb_friction_n_m =
      read_joints(table, kPlantCoulombFriction, joints, p.coulomb_friction_n_m);
  p.friction_transition_rad_per_s =
      table.get_or(kPlantFrictionTransition, p.friction_transition_rad_per_s);
  p.quantisation_rad = table.get_or(kPlantQuantisation, p.quantisation_rad);
  if (p.quantisation_rad > 0 && p.quantisation_rad < kFinestQuantum_rad) {
    table.refuse(kPlantQuantisation, "it must be 0 (none) or at least 1e-6");
  }
  p.delay_s = table.get_or(kPlantDelay, p.delay_s);
  p.torque_ripple_relative = table.get_or(kPlantRipple, p.torque_ripple_relative);
  p.ripple_cycles_per_turn = table.get_or(kPlantRippleCycles, p.ripple_cycles_per_turn);
  p.effort_limit_sigma = table.get_or(kPlantEffortSigma, p.effort_limit_sigma);
  p.gain_sigma = table.get_or(kPlantGainSigma, p.gain_sigma);
  return p;
}

Perturbation load_preset(const ConfigTable& preset, std::size_t joints) {
  Perturbation perturbation = read_keys(preset, joints, {});
  preset.refuse_unknown();
  return perturbation;
}

std::string write_list(const std::vector<double>& values) {
  std::vector<std::string> words;
  for (const double value : values) {
    words.push_back(format_exact(value));
  }
  return "[" + join(words, ",") + "]";
}

}  // namespace

const SettingTable kPerturbationSettings{
    .key = "perturbation",
    .settings = {&kPlantPreset, &kPlantSet, &kPlantApplyTo, &kPlantMass, &kPlantLoad,
                 &kPlantViscousFriction, &kPlantCoulombFriction, &kPlantFrictionTransition,
                 &kPlantQuantisation, &kPlantDelay, &kPlantRipple, &kPlantRippleCycles,
                 &kPlantEffortSigma, &kPlantGainSigma}};

Perturbation load_perturbation(const std::string& preset, std::size_t joints) {
  const auto file = resolve_config("perturbations", preset);
  return load_preset(ConfigTable::load(kPerturbationSettings, file), joints);
}

std::vector<std::string> make_overrides(const Perturbation& p) {
  std::vector<double> load_kg;
  if (p.load_kg) {
    load_kg = {p.load_kg->first, p.load_kg->second};
  }
  const std::pair<const AnySetting*, std::string> values[] = {
      {&kPlantPreset, "\"\""},
      {&kPlantSet, p.set},
      {&kPlantApplyTo, get_place(p.where)},
      {&kPlantMass, format_exact(p.mass_relative)},
      {&kPlantLoad, write_list(load_kg)},
      {&kPlantViscousFriction, write_list(p.viscous_friction_n_m_s_per_rad)},
      {&kPlantCoulombFriction, write_list(p.coulomb_friction_n_m)},
      {&kPlantFrictionTransition, format_exact(p.friction_transition_rad_per_s)},
      {&kPlantQuantisation, format_exact(p.quantisation_rad)},
      {&kPlantDelay, format_exact(p.delay_s)},
      {&kPlantRipple, format_exact(p.torque_ripple_relative)},
      {&kPlantRippleCycles, fmt::format("{}", p.ripple_cycles_per_turn)},
      {&kPlantEffortSigma, format_exact(p.effort_limit_sigma)},
      {&kPlantGainSigma, format_exact(p.gain_sigma)}};
  std::vector<std::string> overrides;
  for (const auto& [setting, value] : values) {
    overrides.push_back(fmt::format("{}.{}={}", kPerturbationSettings.key, setting->key, value));
  }
  return overrides;
}

Perturbation read_perturbation(const ConfigTable& table, std::size_t joints,
                               LoadedProblem& loaded) {
  Perturbation perturbation;
  if (!table.get(kPlantPreset).empty()) {
    const auto file = resolve_named(table, kPlantPreset, "perturbations");
    const ConfigTable preset = ConfigTable::load(kPerturbationSettings, file);
    perturbation = load_preset(preset, joints);
    table.settle(kPlantPreset, "");
    table.settle_missing(preset);
    add_input(loaded, file);
  }
  return read_keys(table, joints, perturbation);
}

}  // namespace armwright
