// Comparisons on a real Slurm, started for the test on this machine alone (slurm-onebox.sh). What
// goes wrong on clusters is done to it: a node is lost, its jobs are begun again elsewhere, and
// what the node ran goes on as if nothing had happened.
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "base/temporary_folder.hpp"
#include "base/text.hpp"
#include "e2e/processes.hpp"
#include "e2e/program.hpp"
#include "wait_until.hpp"

namespace armwright {
namespace {

using testing::HasSubstr;

int read_number(const std::filesystem::path& file) {
  int number = 0;
  std::ifstream(file) >> number;
  return number;
}

// What an attempt at a cell says of its process; 0 if there is none.
int find_attempt_process(const std::filesystem::path& attempt) {
  const auto record = nlohmann::json::parse(read_text(attempt / "attempt.json"), nullptr, false);
  return record.is_object() ? record.value("pid", 0) : 0;
}

// One of each chunk.
std::set<std::string> find_first_patient_cells(const std::filesystem::path& script) {
  std::set<std::string> cells;
  std::ifstream lines(script);
  for (std::string line; std::getline(lines, line);) {
    if (line.find(") run_cells ") == std::string::npos) {
      continue;
    }
    for (const std::string& word : split(line, ' ')) {
      if (word.find("/patient/") != std::string::npos) {
        cells.insert(word);
        break;
      }
    }
  }
  return cells;
}

class Slurm : public testing::Test {
 protected:
  void SetUp() override {
    if (::geteuid() != 0) {
      GTEST_SKIP() << "a Slurm of one's own needs root";
    }
    if (::access("/usr/sbin/slurmctld", X_OK) != 0) {
      GTEST_SKIP() << "slurmctld is not installed: scripts/setup --tests installs slurm-wlm";
    }
    // Slurm's step daemons leave their parents; they are to be reaped all the same.
    ::prctl(PR_SET_CHILD_SUBREAPER, 1);
    std::ofstream(gate_) << "closed\n";
    const std::string wait = "while kill -0 $PPID && [ ! -e \"$BOX_END\" ]; do sleep 0.05; done";
    box_ = std::make_unique<Program>(
        folder_.path(), std::vector<std::string>{},
        Environment{.variables = {{"BOX_END", (folder_ / "end").string()}},
                    .out_file = "",
                    .launcher = {"bash", ARMWRIGHT_SLURM_ONEBOX, (folder_ / "box").string(), "2",
                                 "--", "sh", "-c", wait, "sh"}});
    environment_.variables = {{"SLURM_CONF", (folder_ / "box/slurm.conf").string()},
                              {"PATIENT_GATE", gate_.string()}};
    ASSERT_TRUE(wait_until([&] { return std::filesystem::exists(folder_ / "box/ready"); }))
        << read_text(folder_ / "box/log/slurmctld.log");
  }
  void TearDown() override {
    std::filesystem::remove(gate_);
    if (!box_) {
      return;
    }
    std::ofstream(folder_ / "end") << "\n";
    EXPECT_EQ(box_->wait().exit_code, 0);
    EXPECT_TRUE(wait_until([] {
      while (::waitpid(-1, nullptr, WNOHANG) > 0) {
      }
      return ::waitpid(-1, nullptr, WNOHANG) < 0;
    })) << "processes are left behind";
    ::prctl(PR_SET_CHILD_SUBREAPER, 0);
  }

  Outcome run(const std::vector<std::string>& words) {
    return run_program(folder_.path(), words, environment_);
  }
  std::string ask_slurm(const std::string& command) {
    Environment environment = environment_;
    environment.launcher = {"sh", "-c", command, "sh"};
    const Outcome outcome = run_program(folder_.path(), {}, environment);
    return outcome.out + outcome.err;
  }
  void write_plan() {
    std::ofstream(folder_ / "patient's.toml") << R"(
problems = ["sphere", "rosenbrock"]
replicates = 10
budget = 60
baselines = false
[[optimizer]]
name = "random"
[[optimizer]]
name = "exec:python3 )" << ARMWRIGHT_TEST_PLUGINS_SOURCE
                                              << R"(/patient.py"
label = "patient"
)";
  }
  // Every file that a comparison comes to, its cells' results among them.
  std::map<std::string, std::string> read_all(const std::filesystem::path& study) {
    auto files = read_study(study);
    for (const auto& entry : std::filesystem::recursive_directory_iterator(study / "cells")) {
      const std::string name = entry.path().filename();
      if (name == "cell.json" || name == "result.json") {
        files[entry.path().lexically_relative(study)] = read_text(entry.path());
      }
    }
    return files;
  }

  TemporaryFolder folder_;
  const std::filesystem::path gate_ = folder_ / "gate";
  Environment environment_;
  std::unique_ptr<Program> box_;
};

TEST_F(Slurm, ANodeLostInTheMidstAndItsOrphansChangeNothing) {
  write_plan();
  const auto study = folder_ / "results/patient%27s";
  const std::vector<std::string> submission = {"compare", "patient's.toml", "--executor", "slurm",
                                               "--chunk", "0.24s",          "--quiet"};
  const Outcome submitted = run(submission);
  ASSERT_EQ(submitted.exit_code, 0) << submitted.err;
  EXPECT_THAT(submitted.out, HasSubstr("job 1: "));
  const Outcome again = run(submission);
  EXPECT_EQ(again.exit_code, 5);
  EXPECT_THAT(again.err, HasSubstr("job 1 of this study is still in the queue"));

  // Every task waits in the midst of its first cell with the patient optimizer.
  const std::set<std::string> held = find_first_patient_cells(study / "submissions/001/run.sh");
  ASSERT_GE(held.size(), 2U);
  ASSERT_LE(held.size(), 8U);  // a node's processors, so that all are on the first
  const auto is_begun = [&](const char* token) {
    for (const std::string& cell : held) {
      const auto attempt = study / "attempts" / cell / token;
      if (find_attempt_process(attempt) == 0 || read_text(attempt / "run/journal").size() < 500) {
        return false;
      }
    }
    return true;
  };
  ASSERT_TRUE(wait_until([&] { return is_begun("001"); })) << ask_slurm("squeue");
  const Outcome status = run({"status", study.string(), "--json"});
  EXPECT_EQ(nlohmann::json::parse(status.out).at("counts").at("running"), held.size());

  // The node dies, but not what it runs; Slurm begins its jobs again, after two minutes unless it
  // is told to hurry.
  std::set<int> orphans;
  for (const std::string& cell : held) {
    const int pid = find_attempt_process(study / "attempts" / cell / "001");
    orphans.insert(pid);
    ::kill(find_parent(pid), SIGKILL);
  }
  ::kill(read_number(folder_ / "box/run/n1.started"), SIGKILL);
  ask_slurm("scontrol update nodename=n1 state=down reason=test");
  ASSERT_TRUE(wait_until([&] {
    ask_slurm("scontrol update jobid=1 starttime=now");
    return is_begun("002");
  })) << ask_slurm("squeue; scontrol show job");
  EXPECT_EQ(orphans.size(), held.size());

  // The orphans notice, in the midst of a cell that goes on nowhere.
  for (const int pid : orphans) {
    EXPECT_TRUE(wait_until([&] { return !is_alive(pid); }));
  }
  std::filesystem::remove(gate_);
  ASSERT_TRUE(wait_until([&] { return ask_slurm("squeue -h").empty(); })) << ask_slurm("squeue");
  const std::string log = read_text(study / "submissions/001/task-1.log");
  EXPECT_THAT(log, HasSubstr("sphere/patient/r01: superseded by attempt 2"));  // the first of all
  EXPECT_THAT(log, HasSubstr("resuming: 10 evaluations and 0 judgements are recorded"));
  EXPECT_EQ(
      std::distance(std::filesystem::directory_iterator(study / "attempts/sphere/patient/r01"), {}),
      2);

  const Outcome merged = run({"merge", study.string(), "--quiet"});
  EXPECT_EQ(merged.exit_code, 0) << merged.err;
  EXPECT_FALSE(std::filesystem::exists(study / "attempts"));
  const Outcome local =
      run({"compare", "patient's.toml", "--out", "local", "--jobs", "4", "--quiet"});
  ASSERT_EQ(local.exit_code, 0) << local.err;
  EXPECT_EQ(local.out.substr(0, local.out.find("Tables:")),
            merged.out.substr(0, merged.out.find("Tables:")));
  EXPECT_EQ(read_all(study), read_all(folder_ / "local"));

  const Outcome refused = run({"compare", "patient's.toml", "--out", "other", "--executor", "slurm",
                               "--sbatch=--partition=nowhere", "--quiet"});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, HasSubstr("invalid partition specified: nowhere"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "other/submissions/001"));
}

}  // namespace
}  // namespace armwright
