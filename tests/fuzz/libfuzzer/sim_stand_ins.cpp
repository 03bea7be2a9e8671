// Loading a problem makes its engine, and simulates a start that is proposed. Here every simulation
// ends well at once, so that fuzzers need not wait for the SIMD kernels to compile.
#include "sim/engines/articulated/articulated_engine.hpp"
#include "sim/kinematics/posture_solver.hpp"
#include "sim/kinematics/targets.hpp"

namespace armwright {
namespace {

class NoEngine final : public PhysicsEngine {
 public:
  std::vector<TrackingResult> simulate(const TrackingSetup& /*setup*/,
                                       std::span<const TrackingJob> jobs) const override {
    return std::vector<TrackingResult>(jobs.size());
  }
  bool has_derivatives() const override { return true; }
  BatchSize batch_size() const override { return {}; }
};

}  // namespace

std::unique_ptr<PhysicsEngine> make_articulated_engine(const EngineOptions& /*options*/) {
  return std::make_unique<NoEngine>();
}

targets::MoveFunctions targets::get_move_functions(SimdLevel /*level*/) {
  return {solve_move_scalar, calc_positions_scalar};
}

postures::Solve postures::get_solve(SimdLevel /*level*/) {
  return solve_scalar;
}

}  // namespace armwright
