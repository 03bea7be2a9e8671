// The engine `articulated`: joint coordinates, batches of simulations in SIMD lanes. Each lane
// is one (design, test case) pair. What a lane computes does not depend on its neighbours or on its
// place, so results are the same for any batch and any number of threads, with one build and one
// SIMD level. Semi-implicit Euler in the same step order as the engine `ode`.
#pragma once

#include <memory>

#include "sim/tracking/physics_engine.hpp"

namespace armwright {

// options.simd has a value that this CPU supports.
std::unique_ptr<PhysicsEngine> make_articulated_engine(const EngineOptions& options);

}  // namespace armwright
