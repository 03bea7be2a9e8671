// Reads perturbations of the plant, from files and from the command line.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/folder.hpp"
#include "base/text.hpp"
#include "problems/config/config_files.hpp"
#include "problems/config/problem_readers.hpp"
#include "sim/tracking/designed_arm.hpp"

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
const Setting<std::vector<double>> kPlantLoadShare{
    "load_share",
    {.lower = 0, .upper = 10},
    kNoDefault,
    "the lightest and the heaviest load as shares of the mass of the moving links, two numbers; "
    "[]: the task's load"};
const Setting<double> kPlantViscousShare{
    "viscous_friction_share",
    {.lower = 0, .upper = 1},
    Perturbation{}.viscous_friction_share,
    "largest viscous friction at 1 rad/s or 1 m/s, as a share of each joint's effort limit at the "
    "start of the optimization"};
const Setting<double> kPlantCoulombShare{
    "coulomb_friction_share",
    {.lower = 0, .upper = 1},
    Perturbation{}.coulomb_friction_share,
    "largest Coulomb friction, as a share of the same effort limits"};
constexpr Range kSpread{.lower = 0, .upper = 0.9};
const Setting<double> kPlantFriction{
    "friction_relative", kSpread, Perturbation{}.friction_relative,
    "friction of the robot's joints differs by at most this share"};
const Setting<double> kPlantArmature{
    "armature_relative", kSpread, Perturbation{}.armature_relative,
    "armature of the robot's joints differs by at most this share"};
const Setting<double> kPlantStiffness{
    "stiffness_relative", kSpread, Perturbation{}.stiffness_relative,
    "stiffness of the robot's joints, and their damping, differ by at most this share"};
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

const Setting<std::string> kPlantFitted{
    "fitted", one_of({"none", "draws", "corners"}), kNoDefault,  // in the order of the enum
    "draws: the parameters in [identification] of the plant's file are drawn from their "
    "distribution; corners: they lie two standard deviations away along its main axes, in turn "
    "(default: draws if the plant's file has [identification])"};

std::vector<double> read_joints(const ConfigTable& table,
                                const Setting<std::vector<double>>& setting, std::size_t joints,
                                const std::vector<double>& fallback) {
  auto values = table.get_or(setting, fallback);
  if (table.has(setting) && !values.empty() && values.size() != joints) {
    table.refuse(setting, fmt::format("it must hold {} numbers, one a joint, or none", joints));
  }
  return values;
}

using Interval = std::optional<std::pair<double, double>>;

Interval read_interval(const ConfigTable& table, const Setting<std::vector<double>>& setting,
                       const Interval& fallback) {
  const auto values = table.find(setting);
  if (!values) {
    return fallback;
  }
  if (values->empty()) {
    return {};
  }
  if (values->size() != 2 || values->at(0) > values->at(1)) {
    table.refuse(setting, "it must be two numbers, the lightest and the heaviest load, or none");
  }
  return std::pair(values->at(0), values->at(1));
}

std::string get_place(Perturbation::Where where) {
  return kPlantApplyTo.choices()[static_cast<std::size_t>(where)];
}

std::string get_name(Perturbation::Fitted fitted) {
  return kPlantFitted.choices()[static_cast<std::size_t>(fitted)];
}

// Sets the loads and frictions in `p`.
void read_sizes(const ConfigTable& table, const PerturbedRobot& robot, Perturbation& p) {
  const std::size_t joints = robot.model.joint_count();
  p.load_kg = read_interval(table, kPlantLoad, p.load_kg);
  p.viscous_friction_n_m_s_per_rad =
      read_joints(table, kPlantViscousFriction, joints, p.viscous_friction_n_m_s_per_rad);
  p.coulomb_friction_n_m =
      read_joints(table, kPlantCoulombFriction, joints, p.coulomb_friction_n_m);
  p.load_share = read_interval(table, kPlantLoadShare, p.load_share);
  p.viscous_friction_share = table.get_or(kPlantViscousShare, p.viscous_friction_share);
  p.coulomb_friction_share = table.get_or(kPlantCoulombShare, p.coulomb_friction_share);
  if (p.load_kg && p.load_share && table.has(kPlantLoad)) {
    table.refuse(kPlantLoadShare, "load_kg is given, too; give one of the two");
  }
  if (p.load_share) {
    const double mass_kg = calc_moving_mass_kg(robot.model);
    p.load_kg = {p.load_share->first * mass_kg, p.load_share->second * mass_kg};
  }
  p.efforts.clear();
  if (p.viscous_friction_share > 0 || p.coulomb_friction_share > 0) {
    for (const JointDrive& joint : robot.start.joints) {
      p.efforts.push_back(std::max(std::abs(joint.limits.min), std::abs(joint.limits.max)));
    }
  }
}

// Returns `p` with the values of the keys that are there.
Perturbation read_keys(const ConfigTable& table, const PerturbedRobot& robot, Perturbation p) {
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
  read_sizes(table, robot, p);
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
  p.friction_relative = table.get_or(kPlantFriction, p.friction_relative);
  p.armature_relative = table.get_or(kPlantArmature, p.armature_relative);
  p.stiffness_relative = table.get_or(kPlantStiffness, p.stiffness_relative);
  if (table.has(kPlantFitted)) {
    p.fitted = static_cast<Perturbation::Fitted>(table.get_choice(kPlantFitted));
    if (p.fitted != Perturbation::Fitted::none && !robot.fitted) {
      table.refuse(kPlantFitted,
                   "the robot's plant must have [identification], as armwright identify writes it "
                   "(robot.plant, --plant)");
    }
    p.fitted_plant = p.fitted == Perturbation::Fitted::none ? nullptr : robot.fitted;
  }
  return p;
}

// Names the robots that the numbers of the presets in a folder are made for.
constexpr const char* kPresetRobotsFile = "_robots.toml";
const Setting<std::vector<std::string>> kPresetRobots{
    "robots", kNoDefault, "names of the robots that the numbers of these presets are made for"};
const SettingTable kPresetRobotsSettings{.key = "", .settings = {&kPresetRobots}};

// Returns the file of a preset that is for the robot: _NAME.toml beside NAME.toml, if there is one
// and _robots.toml does not name the robot.
std::filesystem::path find_preset(const std::filesystem::path& file, const RobotModel& robot) {
  const auto other = file.parent_path() / ("_" + file.filename().string());
  const auto list = file.parent_path() / kPresetRobotsFile;
  if (!path_exists(other) || !path_exists(list)) {
    return file;
  }
  const ConfigTable table = ConfigTable::load(kPresetRobotsSettings, list);
  const std::vector<std::string> robots = table.get(kPresetRobots);
  table.refuse_unknown();
  return std::ranges::find(robots, robot.name) == robots.end() ? other : file;
}

Perturbation load_preset(const ConfigTable& preset, const PerturbedRobot& robot) {
  Perturbation perturbation = read_keys(preset, robot, {});
  preset.refuse_unknown();
  return perturbation;
}

// Removes from the preset's `p`, and from the record, a load or friction that a key beside the
// preset states in the other form: as a share, or as numbers in kg and per joint.
void replace_other_forms(const ConfigTable& table, Perturbation& p) {
  const auto replaces = [&](const AnySetting& stated, const AnySetting& other) {
    if (!table.has(stated) || table.has(other)) {
      return false;
    }
    table.leave_out(other);
    return true;
  };
  if (replaces(kPlantLoad, kPlantLoadShare)) {
    p.load_share.reset();
  }
  if (replaces(kPlantLoadShare, kPlantLoad)) {
    p.load_kg.reset();
  }
  if (replaces(kPlantViscousFriction, kPlantViscousShare)) {
    p.viscous_friction_share = 0;
  }
  if (replaces(kPlantViscousShare, kPlantViscousFriction)) {
    p.viscous_friction_n_m_s_per_rad.clear();
  }
  if (replaces(kPlantCoulombFriction, kPlantCoulombShare)) {
    p.coulomb_friction_share = 0;
  }
  if (replaces(kPlantCoulombShare, kPlantCoulombFriction)) {
    p.coulomb_friction_n_m.clear();
  }
}

std::string write_list(const std::vector<double>& values) {
  std::vector<std::string> words;
  for (const double value : values) {
    words.push_back(format_exact(value));
  }
  return "[" + join(words, ",") + "]";
}

}  // namespace

const SettingTable kPerturbationSettings{.key = "perturbation",
                                         .settings = {&kPlantPreset,
                                                      &kPlantSet,
                                                      &kPlantApplyTo,
                                                      &kPlantMass,
                                                      &kPlantLoad,
                                                      &kPlantLoadShare,
                                                      &kPlantViscousFriction,
                                                      &kPlantCoulombFriction,
                                                      &kPlantFrictionTransition,
                                                      &kPlantViscousShare,
                                                      &kPlantCoulombShare,
                                                      &kPlantFriction,
                                                      &kPlantArmature,
                                                      &kPlantStiffness,
                                                      &kPlantQuantisation,
                                                      &kPlantDelay,
                                                      &kPlantRipple,
                                                      &kPlantRippleCycles,
                                                      &kPlantEffortSigma,
                                                      &kPlantGainSigma,
                                                      &kPlantFitted}};

Perturbation load_perturbation(const std::string& preset, const PerturbedRobot& robot) {
  const auto file = find_preset(resolve_config("perturbations", preset), robot.model);
  return load_preset(ConfigTable::load(kPerturbationSettings, file), robot);
}

std::vector<std::string> make_overrides(const Perturbation& p) {
  const auto write_interval = [](const Interval& interval) {
    return write_list(interval ? std::vector{interval->first, interval->second}
                               : std::vector<double>());
  };
  const std::pair<const AnySetting*, std::string> values[] = {
      {&kPlantPreset, "\"\""},
      {&kPlantSet, p.set},
      {&kPlantApplyTo, get_place(p.where)},
      {&kPlantMass, format_exact(p.mass_relative)},
      {&kPlantLoad, write_interval(p.load_share ? Interval() : p.load_kg)},
      {&kPlantLoadShare, write_interval(p.load_share)},
      {&kPlantViscousFriction, write_list(p.viscous_friction_n_m_s_per_rad)},
      {&kPlantCoulombFriction, write_list(p.coulomb_friction_n_m)},
      {&kPlantFrictionTransition, format_exact(p.friction_transition_rad_per_s)},
      {&kPlantViscousShare, format_exact(p.viscous_friction_share)},
      {&kPlantCoulombShare, format_exact(p.coulomb_friction_share)},
      {&kPlantFriction, format_exact(p.friction_relative)},
      {&kPlantArmature, format_exact(p.armature_relative)},
      {&kPlantStiffness, format_exact(p.stiffness_relative)},
      {&kPlantQuantisation, format_exact(p.quantisation_rad)},
      {&kPlantDelay, format_exact(p.delay_s)},
      {&kPlantRipple, format_exact(p.torque_ripple_relative)},
      {&kPlantRippleCycles, fmt::format("{}", p.ripple_cycles_per_turn)},
      {&kPlantEffortSigma, format_exact(p.effort_limit_sigma)},
      {&kPlantGainSigma, format_exact(p.gain_sigma)},
      {&kPlantFitted, get_name(p.fitted)}};
  std::vector<std::string> overrides;
  for (const auto& [setting, value] : values) {
    overrides.push_back(fmt::format("{}.{}={}", kPerturbationSettings.key, setting->key, value));
  }
  return overrides;
}

Perturbation read_perturbation(const ConfigTable& table, const PerturbedRobot& robot,
                               LoadedProblem& loaded) {
  Perturbation perturbation;
  const bool has_preset = !table.get(kPlantPreset).empty();
  if (has_preset) {
    const auto file = find_preset(resolve_named(table, kPlantPreset, "perturbations"), robot.model);
    const ConfigTable preset = ConfigTable::load(kPerturbationSettings, file);
    perturbation = load_preset(preset, robot);
    table.settle(kPlantPreset, "");
    table.settle_missing(preset);
    replace_other_forms(table, perturbation);
    add_input(loaded, file);
  }
  perturbation = read_keys(table, robot, perturbation);
  if (robot.fitted && !table.has(kPlantFitted) && !has_preset) {
    perturbation.fitted = Perturbation::Fitted::draws;
    perturbation.fitted_plant = robot.fitted;
    table.settle(kPlantFitted, get_name(perturbation.fitted));
  }
  return perturbation;
}

void check_load(const ConfigTable& task, const ConfigTable& table, const TrackingConfig& config) {
  // `verify` writes load_kg = [] for the nominal arm of a problem that draws loads.
  const bool draws_load =
      config.perturbation.load_kg || table.has(kPlantLoad) || table.has(kPlantLoadShare);
  if (config.task.load_body && config.task.load_kg == 0 && !draws_load) {
    task.refuse(kTaskLoadCom,
                "it needs task.load_kg > 0, the mass that it belongs to, or a load in "
                "[perturbation]");
  }
}

}  // namespace armwright
