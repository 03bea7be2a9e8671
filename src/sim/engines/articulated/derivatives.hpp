// Exact derivatives of a tracking simulation with respect to what a design says of its joints.
#pragma once

#include <span>
#include <vector>

#include "sim/tracking/tracking.hpp"

namespace armwright::articulated {

// See PhysicsEngine::calc_derivatives(). Always in double, and the same at any SIMD level.
std::vector<double> calc_point_derivatives(const TrackingSetup& setup, const TrackingJob& job,
                                           std::span<const ArmDesign> directions);

}  // namespace armwright::articulated
