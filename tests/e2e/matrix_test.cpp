// Cells of a comparison run one by one, by scripts and on several machines: the same bytes as of a
// comparison that ran here alone.
#include <gmock/gmock.h>
#include <signal.h>

#include <chrono>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <thread>

#include "base/temporary_folder.hpp"
#include "e2e/program.hpp"
#include "study/journal/journal.hpp"
#include "wait_until.hpp"

namespace armwright {
namespace {

using testing::HasSubstr;
using testing::Not;

using Words = std::vector<std::string>;

class CliMatrix : public testing::Test {
 protected:
  void SetUp() override {
    std::ofstream(folder_ / "mine.toml") << R"toml(
problems = ["sphere", "rosenbrock"]
replicates = 6
budget = 60
baselines = false
[[optimizer]]
name = "ga"
label = "my ga, 'small': 50% / \"half\" $(touch x)"
options = ["population=10"]
[[optimizer]]
name = "random"
)toml";
  }
  Outcome run(const Words& words, const Environment& environment = {}) {
    return run_program(folder_.path(), words, environment);
  }
  Outcome run_script(const std::string& arguments) {
    return run({}, {.variables = {},
                    .out_file = "",
                    .launcher = {"sh", "-c", "bash run.sh " + arguments, "sh"}});
  }
  // The script of a new study in `out`, as run.sh.
  void write_script(const std::string& out, const Words& more = {}) {
    Words words = {"compare", "mine.toml", "--executor", "script", "--out", out, "--quiet"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = run(words);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    std::ofstream(folder_ / "run.sh") << outcome.out;
  }
  // All that the study has come to, with its cells' own records.
  std::map<std::string, std::string> read_all(const std::string& study) {
    auto files = read_study(folder_ / study);
    for (const auto& entry :
         std::filesystem::recursive_directory_iterator(folder_ / study / "cells")) {
      const std::string name = entry.path().filename();
      if (name == "cell.json" || name == "result.json") {
        files[entry.path().lexically_relative(folder_ / study)] = read_text(entry.path());
      }
    }
    return files;
  }
  TemporaryFolder folder_;
};

TEST_F(CliMatrix, AScriptComesToTheSameBytesAsALocalComparison) {
  ASSERT_EQ(run({"compare", "mine.toml", "--out", "local", "--quiet"}).exit_code, 0);
  write_script("a study's", {"--chunk", "0.1s"});
  const Outcome one = run_script("2");
  EXPECT_EQ(one.exit_code, 0) << one.err;
  const Outcome all = run_script("");
  EXPECT_EQ(all.exit_code, 0) << all.err;
  EXPECT_THAT(all.err, HasSubstr("all chunks have ended. Statistics, tables and verdict:"));
  const Outcome status = run({"status", "a study's"});
  EXPECT_THAT(status.out, HasSubstr("All cells have ended. To make tables and verdict:"));
  EXPECT_THAT(status.out, HasSubstr("merge 'a study'\\''s'"));
  const Outcome merged = run({"merge", "a study's", "--json", "--quiet"});
  EXPECT_EQ(merged.exit_code, 0) << merged.err;
  EXPECT_EQ(merged.out, read_text(folder_ / "local/result.json"));
  EXPECT_EQ(read_all("a study's"), read_all("local"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "a study's/attempts"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "x"));
  const Outcome again = run({"compare", "mine.toml", "--executor", "script", "--out", "a study's"});
  EXPECT_EQ(again.exit_code, 0);
  EXPECT_EQ(again.out, "");
  EXPECT_THAT(again.err, HasSubstr("all cells are done. To make tables and verdict:"));
}

TEST_F(CliMatrix, ADryRunSaysWhatWouldBeSubmittedAndWritesNothing) {
  const Outcome outcome = run({"compare", "mine.toml", "--executor", "slurm", "--dry-run",
                               "--sbatch=--partition=short", "--sbatch=--mem=1G", "--quiet"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("cells    24, of which 0 are done\nchunks   1, of 24 cells"));
  EXPECT_THAT(outcome.out, HasSubstr("memory   about 96 MiB per task"));
  EXPECT_THAT(outcome.out, HasSubstr("submit   sbatch --parsable --array=1-1 --requeue "
                                     "--open-mode=append --job-name=armwright-mine --output="));
  EXPECT_THAT(outcome.out, HasSubstr("--time=11 --cpus-per-task=1 --partition=short --mem=1G "));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "results"));
  const Outcome script = run({"compare", "mine.toml", "--executor", "script", "--dry-run"});
  EXPECT_THAT(script.out, Not(HasSubstr("sbatch")));
}

TEST_F(CliMatrix, WhatCannotBeIsRefused) {
  const auto expect = [&](const Words& more, int code, const std::string& message) {
    Words words = {"compare", "mine.toml", "--quiet"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = run(words, {.variables = {{"PATH", "/nowhere"}}, .out_file = ""});
    EXPECT_EQ(outcome.exit_code, code) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(message));
  };
  expect({"--executor", "slrum"}, 2, "unknown executor 'slrum'; did you mean 'slurm'?");
  expect({"--chunk", "1m"}, 2, "--chunk is for --executor slurm or script");
  expect({"--sbatch=-x", "--executor", "script"}, 2, "--sbatch is for --executor slurm");
  expect({"--json", "--executor", "script"}, 2,
         "--json and --time-limit cannot be used with --executor slurm or script");
  expect({"--executor", "mpi"}, 2, "--executor mpi needs ranks that mpirun starts");
  expect({"--executor", "slurm"}, 2, "there is no program 'sbatch' on this machine's PATH");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "results/mine/submissions/001"));
  std::filesystem::create_directories(folder_ / "results/mine/submissions/001");
  std::ofstream(folder_ / "results/mine/submissions/001/submission.json") << "{\"job\": \"-a\"}";
  expect({"--executor", "slurm"}, 4, "submission.json: is not what armwright wrote");
  for (const char* command : {"cell", "status", "merge"}) {
    Words words = {command, "."};
    if (command == std::string("cell")) {
      words.emplace_back("0");
    }
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.err, HasSubstr("is neither the folder of a study"));
  }
}

TEST_F(CliMatrix, MergeNamesWhatIsMissingAndTakesItFromOtherFolders) {
  ASSERT_EQ(run({"compare", "mine.toml", "--out", "local", "--quiet"}).exit_code, 0);
  for (const char* machine : {"here", "there"}) {
    write_script(machine);
  }
  const Outcome nothing = run({"merge", "here"});
  EXPECT_EQ(nothing.exit_code, 2);
  EXPECT_THAT(nothing.err, HasSubstr("no cell has ended"));
  EXPECT_EQ(run({"cell", "here", "0-12", "--quiet"}).exit_code, 0);
  EXPECT_EQ(run({"cell", "there/study.toml", "11-23", "--quiet"}).exit_code, 0);
  const Outcome missing = run({"merge", "here", "--quiet"});
  EXPECT_EQ(missing.exit_code, 3);
  EXPECT_THAT(missing.err, HasSubstr("11 of 24 cells have not ended: sphere/random/r04, "));
  EXPECT_THAT(missing.err, HasSubstr(" and 1 more. To run them on this machine:"));
  EXPECT_THAT(missing.out, HasSubstr("11 of 24 cells have not ended"));
  const Outcome merged = run({"merge", "here", "there"});
  EXPECT_EQ(merged.exit_code, 0) << merged.err;
  EXPECT_THAT(merged.err, HasSubstr("11 cells copied"));
  EXPECT_EQ(read_all("here"), read_all("local"));
}

// A cell whose record is damaged costs itself alone; and one that is done is not run again.
TEST_F(CliMatrix, ABrokenCellDoesNotKeepTheOthers) {
  write_script("study", {"--chunk", "0.2s"});
  const auto broken = folder_ / "study/cells/rosenbrock/random/r01";
  std::filesystem::create_directories(broken);
  std::ofstream(broken / "cell.json") << "?";
  const Outcome outcome = run_script("");
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.err, HasSubstr("rosenbrock/random/r01: error: "));
  const Outcome status = run({"status", "study", "--json"});
  const auto counts = nlohmann::json::parse(status.out).at("counts");
  EXPECT_EQ(counts.at("done"), 23);
  EXPECT_EQ(counts.at("broken"), 1);
  EXPECT_THAT(run({"status", "study"}).out, HasSubstr("broken\n  rosenbrock/random/r01: "));
  std::filesystem::remove_all(broken);
  const Outcome last = run({"cell", "study", "0-23"});
  EXPECT_EQ(last.exit_code, 0);
  EXPECT_THAT(last.err, HasSubstr("1 cell done, 23 before; 0 failed"));
}

TEST_F(CliMatrix, ACellKilledOrStoppedGoesOnAndALocalComparisonTakesOver) {
  std::ofstream(folder_ / "slow.toml") << R"(
problems = ["sphere"]
replicates = 2
budget = 60
baselines = false
[[optimizer]]
name = "exec:python3 )" << ARMWRIGHT_TEST_PLUGINS_SOURCE
                                       << R"(/patient.py"
label = "patient"
)";
  const auto gate = folder_ / "gate";
  std::ofstream(gate) << "closed\n";
  const Environment environment{.variables = {{"PATIENT_GATE", gate.string()}}, .out_file = ""};
  ASSERT_EQ(run({"compare", "slow.toml", "--executor", "script", "--out", "study", "-q"}).exit_code,
            0);
  const auto attempts = folder_ / "study/attempts/sphere/patient/r01";
  const auto wait_for = [&](const char* token) {
    const auto journal = attempts / token / "run/journal";
    // The optimizer waits after ten evaluations (patient.py).
    return wait_until(
        [&] { return !read_text(journal).empty() && read_journal(journal).training.size() == 10; });
  };
  Program first(folder_.path(), {"cell", "study", "0-1"}, environment);
  ASSERT_TRUE(wait_for("001"));
  first.send(SIGKILL);
  first.wait();
  Program second(folder_.path(), {"cell", "study", "0-1"}, environment);
  ASSERT_TRUE(wait_for("002"));
  EXPECT_THAT(run({"status", "study"}).out, HasSubstr("running\n  sphere/patient/r01: process " +
                                                      std::to_string(second.pid()) + " on "));
  second.send(SIGTERM);
  const Outcome stopped = second.wait();
  EXPECT_EQ(stopped.exit_code, 75);
  EXPECT_THAT(stopped.err, HasSubstr("resuming: 10 evaluations"));
  EXPECT_THAT(stopped.err, HasSubstr("nothing is lost. To resume:"));

  // A local comparison holds the study, so that others keep away.
  Program local(folder_.path(), {"compare", "slow.toml", "--out", "study"}, environment);
  ASSERT_TRUE([&] {
    for (int tries = 0; tries < 1000; ++tries) {
      if (run({"status", "study"}).out.find("One process runs the whole study") !=
          std::string::npos) {
        return true;
      }
    }
    return false;
  }());
  const Outcome busy = run({"cell", "study", "0"}, environment);
  EXPECT_EQ(busy.exit_code, 5);
  EXPECT_THAT(busy.err, HasSubstr("is in use by process "));
  std::filesystem::remove(gate);
  const Outcome done = local.wait();
  EXPECT_EQ(done.exit_code, 0) << done.err;
  EXPECT_THAT(done.err, HasSubstr("resuming: 10 evaluations"));
  ASSERT_EQ(run({"compare", "slow.toml", "--out", "alone", "-q"}).exit_code, 0);
  EXPECT_EQ(read_all("study"), read_all("alone"));
}

}  // namespace
}  // namespace armwright
