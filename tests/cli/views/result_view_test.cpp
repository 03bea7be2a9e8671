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

TEST(SummaryTable, HasALinePerErrorThatWasMeasured) {
  const ErrorSummary summary = summarize(std::vector<double>{0.0002, 0.0004}, 0.1);
  const auto show = [&](const std::optional<MotionSummary>& motion) {
    Table table = make_summary_table(summary, motion);
    add_efforts({.torque_n_m = 120, .force_n = 400}, table);
    return table.format(Style(false), 2);
  };
  const std::string all =
      show(MotionSummary{.moving_rms_m = 0.00085, .moving_peak_m = 0.0053, .start_up_m = 0.112});
  EXPECT_THAT(all, ContainsRegex("\n? *mean error at rest +0.3000 mm\n"));
  EXPECT_THAT(all, ContainsRegex("\n  error while moving +RMS 0.8500 mm, peak 5.300 mm\n"));
  EXPECT_THAT(all, ContainsRegex("\n  error after start-up +up to 112.0 mm\n"));
  EXPECT_THAT(all, ContainsRegex("\n  total torque +120.0 N m\n  total force +400.0 N\n"));
  const std::string path =
      show(MotionSummary{.moving_rms_m = 0.00085, .moving_peak_m = 0.0053, .start_up_m = {}});
  EXPECT_THAT(path, testing::Not(testing::HasSubstr("rest")));
  EXPECT_THAT(path, testing::Not(testing::HasSubstr("start-up")));
  EXPECT_THAT(path, testing::HasSubstr("error while moving"));
  const std::string of_version_1 = show({});
  EXPECT_THAT(of_version_1, ContainsRegex("mean error +0.3000 mm\n"));
  EXPECT_THAT(of_version_1, testing::Not(testing::HasSubstr("moving")));
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
