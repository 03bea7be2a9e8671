// Tests which of a run's improvements are judged.
#include "study/run/candidate_pool.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "base/random.hpp"

namespace armwright {
namespace {

using testing::ElementsAre;

// Returns which evaluations of a run are judged, if each of its ten evaluations is an improvement,
// and four last and two best candidates are selected. With `earlier`, returns those that are judged
// if the best of these fails.
std::vector<std::uint64_t> select_of_ten(const std::string& problem, bool earlier = false) {
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
  for (const Candidate& candidate : earlier ? pool.select_earlier() : pool.select()) {
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

TEST(CandidatePoolTest, IfTheBestOneFailsFurtherOnesOfTheWholeRun) {
  EXPECT_THAT(select_of_ten("q2-e2"), ElementsAre(6, 7, 8, 9));
  EXPECT_THAT(select_of_ten("q2-e2", true), ElementsAre(0, 3));    // of 0, 3, 6 and 9
  EXPECT_THAT(select_of_ten("constrained", true), ElementsAre());  // has them already
  EXPECT_THAT(select_of_ten("sphere", true), ElementsAre());       // nothing fails there
}

// Returns the kinds of the judged candidates of a run with twelve improvements, oldest first: the
// objective of an evaluated one, 0 for a recommendation. After each of the last `recommendations`
// improvements comes a recommendation.
std::vector<double> select_with(const Selection& selection, int recommendations) {
  RunPlan plan;
  plan.problem = load_problem("sphere");
  plan.selection = selection;
  CandidatePool pool(plan);
  for (int i = 0; i < 12; ++i) {
    EvaluationRecord record;
    record.index = static_cast<std::uint64_t>(i);
    record.generation = record.index;
    record.x = {static_cast<double>(i)};
    record.evaluation.objectives = {112.0 - i};
    pool.consider(record);
    if (i >= 12 - recommendations) {
      pool.recommend({i + 0.5}, record.generation);
    }
  }
  std::vector<double> kinds;
  for (const Candidate& candidate : pool.select()) {
    kinds.push_back(candidate.recommended ? 0 : candidate.training_objective);
  }
  return kinds;
}

TEST(CandidatePoolTest, EveryOptimizerHasTheSameNumberOfPlaces) {
  const Selection nine{.last = 9, .best = 5, .most = 9};
  EXPECT_THAT(select_with(nine, 0), ElementsAre(109, 108, 107, 106, 105, 104, 103, 102, 101));
  // Recommendations displace the oldest of the last candidates, never the five best.
  EXPECT_THAT(select_with(nine, 2), ElementsAre(107, 106, 105, 104, 103, 0, 102, 0, 101));
  EXPECT_THAT(select_with(nine, 12), ElementsAre(105, 0, 104, 0, 103, 0, 102, 0, 101));
}

// The pool keeps few of a long run's candidates. They must be the same as if it kept all.
TEST(RememberedCandidatesTest, AreThoseThatAllTogetherWouldHaveGiven) {
  RandomStream random("test/remembered-candidates", 1);
  for (int round = 0; round < 200; ++round) {
    const Selection selection{.last = 1 + round % 7, .best = round % 4};
    RememberedCandidates remembered(selection, true);
    std::vector<Candidate> all;
    for (std::uint64_t i = 0; i < 60; ++i) {
      const double x = std::floor(random.uniform(0, 12));  // many come again
      const bool recommended = random.uniform(0, 1) < 0.3;
      all.push_back({{x}, i, i, recommended, recommended ? 0 : std::floor(random.uniform(0, 5))});
      remembered.add(all.back());
    }
    const auto list_different = [&](const std::vector<Candidate>& candidates, int most) {
      std::vector<std::uint64_t> numbers;
      std::vector<double> seen;
      for (const Candidate& candidate : candidates) {
        if (std::ssize(numbers) < most && !std::ranges::count(seen, candidate.x[0])) {
          seen.push_back(candidate.x[0]);
          numbers.push_back(candidate.evaluation);
        }
      }
      return numbers;
    };
    std::vector<Candidate> newest_first(all.rbegin(), all.rend());
    std::vector<Candidate> best_first = all;
    std::erase_if(best_first, [](const Candidate& candidate) { return candidate.recommended; });
    std::ranges::stable_sort(best_first, {}, &Candidate::training_objective);
    const std::vector<Candidate>& last = remembered.last();
    EXPECT_EQ(list_different({last.rbegin(), last.rend()}, 60),
              list_different(newest_first, selection.last));
    EXPECT_EQ(list_different(remembered.best(), 60), list_different(best_first, selection.best));
  }
}

TEST(RememberedCandidatesTest, AreSpreadOverTheWholeOfALongRun) {
  RememberedCandidates remembered({.last = 4, .best = 2}, true);
  constexpr std::uint64_t kCount = 1'000'000;
  for (std::uint64_t i = 0; i < kCount; ++i) {
    remembered.add({{static_cast<double>(i)}, i, i, false, 0});
  }
  const std::vector<Candidate> some = remembered.spread(5);
  ASSERT_EQ(some.size(), 5u);
  EXPECT_EQ(some.back().evaluation, kCount - 1);
  for (std::uint64_t i = 0; i < 5; ++i) {
    EXPECT_NEAR(static_cast<double>(some[i].evaluation), 0.25 * static_cast<double>(i * kCount),
                64);
  }
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
