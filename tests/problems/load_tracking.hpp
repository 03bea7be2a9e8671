// Loads tracking problems for tests.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
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

// Returns the metric with this name. Adds a failure to the test if there is none.
inline double get_metric(const TrackingProblem& problem, const Evaluation& evaluation,
                         const std::string& name) {
  const auto& metrics = problem.description().metrics;
  const auto found = std::ranges::find(metrics, name, &Quantity::name);
  if (found == metrics.end()) {
    ADD_FAILURE() << "no metric " << name;
    return 0;
  }
  return evaluation.metrics.at(static_cast<std::size_t>(found - metrics.begin()));
}

}  // namespace armwright
