// Which of a run's improvements are judged.
#include "study/candidate_pool.hpp"

#include <gmock/gmock.h>

namespace armwright {
namespace {

using testing::ElementsAre;

// Of a run of ten improvements, one an evaluation: which are judged if four may be, and two more
// for their objective.
std::vector<std::uint64_t> select_of_ten(const std::string& problem) {
  RunPlan plan;
  plan.problem = load_problem(problem);
  plan.selection = {.last = 4, .best = 2};
  CandidatePool pool(plan);
  for (std::uint64_t i = 0; i < 10; ++i) {
    EvaluationRecord record;
    record.index = i;
    record.x = {static_cast<double>(i)};
    record.evaluation.objectives = {100.0 - static_cast<double>(i)};
    pool.consider(record);
  }
  std::vector<std::uint64_t> evaluations;
  for (const Candidate& candidate : pool.select()) {
    evaluations.push_back(candidate.evaluation);
  }
  return evaluations;
}

TEST(CandidatePoolTest, TheLastImprovementsAreJudged) {
  EXPECT_THAT(select_of_ten("sphere"), ElementsAre(6, 7, 8, 9));
}

TEST(CandidatePoolTest, WithConstraintsThoseOfTheWholeRun) {
  EXPECT_THAT(select_of_ten("constrained"), ElementsAre(0, 3, 6, 8, 9));
}

TEST(CandidatePoolTest, NothingFeasibleIsNothingToJudge) {
  for (const char* name : {"sphere", "constrained"}) {
    RunPlan plan;
    plan.problem = load_problem(name);
    EXPECT_TRUE(CandidatePool(plan).select().empty());
  }
}

}  // namespace
}  // namespace armwright
