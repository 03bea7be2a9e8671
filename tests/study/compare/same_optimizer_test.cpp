// An A/A test: an optimizer is compared with itself under another name. Every difference found is a
// false alarm. The share of false alarms must not exceed the significance level.
#include <gtest/gtest.h>

#include "study/analysis/study_result.hpp"
#include "study/compare/optimizer_streams.hpp"
#include "study/compare/study_plan.hpp"
#include "study/contract/memory_evaluator.hpp"

namespace armwright {
namespace {

constexpr int kStudies = 200;
constexpr int kReplicates = 12;

// A plan with ga twice; `optimizer` 0 and 1.
StudyPlan make_plan(std::uint64_t seed) {
  StudyRequest request;
  request.problems = {"sphere"};
  request.settings = {"function.dimension=4"};
  request.optimizers = {"ga"};
  request.replicates = kReplicates;
  request.budget = 140;
  request.seed = seed;
  request.baselines = false;
  StudyPlan plan = make_study_plan(request);
  plan.optimizers.push_back(plan.optimizers.front());
  plan.optimizers.back().label = "ga under another name";
  plan.optimizers.back().stream.clear();
  name_streams(plan);
  return plan;
}

double run(const StudyPlan& plan, const Cell& cell) {
  const RunPlan run = make_run_plan(plan, cell);
  MemoryEvaluator evaluator(*run.problem.problem, {.budget = run.budget});
  run.optimizer.make(run.options)->minimize(evaluator, run.seed);
  return *evaluator.best();
}

TEST(SameOptimizer, IsFoundDifferentAsOftenAsTheLevelSays) {
  int alarms = 0;
  for (int study = 0; study < kStudies; ++study) {
    const StudyPlan plan = make_plan(static_cast<std::uint64_t>(study));
    std::vector<std::vector<double>> values(2);
    for (std::size_t optimizer = 0; optimizer < 2; ++optimizer) {
      for (int replicate = 1; replicate <= kReplicates; ++replicate) {
        values[optimizer].push_back(run(plan, {0, optimizer, replicate}));
      }
    }
    EXPECT_NE(values[0], values[1]) << study;  // each has its own random stream
    alarms += compare_pairs(values).front().is_significant() ? 1 : 0;
  }
  const double share = static_cast<double>(alarms) / kStudies;
  RecordProperty("false_alarms", alarms);
  EXPECT_GE(share, 0.02);
  EXPECT_LE(share, 0.09);
}

}  // namespace
}  // namespace armwright
