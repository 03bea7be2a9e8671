// Running times are exact numbers of evaluations.
#include <gmock/gmock.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "study/analysis/analysis_support.hpp"
#include "study/compare/study_support.hpp"
#include "study/journal/journal.hpp"

namespace armwright {
namespace {

using testing::ElementsAre;

// A trace counts the quality that a run keeps, not a value that it had once by luck.
TEST(Trace, IsTheWorstFromThereOn) {
  CellOutcome cell;
  cell.trace = {{7, 5, {}}, {13, 2, {}}, {29, 4, {}}};
  std::vector<double> values;
  for (const TracePoint& point : make_trace(cell)) {
    values.push_back(point.best_value);
  }
  EXPECT_THAT(values, ElementsAre(5, 4, 4));
  EXPECT_EQ(make_trace(cell)[1].cost, 13);
}

TEST(ExactTimes, ComeFromTheTraceAndNotFromTheCheckpoints) {
  const StudyPlan plan = make_sphere_plan({"ga", "cmaes"}, 2);
  std::vector<CellOutcome> cells;
  for (std::size_t o = 0; o < 2; ++o) {
    for (const int replicate : {1, 2}) {
      CellOutcome cell = make_value_cell(plan, o, replicate, 0);
      cell.curve = {{500, 60, 0}, {1000, 0, 0}};
      cell.trace = {{3, 60, 0}, {replicate == 1 ? 701 : 801, 0, 0}};
      cells.push_back(cell);
    }
  }
  const ProblemResult problem = analyze_problem(plan, 0, cells);
  EXPECT_EQ(problem.optimizers[0].running_times[0].target, 10);
  EXPECT_EQ(problem.optimizers[0].running_times[0].expected, 751);
  EXPECT_EQ(problem.optimizers[0].running_times[0].interval.lower, 701);
  EXPECT_EQ(problem.optimizers[0].running_times[0].interval.upper, 801);
}

// Both tables give the expected running times that cocopp has computed from an export of the same
// runs. The numbers and how they were made: tests/data/exports/running_times.json.
TEST(ExactTimes, InTheTablesAreThoseOfCocopp) {
  const auto oracle = nlohmann::json::parse(
      read_file(std::string(ARMWRIGHT_TEST_DATA) + "/exports/running_times.json", 1 << 20));
  int compared = 0;
  for (const auto& times_and_runs : oracle.at("cells")) {
    const auto& runs = times_and_runs.at("runs");
    StudyPlan plan = make_sphere_plan({"ga"}, static_cast<int>(runs.size()));
    plan.budget = 2000;
    std::vector<CellOutcome> cells;
    for (const auto& run : runs) {
      CellOutcome cell = make_value_cell(plan, 0, static_cast<int>(cells.size()) + 1, 0);
      cell.cases = run.at("evaluations");
      cell.trace.clear();
      for (const auto& improvement : run.at("improvements")) {
        cell.trace.push_back({improvement.at(0), improvement.at(1), {}});
      }
      cells.push_back(cell);
    }
    for (const auto& time : times_and_runs.at("times")) {
      const double target = time.at("target");
      plan.targets = {{.label = "target", .problems = {"sphere"}, .value = target, .failures = {}}};
      for (CellOutcome& cell : cells) {
        cell.start_value = 10 * target;  // a tenth of the way to 0 is left at the target
      }
      const OptimizerResult ga = analyze_problem(plan, 0, cells).optimizers.at(0);
      const double expected = time.at("cocopp");
      EXPECT_NEAR(ga.target_times.at(0).expected, expected, 1e-3) << times_and_runs.at("problem");
      EXPECT_NEAR(ga.running_times.at(0).target, target, 1e-12 * target);
      EXPECT_NEAR(ga.running_times.at(0).expected, expected, 1e-3) << times_and_runs.at("problem");
      ++compared;
    }
  }
  EXPECT_GE(compared, 20);
}

class ExactTimesOfRuns : public StudyTest {
 protected:
  // Returns the number of cases until the journal has a value of at most `target`; the whole budget
  // if it never has.
  Trial find_hit(const StudyPlan& plan, const Cell& cell, double target) {
    const auto journal =
        read_journal(temporary_ / "study" / make_cell_path(plan, cell) / "journal");
    double cases = 0;
    for (const EvaluationRecord& record : journal.training) {
      cases += static_cast<double>(record.calc_charge());
      if (record.evaluation.objectives.at(0) <= target) {
        return {cases, true};
      }
    }
    return {cases, false};
  }
};

TEST_F(ExactTimesOfRuns, AreTheFirstHitsInTheJournals) {
  const StudyPlan plan = load_plan(temporary_, R"(problems = ["sphere"]
optimizers = ["ga", "cmaes", "nlopt:cobyla"]
set = ["function.dimension=5"]
replicates = 6
budget = 800
baselines = false
[[target]]
label = "one"
value = 1.0
)");
  const StudyResult result = study(plan, "study");
  const ProblemResult& problem = result.problems.front();
  EXPECT_EQ(problem.best_known, 0);
  int reached = 0;
  for (std::size_t o = 0; o < plan.optimizers.size(); ++o) {
    const auto find_trials = [&](double target) {
      std::vector<Trial> trials;
      for (int r = 1; r <= plan.replicates; ++r) {
        trials.push_back(find_hit(plan, {0, o, r}, target));
      }
      return trials;
    };
    EXPECT_EQ(problem.optimizers[o].target_times[0].expected,
              calc_expected_running_time(find_trials(1)));
    for (const RunningTime& time : problem.optimizers[o].running_times) {
      EXPECT_EQ(time.expected, calc_expected_running_time(find_trials(time.target)));
      reached += time.reached;
    }
  }
  EXPECT_GT(reached, 0);
}

TEST_F(ExactTimesOfRuns, OfAnArmAreThoseOfItsIncumbents) {
  StudyRequest request;
  request.problems = {"q1-complex"};
  request.optimizers = {"cmaes"};
  request.settings = {"physics.engine=articulated", "sets.validation_cases=3", "sets.test_cases=4"};
  request.replicates = 1;
  request.budget = 150;
  request.baselines = false;
  const StudyPlan plan = make_study_plan(request);
  const StudyResult result = study(plan, "study");
  const CellOutcome& cell = result.cells.front();
  const auto& trace = cell.trace;
  ASSERT_GT(trace.size(), 2u);
  // Where a checkpoint and an incumbent coincide, both have the same value.
  for (const CurvePoint& point : cell.curve) {
    const auto after = std::ranges::upper_bound(trace, point.budget, {}, &CurvePoint::budget);
    ASSERT_NE(after, trace.begin()) << point.budget;
    EXPECT_EQ(std::prev(after)->value, point.value) << point.budget;
  }
  const auto file = temporary_ / "study" / make_cell_path(plan, {0, 0, 1}) / "cell.json";
  const CellOutcome read = parse_cell(read_file(file, 1 << 24), file);
  EXPECT_EQ(to_json(read), read_file(file, 1 << 24));
  EXPECT_EQ(read.trace.back().budget, trace.back().budget);
}

}  // namespace
}  // namespace armwright
