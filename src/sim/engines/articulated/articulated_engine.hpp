// The engine `articulated`: joint coordinates, batches of simulations in SIMD lanes. Each lane is
// one (design, test case) pair. A lane's results depend neither on the other lanes nor on its
// place. They are therefore the same for any batch and any number of threads, with one build and
// one SIMD level. The integrator is semi-implicit Euler, with the same order of steps as in the
// engine `ode`.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "sim/tracking/physics_engine.hpp"

namespace armwright {

// options.simd must have a value, a level that this CPU supports.
std::unique_ptr<PhysicsEngine> make_articulated_engine(const EngineOptions& options);

namespace articulated {

// Computes PhysicsEngine::calc_derivatives() for a job that can be simulated, always in double. The
// results are the same at any SIMD level.
std::vector<double> calc_point_derivatives(const TrackingSetup& setup, const TrackingJob& job,
                                           std::span<const ArmDesign> directions);

}  // namespace articulated
}  // namespace armwright
