#include "study/verification/verification.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <set>

namespace armwright {
namespace {

template <class Has>
bool any_plant(const RobotModel& robot, const Has& has) {
  return std::ranges::any_of(robot.joints, [&](const Joint& joint) { return has(joint.plant); });
}

bool has_friction(const RobotModel& robot) {
  return any_plant(robot, [](const JointPlant& plant) { return plant.has_friction(); });
}

bool has_armature(const RobotModel& robot) {
  return any_plant(robot, [](const JointPlant& plant) { return plant.armature > 0; });
}

bool is_elastic(const RobotModel& robot) {
  return any_plant(robot, [](const JointPlant& plant) { return plant.is_elastic(); });
}

bool is_rigid_with_armature(const RobotModel& robot) {
  return has_armature(robot) && !is_elastic(robot);
}

bool lacks_armature(const RobotModel& robot) {
  return !has_armature(robot);
}

constexpr const char* kNoArmature =
    "no joint of the robot has an armature (robot.plant); try added-rotors";
// Half of the inertia that a joint moves: an assumption. The rotors of a PUMA 560 have more than
// half of its shoulder's inertia.
constexpr double kAddedArmatureShare = 0.5;
// The motors of the axes 1 to 3 of a KUKA KR300 swing at 12 to 15 Hz: their stiffnesses are 4.1 to
// 7.5e6 N m/rad, their armatures 609 to 844 kg m^2 (Weigand et al., 2021).
constexpr double kElastic_hz = 15;

// Returns the setting with an engine, substeps and a plant. Other masses are those of the own plant.
VerifySetting make_setting(const VerifySetting& own, const std::string& engine, int substeps,
                           const std::string& plant) {
  VerifySetting setting{engine, substeps, 1, plant};
  if (plant == kLighter || plant == kHeavier) {
    setting.mass_factor = plant == kLighter ? 0.9 : 1.1;
    setting.perturbation = own.perturbation;
  }
  return setting;
}

}  // namespace

std::vector<VerifySetting> list_verify_settings(const VerifySetting& own,
                                                const VerifyMatrix& matrix) {
  std::vector<std::string> engines = matrix.engines;
  std::ranges::stable_partition(engines,
                                [&](const std::string& engine) { return engine == own.engine; });
  std::vector<VerifySetting> settings = {own};
  const auto add = [&](const std::string& engine, int substeps, const std::string& plant) {
    VerifySetting setting = make_setting(own, engine, substeps, plant);
    if (std::ranges::find(settings, setting) == settings.end()) {
      settings.push_back(std::move(setting));
    }
  };
  for (const std::string& engine : engines) {
    for (const int substeps : std::set(matrix.substeps.begin(), matrix.substeps.end())) {
      for (const std::string& plant : matrix.plants) {
        add(engine, substeps, plant);
      }
    }
  }
  for (const std::string& plant : matrix.own_plants) {
    add(own.engine, own.substeps, plant);
  }
  return settings;
}

std::vector<VerifySetting> list_check_settings(const VerifySetting& own,
                                               const std::vector<std::string>& engines) {
  std::vector<VerifySetting> settings;
  const bool is_articulated = own.engine == "articulated";
  for (const std::string& engine : engines) {
    // ODE gives the second opinion on the articulated engine only: an engine in joint coordinates
    // checks another one quicker.
    if (engine != own.engine && (is_articulated || engine != "ode")) {
      settings.push_back({engine, own.substeps, 1, own.perturbation});
    }
  }
  std::vector<int> finer;
  std::ranges::copy_if(kCheckSubsteps, std::back_inserter(finer),
                       [&](int substeps) { return substeps > own.substeps; });
  if (finer.empty() && 2 * own.substeps <= kMostSubsteps) {
    finer = {2 * own.substeps};
  }
  for (const int substeps : finer) {
    settings.push_back({own.engine, substeps, 1, own.perturbation});
  }
  for (const char* plant : {kLighter, kHeavier, kFrictionPreset, kSensorPreset}) {
    settings.push_back(make_setting(own, own.engine, own.substeps, plant));
  }
  return settings;
}

const std::vector<OtherPlant>& other_plants() {
  static const std::vector<OtherPlant> plants = {
      {"more-friction",
       "friction x 2",
       {.friction = 2},
       has_friction,
       "no joint of the robot has friction (<dynamics>, robot.plant); the preset friction adds "
       "some"},
      {"lighter-rotors", "rotors -50 %", {.armature = 0.5}, has_armature, kNoArmature},
      {"heavier-rotors", "rotors +50 %", {.armature = 1.5}, has_armature, kNoArmature},
      {"added-rotors",
       "rotors added",
       {.armature_share = kAddedArmatureShare},
       lacks_armature,
       "a joint of the robot has an armature; try heavier-rotors"},
      {"softer",
       "stiffness -50 %",
       {.stiffness = 0.5},
       is_elastic,
       "no joint of the robot is elastic (robot.plant); try elastic or elastic-rotors"},
      {"elastic",
       "elastic",
       {.elastic_hz = kElastic_hz},
       is_rigid_with_armature,
       "no joint of the robot has an armature, or one is elastic (robot.plant); try "
       "elastic-rotors or softer"},
      {"elastic-rotors",
       "elastic, rotors added",
       {.armature_share = kAddedArmatureShare, .elastic_hz = kElastic_hz},
       lacks_armature,
       "a joint of the robot has an armature; try elastic or softer"}};
  return plants;
}

const OtherPlant* find_other_plant(const std::string& name) {
  const auto found = std::ranges::find(other_plants(), name, &OtherPlant::name);
  return found == other_plants().end() ? nullptr : &*found;
}

std::string describe_plant(const VerifySetting& setting) {
  if (const OtherPlant* plant = find_other_plant(setting.perturbation)) {
    return plant->words;
  }
  if (setting.mass_factor != 1) {
    return fmt::format("masses {:+.0f} %", 100 * (setting.mass_factor - 1));
  }
  return setting.perturbation.empty() ? "own" : setting.perturbation;
}

const char* to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::holds:
      return "holds";
    case Verdict::worse:
      return "worse";
    case Verdict::fails:
      return "fails";
    case Verdict::missing:
      return "not simulated";
  }
  return "?";
}

VerifyRow judge_setting(const VerifySetting& setting, const ErrorSummary& summary,
                        const ErrorSummary& own) {
  VerifyRow row{setting, summary, {}, Verdict::holds};
  if (summary.median && own.median && *own.median > 0) {
    row.ratio = *summary.median / *own.median;
  }
  if (!summary.median || summary.failures > own.failures || row.ratio > kFailRatio) {
    row.verdict = Verdict::fails;
  } else if (row.ratio > kWorseRatio) {
    row.verdict = Verdict::worse;
  }
  return row;
}

VerifyRow make_missing_row(const VerifySetting& setting, const std::string& fault) {
  return {setting, {}, {}, Verdict::missing, fault};
}

}  // namespace armwright
