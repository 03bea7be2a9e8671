// An engine with SIMD lanes for tests of how engines are chosen and fed: it answers at once with
// made-up errors that depend on design, case and precision, and not on the SIMD level.
#pragma once

#include <memory>
#include <vector>

#include "sim/engines/engine_table.hpp"
#include "sim/tracking/physics_engine.hpp"

namespace armwright {

class LanesEngine final : public PhysicsEngine {
 public:
  explicit LanesEngine(const EngineOptions& options) : options_(options) {}

  std::vector<TrackingResult> simulate(const TrackingSetup& /*setup*/,
                                       std::span<const TrackingJob> jobs) const override {
    std::vector<TrackingResult> results;
    for (const TrackingJob& job : jobs) {
      const double error_m = calc_error_m(*job.design, *job.targets, options_.precision);
      TrackingResult& result = results.emplace_back();
      result.steps = job.targets->steps;
      result.point_error_m.assign(job.targets->segments.size(), error_m);
      result.mean_error_m = error_m;
      result.peak_effort.resize(job.targets->joints);
      result.rms_effort.resize(job.targets->joints);
      result.saturated_share.resize(job.targets->joints);
    }
    return results;
  }
  BatchSize batch_size() const override { return {.granularity = 4, .largest = 16}; }

  static double calc_error_m(const ArmDesign& design, const TargetTable& targets,
                             Precision precision) {
    double error_m = 0.01 + 1e-3 * targets.start_positions[0] * targets.start_positions[0];
    for (const JointDrive& joint : design.joints) {
      error_m += 1e-9 * joint.gains[0];
    }
    return precision == Precision::single ? static_cast<double>(static_cast<float>(error_m))
                                          : error_m;
  }

 private:
  EngineOptions options_;
};

// The real engine that every build has, and "lanes".
inline const std::vector<EngineRow>& engines_with_lanes() {
  static const std::vector<EngineRow> table = {
      find_engine("ode"),
      {"lanes", "made up by a test", true,
       [](const EngineOptions& options) -> std::unique_ptr<PhysicsEngine> {
         return std::make_unique<LanesEngine>(options);
       }}};
  return table;
}

}  // namespace armwright
