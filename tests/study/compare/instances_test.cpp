// Comparisons on functions with an instance per replicate.
#include <gmock/gmock.h>

#include <set>

#include "study/compare/study_support.hpp"

namespace armwright {
namespace {

StudyRequest make_rastrigin_request() {
  StudyRequest request;
  request.problems = {"rastrigin"};
  request.optimizers = {"cmaes"};
  request.settings = {"function.dimension=3"};
  request.replicates = 4;
  request.budget = 60;
  return request;
}

TEST(StudyInstances, AReplicateHasTheSameInstanceForEveryOptimizer) {
  const StudyPlan plan = make_study_plan(make_rastrigin_request());
  std::map<int, std::set<std::vector<double>>> minimisers;  // by replicate
  std::set<std::vector<double>> all;
  for (const Cell& cell : list_cells(plan)) {
    const RunPlan run = make_run_plan(plan, cell);
    const std::vector<double>& minimiser = run.problem.problem->description().known_optimum;
    minimisers[cell.replicate].insert(minimiser);
    all.insert(minimiser);
  }
  for (const auto& [replicate, own] : minimisers) {
    EXPECT_EQ(own.size(), 1u) << replicate;
  }
  EXPECT_EQ(all.size(), 4u);
}

}  // namespace
}  // namespace armwright
