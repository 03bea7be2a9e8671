#include "problems/config/plant_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <numbers>
#include <vector>

#include "base/config.hpp"
#include "base/error.hpp"
#include "base/read_limit.hpp"
#include "base/text.hpp"
#include "problems/config/plant_parts.hpp"

namespace armwright {
namespace {

constexpr std::size_t kCounterbalancePoints = 1025;  // over the joint's range; docs/robots.md
// The Stribeck rate is this many times the transition rate unless the file gives it.
constexpr double kRatesRatio = JointPlant{}.stribeck_rate / JointPlant{}.transition_rate;

constexpr Range kPlantNotNegative{.lower = 0, .upper = 1e9};
constexpr Range kPlantPositive{.lower = 0, .upper = 1e9, .lower_open = true};
constexpr Range kPlantAnySign{.lower = -1e9, .upper = 1e9};
constexpr Range kPlantRate{.lower = 1e-9, .upper = 1e3};

// A value of a joint. Its key depends on the joint's kind, as its unit does.
template <class Value>
struct JointSetting {
  JointSetting(const std::string& turning, const std::string& sliding, const Range& range,
               const std::string& words)
      : revolute(turning, range, kNoDefault, "joints that turn: " + words),
        prismatic(sliding, range, kNoDefault, "joints that slide: " + words) {}

  const Setting<Value>& get(JointKind kind) const {
    return kind == JointKind::revolute ? revolute : prismatic;
  }

  Setting<Value> revolute, prismatic;
};
using JointNumber = JointSetting<double>;
using JointNumbers = JointSetting<std::vector<double>>;

const JointNumber kArmature{
    "armature_kg_m2", "armature_kg", kPlantNotNegative,
    "inertia of the rotor as the joint feels it, behind its gear (default: 0)"};
const Setting<double> kRotorInertia{
    "rotor_inertia_kg_m2", kPlantNotNegative, kNoDefault,
    "inertia of the rotor at the motor; with the gear ratio in place of the armature"};
const JointNumber kGearRatio{"gear_ratio", "gear_ratio_rad_per_m", kPlantPositive,
                             "motor's angle per joint position; needs rotor_inertia_kg_m2"};
const JointNumber kViscous{"viscous_n_m_s_per_rad", "viscous_n_s_per_m", kPlantNotNegative,
                           "viscous friction (default: that of <dynamics>)"};
const JointNumber kCoulomb{"coulomb_n_m", "coulomb_n", kPlantNotNegative,
                           "Coulomb friction (default: that of <dynamics>)"};
const JointNumber kStribeck{
    "stribeck_n_m", "stribeck_n", kPlantAnySign,
    "friction at breakaway beyond Coulomb friction; at least -Coulomb friction (default: 0)"};
const JointNumber kTransitionRate{
    "transition_rate_rad_per_s", "transition_rate_m_per_s", kPlantRate,
    "rate within which friction rises to its value at breakaway (default: 0.01)"};
const JointNumber kStribeckRate{
    "stribeck_rate_rad_per_s", "stribeck_rate_m_per_s", kPlantRate,
    "rate by which friction has fallen to Coulomb friction; at least the transition rate "
    "(default: 10 times that)"};
const JointNumber kOffset{"offset_n_m", "offset_n", kPlantAnySign,
                          "constant friction (default: 0)"};
const JointNumber kStiffness{
    "stiffness_n_m_per_rad", "stiffness_n_per_m", kPlantNotNegative,
    "stiffness between motor and link; needs an armature; 0: rigid; of an unactuated joint: of its "
    "spring (default: 0)"};
const JointNumber kDamping{
    "damping_n_m_s_per_rad", "damping_n_s_per_m", kPlantNotNegative,
    "damping between motor and link; needs a stiffness; of an unactuated joint: beside "
    "its spring (default: 0)"};
const Setting<std::string> kMeasured{
    "measured", one_of({"motor", "link"}), kNoDefault,  // in the order of the enum
    "side of an elastic joint that the controller measures (default: motor)"};

const Setting<bool> kUnactuated{
    "unactuated", false,
    "the joint has no motor: its spring, relaxed at 0, and its damping are all that act on it"};

const JointNumbers kPositions{"positions_rad", "positions_m", kPlantAnySign,
                              "increasing positions that cover the joint's range"};
const JointNumbers kEfforts{"efforts_n_m", "efforts_n", kPlantAnySign,
                            "efforts on the joint at these positions"};

const Setting<double> kSpringDistance{"distance_m", kPlantPositive, kNoDefault,
                                      "gas spring: from the joint's axis to its far end"};
const Setting<double> kSpringArm{"arm_m", kPlantPositive, kNoDefault,
                                 "gas spring: from the joint's axis to its near end"};
const Setting<double> kSpringOffset{
    "angle_offset_rad", Range{.lower = -7, .upper = 7}, 0.0,
    "gas spring: its angle at joint position 0; at angle 0 it is shortest"};
const Setting<double> kSpringPiston{"piston_diameter_m", kPlantPositive, kNoDefault,
                                    "gas spring: diameter of the piston"};
const Setting<double> kSpringRod{"rod_diameter_m", kPlantNotNegative, kNoDefault,
                                 "gas spring: diameter of the rod"};
const Setting<double> kSpringArea{"area_m2", kPlantPositive, kNoDefault,
                                  "gas spring: area in place of the two diameters"};
const Setting<double> kSpringVolume{"volume_m3", kPlantPositive, kNoDefault,
                                    "gas spring: gas volume where it is shortest"};
const Setting<double> kSpringProduct{"pressure_volume_j", kPlantPositive, kNoDefault,
                                     "gas spring: pressure times volume"};
const Setting<double> kSpringPressure{
    "pressure_pa", kPlantPositive, kNoDefault,
    "gas spring: pressure where it is shortest, in place of pressure_volume_j"};

const Setting<double> kBalanceScale{"scale",
                                    {.lower = 1e-3, .upper = 1e3},
                                    1.0,
                                    "factor on the efforts, as armwright identify finds it"};
const Setting<double> kBalanceSlope{
    "slope",
    {.lower = -0.95, .upper = 0.95},
    0.0,
    "the factor is scale (1 + slope z), with z from -1 to 1 over the joint's range"};

const SettingTable kCounterbalanceSettings{
    .key = "counterbalance",
    .settings = {&kPositions.revolute, &kEfforts.revolute, &kPositions.prismatic,
                 &kEfforts.prismatic, &kBalanceScale, &kBalanceSlope}};
const SettingTable kGasSpringSettings{
    .key = "gas_spring",
    .settings = {&kSpringDistance, &kSpringArm, &kSpringOffset, &kSpringPiston, &kSpringRod,
                 &kSpringArea, &kSpringVolume, &kSpringProduct, &kSpringPressure, &kBalanceScale,
                 &kBalanceSlope}};

// The declarations of a file for joints and links of these names.
class PlantSettings {
 public:
  PlantSettings(const std::vector<std::string>& names, const std::vector<std::string>& links)
      : joints_{.key = "joint"}, links_{.key = "link"} {
    for (const std::string& name : names) {
      SettingTable& table = tables_.emplace_back();
      table.key = name;
      for (const JointNumber* both :
           {&kArmature, &kGearRatio, &kViscous, &kCoulomb, &kStribeck, &kTransitionRate,
            &kStribeckRate, &kOffset, &kStiffness, &kDamping}) {
        table.settings.push_back(&both->revolute);
        table.settings.push_back(&both->prismatic);
        if (both == &kArmature) {
          table.settings.push_back(&kRotorInertia);
        }
      }
      table.settings.push_back(&kMeasured);
      table.settings.push_back(&kUnactuated);
      table.tables = {&kCounterbalanceSettings, &kGasSpringSettings};
      joints_.tables.push_back(&table);
    }
    for (const std::string& name : links) {
      SettingTable& table = tables_.emplace_back(kPayloadSettings);
      table.key = name;
      links_.tables.push_back(&table);
    }
    file_.tables = {&joints_, &links_, &kPayloadSettings, &kFittedSettings};
    file_.listed_as = "plant:";
  }
  PlantSettings(const PlantSettings&) = delete;  // tables point into each other

  const SettingTable& file() const { return file_; }
  const SettingTable& joints() const { return joints_; }
  const SettingTable& links() const { return links_; }

 private:
  std::deque<SettingTable> tables_;
  SettingTable joints_, links_, file_;
};

// The number of a key, or `fallback`. Refuses the key of the other kind of joint.
template <class Value>
std::optional<Value> find(const ConfigTable& table, const JointSetting<Value>& setting,
                          JointKind kind) {
  const bool turns = kind == JointKind::revolute;
  const Setting<Value>& wrong = turns ? setting.prismatic : setting.revolute;
  table.has(setting.get(kind));  // hints name the right key first
  if (table.has(wrong)) {
    table.refuse(wrong, fmt::format("the joint {}, so the key must be {}",
                                    turns ? "turns" : "slides", setting.get(kind).key));
  }
  return table.find(setting.get(kind));
}

double find_or(const ConfigTable& table, const JointNumber& setting, JointKind kind,
               double fallback) {
  return find(table, setting, kind).value_or(fallback);
}

double read_armature(const ConfigTable& table, JointKind kind, double fallback) {
  const auto armature = find(table, kArmature, kind);
  const auto ratio = find(table, kGearRatio, kind);
  const auto rotor = table.find(kRotorInertia);
  const Setting<double>& ratio_setting = kGearRatio.get(kind);
  if (armature && rotor) {
    table.refuse(kRotorInertia,
                 fmt::format("{} is given, too; give one of the two", kArmature.get(kind).key));
  }
  if (rotor && !ratio) {
    table.refuse(kRotorInertia, fmt::format("it needs {}", ratio_setting.key));
  }
  if (ratio && !rotor && !armature) {
    table.refuse(ratio_setting, fmt::format("it needs {}", kRotorInertia.key));
  }
  return rotor ? *rotor * *ratio * *ratio : armature.value_or(fallback);
}

void read_friction(const ConfigTable& table, JointKind kind, JointPlant& plant) {
  plant.viscous = find_or(table, kViscous, kind, plant.viscous);
  plant.coulomb = find_or(table, kCoulomb, kind, plant.coulomb);
  plant.stribeck = find_or(table, kStribeck, kind, plant.stribeck);
  plant.transition_rate = find_or(table, kTransitionRate, kind, plant.transition_rate);
  plant.stribeck_rate = find_or(table, kStribeckRate, kind, kRatesRatio * plant.transition_rate);
  plant.offset = find_or(table, kOffset, kind, plant.offset);
  if (plant.stribeck < -plant.coulomb) {
    table.refuse(kStribeck.get(kind),
                 fmt::format("it must be at least -{}, the Coulomb friction with the other sign",
                             format_exact(plant.coulomb)));
  }
  if (plant.stribeck_rate < plant.transition_rate) {
    table.refuse(kStribeckRate.get(kind),
                 fmt::format("it must be at least {}, the {}", format_exact(plant.transition_rate),
                             kTransitionRate.get(kind).key));
  }
}

void read_elasticity(const ConfigTable& table, JointKind kind, JointPlant& plant) {
  plant.stiffness = find_or(table, kStiffness, kind, plant.stiffness);
  if (plant.is_elastic() && !(plant.armature > 0)) {
    table.refuse(kStiffness.get(kind),
                 fmt::format("an elastic joint needs a motor with inertia: give {}, or {} and {}",
                             kArmature.get(kind).key, kRotorInertia.key, kGearRatio.get(kind).key));
  }
  const auto refuse_rigid = [&](const AnySetting& setting) {
    if (!plant.is_elastic()) {
      table.refuse(setting, fmt::format("it needs {} > 0", kStiffness.get(kind).key));
    }
  };
  if (const auto damping = find(table, kDamping, kind)) {
    refuse_rigid(kDamping.get(kind));
    plant.damping = *damping;
  }
  if (table.has(kMeasured)) {
    plant.measured = static_cast<MeasuredSide>(table.get_choice(kMeasured));
    refuse_rigid(kMeasured);
  }
}

// Reads the spring and the damper of an unactuated joint.
void read_unactuated(const ConfigTable& table, Joint& joint) {
  const double stiffness = find_or(table, kStiffness, joint.kind, 0);
  const double damping = find_or(table, kDamping, joint.kind, 0);
  if (!(stiffness > 0) && !(damping > 0)) {
    table.refuse(kUnactuated,
                 fmt::format("such a joint needs {} > 0 or {} > 0; without both nothing holds it",
                             kStiffness.get(joint.kind).key, kDamping.get(joint.kind).key));
  }
  for (const std::string& key :
       {kMeasured.key, kCounterbalanceSettings.key, kGasSpringSettings.key}) {
    if (table.has(key)) {
      table.refuse(key, "the joint is unactuated; leave this out");
    }
  }
  if (joint.lower > 0 || joint.upper < 0) {
    table.refuse(kUnactuated,
                 fmt::format("its spring is relaxed at 0, which must lie within the range of the "
                             "joint; that is {} to {} {}",
                             format_exact(joint.lower), format_exact(joint.upper),
                             joint.kind == JointKind::revolute ? "rad" : "m"));
  }
  constexpr double kTimesRange = 10;  // of a joint that slides; at least 1 m
  const double slide = std::max({1.0, kTimesRange * joint.upper, -kTimesRange * joint.lower});
  joint.plant.set_unactuated(
      stiffness, damping,
      joint.kind == JointKind::revolute ? std::numbers::pi : std::min(slide, 1e6));
}

// Refuses a counterbalance on a joint that turns without end or more than once.
void check_range(const ConfigTable& table, const SettingTable& inner, const Joint& joint) {
  const bool turns = joint.kind == JointKind::revolute;
  const double width = joint.upper - joint.lower;
  if (std::isfinite(width) && width > 0 && !(turns && width > 2 * std::numbers::pi)) {
    return;
  }
  table.refuse(inner.key,
               fmt::format("the joint must have a finite range{}; its range in the URDF is {} to "
                           "{} {}",
                           turns ? " of at most one turn" : "", format_exact(joint.lower),
                           format_exact(joint.upper), turns ? "rad" : "m"));
}

// Returns the counterbalance over the joint's range with the efforts that `calc_effort` returns. It
// is called with increasing positions.
template <class Function>
Counterbalance sample(const Joint& joint, const Function& calc_effort) {
  Counterbalance balance{joint.lower, joint.upper, {}};
  for (std::size_t i = 0; i < kCounterbalancePoints; ++i) {
    const double share = static_cast<double>(i) / (kCounterbalancePoints - 1);
    balance.efforts.push_back(calc_effort(joint.lower + (joint.upper - joint.lower) * share));
  }
  return balance;
}

Counterbalance read_points(const ConfigTable& table, const Joint& joint) {
  const Setting<std::vector<double>>& position_setting = kPositions.get(joint.kind);
  const Setting<std::vector<double>>& effort_setting = kEfforts.get(joint.kind);
  find(table, kPositions, joint.kind);  // refuses the keys of the other kind first
  find(table, kEfforts, joint.kind);
  const std::vector<double> positions = table.get(position_setting);
  const std::vector<double> efforts = table.get(effort_setting);
  if (positions.size() < 2) {
    table.refuse(position_setting, "it must hold at least two positions");
  }
  if (efforts.size() != positions.size()) {
    table.refuse(effort_setting,
                 fmt::format("it must hold {} efforts, one per position", positions.size()));
  }
  for (std::size_t i = 1; i < positions.size(); ++i) {
    if (!(positions[i] > positions[i - 1])) {
      table.refuse(position_setting,
                   fmt::format("positions must increase; number {} is {} after {}", i + 1,
                               format_exact(positions[i]), format_exact(positions[i - 1])));
    }
  }
  if (positions.front() > joint.lower || positions.back() < joint.upper) {
    table.refuse(position_setting,
                 fmt::format("positions must cover the joint's range in the URDF, {} to {}",
                             format_exact(joint.lower), format_exact(joint.upper)));
  }
  std::size_t right = 1;
  return sample(joint, [&](double position) {
    while (right + 1 < positions.size() && positions[right] < position) {
      ++right;
    }
    const double width = positions[right] - positions[right - 1];
    const double share = std::clamp((position - positions[right - 1]) / width, 0.0, 1.0);
    return efforts[right - 1] + share * (efforts[right] - efforts[right - 1]);
  });
}

double read_area_m2(const ConfigTable& table) {
  if (const auto area_m2 = table.find(kSpringArea)) {
    for (const auto* setting : {&kSpringPiston, &kSpringRod}) {
      if (table.has(*setting)) {
        table.refuse(*setting, "area_m2 is given, too; give the area or the two diameters");
      }
    }
    return *area_m2;
  }
  const double piston_m = table.get(kSpringPiston);
  const double rod_m = table.get(kSpringRod);
  if (rod_m >= piston_m) {
    table.refuse(kSpringRod, fmt::format("it must be less than {}, the piston's diameter",
                                         format_exact(piston_m)));
  }
  return std::numbers::pi * (piston_m * piston_m - rod_m * rod_m) / 4;
}

Counterbalance read_gas_spring(const ConfigTable& table, const Joint& joint) {
  const double distance_m = table.get(kSpringDistance);
  const double arm_m = table.get(kSpringArm);
  const double offset_rad = table.get(kSpringOffset);
  const double area_m2 = read_area_m2(table);
  const double volume_m3 = table.get(kSpringVolume);
  const bool has_product = table.has(kSpringProduct);
  if (has_product && table.has(kSpringPressure)) {
    table.refuse(kSpringPressure, "pressure_volume_j is given, too; give one of the two");
  }
  const double product_j =
      has_product ? table.get(kSpringProduct) : table.get(kSpringPressure) * volume_m3;
  if (arm_m >= distance_m) {
    table.refuse(kSpringArm,
                 fmt::format("it must be less than distance_m, {}", format_exact(distance_m)));
  }
  const double shortest_m = distance_m - arm_m;
  double least_m3 = volume_m3;
  Counterbalance balance = sample(joint, [&](double position) {
    const double x = position + offset_rad;
    const double length_m =
        std::sqrt(distance_m * distance_m + arm_m * arm_m - 2 * distance_m * arm_m * std::cos(x));
    const double left_m3 = volume_m3 - area_m2 * (length_m - shortest_m);
    least_m3 = std::min(least_m3, left_m3);
    return -distance_m * arm_m * std::sin(x) / length_m * area_m2 * product_j / left_m3;
  });
  if (!(least_m3 > 0)) {
    table.refuse(kSpringVolume,
                 fmt::format("the piston takes {:.6g} m^3 within the joint's range; the volume "
                             "must be larger",
                             volume_m3 - least_m3));
  }
  return balance;
}

void read_joint(const ConfigTable& table, Joint& joint) {
  if (joint.kind == JointKind::prismatic && table.has(kGasSpringSettings.key)) {
    table.refuse(kGasSpringSettings.key,
                 "its formula is for a joint that turns; give a table [counterbalance]");
  }
  JointPlant& plant = joint.plant;
  plant.armature = read_armature(table, joint.kind, plant.armature);
  plant.gear_ratio = find_or(table, kGearRatio, joint.kind, plant.gear_ratio);
  read_friction(table, joint.kind, plant);
  if (table.get(kUnactuated)) {
    read_unactuated(table, joint);
    return;
  }
  read_elasticity(table, joint.kind, plant);
  const bool has_points = table.has(kCounterbalanceSettings.key);
  const bool has_spring = table.has(kGasSpringSettings.key);
  if (has_points && has_spring) {
    table.refuse(kGasSpringSettings.key, "counterbalance is given, too; give one of the two");
  }
  if (has_points) {
    check_range(table, kCounterbalanceSettings, joint);
    plant.counterbalance = read_points(table.get_table(kCounterbalanceSettings), joint);
  } else if (has_spring) {
    check_range(table, kGasSpringSettings, joint);
    plant.counterbalance = read_gas_spring(table.get_table(kGasSpringSettings), joint);
  }
  if (has_points || has_spring) {
    const ConfigTable its =
        table.get_table(has_points ? kCounterbalanceSettings : kGasSpringSettings);
    plant.counterbalance.correct(its.get(kBalanceScale), its.get(kBalanceSlope));
  }
}

// Makes every key of a joint beside the chain known. Its values are not used.
void skip_joint(const ConfigTable& table, const SettingTable& settings) {
  for (const AnySetting* setting : settings.settings) {
    table.has(*setting);
  }
  for (const SettingTable* inner : settings.tables) {
    if (table.has(inner->key)) {
      skip_joint(table.get_table(*inner), *inner);
    }
  }
}

std::optional<FittedPlant> read_plant(const std::filesystem::path& file, RobotModel& robot) {
  std::vector<std::string> names, link_names;
  for (const Link& link : robot.links) {
    link_names.push_back(link.name);
  }
  for (const Joint& joint : robot.joints) {
    names.push_back(joint.name);
  }
  names.insert(names.end(), robot.held_joints.begin(), robot.held_joints.end());
  const PlantSettings settings(names, link_names);
  const ConfigTable document = ConfigTable::load(settings.file(), file);
  const bool has_others = document.has(settings.links().key) ||
                          document.has(kPayloadSettings.key) || document.has(kFittedSettings.key);
  const ConfigTable joints = has_others ? document.get_table_or_empty(settings.joints())
                                        : document.get_table(settings.joints());
  for (const std::string& name : names) {  // messages list the names in this order
    joints.has(name);
  }
  for (std::size_t i = 0; i < names.size(); ++i) {
    const SettingTable& its = *settings.joints().tables[i];
    if (!joints.has(its.key)) {
      continue;
    }
    const ConfigTable table = joints.get_table(its);
    if (i < robot.joints.size()) {
      read_joint(table, robot.joints[i]);
    } else {
      skip_joint(table, its);
    }
  }
  const ConfigTable links = document.get_table_or_empty(settings.links());
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    const SettingTable& its = *settings.links().tables[i];
    if (links.has(its.key)) {
      robot.links[i].inertial = read_link_body(links.get_table(its));
    }
  }
  if (document.has(kPayloadSettings.key)) {
    set_payload(robot, read_body(document.get_table(kPayloadSettings)));
  }
  std::optional<FittedPlant> fitted;
  if (document.has(kFittedSettings.key)) {
    fitted = read_fitted(document.get_table(kFittedSettings), robot);
  }
  document.refuse_unknown();
  return fitted;
}

struct PlantNumber {
  double JointPlant::*member;
  const JointNumber* setting;
  const char* words;  // null: describe_plant() leaves it out
};
const PlantNumber kPlantNumbers[] = {
    {&JointPlant::armature, &kArmature, "armature"},
    {&JointPlant::viscous, &kViscous, "viscous friction"},
    {&JointPlant::coulomb, &kCoulomb, "Coulomb friction"},
    {&JointPlant::stribeck, &kStribeck, "Stribeck friction"},
    {&JointPlant::transition_rate, &kTransitionRate, nullptr},
    {&JointPlant::stribeck_rate, &kStribeckRate, nullptr},
    {&JointPlant::offset, &kOffset, "offset"},
    {&JointPlant::stiffness, &kStiffness, "stiffness"},
    {&JointPlant::damping, &kDamping, "damping"},
};

}  // namespace

std::filesystem::path name_plant_file(std::filesystem::path urdf) {
  return urdf.replace_extension(".plant.toml");
}

std::optional<FittedPlant> load_plant(const std::filesystem::path& file, RobotModel& robot) {
  const ReadStep step(fmt::format("the plant '{}'", sanitize(file.string())));
  try {
    return read_plant(file, robot);
  } catch (const Error& error) {
    // The plant is an input like the URDF, not a part of the configuration.
    throw Error(error.kind() == ErrorKind::usage ? ErrorKind::bad_data : error.kind(),
                error.what());
  }
}

const SettingTable& plant_settings() {
  static const PlantSettings settings({"NAME"}, {"NAME"});
  return settings.file();
}

std::map<std::string, double> list_plant_numbers(const Joint& joint) {
  std::map<std::string, double> numbers;
  for (const PlantNumber& number : kPlantNumbers) {
    numbers[number.setting->get(joint.kind).key] = joint.plant.*number.member;
  }
  return numbers;
}

std::string describe_plant(const Joint& joint) {
  const JointPlant& plant = joint.plant;
  std::vector<std::string> parts;
  if (plant.unactuated) {
    parts.emplace_back("unactuated");
  }
  for (const PlantNumber& number : kPlantNumbers) {
    const double value = plant.*number.member;
    if (value != 0 && number.words != nullptr) {
      parts.push_back(
          fmt::format("{} {:.6g} {}", number.words, value, number.setting->get(joint.kind).unit));
    }
  }
  if (plant.is_elastic() && plant.measured == MeasuredSide::link) {
    parts.push_back("measured at the link");
  }
  const std::vector<double>& efforts = plant.counterbalance.efforts;
  if (!efforts.empty() && !plant.unactuated) {
    const auto [least, most] = std::ranges::minmax(efforts);
    parts.push_back(fmt::format("counterbalance {:.6g} to {:.6g} {}", least, most,
                                kOffset.get(joint.kind).unit));
  }
  return join(parts, ", ");
}

}  // namespace armwright
