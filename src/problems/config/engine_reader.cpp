// [physics]: the engines that simulate, and the numbers of the physics.
#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "base/error.hpp"
#include "problems/config/problem_readers.hpp"

namespace armwright {

const Setting<int> kPhysicsSubsteps{"substeps",
                                    {.lower = 1, .upper = 1000},
                                    PhysicsSettings{}.substeps,
                                    "physics steps per control period"};

namespace {

constexpr const char* kAuto = "auto";

std::vector<std::string> list_simd_choices() {
  std::vector<std::string> levels = simd_names();
  levels.insert(levels.begin(), kAuto);
  return levels;
}

const Setting<std::string> kPhysicsEngine{
    "engine", engine_names, "ode",
    "engine that simulates training cases, and all other cases unless judging_engine is given "
    "(armwright list engines)"};
const Setting<std::string> kPhysicsJudgingEngine{
    "judging_engine", engine_names, kNoDefault,
    "engine that simulates validation and test cases and every evaluation of a given design "
    "(default: the engine)"};
const Setting<std::string> kPhysicsPrecision{
    "precision", precision_names, "double",
    "precision of training, for engines with SIMD; every other simulation is in double"};
const Setting<std::string> kPhysicsSimd{
    "simd", list_simd_choices, kAuto,
    "instruction set, for engines with SIMD; auto: the widest of this machine. The level in use is "
    "recorded, because the last digits of results depend on it"};
const Setting<double> kPhysicsGravity{"gravity_m_per_s2",
                                      {.lower = 0, .upper = 1000},
                                      PhysicsSettings{}.gravity_m_per_s2,
                                      "gravity, downwards along -z"};
const Setting<double> kPhysicsErp{
    "erp",
    {.lower = 0, .upper = 1},
    PhysicsSettings{}.erp,
    "ODE's error reduction parameter: share of a joint's position error that one step corrects"};
const Setting<double> kPhysicsCfm{"cfm",
                                  {.lower = 0, .upper = 1},
                                  PhysicsSettings{}.cfm,
                                  "ODE's constraint force mixing: how soft its joints are"};

const EngineRow& read_engine(const ConfigTable& physics, const Setting<std::string>& setting,
                             const std::string& fallback, std::span<const EngineRow> table) {
  std::vector<std::string> names;
  for (const EngineRow& row : table) {
    names.push_back(row.name);
  }
  Setting<std::string> any_text = setting;
  any_text.choices = nullptr;
  for (const MissingEngine& missing : missing_engine_table()) {
    if (physics.get_or(any_text, fallback) == missing.name &&
        std::ranges::find(names, missing.name) == names.end()) {
      physics.refuse(setting, missing.reason);
    }
  }
  const std::string name = physics.get_or(setting.among(names), fallback);
  return *std::ranges::find(table, name, &EngineRow::name);
}

// Returns the options for one of the two engines. An option that it lacks is for the other one.
EngineOptions resolve(const EngineRow& engine, EngineOptions options) {
  return engine.simd ? resolve_options(engine, options) : EngineOptions{};
}

}  // namespace

const SettingTable kPhysicsSettings{
    .key = "physics",
    .settings = {&kPhysicsEngine, &kPhysicsJudgingEngine, &kPhysicsPrecision, &kPhysicsSimd,
                 &kPhysicsGravity, &kPhysicsSubsteps, &kPhysicsErp, &kPhysicsCfm}};

EnginePair read_engines(const ConfigTable& physics, std::span<const EngineRow> table) {
  const EngineRow& training = read_engine(physics, kPhysicsEngine, *kPhysicsEngine.fallback, table);
  const EngineRow& judging = read_engine(physics, kPhysicsJudgingEngine, training.name, table);
  EngineOptions options;
  options.precision = parse_precision(physics.get(kPhysicsPrecision));
  const std::string simd = physics.get(kPhysicsSimd);
  if (simd != kAuto) {
    options.simd = parse_simd(simd);
  }

  try {
    resolve_options(training, {.precision = options.precision, .simd = {}});
  } catch (const Error& error) {
    physics.refuse(kPhysicsPrecision,
                   fmt::format("{} ('double' suits every engine)", error.what()));
  }
  const EngineOptions double_only{.precision = Precision::double_, .simd = options.simd};
  EnginePair engines;
  try {
    resolve_options(training.simd ? training : judging, double_only);
    const EngineOptions for_training = resolve(training, options);
    const EngineOptions for_judging = resolve(judging, double_only);
    engines.training_name = training.name;
    engines.judging_name = judging.name;
    engines.training = training.make(for_training);
    const bool alike = &judging == &training && options.precision == Precision::double_;
    engines.judging = alike ? engines.training : judging.make(for_judging);
    if (const auto level = training.simd ? for_training.simd : for_judging.simd) {
      physics.settle(kPhysicsSimd, to_string(*level));
    }
  } catch (const Error& error) {
    physics.refuse(kPhysicsSimd, fmt::format("{} ('auto' suits every engine)", error.what()));
  }
  return engines;
}

PhysicsSettings read_physics(const ConfigTable& physics) {
  PhysicsSettings read;
  read.gravity_m_per_s2 = physics.get(kPhysicsGravity);
  read.substeps = physics.get(kPhysicsSubsteps);
  read.erp = physics.get(kPhysicsErp);
  read.cfm = physics.get(kPhysicsCfm);
  return read;
}

}  // namespace armwright
