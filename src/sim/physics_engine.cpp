#include "sim/physics_engine.hpp"

#include "base/error.hpp"
#include "base/text.hpp"
#include "sim/ode_arm.hpp"
#include "sim/tracking_loop.hpp"

namespace armwright {
namespace {

class OdeEngine final : public PhysicsEngine {
 public:
  std::vector<TrackingResult> simulate(const TrackingSetup& setup,
                                       std::span<const TrackingJob> jobs) const override {
    std::vector<TrackingResult> results;
    results.reserve(jobs.size());
    for (const TrackingJob& job : jobs) {
      if (!job.targets->unreachable.empty()) {
        TrackingResult result;
        result.status = SimulationStatus::unreachable;
        result.reason = job.targets->unreachable;
        results.push_back(std::move(result));
        continue;
      }
      OdeArm arm(setup.robot(), job.targets->start_rad, setup.task().physics);
      results.push_back(TrackingLoop(setup, job).run(arm));
    }
    return results;
  }
};

}  // namespace

const std::vector<EngineRow>& engine_table() {
  static const std::vector<EngineRow> table = {
      {"ode", "Open Dynamics Engine, maximal coordinates, dWorldStep: the reference",
       []() -> std::unique_ptr<PhysicsEngine> { return std::make_unique<OdeEngine>(); }},
  };
  return table;
}

std::vector<std::string> engine_names() {
  std::vector<std::string> names;
  for (const EngineRow& row : engine_table()) {
    names.push_back(row.name);
  }
  return names;
}

std::unique_ptr<PhysicsEngine> make_engine(std::string_view name) {
  for (const EngineRow& row : engine_table()) {
    if (row.name == name) {
      return row.make();
    }
  }
  throw Error(ErrorKind::usage, describe_unknown("engine", name, engine_names()));
}

}  // namespace armwright
