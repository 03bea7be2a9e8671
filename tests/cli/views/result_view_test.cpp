#include "cli/views/result_view.hpp"

#include <gmock/gmock.h>

#include <memory>

#include "cli/terminal/format.hpp"
#include "study/own_problem.hpp"
#include "study/run_support.hpp"

namespace armwright {
namespace {

using testing::ContainsRegex;

class ResultView : public RunTest {};

TEST_F(ResultView, AWinnerHasWholeNumbersForIntegersWithAndWithoutItsFile) {
  RunPlan plan;
  plan.problem = make_own_problem(describe_own(), std::make_shared<OwnProblemCounts>());
  plan.optimizer = load_optimizer("lhs");
  plan.options = Options::parse("lhs", plan.optimizer.options, {});
  plan.budget = 10;
  plan.schedule = plan.problem.schedule;
  const auto result = run(plan, "run");
  ASSERT_TRUE(result && result->winner);
  for (const bool has_file : {true, false}) {
    if (!has_file) {
      std::filesystem::remove(temporary_ / "run/winner.toml");
    }
    const std::string text = describe_result(*result, temporary_ / "run", Style(false));
    EXPECT_THAT(text, ContainsRegex("\n  n +-?[0-4] *V?\n")) << has_file;
    EXPECT_THAT(text, ContainsRegex("\n  a +-?[0-9]\\.[0-9]+")) << has_file;
  }
}

TEST(FormatJson, AVariableIsAWholeNumberAWordOrANumber) {
  DecisionVariable variable = {.name = "v", .unit = "", .lower = 0, .upper = 9, .start = 0};
  EXPECT_EQ(to_json_value(variable, 2).dump(), "2.0");
  variable.type = VariableType::integer;
  EXPECT_EQ(to_json_value(variable, 2).dump(), "2");
  variable.type = VariableType::category;
  variable.choices = {"thin", "thick"};
  EXPECT_EQ(to_json_value(variable, 1).dump(), "\"thick\"");
}

}  // namespace
}  // namespace armwright
