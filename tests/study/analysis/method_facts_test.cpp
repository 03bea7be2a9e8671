// What the optimizers saw and did: in the verdict, in summary.csv and in result.json.
#include "study/analysis/method_facts.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "base/text.hpp"
#include "study/analysis/study_tables.hpp"
#include "study/analysis/verdict.hpp"
#include "study/compare/study_support.hpp"

namespace armwright {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;

// Returns random search under another name, which claims to use residuals.
OptimizerRow make_residual_row() {
  OptimizerRow row = load_optimizer("random");
  row.name = "gauss";
  row.capabilities.residuals = true;
  return row;
}

StudyRequest make_facts_request() {
  StudyRequest request;
  request.problems = {"sphere"};
  request.optimizers = {"random", "lhs"};
  request.settings = {"function.dimension=3"};
  request.replicates = 3;
  request.budget = 3000;
  request.baselines = false;
  return request;
}

// Returns a result in which every run spent its budget and judged five candidates.
StudyResult make_even_result(const StudyPlan& plan) {
  StudyResult result;
  for (const StudyProblem& problem : plan.problems) {
    result.problems.emplace_back().label = problem.label;
    for (const StudyOptimizer& optimizer : plan.optimizers) {
      for (int replicate = 1; replicate <= plan.replicates; ++replicate) {
        CellOutcome& cell = result.cells.emplace_back();
        cell.problem = problem.label;
        cell.optimizer = optimizer.label;
        cell.replicate = replicate;
        cell.end_reason = "budget";
        cell.cases = static_cast<std::uint64_t>(plan.budget);
        cell.judged = 5;
      }
    }
  }
  return result;
}

TEST(MethodFacts, OfEqualMethodsAreNotInTheVerdict) {
  const StudyPlan plan = make_study_plan(make_facts_request());
  EXPECT_THAT(describe_methods(plan, make_even_result(plan)), IsEmpty());
}

TEST(MethodFacts, NameUnusedBudgetAndWhy) {
  StudyRequest request = make_facts_request();
  request.problems.push_back("rosenbrock");
  const StudyPlan plan = make_study_plan(request);
  StudyResult result = make_even_result(plan);
  for (std::size_t i = 0; i < 3; ++i) {
    result.cells[3 + i].end_reason = "optimizer finished";
    result.cells[3 + i].cases = std::uint64_t{309} + 100 * i;
  }
  result.cells[6].end_reason = "optimizer failed";
  result.cells[6].cases = 7;
  result.cells[7].end_reason = "optimizer finished";
  result.cells[7].cases = 2999;  // less than 1 % is left
  EXPECT_THAT(describe_methods(plan, result),
              ElementsAre("On sphere lhs stopped after 309 to 509 of 3000 simulations in 3 of 3 "
                          "runs (it ended by itself).",
                          "On rosenbrock random stopped after 7 of 3000 simulations in 1 of 3 runs "
                          "(it failed)."));
}

TEST(MethodFacts, NameTheFewestAndTheMostJudgedCandidates) {
  StudyPlan plan = make_study_plan(make_facts_request());
  StudyResult result = make_even_result(plan);
  for (std::size_t i = 3; i < 6; ++i) {
    result.cells[i].judged = 9;
  }
  EXPECT_THAT(describe_methods(plan, result),
              ElementsAre("Between 5 (random) and 9 (lhs) candidates of a run "
                          "were judged on the validation set, in the median."));
  plan.judge_along = true;  // candidates are judged at every checkpoint; these are not counted
  EXPECT_THAT(describe_methods(plan, result), IsEmpty());
}

TEST(MethodFacts, NameTheOptimizersThatSeeResiduals) {
  StudyRequest request = make_facts_request();
  request.optimizers = {"gauss", "lhs"};
  request.rows = {make_residual_row()};
  const StudyPlan plan = make_study_plan(request);
  EXPECT_THAT(describe_methods(plan, make_even_result(plan)),
              ElementsAre("On sphere gauss sees 3 residuals per evaluation; the others see only "
                          "the objective."));
}

TEST(MethodFacts, CountTheResidualsOfAllCasesOfTheSchedule) {
  StudyRequest request = make_facts_request();
  request.problems = {"q2-e6"};  // has residuals that belong to no case
  request.settings = {"physics.engine=articulated", "workspace.points=4", "sets.test_cases=3",
                      "sets.validation_cases=3"};
  request.optimizers = {"gauss", "lhs"};
  request.rows = {make_residual_row()};
  request.schedule = Schedule{.kind = Schedule::Kind::fixed, .cases = 7};
  const StudyPlan plan = make_study_plan(request);
  const RunPlan run = make_run_plan(plan, {0, 0, 1});
  std::vector<double> start;
  for (const DecisionVariable& variable : run.problem.problem->description().variables) {
    start.push_back(variable.start);
  }
  const CaseBlock block{.role = CaseRole::training,
                        .set = run.problem.sets.training,
                        .numbers = {0, 1, 2, 3, 4, 5, 6}};
  const auto facts = calc_method_facts(plan, "q2-e6", {});
  EXPECT_EQ(facts[0].residuals, run.problem.problem->evaluate(start, block).residuals.size());
  EXPECT_GT(facts[0].residuals, 7u);
  EXPECT_EQ(facts[1].residuals, 0u);
}

TEST(MethodFacts, NameExactDerivatives) {
  StudyRequest request = make_facts_request();
  request.problems = {"q1-complex"};
  request.settings = {"physics.engine=articulated", "workspace.points=4", "sets.test_cases=3",
                      "sets.validation_cases=3", "task.ik_bug=false"};
  OptimizerRow row = make_residual_row();
  row.options.push_back({.name = "derivatives",
                         .description = "",
                         .fallback = std::string("exact"),
                         .choices = {"differences", "exact"}});
  request.optimizers = {"gauss", "lhs"};
  request.rows = {row};
  const StudyPlan plan = make_study_plan(request);
  EXPECT_THAT(describe_methods(plan, make_even_result(plan)),
              Contains(HasSubstr("residuals per evaluation and their exact derivatives; the others "
                                 "see only the objective.")));
}

TEST(MethodFacts, NameDefaultsThatWereChosenOnAProblemOfTheStudy) {
  StudyRequest request = make_facts_request();
  request.problems = {"sphere", "rosenbrock"};
  OptimizerRow row = load_optimizer("random");
  row.name = "tuned";
  row.tuned_on = {"rosenbrock", "rastrigin"};
  request.optimizers = {"tuned", "lhs"};
  request.rows = {row};
  const StudyPlan plan = make_study_plan(request);
  EXPECT_THAT(describe_methods(plan, make_even_result(plan)),
              ElementsAre("Default settings of tuned were chosen on a problem of this study: "
                          "rosenbrock."));
}

TEST(MethodFacts, KnowTheArmsOnWhichDefaultsWereChosen) {
  const auto is_tuned = [](const std::string& optimizer, const std::string& urdf) {
    StudyRequest request = make_facts_request();
    request.problems = {"robot"};
    request.optimizers = {optimizer};
    request.settings = {"robot.urdf=" + urdf, "workspace.points=3"};
    const StudyPlan plan = make_study_plan(request);
    return calc_method_facts(plan, plan.problems.front().label, {})[0].is_tuned_here;
  };
  EXPECT_TRUE(is_tuned("ceres:lm", "planar2.urdf"));
  EXPECT_FALSE(is_tuned("ceres:lm", "irb4600_40_255.urdf"));
  EXPECT_FALSE(is_tuned("ceres:bfgs", "planar2.urdf"));
}

TEST_F(StudyTest, MethodFactsAreInTheTablesAndInTheResult) {
  StudyRequest request = make_facts_request();
  request.optimizers = {"random", "nlopt:neldermead"};
  request.budget = 20'000;  // more than the local search needs
  const StudyPlan plan = make_study_plan(request);
  const StudyResult result = study(plan, "study");
  const auto facts = calc_method_facts(plan, "sphere", result.cells);
  ASSERT_TRUE(facts[1].judged);
  for (const CellOutcome& cell : result.cells) {
    const auto folder = temporary_ / "study" / make_cell_path(plan, {0, 1, cell.replicate});
    const auto run = parse_result(read_file(folder / "result.json", 1 << 24), folder);
    if (cell.optimizer == "nlopt:neldermead") {
      EXPECT_EQ(cell.judged, run.judged.size());
    }
  }
  const auto files = read_tree(temporary_ / "study");
  const auto lines = split(files.at("tables/summary.csv"), '\n');
  EXPECT_THAT(lines[0], EndsWith("optimum," + std::string(kMethodColumns)));
  EXPECT_THAT(lines[2], EndsWith("," + make_method_fields(facts[1])));
  EXPECT_THAT(lines[2], HasSubstr("optimizer finished"));
  EXPECT_EQ(std::ranges::count(lines[0], ','), std::ranges::count(lines[2], ','));
  const auto whole = nlohmann::json::parse(files.at("result.json"));
  EXPECT_EQ(whole["problems"][0]["optimizers"]["nlopt:neldermead"]["method"],
            method_to_json(facts[1]));
}

TEST_F(StudyTest, WithoutARunsResultItsJudgedCandidatesAreNotKnown) {
  StudyRequest request = make_facts_request();
  request.budget = 60;
  const StudyPlan plan = make_study_plan(request);
  study(plan, "study");
  for (const Cell& cell : list_cells(plan)) {
    std::filesystem::remove(temporary_ / "study" / make_cell_path(plan, cell) / "result.json");
  }
  const StudyResult result = analyze_study(plan, temporary_ / "study");
  for (const MethodFacts& facts : calc_method_facts(plan, "sphere", result.cells)) {
    EXPECT_FALSE(facts.judged);
    EXPECT_EQ(facts.runs, 3);
  }
}

}  // namespace
}  // namespace armwright
