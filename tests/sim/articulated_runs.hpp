// Functions that run the engine `articulated`, shared by its tests.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "physics/tracking_arms.hpp"
#include "sim/simd/simd_level.hpp"

namespace armwright::articulated_test {

using namespace physics_test;

inline std::vector<EngineOptions> make_double_options() {
  std::vector<EngineOptions> options;
  for (const std::string& name : supported_simd_names()) {
    options.push_back({.precision = Precision::double_, .simd = parse_simd(name)});
  }
  return options;
}

inline std::vector<EngineOptions> make_all_options() {
  std::vector<EngineOptions> options = make_double_options();
  for (EngineOptions one : make_double_options()) {
    one.precision = Precision::single;
    options.push_back(one);
  }
  return options;
}

inline std::string describe(const EngineOptions& options) {
  return std::string(to_string(*options.simd)) + ", " + to_string(options.precision);
}

inline std::unique_ptr<PhysicsEngine> make_articulated(const EngineOptions& options = {}) {
  return make_engine("articulated", options);
}

inline TrackingResult simulate_alone(const PhysicsEngine& engine, const TrackingSetup& setup,
                                     const TrackingJob& job) {
  auto results = engine.simulate(setup, {&job, 1});
  EXPECT_EQ(results.size(), 1U);
  return std::move(results.at(0));
}

inline double calc_mean_m(const std::vector<TrackingResult>& results) {
  double sum_m = 0;
  for (const TrackingResult& result : results) {
    EXPECT_EQ(result.status, SimulationStatus::ok) << result.reason;
    sum_m += result.mean_error_m;
  }
  return sum_m / static_cast<double>(results.size());
}

}  // namespace armwright::articulated_test
