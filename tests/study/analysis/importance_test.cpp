// Which variables of a run matter, from its journal and from simulations.
#include "study/analysis/importance.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "base/expect_error.hpp"
#include "base/random.hpp"
#include "study/run/run_folder.hpp"
#include "study/run_support.hpp"

namespace armwright {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::IsEmpty;

// A run of random points on the ellipsoid in 3 dimensions, whose weights are 1, 1e3 and 1e6: the
// last variable decides nearly all of its value.
class Importances : public RunTest {
 protected:
  RunPlan make_plan(const std::string& optimizer, std::int64_t budget) {
    RunPlan plan;
    plan.problem = load_problem(
        "ellipsoid", std::vector<std::string>{"function.dimension=3", "function.instance=0"});
    plan.optimizer = load_optimizer(optimizer);
    plan.options = Options::parse(optimizer, plan.optimizer.options, {});
    plan.budget = budget;
    plan.schedule = {.kind = Schedule::Kind::fixed, .cases = 1};
    return plan;
  }
  Importance calc(const std::string& folder) {
    const LoadedProblem problem = load_problem_of_run(temporary_ / folder);
    return calc_importance(temporary_ / folder, problem.problem->description());
  }
  bool simulate(const std::string& folder, std::int64_t simulations, Importance& importance) {
    const LoadedProblem problem = load_problem_of_run(temporary_ / folder);
    StopSignal stop;
    return add_simulated_importance(temporary_ / folder, *problem.problem, simulations, 2, stop,
                                    observer_, importance);
  }
};

TEST_F(Importances, TheVariableThatDecidesHasNearlyAllOfTheVariance) {
  run(make_plan("random", 300), "run");
  const Importance importance = calc("run");
  EXPECT_EQ(importance.evaluations, 300);
  EXPECT_EQ(importance.left_out, 0);
  ASSERT_EQ(importance.parts.size(), 2);
  EXPECT_EQ(importance.parts[0].region, ImportanceRegion::winner);
  EXPECT_EQ(importance.parts[1].region, ImportanceRegion::run);
  EXPECT_EQ(importance.parts[1].points, 300);
  for (const ImportancePart& part : importance.parts) {
    EXPECT_GT(part.explained.value(), 0.8);
    EXPECT_THAT(part.judgement, HasSubstr("can be relied on"));
    EXPECT_GT(part.variables[2].total, 0.9);
    EXPECT_LT(part.variables[0].total, 0.05);
    EXPECT_LE(part.variables[2].total_interval.lower, part.variables[2].total);
  }
  // So few points are near that the region grew until it had 200.
  EXPECT_GT(*importance.parts[0].half_width, 0.1);
  EXPECT_GE(importance.parts[0].points, 200);
}

TEST_F(Importances, SimulationsNeedNoModel) {
  run(make_plan("random", 50), "run");
  Importance importance = calc("run");
  ASSERT_TRUE(simulate("run", 1000, importance));
  const ImportancePart& part = importance.parts.front();
  EXPECT_EQ(part.region, ImportanceRegion::design);
  EXPECT_EQ(part.points, 1000);  // 200 rows of five designs
  EXPECT_FALSE(part.explained);
  EXPECT_GT(part.variables[2].total, 0.9);
  EXPECT_LT(part.variables[0].total, 0.05);
}

TEST_F(Importances, TooFewSimulationsSayHowManyAreNeeded) {
  run(make_plan("random", 50), "run");
  Importance importance = calc("run");
  EXPECT_THAT(usage_error_of([&] { simulate("run", 39, importance); }),
              HasSubstr("--simulations is 39; a design for 3 variables on 1 training case needs at "
                        "least 40"));
  EXPECT_TRUE(simulate("run", 40, importance));
}

TEST_F(Importances, AModelThatExplainsTooLittleSaysSo) {
  // Values that have nothing to do with the variables.
  ProblemDescription description;
  description.objectives = {{"f", ""}};
  description.variables.resize(3, {"x", "", 0, 1, 0.5});
  JournalContent recorded;
  Journal journal(Folder::make(temporary_.path(), temporary_.path()), "journal", recorded);
  RandomStream random("test/importance");
  for (std::uint64_t i = 0; i < 60; ++i) {
    EvaluationRecord record;
    record.index = i;
    record.x = {random.uniform(), random.uniform(), random.uniform()};
    record.cases = {CaseRole::training, "train/1", {0}};
    record.evaluation.objectives = {random.normal()};
    journal.append(record);
  }
  journal.close();
  const Importance importance = calc_importance(temporary_.path(), description);
  ASSERT_EQ(importance.parts.size(), 1);
  EXPECT_LT(*importance.parts[0].explained, kEnoughExplained);
  EXPECT_THAT(importance.parts[0].judgement, HasSubstr("too little. Do not rely"));
}

TEST_F(Importances, FewEvaluationsGiveANote) {
  run(make_plan("random", 5), "run");
  const Importance importance = calc("run");
  EXPECT_THAT(importance.parts, IsEmpty());
  EXPECT_THAT(importance.notes.back(), HasSubstr("its 5 evaluations are too few"));
}

TEST_F(Importances, TheJsonHasEveryPartAndIndex) {
  run(make_plan("random", 300), "run");
  const json all = json::parse(to_json(calc("run")));
  EXPECT_EQ(all["parts"][0]["region"], "winner");
  EXPECT_EQ(all["parts"][1]["half_width"], nullptr);
  const json& variable = all["parts"][1]["variables"][2];
  EXPECT_EQ(variable["name"], "x_3");
  EXPECT_GT(variable["total"]["value"], 0.9);
  EXPECT_LE(variable["total"]["lower"], variable["total"]["upper"]);
}

}  // namespace
}  // namespace armwright
