// The explicit table of the physics engines: one row per engine, and one row per engine that this build
// leaves out.
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
  bool simd = false;  // works in SIMD lanes: precision and SIMD level can be chosen
  // Of an engine with SIMD, `simd` has a value that this CPU supports.
  std::unique_ptr<PhysicsEngine> (*make)(const EngineOptions& options);
};

// An optional engine that this build leaves out.
struct MissingEngine {
  std::string name;
  std::string reason;  // and what to do about it
};

const std::vector<EngineRow>& engine_table();
const std::vector<MissingEngine>& missing_engine_table();
std::vector<std::string> engine_names();
// Error{usage} if there is none of that name, or this build leaves it out.
const EngineRow& find_engine(std::string_view name,
                             std::span<const EngineRow> table = engine_table());

// Precision and SIMD level as the engine will use them: of one with SIMD the level is set to the
// best of this machine where none is given. Error{usage} for a choice that the engine does not
// have, and for a level that this CPU lacks.
EngineOptions resolve_options(const EngineRow& engine, EngineOptions options);
std::unique_ptr<PhysicsEngine> make_engine(std::string_view name,
                                           const EngineOptions& options = {});

}  // namespace armwright
