#include "cli/views/study_view.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "study/analysis/analysis_support.hpp"
#include "study/statistics/power.hpp"

namespace armwright {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

StudyPlan make_plan(int replicates) {
  StudyRequest request;
  request.problems = {"sphere"};
  request.optimizers = {"ga", "cmaes"};  // with the two baselines six pairs
  request.replicates = replicates;
  request.budget = 100;
  return make_study_plan(request);
}

TEST(DescribePlan, ShowsSettingsButNoRecordedDescriptions) {
  StudyPlan plan = make_plan(2);
  plan.problems[0].settings = {"function.dimension=3", "program.description={\"variables\": []}"};
  EXPECT_THAT(describe_plan(plan),
              AllOf(HasSubstr("(function.dimension=3)"), Not(HasSubstr("description"))));
}

TEST(DescribeStudy, ShowsTheBestWinnerByTheProgramsNameAsTyped) {
  const StudyPlan plan = make_sphere_plan({"ga", "cmaes"}, 6);
  const StudyResult result = analyze_values(plan, {{3, 3, 3, 3, 3, 3}, {4, 4, 2, 4, 4, 4}});
  Session session;
  session.command_line = {"./bin/arm", "show", "mine"};
  session.color = "never";
  EXPECT_THAT(describe_study(plan, result, "mine", session),
              HasSubstr("Best winner of sphere: ./bin/arm show mine/cells/sphere/cmaes/r03\n"));
}

TEST(DescribePower, SaysWhichDifferenceTheStudyCanShow) {
  const std::string text = describe_power(make_plan(15));
  EXPECT_THAT(text, HasSubstr("With 15 replicates and 10 pairs of optimizers per problem"));
  EXPECT_THAT(text, HasSubstr(fmt::format("A12 = {:.2f} on", find_detectable_a12(15, 10))));
  EXPECT_THAT(text, HasSubstr("A medium difference (A12 = 0.64)"));
  EXPECT_THAT(text, HasSubstr(fmt::format("{} replicates find it", find_needed_pairs(0.64, 10))));
  EXPECT_THAT(text, Not(HasSubstr("warning")));
}

TEST(DescribePower, WarnsIfNoOutcomeCanBeSignificant) {
  EXPECT_THAT(describe_power(make_plan(7)),
              HasSubstr("warning: with 7 replicates and 10 pairs of optimizers per problem no "
                        "difference, however clear, is significant after Holm's correction.\n"
                        "9 replicates are the fewest that can decide a pair"));
}

TEST(DescribePower, IsEmptyForOneOptimizer) {
  StudyPlan plan = make_plan(15);
  plan.optimizers.resize(1);
  EXPECT_EQ(describe_power(plan), "");
}

}  // namespace
}  // namespace armwright
