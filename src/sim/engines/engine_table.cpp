#include "sim/engines/engine_table.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.hpp"
#include "base/text.hpp"
#include "sim/engines/articulated/articulated_engine.hpp"
#include "sim/engines/ode/ode_arm.hpp"
#include "sim/tracking/engine_support.hpp"
#include "sim/tracking/tracking_loop.hpp"
#ifdef ARMWRIGHT_WITH_MUJOCO
#include "sim/engines/mujoco/mujoco_arm.hpp"
#endif

namespace armwright {
namespace {

// Simulates jobs for engines that step one arm at a time. `make_arm` makes the arm of a job at its
// start. It is not called for a job whose targets are out of reach.
template <class MakeArm>
std::vector<TrackingResult> simulate_one_by_one(const TrackingSetup& setup,
                                                std::span<const TrackingJob> jobs,
                                                const MakeArm& make_arm) {
  std::vector<TrackingResult> results;
  results.reserve(jobs.size());
  for (const TrackingJob& job : jobs) {
    TrackingResult unreachable;
    if (apply_unreachable(job, unreachable)) {
      results.push_back(std::move(unreachable));
      continue;
    }
    const TrackingSetup& own = job.choose_setup(setup);
    auto arm = make_arm(own, job.targets->start_positions);
    results.push_back(TrackingLoop(own, job).run(arm));
  }
  return results;
}

std::vector<TrackingResult> simulate_in_ode(const TrackingSetup& setup,
                                            std::span<const TrackingJob> jobs) {
  return simulate_one_by_one(setup, jobs,
                             [](const TrackingSetup& own, std::span<const double> start) {
                               return OdeArm(own.robot(), start, own.task().physics);
                             });
}

#ifdef ARMWRIGHT_WITH_MUJOCO
std::vector<TrackingResult> simulate_in_mujoco(const TrackingSetup& setup,
                                               std::span<const TrackingJob> jobs) {
  const auto model = compile_for_mujoco(setup.robot(), setup.task().physics);
  return simulate_one_by_one(
      setup, jobs, [&](const TrackingSetup& own, std::span<const double> start) {
        return &own == &setup ? MujocoArm(*model, start)
                              : MujocoArm(own.robot(), start, own.task().physics);
      });
}
#endif

// An engine that steps one arm at a time.
class OneByOneEngine final : public PhysicsEngine {
 public:
  using Simulate = std::vector<TrackingResult> (*)(const TrackingSetup& setup,
                                                   std::span<const TrackingJob> jobs);
  explicit OneByOneEngine(Simulate function) : simulate_(function) {}

  std::vector<TrackingResult> simulate(const TrackingSetup& setup,
                                       std::span<const TrackingJob> jobs) const override {
    return simulate_(setup, jobs);
  }
  BatchSize batch_size() const override { return {}; }

 private:
  Simulate simulate_;
};

// Returns the advice for a choice that an engine does not have.
std::string describe_engines_with_simd() {
  std::vector<std::string> names;
  for (const EngineRow& row : engine_table()) {
    if (row.simd) {
      names.push_back(row.name);
    }
  }
  return names.empty()
             ? "leave it out"
             : fmt::format("leave it out or choose an engine that has one: {}", join(names, ", "));
}

}  // namespace

const std::vector<EngineRow>& engine_table() {
  static const std::vector<EngineRow> table = {
      {"ode", "Open Dynamics Engine, maximal coordinates, dWorldStep: the reference", false,
       [](const EngineOptions&) -> std::unique_ptr<PhysicsEngine> {
         return std::make_unique<OneByOneEngine>(simulate_in_ode);
       }},
      {"articulated", "joint coordinates, many simulations at once in SIMD lanes", true,
       make_articulated_engine},
#ifdef ARMWRIGHT_WITH_MUJOCO
      {"mujoco", "MuJoCo, joint coordinates, semi-implicit Euler: to check the others with", false,
       [](const EngineOptions&) -> std::unique_ptr<PhysicsEngine> {
         return std::make_unique<OneByOneEngine>(simulate_in_mujoco);
       }},
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

const EngineRow& find_engine(std::string_view name, std::span<const EngineRow> table) {
  std::vector<std::string> names;
  for (const EngineRow& row : table) {
    if (row.name == name) {
      return row;
    }
    names.push_back(row.name);
  }
  for (const MissingEngine& missing : missing_engine_table()) {
    if (missing.name == name) {
      throw Error(ErrorKind::usage,
                  fmt::format("engine '{}' is not there: {}", name, missing.reason));
    }
  }
  throw Error(ErrorKind::usage, describe_unknown("engine", name, names, "armwright list engines"));
}

EngineOptions resolve_options(const EngineRow& engine, EngineOptions options) {
  if (!engine.simd && options.precision != Precision::double_) {
    throw Error(
        ErrorKind::usage,
        fmt::format("the precision is '{}', but engine '{}' always computes in double; {}",
                    to_string(options.precision), engine.name, describe_engines_with_simd()));
  }
  if (!engine.simd && options.simd) {
    throw Error(ErrorKind::usage,
                fmt::format("the SIMD level is '{}', but engine '{}' has none to choose; {}",
                            to_string(*options.simd), engine.name, describe_engines_with_simd()));
  }
  if (options.simd && !is_supported(*options.simd)) {
    throw Error(ErrorKind::usage,
                fmt::format("the SIMD level is '{}', which this CPU lacks; possible here: {}",
                            to_string(*options.simd), join(supported_simd_names(), ", ")));
  }
  if (engine.simd && !options.simd) {
    options.simd = find_best_simd();
  }
  return options;
}

std::unique_ptr<PhysicsEngine> make_engine(std::string_view name, const EngineOptions& options) {
  const EngineRow& row = find_engine(name);
  return row.make(resolve_options(row, options));
}

}  // namespace armwright
