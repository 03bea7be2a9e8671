// Loads tracking problems for tests.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "problems/config/problem_loader.hpp"
#include "problems/tracking/tracking_problem.hpp"

namespace armwright {

inline constexpr const char* kOracle = ARMWRIGHT_TEST_DATA "/tracking-oracle.json";

// Returns the tracking problem, which keeps the loaded problem alive. Null for another problem.
inline std::shared_ptr<const TrackingProblem> share_tracking(const LoadedProblem& loaded) {
  return {loaded.problem, loaded.tracking()};
}

inline std::shared_ptr<const TrackingProblem> load_tracking(
    const std::string& name, const std::vector<std::string>& overrides = {}) {
  return share_tracking(load_problem(name, overrides));
}

inline std::vector<double> get_start(const TrackingProblem& problem) {
  return problem.make_vector(problem.config().start);
}

}  // namespace armwright
