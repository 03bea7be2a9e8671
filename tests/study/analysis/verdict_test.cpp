// The words of the verdict follow the tests of the pairs.
#include "study/analysis/verdict.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <limits>

#include "base/text.hpp"
#include "study/analysis/analysis_support.hpp"
#include "study/statistics/ranking.hpp"

namespace armwright {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

enum class Side { better, worse, undecided };
constexpr Side kSides[] = {Side::better, Side::worse, Side::undecided};

// Returns a number that puts ga before cmaes (-1), behind it (1), or level with it.
int get_sign(Side side) {
  return side == Side::better ? -1 : side == Side::worse ? 1 : 0;
}

PairResult make_pair(std::size_t winner, std::size_t loser, bool is_significant) {
  PairResult pair;
  pair.a = winner;
  pair.b = loser;
  pair.test.pairs = 15;
  pair.test.negative_rank_sum = 100;
  pair.test.positive_rank_sum = 20;
  pair.p_holm = is_significant ? 0.01 : 0.5;
  return pair;
}

std::string describe(const StudyPlan& plan, ProblemResult problem) {
  problem.label = plan.problems.front().label;
  problem.order = order_optimizers(problem.optimizers, true);
  StudyResult result;
  result.problems = {problem};
  return join(describe_verdict(plan, result), "\n");
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

// Every combination of what the median, the mean rank and the test say about ga and cmaes. A third
// optimizer is beaten by the better ones or not told apart from them.
TEST(Verdict, NeverContradictsTheTests) {
  const StudyPlan plan = make_sphere_plan({"ga", "cmaes", "lhs"}, 15);
  for (const Side median : kSides) {
    for (const Side rank : kSides) {
      for (const Side test : kSides) {
        for (const bool third_is_beaten : {false, true}) {
          ProblemResult problem;
          problem.optimizers.resize(3);
          problem.optimizers[0].values = {1};  // the verdict reads that there are values
          problem.optimizers[0].spread.median = 5 + get_sign(median);
          problem.optimizers[1].spread.median = 5;
          problem.optimizers[2].spread.median = 7;
          problem.optimizers[0].mean_rank = 1.5 + 0.2 * get_sign(rank);
          problem.optimizers[1].mean_rank = 1.5 - 0.2 * get_sign(rank);
          problem.optimizers[2].mean_rank = 3;
          const std::size_t winner = test == Side::worse ? 1 : 0;
          problem.pairs = {make_pair(winner, 1 - winner, test != Side::undecided),
                           make_pair(0, 2, third_is_beaten), make_pair(1, 2, third_is_beaten)};
          const std::string text = describe(plan, problem);
          SCOPED_TRACE(text);
          EXPECT_EQ(has(text, "ga beats cmaes"), test == Side::better);
          EXPECT_EQ(has(text, "cmaes beats ga"), test == Side::worse);
          EXPECT_EQ(has(text, "ga cannot be told apart from cmaes") ||
                        has(text, "cmaes cannot be told apart from ga") ||
                        has(text, "no two optimizers can be told apart"),
                    test == Side::undecided);
          EXPECT_EQ(has(text, "no two"), test == Side::undecided && !third_is_beaten);
          EXPECT_FALSE(has(text, "lhs beats"));
          const bool contradicts = (median == Side::better && test == Side::worse) ||
                                   (median == Side::worse && test == Side::better);
          EXPECT_EQ(has(text, "but the pairs of runs decide"), contradicts);
          const bool leader_loses = (rank == Side::better && test == Side::worse) ||
                                    (rank == Side::worse && test == Side::better);
          EXPECT_TRUE(!leader_loses || has(text, "leads the ranking"));
        }
      }
    }
  }
}

// Fifteen pairs; the second optimizer wins fourteen of them, but its median is worse.
TEST(Verdict, LeadsWithTheMeanRankAndNotWithTheMedian) {
  const StudyPlan plan = make_sphere_plan({"ga", "cmaes"}, 15);
  std::vector<double> a, b;
  for (int i = 0; i < 15; ++i) {
    a.push_back(i == 7 ? 6.95 : i + 0.5);
    b.push_back(i);
  }
  const StudyResult result = analyze_values(plan, {a, b});
  const ProblemResult& problem = result.problems.front();
  ASSERT_LT(problem.optimizers[0].spread.median, problem.optimizers[1].spread.median);
  EXPECT_THAT(problem.order, ElementsAre(1u, 0u));
  EXPECT_TRUE(problem.pairs.front().is_won_by(1));
  EXPECT_FALSE(problem.pairs.front().is_won_by(0));
  EXPECT_EQ(problem.pairs.front().wins.wins, 14);
  const auto verdict = describe_verdict(plan, result);
  EXPECT_THAT(verdict, Contains(HasSubstr("cmaes beats ga (A12 ")));
  EXPECT_THAT(verdict, Contains(HasSubstr("The median of ga is better than that of cmaes, but")));
  EXPECT_THAT(verdict, Not(Contains(HasSubstr("told apart"))));
}

TEST(Verdict, SaysWhatFriedmansTestShowsWhereNoPairCanBeDecided) {
  const StudyPlan plan = make_sphere_plan({"ga", "cmaes", "lhs"}, 5);
  const std::vector<double> good = {1, 2, 3, 4, 5};
  const std::vector<double> fair = {2, 3, 4, 5, 6};
  const std::vector<double> poor = {3, 4, 5, 6, 7};
  const auto different = describe_verdict(plan, analyze_values(plan, {good, fair, poor}));
  EXPECT_THAT(different,
              Contains(HasSubstr(
                  "no pair of optimizers can be decided: with 5 replicates and 3 pairs of ")));
  EXPECT_THAT(different, Contains(HasSubstr("The optimizers do differ (Friedman's test, p = ")));
  const auto alike = describe_verdict(plan, analyze_values(plan, {good, good, good}));
  EXPECT_THAT(alike,
              Contains("Friedman's test does not show that the optimizers differ at all (p = 1)."));
  for (const auto& verdict : {different, alike}) {
    EXPECT_THAT(verdict, Not(Contains(HasSubstr("nothing can be concluded"))));
  }
}

// medians[p][o] is the median of optimizer o on problem p.
std::string describe_lead(const std::vector<std::vector<double>>& medians) {
  StudyRequest request;
  request.problems = {"sphere", "rosenbrock", "rastrigin"};
  request.optimizers = {"ga", "cmaes", "lhs", "random"};
  request.replicates = 6;
  request.budget = 100;
  request.baselines = false;
  const StudyPlan plan = make_study_plan(request);
  StudyResult result;
  result.overall.ranking = calc_ranking_stability(medians);
  result.overall.pairs.resize(6);
  return describe_verdict(plan, result).front();
}

TEST(Verdict, SaysWhetherTheLeadDependsOnOneProblem) {
  const std::vector<double> ga_first = {1, 2, 3, 4}, cmaes_first = {2, 1, 3, 4};
  EXPECT_EQ(describe_lead({ga_first, ga_first, ga_first}),
            "Over the 3 problems ga has the best mean rank (1.00 of 4). The lead stays the same "
            "whichever one of the 3 problems is left out.");
  EXPECT_EQ(describe_lead({{1, 4, 2, 3}, cmaes_first, cmaes_first}),
            "Over the 3 problems ga has the best mean rank (1.67 of 4). The lead changes if sphere "
            "is left out.");
  EXPECT_EQ(describe_lead({ga_first, cmaes_first, ga_first}),
            "Over the 3 problems ga has the best mean rank (1.33 of 4). The lead changes if one of "
            "these problems alone is left out: sphere and rastrigin.");
}

TEST(Verdict, NamesOptimizersWithoutFeasibleWinnersAndTheirWeights) {
  StudyRequest request;
  request.problems = {"constrained"};
  request.optimizers = {"cmaes", "random", "ga"};
  request.replicates = 15;
  request.budget = 100;
  request.baselines = false;
  ProblemResult problem;
  problem.optimizers.resize(3);
  for (OptimizerResult& one : problem.optimizers) {
    one.values.assign(15, 1.0);
  }
  const StudyPlan plan = make_study_plan(request);
  problem.pairs = {make_pair(0, 1, false), make_pair(0, 2, false), make_pair(1, 2, false)};
  EXPECT_THAT(describe(plan, problem), Not(HasSubstr("constraint")));
  problem.optimizers[1].unmet = 2;
  EXPECT_THAT(describe(plan, problem),
              HasSubstr("On constrained, runs of these optimizers have no winner that meets the "
                        "constraints on the test set: random (2 of 15).\n"));
  problem.optimizers[0].unmet = 3;
  EXPECT_THAT(describe(plan, problem),
              HasSubstr("cmaes (3 of 15) and random (2 of 15); the option constraint_weight of "
                        "cmaes (10) weighs violations against the objective"));
  // A run without any winner is no matter of constraints on a problem that has none.
  EXPECT_THAT(describe(make_sphere_plan({"cmaes", "random", "ga"}, 15), problem),
              Not(HasSubstr("constraint")));
}

TEST(Verdict, CountsNoFailedOptimizerAndNoFailedCaseAsAViolation) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const StudyPlan plan = make_sphere_plan({"ga", "cmaes"}, 6);
  StudyResult result =
      analyze_values(plan, {{1, 2, kNone, kNone, kNone, kNone}, {1, 2, 3, 4, 5, 6}});
  for (CellOutcome& cell : result.cells) {
    cell.x = {1};
  }
  result.cells[1].violation = 0.5;
  result.cells[2].violation = 0.5;
  result.cells[3].x.clear();  // no winner
  result.cells[4].x.clear();  // the optimizer failed at once
  result.cells[4].failure = "it fell over";
  EXPECT_EQ(analyze_problem(plan, 0, result.cells).optimizers[0].unmet, 3);  // not 4 or 5
  result.cells[3].end_reason = kNotEnded;
  EXPECT_EQ(analyze_problem(plan, 0, result.cells).optimizers[0].unmet, 2);
  EXPECT_EQ(analyze_problem(plan, 0, result.cells).optimizers[1].unmet, 0);
}

}  // namespace
}  // namespace armwright
