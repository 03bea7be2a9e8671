// Which physics engines a problem is simulated with, read from its table [physics]:
//   engine          of training, and of everything else unless judging_engine says otherwise
//   judging_engine  of validation, test and every evaluation of a given design
//   precision       "double" or "float": of training only; judged is always in double
//   simd            "auto" (the best level of this machine) or a level
// Precision and SIMD level are for engines that work in SIMD lanes.
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

struct EnginePair {
  std::shared_ptr<const PhysicsEngine> training;
  std::shared_ptr<const PhysicsEngine> judging;  // may be the same
  std::string training_name;
  std::string judging_name;

  const PhysicsEngine& get(CaseRole role) const {
    return role == CaseRole::training ? *training : *judging;
  }
};

struct ChosenEngines {
  EnginePair engines;
  // What the engines use, which is part of what determines a result; nothing if none has SIMD.
  std::optional<SimdLevel> simd;
};

// Error{usage} names the key of `physics` at fault. `table` holds the engines to choose from.
ChosenEngines choose_engines(const ConfigTable& physics,
                             std::span<const EngineRow> table = engine_table());

}  // namespace armwright
