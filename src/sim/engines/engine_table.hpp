// The explicit table of the physics engines: one row per engine, and one row per engine that this
// build leaves out.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/tracking/physics_engine.hpp"

namespace armwright {

struct EngineRow {
  std::string name;
  std::string summary;
  bool simd = false;  // it works in SIMD lanes: precision and SIMD level can be chosen
  // Makes the engine. If it works in SIMD lanes, options.simd must have a value, a level that this
  // CPU supports.
  std::unique_ptr<PhysicsEngine> (*make)(const EngineOptions& options);
};

// An optional engine that this build leaves out.
struct MissingEngine {
  std::string name;
  std::string reason;  // with the next step for the user
};

const std::vector<EngineRow>& engine_table();
const std::vector<MissingEngine>& missing_engine_table();
std::vector<std::string> engine_names();
// Throws Error{usage} if there is no engine of that name, or if this build leaves it out.
const EngineRow& find_engine(std::string_view name,
                             std::span<const EngineRow> table = engine_table());

// Returns precision and SIMD level as the engine will use them. An engine with SIMD gets the best
// level of this machine if none is given. Throws Error{usage} for a choice that the engine does not
// have, and for a level that this CPU lacks.
EngineOptions resolve_options(const EngineRow& engine, EngineOptions options);
// Throws what find_engine() and resolve_options() throw.
std::unique_ptr<PhysicsEngine> make_engine(std::string_view name,
                                           const EngineOptions& options = {});

}  // namespace armwright
