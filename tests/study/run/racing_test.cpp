// Tests races on examples computed by hand: their cost, which candidates drop out, and the reasons
// given. Whole runs with races: racing_run_test.cpp.
#include "study/run/racing.hpp"

#include <gmock/gmock.h>

#include <atomic>
#include <limits>
#include <utility>

#include "study/racing_support.hpp"

namespace armwright {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;

Racing make_racing(const std::string& text) {
  return *read_racing(text);
}

std::vector<std::pair<std::size_t, std::size_t>> list_rungs(const std::string& racing,
                                                            std::size_t candidates,
                                                            std::size_t cases) {
  std::vector<std::pair<std::size_t, std::size_t>> list;
  for (const Rung& rung : plan_rungs(make_racing(racing), candidates, cases)) {
    list.emplace_back(rung.candidates, rung.cases);
  }
  return list;
}

TEST(Racing, TextReadsBack) {
  for (const std::string text :
       {"none", "halving:1:2", "halving:3:4", "abandonment:1:4", "abandonment:1.25:10"}) {
    EXPECT_EQ(to_text(make_racing(text)), text);
  }
  EXPECT_EQ(to_text(make_racing("halving")), "halving:1:2");
  EXPECT_EQ(to_text(make_racing("halving:5")), "halving:5:2");
  EXPECT_EQ(to_text(make_racing("abandonment")), "abandonment:1:4");
  for (const std::string text : {"", "some", "none:1", "halving:0", "halving:1:1", "halving:1:2:3",
                                 "abandonment:0.9", "abandonment:nan", "abandonment:1:0"}) {
    EXPECT_FALSE(read_racing(text)) << text;
  }
}

TEST(Halving, RungsAndTheirCost) {
  EXPECT_THAT(list_rungs("halving:1:2", 8, 4),
              ElementsAre(std::pair(8, 1), std::pair(4, 2), std::pair(2, 4)));
  EXPECT_EQ(calc_race_cost(plan_rungs(make_racing("halving:1:2"), 8, 4)), 8u + 4 + 2 * 2);
  EXPECT_THAT(list_rungs("halving:3:3", 5, 10),
              ElementsAre(std::pair(5, 3), std::pair(2, 9), std::pair(1, 10)));
  EXPECT_EQ(calc_race_cost(plan_rungs(make_racing("halving:3:3"), 5, 10)), 15u + 12 + 1);
}

TEST(Halving, ASingleCandidateHasAllItsCasesAtOnce) {
  EXPECT_THAT(list_rungs("halving", 1, 10), ElementsAre(std::pair(1, 10)));
}

TEST(Halving, NoRaceWhereTheFirstRungHasAllCases) {
  EXPECT_THAT(list_rungs("halving:10:2", 8, 10), ElementsAre(std::pair(8, 10)));
}

TEST(Halving, TheBudgetBuysTheLargestRaceThatItPaysFor) {
  const Racing racing = make_racing("halving:1:2");
  for (std::size_t budget = 0; budget < 60; ++budget) {
    const std::size_t count = count_affordable(racing, 10, 4, budget);
    EXPECT_LE(count == 0 ? 0 : calc_race_cost(plan_rungs(racing, count, 4)), budget);
    if (count < 10) {
      EXPECT_GT(calc_race_cost(plan_rungs(racing, count + 1, 4)), budget);
    }
  }
  EXPECT_EQ(count_affordable(racing, 10, 4, 3), 0u);
  EXPECT_EQ(count_affordable(racing, 10, 4, 4), 1u);
}

// The errors of each candidate on each case; the decision vector is the candidate's number.
class RaceTest : public testing::Test {
 protected:
  const std::vector<std::vector<double>> errors_ = {{1, 9, 9, 9},  // lucky in the first case
                                                    {2, 2, 2, 2}, {3, 1, 1, 1}, {4, 4, 0, 0},
                                                    {5, 0, 0, 0}, {6, 0, 0, 0}};
  MeanProblem problem_{1, [this](std::span<const double> x, const CaseBlock&, std::uint64_t k) {
                         return errors_[static_cast<std::size_t>(x[0])][k];
                       }};
  const CaseBlock block_{CaseRole::training, "train/1", {0, 1, 2, 3}};
  StopSignal stop_;
  ThreadExecutor executor_{2};
  std::vector<std::vector<double>> points_ = {{0}, {1}, {2}, {3}, {4}, {5}};
  std::vector<std::span<const double>> candidates_{points_.begin(), points_.end()};
};

TEST_F(RaceTest, HalvingByHand) {
  const Racing racing = make_racing("halving:1:2");
  std::atomic<std::size_t> simulated = 0;
  const auto results =
      Racer(racing, problem_, executor_, stop_)
          .halve(candidates_, block_, 1e6, [&](std::size_t cases) { simulated += cases; });
  ASSERT_TRUE(results);
  // 6 on one case: 0, 1, 2 go on (1, 2, 3 < 4). On two: means 5, 2, 2: 1 and 2 go on. On four: 2
  // and 1.5.
  EXPECT_EQ(simulated, 6u + 3 + 2 * 2);
  std::vector<std::size_t> cases;
  std::vector<double> objectives;
  for (const RacedCandidate& result : *results) {
    cases.push_back(result.cases);
    objectives.push_back(result.evaluation.objectives.front());
    EXPECT_THAT(result.evaluation.case_errors, SizeIs(result.cases));
    EXPECT_EQ(result.evaluation.status == EvaluationStatus::ok, result.cases == 4);
  }
  EXPECT_THAT(cases, ElementsAre(2, 4, 4, 1, 1, 1));
  // Candidate 0 has its own 5. Candidate 3 has 4 and counts as 5, the worst of those that got
  // further.
  EXPECT_THAT(objectives, ElementsAre(5, 2, 1.5, 5, 5, 6));
  EXPECT_THAT((*results)[3].evaluation.reason, HasSubstr("dropped out after 1 of 4 cases"));
}

TEST_F(RaceTest, AbandonmentByHand) {
  const Racing racing = make_racing("abandonment:1:2");
  std::atomic<std::size_t> simulated = 0;
  std::vector<RacedCandidate> results(6);
  // The sums of two cases are 10, 4, 4, 8, 5, 6. Those above 4 times the threshold, 6, are
  // abandoned.
  Racer(racing, problem_, executor_, stop_)
      .abandon(
          candidates_, block_, 1.5, [&](std::size_t cases) { simulated += cases; },
          [&](std::size_t candidate, RacedCandidate result) {
            results[candidate] = std::move(result);
          });
  std::vector<std::size_t> cases;
  std::vector<double> objectives;
  for (const RacedCandidate& result : results) {
    cases.push_back(result.cases);
    objectives.push_back(result.evaluation.objectives.front());
    EXPECT_EQ(result.evaluation.status == EvaluationStatus::abandoned, result.cases == 2);
  }
  EXPECT_EQ(simulated, 6u * 2 + 4 * 2);
  EXPECT_THAT(cases, ElementsAre(2, 4, 4, 2, 4, 4));
  EXPECT_THAT(objectives, ElementsAre(2.5, 2, 1.5, 2, 1.25, 1.5));
}

TEST_F(RaceTest, AStopLeavesNoHalfRace) {
  stop_.request(StopReason::interrupted);
  const Racing racing = make_racing("halving:1:2");
  Racer racer(racing, problem_, executor_, stop_);
  EXPECT_FALSE(racer.halve(candidates_, block_, 1e6, [](std::size_t) {}));
  racer.abandon(
      candidates_, block_, 1, [](std::size_t) {},
      [](std::size_t, const RacedCandidate&) { ADD_FAILURE() << "nothing was decided"; });
}

TEST(Abandonment, TheMarginWidensWhateverTheSignIs) {
  const Racing racing = make_racing("abandonment:1.5");
  EXPECT_DOUBLE_EQ(calc_threshold(racing, 2), 3);
  EXPECT_DOUBLE_EQ(calc_threshold(racing, -2), -1);  // objectives can be negative: a logarithm
  EXPECT_EQ(calc_threshold(racing, std::numeric_limits<double>::infinity()),
            std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace armwright
