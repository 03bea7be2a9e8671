#include "study/verification/prepared_setting.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/error.hpp"
#include "base/text.hpp"
#include "problems/config/problem_readers.hpp"
#include "sim/engines/engine_table.hpp"
#include "sim/tracking/elasticity.hpp"

namespace armwright {
namespace {

constexpr const char* kSubsteps = "physics.substeps=";

// Returns the settings of the problem that change all joints beside its own changes.
std::vector<std::string> list_scale_overrides(const PlantScales& changes, const PlantScales& own) {
  std::vector<std::string> overrides;
  const auto add = [&](const char* key, double value, double usual) {
    if (value != usual) {
      overrides.push_back(fmt::format("robot.{}={}", key, format_exact(value)));
    }
  };
  add("friction_scale", own.friction * changes.friction, own.friction);
  add("armature_scale", own.armature * changes.armature, own.armature);
  add("stiffness_scale", own.stiffness * changes.stiffness, own.stiffness);
  add("armature_share", std::max(own.armature_share, changes.armature_share), own.armature_share);
  add("elastic_hz", changes.elastic_hz > 0 ? changes.elastic_hz : own.elastic_hz, own.elastic_hz);
  return overrides;
}

// Returns the settings of the problem that make the setting's plants.
std::vector<std::string> list_plant_overrides(const VerifySetting& setting,
                                              const TrackingConfig& config) {
  if (setting.perturbation.empty()) {
    return {};
  }
  if (const OtherPlant* other = find_other_plant(setting.perturbation)) {
    std::vector<std::string> overrides = list_scale_overrides(other->changes, config.plant_scales);
    if (config.fitted_plant) {  // drawn values would replace those that are changed
      overrides.emplace_back("perturbation.fitted=none");
    }
    return overrides;
  }
  if (setting.perturbation == kNoPerturbation) {
    return config.perturbation.applies_to(CaseRole::test) ? make_overrides(Perturbation{})
                                                          : std::vector<std::string>{};
  }
  if (config.perturbation.changes_anything()) {
    Perturbation plants =
        load_perturbation(setting.perturbation, {config.robot, config.start, config.fitted_plant});
    plants.where =
        Perturbation::Where::everywhere;  // also a preset that is meant for training only
    return make_overrides(plants);
  }
  return {"perturbation.preset=" + setting.perturbation, "perturbation.apply_to=everywhere"};
}

// Returns all changes of the problem's settings that make this setting.
std::vector<std::string> list_setting_changes(const VerifySetting& setting,
                                              const LoadedProblem& base) {
  const TrackingConfig& config = base.tracking()->config();
  // Settings with other masses or another plant have the same task, each with its own substeps.
  std::vector<std::string> changes = list_proposals(nlohmann::json::parse(base.resolved_json));
  std::erase_if(changes, [](const std::string& change) { return change.starts_with(kSubsteps); });
  std::ranges::move(list_plant_overrides(setting, config), std::back_inserter(changes));
  changes.push_back("physics.engine=" + setting.engine);
  changes.push_back("physics.judging_engine=" + setting.engine);
  // Designs are judged in double. Only some engines have a SIMD level.
  changes.push_back("physics.precision=double");
  if (!find_engine(setting.engine).simd) {
    changes.push_back("physics.simd=auto");
  }
  changes.push_back(fmt::format("{}{}", kSubsteps, setting.substeps));
  changes.push_back("robot.mass_scale=" + format_exact(config.mass_scale * setting.mass_factor));
  return changes;
}

// Returns whether the setting may get more substeps than it names. A setting with another number
// than the design's own one shows what that number does, unless its plant is another one.
bool may_need_substeps(const VerifySetting& setting, const TrackingConfig& own) {
  const OtherPlant* const other = find_other_plant(setting.perturbation);
  if (other == nullptr && setting.substeps != own.task.physics.substeps) {
    return false;
  }
  return (other != nullptr && other->changes.elastic_hz > 0) ||
         std::ranges::any_of(own.robot.joints,
                             [](const Joint& joint) { return joint.plant.is_elastic(); });
}

// Returns the substeps that the springs of the problem's plants need; 0 if they have none.
int count_needed_substeps(const TrackingConfig& config) {
  const auto mode = find_fastest_mode(make_fastest_arm(config.robot, config.perturbation));
  return mode ? count_substeps(*mode, config.task.control_period_s) : 0;
}

}  // namespace

VerifySetting get_own_setting(const TrackingProblem& problem) {
  const TrackingConfig& config = problem.config();
  return {config.engines.judging_name, config.task.physics.substeps, 1,
          config.perturbation.applies_to(CaseRole::test) ? "" : kNoPerturbation};
}

PreparedSetting prepare_setting(const VerifySetting& setting, const LoadedProblem& base,
                                const ProblemLoader& load, bool is_own) {
  PreparedSetting prepared{setting, {}, {}, {}};
  const auto load_with = [&](int substeps) {
    prepared.setting.substeps = substeps;
    prepared.changes = list_setting_changes(prepared.setting, base);
    return load(prepared.changes);
  };
  try {
    int substeps = setting.substeps;
    if (!is_own && may_need_substeps(setting, base.tracking()->config())) {
      const LoadedProblem finest = load_with(kMostSubsteps);
      const int needed = count_needed_substeps(finest.tracking()->config());
      prepared.setting.springs = needed >= substeps;
      substeps = std::max(substeps, needed);
    }
    prepared.problem = load_with(substeps);
  } catch (const Error& error) {
    if (is_own || error.kind() == ErrorKind::io) {
      throw;
    }
    prepared.setting = setting;
    prepared.fault = error.what();
  }
  return prepared;
}

std::optional<ErrorSurvey> survey_setting(PreparedSetting& prepared, const ArmDesign& design,
                                          const ChosenCases& cases, unsigned jobs, StopSignal& stop,
                                          RunObserver& observer, const Progress& progress,
                                          bool is_own) {
  if (!prepared.problem) {
    return std::nullopt;
  }
  try {
    return survey_with_progress(*prepared.problem->tracking(), design, cases, jobs, stop, observer,
                                progress);
  } catch (const Error& error) {
    if (is_own || error.kind() == ErrorKind::io) {
      throw;
    }
    prepared.fault = error.what();
    return std::nullopt;
  }
}

}  // namespace armwright
