// armwright report A B: one page about two runs or two studies.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "base/temporary_folder.hpp"
#include "e2e/program.hpp"
#include "report/page/data_contract.hpp"

namespace armwright {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class CliComparison : public testing::Test {
 protected:
  void run(const std::vector<std::string>& words) {
    const Outcome outcome = run_program(folder_.path(), words);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  void make_function_run(const std::string& out, const std::string& optimizer) {
    run({"optimize", "sphere", "--optimizer", optimizer, "--budget", "30", "--out", out,
         "--quiet"});
  }
  void make_arm_run(const std::string& out, std::vector<std::string> more) {
    std::vector<std::string> words = {
        "optimize", "q1-complex", "--optimizer", "ga", "--engine", "articulated",      "--budget",
        "30",       "--quiet",    "--out",       out,  "--set",    "sets.test_cases=7"};
    words.insert(words.end(), more.begin(), more.end());
    run(words);
  }
  void make_study(const std::string& out, const std::string& budget, const std::string& seed = "1",
                  const std::string& problems = "sphere") {
    run({"compare", "--problems", problems, "--optimizers", "cmaes", "--no-baselines",
         "--replicates", "8", "--budget", budget, "--seed", seed, "--out", out, "--quiet"});
  }
  void make_study_of(const std::string& out, const std::string& plan) {
    std::ofstream(folder_ / (out + ".toml")) << plan;
    run({"compare", out + ".toml", "--no-baselines", "--out", out, "--quiet"});
  }
  json compare(const std::string& a, const std::string& b) {
    const Outcome outcome = run_program(folder_.path(), {"report", a, b, "--json", "--quiet"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return json::parse(outcome.out);
  }
  void expect_refusal(const std::vector<std::string>& folders, const std::string& message) {
    std::vector<std::string> words = {"report"};
    words.insert(words.end(), folders.begin(), folders.end());
    const Outcome outcome = run_program(folder_.path(), words);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.out;
    EXPECT_THAT(outcome.err, HasSubstr(message));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "comparison.html"));
  }

  TemporaryFolder folder_;
};

json find_setting(const json& page, const std::string& name) {
  for (const json& one : page["settings"]) {
    if (one["name"] == name) {
      return {one["a"], one["b"]};
    }
  }
  return nullptr;
}

// Returns the parts of the basis whose settings differ.
std::set<std::string> list_obstacles(const json& page) {
  std::set<std::string> parts;
  for (const json& one : page["settings"]) {
    if (one["a"] != one["b"] && !one["basis"].is_null()) {
      parts.insert(one["basis"]);
    }
  }
  return parts;
}

TEST_F(CliComparison, RunsOfAFunction) {
  make_function_run("first", "ga");
  make_function_run("second", "cmaes");
  const json page = compare("first", "second");
  EXPECT_EQ(list_keys(page), read_contract("ComparisonData"));
  EXPECT_EQ(list_keys(page["runs"]), read_contract("ComparedRuns"));
  EXPECT_EQ(page["title"], "A: first – B: second");
  EXPECT_TRUE(page["studies"].is_null());
  EXPECT_EQ(find_setting(page, "run.optimizer"), (json{"ga", "cmaes"}));
  EXPECT_EQ(find_setting(page, "run.budget"), (json{"30", "30"}));
  EXPECT_EQ(list_keys(page["settings"][0]), read_contract("ComparedSetting"));
  EXPECT_EQ(list_obstacles(page), std::set<std::string>{});
  EXPECT_EQ(page["runs"]["same_cases"], true);
  EXPECT_EQ(page["runs"]["a"]["optimizer"], "ga");
  EXPECT_EQ(page["runs"]["b"]["optimizer"], "cmaes");
}

TEST_F(CliComparison, RunsOfAnArmCaseByCase) {
  make_arm_run("a", {});
  make_arm_run("b", {"--seed", "2"});
  const json page = compare("a", "b");
  const json& paired = page["runs"]["paired"];
  EXPECT_EQ(list_keys(paired), read_contract("PairedErrors"));
  EXPECT_EQ(paired["cases"], 7);
  // The counts are those of the recorded errors.
  int wins = 0;
  const json errors_a = page["runs"]["a"]["test"]["designs"][0]["errors"];
  const json errors_b = page["runs"]["b"]["test"]["designs"][0]["errors"];
  for (std::size_t i = 0; i < 7; ++i) {
    const bool a_better = errors_b[i].is_null()
                              ? !errors_a[i].is_null()
                              : !errors_a[i].is_null() && errors_a[i] < errors_b[i];
    wins += a_better ? 1 : 0;
  }
  EXPECT_EQ(paired["wins"], wins);
  EXPECT_EQ(list_obstacles(page), std::set<std::string>{});
  ASSERT_EQ(page["replays"].size(), 1);
  const json& replay = page["replays"][0];
  EXPECT_EQ(replay["designs"].size(), 2);
  EXPECT_GE(replay["cases"].size(), 2);
  for (const json& one : replay["cases"]) {
    ASSERT_EQ(one["motions"].size(), 2);
    EXPECT_THAT(one["label"].get<std::string>(), testing::EndsWith(" (of A)"));
    EXPECT_EQ(one["motions"][0]["design"], "a");
    EXPECT_EQ(one["motions"][1]["design"], "b");
  }

  const json itself = compare("a", "a");
  EXPECT_EQ(itself["runs"]["paired"]["ties"], 7);
  EXPECT_EQ(itself["runs"]["paired"]["p"], 1);
  EXPECT_EQ(itself["runs"]["paired"]["a12"], 0.5);
  EXPECT_TRUE(itself["runs"]["paired"]["better"].is_null());

  // The side that is better has the larger sum of ranks, whatever the number of its cases.
  make_arm_run("worse", {"--set", "variables.bounds_factor=1.01"});
  const json far = compare("a", "worse");
  EXPECT_EQ(list_obstacles(far), std::set<std::string>{"the search space"});
  EXPECT_EQ(far["runs"]["paired"]["better"], "a");
  EXPECT_EQ(compare("worse", "a")["runs"]["paired"]["better"], "b");
}

TEST_F(CliComparison, AnySettingThatChangesWhatIsMeasuredIsAnObstacle) {
  make_arm_run("a", {});
  const auto list = [&](const std::string& name, const std::string& setting) {
    make_arm_run(name, {"--set", setting});
    return list_obstacles(compare("a", name));
  };
  using Parts = std::set<std::string>;
  EXPECT_EQ(list("space", "workspace.radius_m=0.7"), Parts{"the problem"});
  EXPECT_EQ(list("cutoff", "training.cutoff_error_m=2"), Parts{"the training"});
  EXPECT_EQ(list("noise", "perturbation.quantisation_rad=1e-4"), Parts{"the problem"});
  EXPECT_EQ(list("judging", "sets.validation_cases=5"), Parts{});
}

TEST_F(CliComparison, RunsWithOtherTasksHaveNoPairs) {
  make_arm_run("a", {});
  make_arm_run("b", {"--set", "task.speed_m_per_s=1"});
  const json page = compare("a", "b");
  EXPECT_EQ(find_setting(page, "problem.task.speed_m_per_s"), (json{"1.5", "1"}));
  EXPECT_EQ(page["runs"]["same_cases"], false);
  EXPECT_TRUE(page["runs"]["paired"].is_null());
  EXPECT_TRUE(page["replays"].empty());
  EXPECT_THAT(page["notes"].dump(), HasSubstr("no motion of one is beside that of the other"));
}

TEST_F(CliComparison, StudiesReplicateByReplicate) {
  make_study("long", "600", "1", "sphere,rastrigin");
  make_study("short", "40");
  const json page = compare("long", "short");
  EXPECT_EQ(list_keys(page), read_contract("ComparisonData"));
  EXPECT_EQ(list_keys(page["studies"]), read_contract("ComparedStudies"));
  EXPECT_EQ(find_setting(page, "budget"), (json{"600", "40"}));
  EXPECT_EQ(find_setting(page, "problems"), (json{"rastrigin, sphere", "sphere"}));
  ASSERT_EQ(page["studies"]["cells"].size(), 1);  // rastrigin is in one study only
  const json& cell = page["studies"]["cells"][0];
  EXPECT_EQ(list_keys(cell), read_contract("ComparedCell"));
  EXPECT_EQ(list_keys(cell["a"]), read_contract("ComparedSide"));
  EXPECT_EQ(cell["problem"], "sphere");
  EXPECT_EQ(cell["pairs"], 8);
  EXPECT_EQ(cell["wins"], 8);
  EXPECT_EQ(cell["better"], "a");
  EXPECT_EQ(cell["p"], 2.0 / 256);  // one of 2^8 signs, two-sided
  EXPECT_EQ(cell["p_holm"], cell["p"]);
  EXPECT_LT(cell["a"]["median"], cell["b"]["median"]);

  const json turned = compare("short", "long")["studies"]["cells"][0];
  EXPECT_EQ(turned["better"], "b");
  EXPECT_EQ(turned["losses"], 8);
  EXPECT_EQ(turned["a12"], 1 - cell["a12"].get<double>());
}

TEST_F(CliComparison, FrontsOfTwoStudiesAreNotCompared) {
  for (const char* out : {"first", "second"}) {
    run({"compare", "--problems", "q2-pareto", "--optimizers", "pagmo:nsga2", "--no-baselines",
         "--replicates", "1", "--budget", "40", "--engine", "articulated", "--set",
         "sets.test_cases=3", "--set", "sets.validation_cases=3", "--out", out, "--quiet"});
  }
  const json page = compare("first", "second");
  EXPECT_TRUE(page["studies"]["cells"].empty());
  EXPECT_THAT(page["notes"].dump(),
              HasSubstr("The problem q2-pareto is not compared: it has several objectives"));
}

TEST_F(CliComparison, StudiesWithOtherProblemsHaveNoTest) {
  const auto make = [&](const std::string& out, const std::string& instance) {
    make_study_of(out, R"(problems = []
optimizers = ["cmaes"]
replicates = 6
budget = 40
[[problem]]
name = "sphere"
label = "ball of 1.5 m"
set = ["function.instance=)" +
                           instance + R"("]
[[problem]]
name = "sphere"
)");
  };
  make("first", "1");
  make("second", "2");
  const json page = compare("first", "second");
  EXPECT_EQ(list_obstacles(page), std::set<std::string>{"the problem"});
  const json& cells = page["studies"]["cells"];
  ASSERT_EQ(cells.size(), 2);
  for (const json& cell : cells) {
    const bool differs = cell["problem"] == "ball of 1.5 m";
    EXPECT_EQ(cell["untested"], differs ? json("the problem differs") : json(nullptr));
    EXPECT_EQ(cell["p"].is_null(), differs);
    EXPECT_EQ(cell["a12"].is_null(), differs);
    EXPECT_EQ(cell["pairs"], differs ? 0 : 6);
  }
}

TEST_F(CliComparison, StudiesListEverySettingOfThePlan) {
  const auto make = [&](const std::string& out, const std::string& more, int cases) {
    make_study_of(out, more + fmt::format(R"(problems = ["q1-complex"]
replicates = 1
budget = 40
set = ["physics.engine=articulated", "sets.test_cases=3", "sets.validation_cases=3"]
[[optimizer]]
name = "cmaes"
label = "cmaes"
schedule = "fixed:{}"
)",
                                          cases));
  };
  make("first", "checkpoints = 4\nselection.last = 3\n", 2);
  make("second", "checkpoints = 3\nvalue = \"failures\"\nconstraint_tolerance = 0.1\n", 4);
  const json page = compare("first", "second");
  EXPECT_EQ(find_setting(page, "value"), (json{"objective", "failures"}));
  EXPECT_EQ(find_setting(page, "checkpoints"), (json{"4", "3"}));
  EXPECT_EQ(find_setting(page, "constraint_tolerance"), (json{"0.0", "0.1"}));
  EXPECT_EQ(find_setting(page, "selection.last"), (json{"3", "9"}));
  EXPECT_EQ(find_setting(page, "optimizers.cmaes.schedule"), (json{"fixed:2", "fixed:4"}));
  EXPECT_TRUE(page["studies"]["cells"].empty());
}

TEST_F(CliComparison, FewPairsHaveNoTest) {
  for (const char* out : {"first", "second"}) {
    make_study_of(out, R"(problems = ["sphere"]
optimizers = ["cmaes"]
replicates = 5
budget = 40
)");
  }
  const json cell = compare("first", "second")["studies"]["cells"][0];
  EXPECT_EQ(cell["pairs"], 5);
  EXPECT_EQ(cell["untested"], "not enough pairs to decide; at least 6 are needed");
  EXPECT_TRUE(cell["p"].is_null());
}

TEST_F(CliComparison, StudiesWithOtherSeedsHaveNoPairs) {
  make_study("first", "40");
  make_study("second", "40", "2");
  const json cell = compare("first", "second")["studies"]["cells"][0];
  EXPECT_EQ(cell["pairs"], 0);
  EXPECT_TRUE(cell["p"].is_null());
  EXPECT_TRUE(cell["better"].is_null());
  EXPECT_EQ(cell["untested"], "the seed differs");
  EXPECT_FALSE(cell["a12"].is_null());
}

TEST_F(CliComparison, ThePageGoesIntoTheCurrentFolder) {
  make_function_run("first", "ga");
  make_function_run("second", "cmaes");
  const Outcome outcome = run_program(folder_.path(), {"report", "first", "second", "--quiet"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_TRUE(std::filesystem::exists(folder_ / "comparison.html"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "first/report.html"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "second/report.html"));
}

TEST_F(CliComparison, OtherPairsAreRefused) {
  make_function_run("run", "ga");
  make_study("study", "30");
  std::ofstream(folder_ / "file.html") << "no folder";
  expect_refusal({"run", "study"},
                 "run is the folder of a run, and study that of a study; a page "
                 "can compare two runs or two studies");
  expect_refusal({"run", "missing"}, "missing: there is no such folder");
  expect_refusal({"run", "file.html"},
                 "file.html: is a file; a comparison is made from two folders");
  expect_refusal({"run", "run", "run"}, "unexpected argument 'run'");
  expect_refusal({"study", "study", "--case", "test/2:1"}, "--case needs runs");
}

}  // namespace
}  // namespace armwright
