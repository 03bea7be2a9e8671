// The choice of a problem's physics engines, read from its table [physics]:
//   engine          for training; also for all other cases unless judging_engine is given
//   judging_engine  for validation, for tests and for every evaluation of a given design
//   precision       "double" or "float"; training only, all other cases use double
//   simd            "auto" (the best level of this machine) or a level
// Precision and SIMD level apply to engines that work in SIMD lanes.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>

#include "base/config.hpp"
#include "problems/interface/problem.hpp"
#include "sim/engines/engine_table.hpp"
#include "sim/tracking/physics_engine.hpp"

namespace armwright {

// The two engines of a problem. They may be the same object.
struct EnginePair {
  std::shared_ptr<const PhysicsEngine> training;
  std::shared_ptr<const PhysicsEngine> judging;  // for all roles but training
  std::string training_name;
  std::string judging_name;
  // The SIMD level that the engines use; it decides the last bits of results. Nothing if neither
  // engine works in SIMD lanes.
  std::optional<SimdLevel> simd;

  const PhysicsEngine& get(CaseRole role) const {
    return role == CaseRole::training ? *training : *judging;
  }
};

// Makes the engines that `physics` asks for. `table` has the engines to choose from. Throws
// Error{usage} with the wrong key of `physics`.
EnginePair choose_engines(const ConfigTable& physics,
                          std::span<const EngineRow> table = engine_table());

}  // namespace armwright
