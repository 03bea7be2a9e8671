// Comparisons as a user meets them: the command, killed in the middle and gone on with, and its
// export.
#include <gmock/gmock.h>
#include <signal.h>

#include <chrono>
#include <fstream>
#include <map>
#include <thread>

#include "base/temporary_folder.hpp"
#include "e2e/program.hpp"

namespace armwright {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

std::vector<std::string> make_command(const std::string& out, const std::string& jobs,
                                      const std::string& budget = "1000") {
  return {"compare",
          "--problems",
          "q1-complex,q1-trapezoid",
          "--optimizers",
          "ga,cmaes",
          "--replicates",
          "3",
          "--budget",
          budget,
          "--engine",
          "articulated",
          "--set",
          "sets.test_cases=20",
          "--set",
          "sets.validation_cases=5",
          "--jobs",
          jobs,
          "--out",
          out,
          "--quiet"};
}

TEST(CliCompare, KillsInTheMiddleAndAnyNumberOfProcessesChangeNoTable) {
  const TemporaryFolder folder;
  const Outcome one = run_program(folder.path(), make_command("one", "1"));
  ASSERT_EQ(one.exit_code, 0) << one.err;
  ASSERT_EQ(run_program(folder.path(), make_command("two", "2")).exit_code, 0);
  EXPECT_EQ(read_study(folder / "one"), read_study(folder / "two"));
  int kills = 0;
  for (const int wait_ms : {300, 450, 200}) {
    Program program(folder.path(), make_command("killed", "2"));
    std::this_thread::sleep_for(std::chrono::milliseconds(wait_ms));
    kills += program.is_running() ? 1 : 0;
    program.send(SIGKILL);
    program.wait();
  }
  EXPECT_GT(kills, 0);
  const Outcome last = run_program(folder.path(), make_command("killed", "2"));
  EXPECT_EQ(last.exit_code, 0) << last.err;
  EXPECT_EQ(read_study(folder / "one"), read_study(folder / "killed"));
  EXPECT_THAT(one.out, HasSubstr("Verdict"));
  EXPECT_THAT(one.out, testing::ContainsRegex("Next\n  [^\n]*armwright report one\n  "
                                              "[^\n]*armwright show one\n$"));
}

TEST(CliCompare, InterruptedItSaysHowToGoOn) {
  const TemporaryFolder folder;
  Program program(folder.path(), make_command("study", "1"));
  while (program.is_running() && !std::filesystem::exists(folder / "study" / "cells")) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  program.send(SIGINT);
  const Outcome outcome = program.wait();
  EXPECT_EQ(outcome.exit_code, 130);
  EXPECT_THAT(outcome.err, HasSubstr("nothing is lost. To resume:"));
}

TEST(CliCompare, ADryRunPrintsThePlanAndRunsNothing) {
  const TemporaryFolder folder;
  const Outcome outcome = run_program(folder.path(), {"compare", "--preset", "smoke", "--dry-run"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.out, HasSubstr("plan_sha256 = \""));
  EXPECT_THAT(outcome.err, HasSubstr("80 cells"));
  EXPECT_FALSE(std::filesystem::exists(folder / "results"));
}

TEST(CliCompare, AChangeThatWouldMakeCellsIncomparableIsRefused) {
  const TemporaryFolder folder;
  ASSERT_EQ(run_program(folder.path(), make_command("study", "2", "50")).exit_code, 0);
  const Outcome outcome = run_program(folder.path(), make_command("study", "2", "55"));
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("budget: recorded 50, now 55"));
}

TEST(CliCompare, AStudyExportsInEveryFormat) {
  const TemporaryFolder folder;
  std::ofstream(folder / "mine.toml") << R"(
problems = ["sphere"]
replicates = 2
budget = 60
baselines = false
[[optimizer]]
name = "ga"
label = "my ga, 'small': 50% / \"half\""
options = ["population=10"]
[[optimizer]]
name = "random"
)";
  ASSERT_EQ(run_program(folder.path(), {"compare", "mine.toml", "--quiet"}).exit_code, 0);
  for (const std::string format : {"csv", "json", "ioh", "coco"}) {
    const Outcome outcome = run_program(
        folder.path(), {"export", "results/mine", "--format", format, "--out", "out-" + format});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("4 runs with 240 evaluations on 1 problem")) << format;
  }
}

TEST(CliCompare, TheShippedStudiesAreListedAndExplained) {
  const TemporaryFolder folder;
  const Outcome list = run_program(folder.path(), {"list", "studies"});
  for (const char* name : {"smoke", "analytic", "q1", "q2", "q3"}) {
    EXPECT_THAT(list.out, HasSubstr(name));
    const Outcome one = run_program(folder.path(), {"list", "studies", name});
    EXPECT_EQ(one.exit_code, 0) << one.err;
    EXPECT_THAT(one.out, testing::ContainsRegex("\nbaselines +start, random"));
  }
}

// Their names are long: a command with a path, and a path.
TEST(CliCompare, PluginsHaveTheirOwnShortNamesInTables) {
  const TemporaryFolder folder;
  const std::string command =
      "exec:python3 " + std::string(ARMWRIGHT_TEST_PLUGINS_SOURCE) + "/good.py";
  const std::string library = std::string(ARMWRIGHT_TEST_PLUGINS) + "/libgood.so";
  const Outcome outcome = run_program(
      folder.path(), {"compare", "--problems", "sphere", "--optimizers", command + "," + library,
                      "--replicates", "5", "--budget", "30", "--no-baselines", "--out", "study"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("plugin      lcg: " + command),
                                 HasSubstr("plugin      pattern: " + library)));
  for (const auto& [file, text] : read_study(folder / "study")) {
    EXPECT_THAT(text, Not(HasSubstr("/good.py"))) << file;
    EXPECT_THAT(text, Not(HasSubstr("/libgood.so"))) << file;
  }
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("lcg"), HasSubstr("pattern")));
}

}  // namespace
}  // namespace armwright
