// Physics engines behind one interface, and the explicit table of them. An engine simulates a batch
// of (design, test case) jobs; results do not depend on the batch a job is in, on the thread or on
// what ran before.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/tracking.hpp"

namespace armwright {

class PhysicsEngine {
 public:
  virtual ~PhysicsEngine() = default;
  // Thread-safe. A simulation that fails is a status in its result; exceptions are for bugs and
  // lack of memory.
  virtual std::vector<TrackingResult> simulate(const TrackingSetup& setup,
                                               std::span<const TrackingJob> jobs) const = 0;
};

struct EngineRow {
  std::string name;
  std::string summary;
  std::unique_ptr<PhysicsEngine> (*make)();
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
const EngineRow& find_engine(std::string_view name);
std::unique_ptr<PhysicsEngine> make_engine(std::string_view name);

}  // namespace armwright
