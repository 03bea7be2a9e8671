#include "sim/physics_engine.hpp"

#include <fmt/format.h>

#include "base/error.hpp"
#include "base/text.hpp"
#include "sim/ode_arm.hpp"
#include "sim/tracking_loop.hpp"
#ifdef ARMWRIGHT_WITH_MUJOCO
#include "sim/mujoco_arm.hpp"
#endif

namespace armwright {
namespace {

// For engines that step one arm at a time. `make_arm` makes the arm of a job whose targets can be
// reached, at its start.
template <class MakeArm>
std::vector<TrackingResult> simulate_one_by_one(const TrackingSetup& setup,
                                                std::span<const TrackingJob> jobs,
                                                const MakeArm& make_arm) {
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
    auto arm = make_arm(job.targets->start_rad);
    results.push_back(TrackingLoop(setup, job).run(arm));
  }
  return results;
}

class OdeEngine final : public PhysicsEngine {
 public:
  std::vector<TrackingResult> simulate(const TrackingSetup& setup,
                                       std::span<const TrackingJob> jobs) const override {
    return simulate_one_by_one(setup, jobs, [&](std::span<const double> start) {
      return OdeArm(setup.robot(), start, setup.task().physics);
    });
  }
};

#ifdef ARMWRIGHT_WITH_MUJOCO
class MujocoEngine final : public PhysicsEngine {
 public:
  std::vector<TrackingResult> simulate(const TrackingSetup& setup,
                                       std::span<const TrackingJob> jobs) const override {
    const MujocoModel model(setup.robot(), setup.task().physics);
    return simulate_one_by_one(
        setup, jobs, [&](std::span<const double> start) { return MujocoArm(model, start); });
  }
};
#endif

}  // namespace

const std::vector<EngineRow>& engine_table() {
  static const std::vector<EngineRow> table = {
      {"ode", "Open Dynamics Engine, maximal coordinates, dWorldStep: the reference",
       []() -> std::unique_ptr<PhysicsEngine> { return std::make_unique<OdeEngine>(); }},
#ifdef ARMWRIGHT_WITH_MUJOCO
      {"mujoco", "MuJoCo, reduced coordinates, semi-implicit Euler: to check the others with",
       []() -> std::unique_ptr<PhysicsEngine> { return std::make_unique<MujocoEngine>(); }},
#endif
  };
  return table;
}

const std::vector<MissingEngine>& missing_engine_table() {
  static const std::vector<MissingEngine> table = {
#ifndef ARMWRIGHT_WITH_MUJOCO
      {"mujoco",
       "this armwright was built without MuJoCo; install the Debian package libmujoco-dev and "
       "build with the CMake option ARMWRIGHT_WITH_MUJOCO=ON"},
#endif
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

const EngineRow& find_engine(std::string_view name) {
  for (const EngineRow& row : engine_table()) {
    if (row.name == name) {
      return row;
    }
  }
  for (const MissingEngine& missing : missing_engine_table()) {
    if (missing.name == name) {
      throw Error(ErrorKind::usage,
                  fmt::format("engine '{}' is not there: {}", name, missing.reason));
    }
  }
  throw Error(ErrorKind::usage, describe_unknown("engine", name, engine_names()));
}

std::unique_ptr<PhysicsEngine> make_engine(std::string_view name) {
  return find_engine(name).make();
}

}  // namespace armwright
