#include "study/compare/rerun.hpp"

#include <gmock/gmock.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "base/expect_error.hpp"
#include "base/remove_checksums.hpp"
#include "study/compare/cell_comparison.hpp"
#include "study/compare/study_support.hpp"

namespace armwright {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

StudyPlan make_plan_with_labels(const TemporaryFolder& folder) {
  std::ofstream(folder / "plan.toml") << R"toml(
replicates = 12
budget = 40
baselines = false
[[problem]]
name = "sphere"
label = "a/b"
[[problem]]
name = "sphere"
label = "a"
[[problem]]
name = "sphere"
label = "a%2Fb"
[[optimizer]]
name = "random"
label = "c"
[[optimizer]]
name = "random"
label = "b/c"
[[optimizer]]
name = "random"
label = "my 'own' (50%)"
)toml";
  StudyRequest request;
  request.file = (folder / "plan.toml").string();
  return make_study_plan(request);
}

TEST(FindCell, ReadsLabelsAndNamesOfFolders) {
  const TemporaryFolder folder;
  const StudyPlan plan = make_plan_with_labels(folder);
  const auto expect = [&](const std::string& name, const Cell& cell) {
    const Cell found = find_cell(plan, name);
    EXPECT_EQ(found.problem, cell.problem) << name;
    EXPECT_EQ(found.optimizer, cell.optimizer) << name;
    EXPECT_EQ(found.replicate, cell.replicate) << name;
  };
  expect("a/c/r01", {1, 0, 1});
  expect("a/c/r12", {1, 0, 12});
  expect("a/c/r2", {1, 0, 2});
  expect("a/my 'own' (50%)/r01", {1, 2, 1});
  expect("a/my%20%27own%27%20%2850%25%29/r01", {1, 2, 1});
  expect("a/b/b/c/r01", {0, 1, 1});
  expect("a/b%2Fc/r01", {1, 1, 1});
  expect("a%2Fb/c/r01", {0, 0, 1});  // folder names take precedence over labels
  expect("a%252Fb/c/r01", {2, 0, 1});
  for (const Cell& cell : list_cells(plan)) {
    expect(make_cell_path(plan, cell).lexically_relative("cells").string(), cell);
  }
}

TEST(FindCell, RefusesWhatIsNoneAndSaysWhatIsNear) {
  const TemporaryFolder folder;
  const StudyPlan plan = make_plan_with_labels(folder);
  const auto expect = [&](const std::string& name, const std::string& message) {
    EXPECT_THAT(usage_error_of([&] { find_cell(plan, name); }), HasSubstr(message));
  };
  expect("a/b/c/r01", "'a/b/c/r01' fits two cells; name the cell as its folder is named: a%2Fb/c");
  expect("ab/c/r01", "unknown problem 'ab'; did you mean 'a/b'?");
  expect("a/my own (50%)/r01", "did you mean 'my 'own' (50%)'?");
  expect("a/c/r13", "the study has no replicate r13; it has r01 to r12");
  expect("a/c/r0", "the study has no replicate r0");
  for (const char* name : {"", "a", "a/c", "a/c/1", "a/c/r", "a/c/r1x", "r01", "a/c/r-1"}) {
    expect(name, "a cell is PROBLEM/OPTIMIZER/rNN, as in 'a/b/c/r01'");
  }
}

class Rerun : public StudyTest {
 protected:
  // The same cell in two studies of one plan; the runs must be identical.
  void make_two(const std::string& optimizer, const std::string& problem = "sphere") {
    StudyRequest request;
    request.problems = {problem};
    request.optimizers = {optimizer};
    request.replicates = 2;
    request.budget = 60;
    request.baselines = false;
    plan_ = make_study_plan(request);
    study(plan_, "study", 1);
    rerun(2);
    remove_checksums(temporary_ / "study");  // the tests below change recorded files
  }
  void rerun(unsigned jobs) {
    StopSignal stop;
    ASSERT_TRUE(
        run_cell(plan_, kCell, CellRequest{.folder = now(), .jobs = jobs}, stop, observer_));
  }
  std::filesystem::path recorded() { return temporary_ / "study" / make_cell_path(plan_, kCell); }
  std::filesystem::path now() { return temporary_ / "rerun"; }
  static void replace(const std::filesystem::path& file, const std::string& what,
                      const std::string& by) {
    std::string text = read_file(file, 1 << 24);
    ASSERT_NE(text.find(what), std::string::npos);
    text.replace(text.find(what), what.size(), by);
    std::ofstream(file) << text;
  }
  static constexpr Cell kCell{0, 0, 2};
  StudyPlan plan_;
};

TEST_F(Rerun, OnAnyNumberOfThreadsIsIdentical) {
  make_two("cmaes");
  const CellComparison comparison = compare_cells(recorded(), now());
  EXPECT_FALSE(comparison.difference);
  EXPECT_EQ(comparison.evaluations, 60u);
  EXPECT_GT(comparison.judgements, 1u);
  EXPECT_THAT(comparison.files, ElementsAre("result.json", "cell.json"));
}

TEST_F(Rerun, AnotherJournalIsFoundAtTheFirstDifferentEvaluation) {
  make_two("random");
  const auto other = temporary_ / "study" / make_cell_path(plan_, {0, 0, 1});
  std::filesystem::copy_file(other / "journal", recorded() / "journal",
                             std::filesystem::copy_options::overwrite_existing);
  const auto difference = compare_cells(recorded(), now()).difference;
  ASSERT_TRUE(difference);
  EXPECT_EQ(difference->where, "evaluation 0");
  EXPECT_EQ(difference->field, "x[0]");
  EXPECT_NE(difference->recorded, difference->now);
}

TEST_F(Rerun, AChangedEvaluationIsFound) {
  make_two("random");
  const JournalContent content = read_journal(recorded() / "journal");
  std::filesystem::remove(recorded() / "journal");
  JournalContent nothing;
  Journal journal(recorded() / "journal", nothing);
  for (std::size_t i = content.training.size(); i-- > 0;) {  // the order of records does not matter
    EvaluationRecord record = content.training[i];
    if (i == 17) {
      record.evaluation.objectives[0] = std::nextafter(record.evaluation.objectives[0], 0);
    }
    journal.append(record);
  }
  for (const EvaluationRecord& record : content.judgements) {
    journal.append(record);
  }
  journal.append(content.end);
  journal.close();
  const CellComparison comparison = compare_cells(recorded(), now());
  ASSERT_TRUE(comparison.difference);
  EXPECT_EQ(comparison.evaluations, 17u);
  EXPECT_EQ(comparison.difference->where, "evaluation 17");
  EXPECT_EQ(comparison.difference->field, "objectives[0]");
}

TEST_F(Rerun, AMissingEvaluationIsFound) {
  make_two("random");
  const JournalContent content = read_journal(recorded() / "journal");
  std::filesystem::remove(recorded() / "journal");
  JournalContent nothing;
  Journal journal(recorded() / "journal", nothing);
  for (std::size_t i = 0; i + 1 < content.training.size(); ++i) {
    journal.append(content.training[i]);
  }
  journal.close();
  const auto difference = compare_cells(recorded(), now()).difference;
  ASSERT_TRUE(difference);
  EXPECT_EQ(difference->field, "number of evaluations");
  EXPECT_EQ(difference->recorded, "59");
  EXPECT_EQ(difference->now, "60");
}

TEST_F(Rerun, ChangedFilesAreFound) {
  make_two("random");
  replace(recorded() / "cell.json", "\"cases\": 60", "\"cases\": 61");
  const auto in_cell = compare_cells(recorded(), now()).difference;
  ASSERT_TRUE(in_cell);
  EXPECT_EQ(in_cell->where, "cell.json");
  EXPECT_EQ(in_cell->field, "cases");
  EXPECT_EQ(in_cell->recorded, "61");
  EXPECT_EQ(in_cell->now, "60");
  replace(recorded() / "result.json", "\"test_set\"", "\"the_set\"");
  const auto in_result = compare_cells(recorded(), now()).difference;
  ASSERT_TRUE(in_result);
  EXPECT_EQ(in_result->where, "result.json");
  EXPECT_EQ(in_result->field, "the_set");
  EXPECT_EQ(in_result->now, "absent");
}

TEST_F(Rerun, LikelyCausesComeFromTheManifests) {
  make_two("random");
  EXPECT_THAT(list_likely_causes(recorded(), now()),
              ElementsAre(HasSubstr("the recorded files were changed after the run")));
  // An earlier version did not record the libraries.
  replace(recorded() / "manifest.json", "\"nlopt\": ", "\"a-library-of-then\": ");
  EXPECT_THAT(list_likely_causes(recorded(), now()), Not(Contains(HasSubstr("nlopt"))));
  replace(recorded() / "manifest.json", "\"compiler\": \"", "\"compiler\": \"old ");
  replace(recorded() / "manifest.json", "\"budget\": 60", "\"budget\": 61");
  const auto causes = list_likely_causes(recorded(), now());
  EXPECT_THAT(causes, Contains(HasSubstr("compiler: recorded \"old ")));
  EXPECT_THAT(causes, Contains(HasSubstr("budget: recorded 61, now 60")));
}

TEST_F(Rerun, GoesIntoAFolderOfItsOwn) {
  make_two("random");
  const auto study = temporary_ / "study";
  const auto first = choose_rerun_folder(study, plan_, kCell);
  EXPECT_EQ(first, study / "reruns" / "sphere" / "random" / "r02");
  std::filesystem::create_directories(first);
  EXPECT_EQ(choose_rerun_folder(study, plan_, kCell), first);  // it has not ended, so it is resumed
  std::ofstream(first / "cell.json") << "{}";
  EXPECT_EQ(choose_rerun_folder(study, plan_, kCell),
            study / "reruns" / "sphere" / "random" / "r02-002");
}

}  // namespace
}  // namespace armwright
