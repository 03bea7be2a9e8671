#include "problems/tracking/engine_choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "base/error.hpp"

namespace armwright {
namespace {

constexpr const char* kAuto = "auto";

const EngineRow& read_engine(const ConfigTable& physics, std::string_view key,
                             std::string_view fallback, std::span<const EngineRow> table) {
  std::vector<std::string> names;
  for (const EngineRow& row : table) {
    names.push_back(row.name);
  }
  for (const MissingEngine& missing : missing_engine_table()) {
    if (physics.get_string(key, fallback) == missing.name &&
        std::ranges::find(names, missing.name) == names.end()) {
      physics.refuse(key, missing.reason);
    }
  }
  const std::string name = physics.get_choice(key, names, fallback);
  return *std::ranges::find(table, name, &EngineRow::name);
}

// Returns the options of one of the two chosen engines. An engine without SIMD gets the defaults,
// because the options are meant for the other engine.
EngineOptions resolve(const EngineRow& engine, EngineOptions options) {
  return engine.simd ? resolve_options(engine, options) : EngineOptions{};
}

}  // namespace

EnginePair choose_engines(const ConfigTable& physics, std::span<const EngineRow> table) {
  const EngineRow& training = read_engine(physics, "engine", "ode", table);
  const EngineRow& judging = read_engine(physics, "judging_engine", training.name, table);
  std::vector<std::string> levels = simd_names();
  levels.insert(levels.begin(), kAuto);
  EngineOptions options;
  options.precision = parse_precision(physics.get_choice("precision", precision_names(), "double"));
  const std::string simd = physics.get_choice("simd", levels, kAuto);
  if (simd != kAuto) {
    options.simd = parse_simd(simd);
  }

  try {
    resolve_options(training, {.precision = options.precision, .simd = {}});
  } catch (const Error& error) {
    physics.refuse("precision", fmt::format("{} ('double' suits every engine)", error.what()));
  }
  const EngineOptions double_only{.precision = Precision::double_, .simd = options.simd};
  EnginePair chosen;
  try {
    resolve_options(training.simd ? training : judging, double_only);
    const EngineOptions for_training = resolve(training, options);
    const EngineOptions for_judging = resolve(judging, double_only);
    chosen.simd = training.simd ? for_training.simd : for_judging.simd;
    chosen.training_name = training.name;
    chosen.judging_name = judging.name;
    chosen.training = training.make(for_training);
    const bool alike = &judging == &training && options.precision == Precision::double_;
    chosen.judging = alike ? chosen.training : judging.make(for_judging);
  } catch (const Error& error) {
    physics.refuse("simd", fmt::format("{} ('auto' suits every engine)", error.what()));
  }
  return chosen;
}

}  // namespace armwright
