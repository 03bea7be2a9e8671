// Comparisons on functions with an instance per replicate, and those that version 1.0 recorded.
#include <gmock/gmock.h>

#include <set>

#include "study/compare/study_support.hpp"

namespace armwright {
namespace {

StudyRequest make_rastrigin_request() {
  StudyRequest request;
  request.problems = {"rastrigin"};
  request.optimizers = {"cmaes"};
  request.settings = {"function.dimension=3"};
  request.replicates = 4;
  request.budget = 60;
  return request;
}

TEST(StudyInstances, AReplicateHasTheSameInstanceForEveryOptimizer) {
  const StudyPlan plan = make_study_plan(make_rastrigin_request());
  std::map<int, std::set<std::vector<double>>> minimisers;  // by replicate
  std::set<std::vector<double>> all;
  for (const Cell& cell : list_cells(plan)) {
    const RunPlan run = make_run_plan(plan, cell);
    const std::vector<double>& minimiser = run.problem.problem->description().known_optimum;
    minimisers[cell.replicate].insert(minimiser);
    all.insert(minimiser);
  }
  for (const auto& [replicate, own] : minimisers) {
    EXPECT_EQ(own.size(), 1u) << replicate;
  }
  EXPECT_EQ(all.size(), 4u);
}

// Version 1.0 recorded neither the instance nor a setting for the plain form, and its shipped file
// had no other form.
TEST(StudyInstances, APlanOfVersion1KeepsThePlainForm) {
  StudyRequest request = make_rastrigin_request();
  request.settings.push_back("function.instance=0");
  const StudyPlan made = make_study_plan(request);
  std::string toml = to_toml(made);
  toml.erase(0, toml.find('\n') + 1);  // the line with the hash of the following text
  const std::string setting = ", \"function.instance=0\"";
  ASSERT_NE(toml.find(setting), std::string::npos);
  toml.erase(toml.find(setting), setting.size());
  const TemporaryFolder folder;
  const StudyPlan read = load_plan(folder, toml);
  EXPECT_EQ(calc_configuration_hash(read.problems[0].loaded),
            calc_configuration_hash(made.problems[0].loaded));
  EXPECT_EQ(make_run_plan(read, {0, 0, 3}).problem.problem->description().known_optimum,
            make_analytic("rastrigin", 3)->description().known_optimum);
}

// The command of a study that version 1.0 began continues it, as the shipped problem was then.
TEST_F(StudyTest, AStudyOfVersion1GoesOnWithThePlainForm) {
  StudyRequest request = make_rastrigin_request();
  StudyPlan old = make_study_plan(request);
  old.problems[0].loaded = load_problem(
      "rastrigin", std::vector<std::string>{"function.dimension=3", "function.instance=0"});
  study(old, "study");
  const auto before = read_cells("study");
  request.replicates = 5;
  StudyPlan now = make_study_plan(request);
  adopt_recorded(temporary_ / "study", now);
  study(now, "study");
  const auto after = read_cells("study");
  EXPECT_GT(after.size(), before.size());
  for (const auto& [path, text] : before) {
    EXPECT_EQ(after.at(path), text) << path;
  }
  EXPECT_EQ(make_run_plan(now, {0, 0, 5}).problem.problem->description().known_optimum,
            make_analytic("rastrigin", 3)->description().known_optimum);
}

// Its problem has a workspace, a speed and a start that are not proposed any more.
TEST_F(StudyTest, AStudyOfVersion1KeepsWhatWasProposed) {
  StudyRequest request;
  request.problems = {"robot"};
  request.optimizers = {"random"};
  request.settings = {"robot.urdf=\"planar2\"", "sets.validation_cases=2", "sets.test_cases=2",
                      "schedule.cases=1"};
  request.baselines = false;
  request.replicates = 1;
  request.budget = 4;
  StudyPlan old = make_study_plan(request);
  std::vector<std::string> then = request.settings;
  then.insert(then.end(), kProposedByVersion1.begin(), kProposedByVersion1.end());
  old.problems[0].loaded = load_problem("robot", then);
  study(old, "study");
  StudyPlan now = make_study_plan(request);
  EXPECT_NE(now.problems[0].loaded.resolved_json, old.problems[0].loaded.resolved_json);
  adopt_recorded(temporary_ / "study", now);
  EXPECT_EQ(now.problems[0].loaded.resolved_json, old.problems[0].loaded.resolved_json);
  const auto before = read_cells("study");
  study(now, "study");
  EXPECT_EQ(read_cells("study"), before);
}

// An optimizer with settings of its own has the same function.
TEST(StudyInstances, AnOptimizerWithSettingsHasThePlainFormTooInAPlanOfVersion1) {
  const TemporaryFolder folder;
  const auto write = [](const std::string& set, const std::string& hash) {
    return "problems = []\nreplicates = 3\nbudget = 60\n[[problem]]\nname = 'sphere'\n" + set +
           hash +
           "[[optimizer]]\nname = 'cmaes'\n[[optimizer]]\nname = 'cmaes'\nlabel = 'racing'\n"
           "set = ['racing.kind=none']\n";
  };
  const StudyPlan made = load_plan(folder, write("set = ['function.instance=0']\n", ""));
  const StudyPlan read =
      load_plan(folder, write("", "configuration_sha256 = '" +
                                      calc_configuration_hash(made.problems[0].loaded) + "'\n"));
  EXPECT_EQ(make_run_plan(read, {0, 1, 1}).problem.problem->description().known_optimum,
            make_analytic("sphere", 10)->description().known_optimum);
}

}  // namespace
}  // namespace armwright
