// Tracking problems as the tests of them ask for them.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "problems/config/problem_loader.hpp"
#include "problems/tracking/tracking_problem.hpp"

namespace armwright {

inline constexpr const char* kOracle = ARMWRIGHT_TEST_DATA "/tracking-oracle.json";

inline std::shared_ptr<const TrackingProblem> load_tracking(
    const std::string& name, const std::vector<std::string>& overrides = {}) {
  return load_problem(name, overrides).tracking;
}

inline std::vector<double> get_start(const TrackingProblem& problem) {
  return problem.make_vector(problem.config().start);
}

}  // namespace armwright
