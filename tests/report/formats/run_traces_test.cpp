#include "report/formats/run_traces.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/temporary_folder.hpp"
#include "report/formats/formats.hpp"
#include "report/hand_made_traces.hpp"
#include "study/contract/contract_checks.hpp"
#include "study/run_support.hpp"

namespace armwright {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

class FindRuns : public testing::Test {
 protected:
  // Writes cells/FOLDER/cell.json with this text, or the folder without the file.
  void make_cell(const std::string& folder, const std::string& text) {
    const auto cell = folder_ / ("cells/" + folder);
    std::filesystem::create_directories(cell);
    if (!text.empty()) {
      std::ofstream(cell / "cell.json") << text;
    }
  }
  void expect_refused(ErrorKind kind, const testing::Matcher<std::string>& message) {
    try {
      find_runs(folder_.path());
      ADD_FAILURE() << "not refused";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), kind);
      EXPECT_THAT(std::string(error.what()), message);
    }
  }
  TemporaryFolder folder_;
};

TEST_F(FindRuns, TakesNamesFromTheCellsAndSortsThem) {
  make_cell("a/b/010", R"({"problem":"p","label":"l","optimizer":"ga","replicate":10})");
  make_cell("a/b/9", R"({"problem":"p","label":"l","optimizer":"ga","replicate":9,"more":1})");
  make_cell("z/b/1", R"({"problem":"\"o/o\"","label":"","optimizer":"random","replicate":1})");
  make_cell("a/b/11", "");
  std::ofstream(folder_ / "cells/file") << "no cell";
  const FoundRuns found = find_runs(folder_.path());
  EXPECT_EQ(found.unfinished, 1u);
  std::vector<std::string> names;
  for (const RunEntry& run : found.runs) {
    names.push_back(run.problem + "|" + run.label + "|" + run.optimizer + "|" +
                    std::to_string(run.replicate));
  }
  EXPECT_THAT(names, ElementsAre("\"o/o\"||random|1", "p|l|ga|9", "p|l|ga|10"));
  EXPECT_EQ(found.runs[2].folder, folder_ / "cells/a/b/010");
}

TEST_F(FindRuns, KnowsThePlaceOfAProblemInThePlan) {
  make_cell("a/l/1", R"({"problem":"a","label":"l","optimizer":"ga","replicate":1})");
  make_cell("z/l/1", R"({"problem":"z","label":"l","optimizer":"ga","replicate":1})");
  std::ofstream(folder_ / "study.toml") << "[[problem]]\nname = \"p\"\nlabel = \"z\"\n"
                                           "[[problem]]\nname = \"p\"\nlabel = \"a\"\n";
  const FoundRuns found = find_runs(folder_.path());
  EXPECT_EQ(found.runs.at(0).problem, "a");
  EXPECT_EQ(found.runs.at(0).problem_place, 1u);
  EXPECT_EQ(found.runs.at(1).problem_place, 0u);
  std::ofstream(folder_ / "study.toml") << "name = 1\n";
  expect_refused(ErrorKind::usage, HasSubstr("study.toml: is not a plan that armwright wrote"));
}

TEST_F(FindRuns, RefusesAFolderOfNeitherKind) {
  expect_refused(ErrorKind::usage, AllOf(HasSubstr("manifest.json"), HasSubstr("cells")));
}

TEST_F(FindRuns, RefusesAStudyInWhichNothingHasFinished) {
  make_cell("a/b/1", "");
  expect_refused(ErrorKind::usage, HasSubstr("no cell of this study has finished"));
}

TEST_F(FindRuns, RefusesACellTwice) {
  make_cell("a/b/1", R"({"problem":"p","label":"l","optimizer":"ga","replicate":1})");
  make_cell("a/c/1", R"({"problem":"p","label":"l","optimizer":"ga","replicate":1})");
  expect_refused(ErrorKind::bad_data,
                 AllOf(HasSubstr("a/b/1 and "), HasSubstr("a/c/1 are both replicate 1 of 'l'")));
}

TEST_F(FindRuns, RefusesCellsItCannotUseAndNamesTheFile) {
  for (const char* text : {"{", "[]", R"({"problem":"p","label":"l","optimizer":"ga"})",
                           R"({"problem":1,"label":"l","optimizer":"ga","replicate":1})"}) {
    make_cell("a/b/1", text);
    expect_refused(ErrorKind::bad_data, HasSubstr("a/b/1/cell.json: is not a cell file"));
  }
  make_cell("a/b/1", R"({"problem":"p","label":"l","optimizer":"ga","replicate":0})");
  expect_refused(ErrorKind::bad_data, HasSubstr("replicate is 0; they are counted from 1"));
}

TEST(TracedEvaluations, HaveAFirstALastAndTheEarliestOfTheBestFeasible) {
  const TracedEvaluations none;
  EXPECT_TRUE(none.empty());
  EXPECT_FALSE(none.first() || none.last() || none.best());
  const RunTrace trace = make_trace(
      {1.0, 2.0, 2.0}, [](std::vector<TracedEvaluation>& all) { all[0].feasible = false; });
  EXPECT_EQ(trace.evaluations.size(), 3u);
  EXPECT_EQ(trace.evaluations.first()->number, 1u);
  EXPECT_EQ(trace.evaluations.best()->number, 2u);
  EXPECT_EQ(trace.evaluations.last()->number, 3u);
}

// Asks for one point of whole numbers, and for one that is rounded.
class TwoPoints : public Optimizer {
 public:
  void minimize(Evaluator& evaluator, std::uint64_t /*seed*/) override {
    evaluator.evaluate(std::vector<std::vector<double>>{{2, 0.5, 3, 10}, {1.25, 0.5, 3, 9.75}});
  }
};

TEST(RunTraces, ProblemsWithDiscreteVariablesHaveProposalsAndWords) {
  RunPlan plan;
  plan.optimizer.name = "two";
  plan.optimizer.make = [](const Options&) { return std::make_unique<TwoPoints>(); };
  plan.problem.problem = make_contract_problems(plan.optimizer).back();  // mixed_bowl
  plan.problem.name = "mixed_bowl";
  plan.problem.resolved_json = load_problem("sphere").resolved_json;  // names the function only
  plan.budget = 2;
  const TemporaryFolder folder;
  StopSignal stop;
  SilentObserver observer;
  ASSERT_TRUE(execute_run({plan, folder / "run", 1, {}}, stop, observer));
  const CollectedRuns collected = collect_runs(find_runs(folder / "run").runs);
  write_csv(collected, folder / "csv");
  const std::string csv = read_file(folder / "csv" / "evaluations" / "mixed_bowl.csv", 1 << 16);
  EXPECT_THAT(csv,
              AllOf(HasSubstr(",x.turns,proposed.oil,proposed.gain,proposed.teeth,"
                              "proposed.turns\n"),
                    HasSubstr(",2,0.5,3,10,,,,\n"), HasSubstr(",1,0.5,3,10,1.25,0.5,3,9.75\n")));
  write_json(collected, folder / "json");
  const auto problem =
      nlohmann::json::parse(read_file(folder / "json" / "runs.json", 1 << 16))["problems"][0];
  EXPECT_EQ(problem["discrete_variables"]["oil"][4], "thick");
  EXPECT_EQ(problem["discrete_variables"]["teeth"], nlohmann::json::array());
  EXPECT_FALSE(problem["runs"][0]["evaluations"][0].contains("proposed"));
  EXPECT_EQ(problem["runs"][0]["evaluations"][1]["proposed"][0], 1.25);
  write_ioh(collected, folder / "ioh");
  const auto read_only = [&](const std::filesystem::path& below, const std::string& ending) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(below)) {
      if (entry.path().extension() == ending) {
        return read_file(entry.path(), 1 << 16);
      }
    }
    return std::string();
  };
  const auto scenario = nlohmann::json::parse(read_only(folder / "ioh", ".json"))["scenarios"][0];
  EXPECT_EQ(scenario["words"]["oil"][4], "thick");
  EXPECT_FALSE(scenario["words"].contains("teeth"));
  write_coco(collected, folder / "coco");
  EXPECT_THAT(read_only(folder / "coco", ".info"), HasSubstr("; oil: 0 = '"));
  EXPECT_THAT(read_only(folder / "coco", ".info"), HasSubstr(", 4 = 'thick'"));
}

}  // namespace
}  // namespace armwright
