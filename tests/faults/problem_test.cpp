// Tests runs on problems of users under SIGKILL: a resumed run ends with the same bytes, and the
// processes of the problem end with the run.
#include <unistd.h>

#include <string>
#include <tuple>

#include "base/random.hpp"
#include "faults/support.hpp"

namespace armwright::faults {
namespace {

using Fault = FailingFiles::Fault;

// Finds the processes of this test among those of tests that run at the same time.
const std::string kMark = "problem-" + std::to_string(getpid());

// The way by which the problem reaches armwright, and the optimizer.
class KilledProblem : public testing::TestWithParam<std::tuple<const char*, const char*>> {
 protected:
  std::string way() const { return std::get<0>(GetParam()); }
  std::string optimizer() const { return std::get<1>(GetParam()); }

  void SetUp() override {
#ifndef ARMWRIGHT_PYTHON
    if (way() == "python") {
      GTEST_SKIP() << "armwright was built without the Python package";
    }
#endif
  }

  Outcome run(const std::string& out, int jobs, Environment environment = {}) const {
    Words words = {"optimize"};
    if (way() == "program") {
      words.push_back("exec:python3 " + get_script("problem.py") + " slow-squares");
    } else if (way() == "library") {
      words.push_back(ARMWRIGHT_TEST_LIBRARIES "/libsquares.so");
    }
#ifdef ARMWRIGHT_PYTHON
    if (way() == "python") {  // a script that takes the same words runs in place of the program
      environment.launcher = {ARMWRIGHT_PYTHON, get_script("squares.py")};
      environment.variables.emplace_back("PYTHONPATH", ARMWRIGHT_PYTHON_PACKAGE);
    }
#endif
    words = words + Words{"--optimizer", optimizer(), "--budget",           "600",    "--out",
                          out,           "--jobs",    std::to_string(jobs), "--quiet"};
    return run_program(folder_.path(), words, environment);
  }

  const TemporaryFolder folder_;
};

TEST_P(KilledProblem, EndsWithTheSameBytesAfterTenKills) {
  std::filesystem::create_directory(folder_ / "runs");
  const Outcome whole = run("whole", 2);
  ASSERT_EQ(whole.exit_code, 0) << whole.err;
  FailingFiles files(folder_ / "runs", "write");
  RandomStream random("test/killed-problem/" + optimizer(), 1);
  int kills = 0;
  for (int life = 0; life < 10; ++life) {
    const auto at = static_cast<std::uint64_t>(random.uniform(2, 9));
    Environment environment = files.make_environment(Fault::kill, at, 0);
    environment.variables.emplace_back("FAULTS_MARK", kMark);
    const Outcome killed = run("runs/killed", 1 + life % 2, environment);
    kills += killed.exit_code == -SIGKILL ? 1 : 0;
    ASSERT_TRUE(wait_until([] { return list_processes(kMark).empty(); }))
        << "processes of the problem outlive the run";
  }
  EXPECT_EQ(kills, 10);
  const Outcome last = run("runs/killed", 2);
  ASSERT_EQ(last.exit_code, 0) << last.err;
  expect_same_run(folder_ / "whole", folder_ / "runs/killed");
}

std::string make_name(const testing::TestParamInfo<std::tuple<const char*, const char*>>& test) {
  std::string name = std::string(std::get<0>(test.param)) + "_" + std::get<1>(test.param);
  std::erase(name, ':');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Ways, KilledProblem,
                         testing::Values(std::tuple("program", "ga"),
                                         std::tuple("library", "cmaes"),
                                         std::tuple("python", "ceres:lm")),
                         make_name);
INSTANTIATE_TEST_SUITE_P(Long, KilledProblem,
                         testing::Combine(testing::Values("program", "library", "python"),
                                          testing::Values("ga", "cmaes", "pagmo:de", "nlopt:cobyla",
                                                          "ceres:lm", "random")),
                         make_name);

// A problem whose cases do not end as long as a file is missing, by the way on which armwright
// reaches it.
class InterruptedProblem : public testing::TestWithParam<const char*> {
 protected:
  Words make_words(const std::string& out) const {
    Words words = {"optimize"};
    const std::string way = GetParam();
    if (way == "program") {
      words.push_back("exec:python3 " + get_script("problem.py") + " slow-squares");
    } else if (way == "library") {
      words.push_back(ARMWRIGHT_TEST_LIBRARIES "/libsquares.so");
    } else {
      write_text(folder_ / "p.toml",
                 "kind = \"command\"\ncommand.run = \"sh script\"\n"
                 "command.time_limit_s = 10000\n[[command.input]]\nfile = \"script\"\ntext = '''\n"
                 "while [ ! -e $TEST_GATE ]; do touch $TEST_GATE.reached; sleep 0.01; done\n"
                 "echo {x}\n'''\n[[variable]]\nname = \"x\"\nlower = 0\nupper = 1\n"
                 "[[objective]]\nname = \"f\"\nregex = '(.*)'\n");
      words.push_back((folder_ / "p.toml").string());
    }
    if (way != "command") {
      words = words + Words{"--set", "program.time_limit_s=10000"};
    }
    return words + Words{"--optimizer", "random", "--budget", "60", "--out", out, "--jobs", "2"};
  }

  Environment make_environment() const {
    Environment environment;
    environment.variables = {{"TEST_GATE", gate_.string()}, {"FAULTS_MARK", kMark}};
    return environment;
  }

  const TemporaryFolder folder_;
  const std::filesystem::path gate_ = folder_ / "gate";
};

TEST_P(InterruptedProblem, ACaseInProgressEndsWithTheRunAndIsSimulatedAgain) {
  write_text(gate_, "");
  ASSERT_EQ(run_program(folder_.path(), make_words("whole"), make_environment()).exit_code, 0);
  std::filesystem::remove(gate_);
  Program program(folder_.path(), make_words("stopped"), make_environment());
  ASSERT_TRUE(wait_until([&] { return std::filesystem::exists(folder_ / "gate.reached"); }));
  program.send(SIGINT);
  const Outcome stopped = program.wait();
  EXPECT_EQ(stopped.exit_code, 130) << stopped.err;
  EXPECT_THAT(stopped.err, HasSubstr("interrupted; nothing is lost. To resume:"));
  EXPECT_TRUE(wait_until([] { return list_processes(kMark).empty(); }));
  write_text(gate_, "");
  const Outcome last = run_program(folder_.path(), make_words("stopped"), make_environment());
  ASSERT_EQ(last.exit_code, 0) << last.err;
  expect_same_run(folder_ / "whole", folder_ / "stopped");
}

// As job systems end a job: the processes of the problem die while armwright has not yet seen the
// signal.
TEST_P(InterruptedProblem, ASignalToEveryProcessOfTheJobFailsNoCase) {
  write_text(gate_, "");
  ASSERT_EQ(run_program(folder_.path(), make_words("whole"), make_environment()).exit_code, 0);
  std::filesystem::remove(gate_);
  Program program(folder_.path(), make_words("stopped"), make_environment());
  ASSERT_TRUE(wait_until([&] { return std::filesystem::exists(folder_ / "gate.reached"); }));
  program.send(SIGSTOP);
  EXPECT_TRUE(wait_until([&] {  // it may have started another process before it stopped
    auto others = list_processes(kMark);
    std::erase(others, program.pid());
    for (const int process : others) {
      kill(process, SIGTERM);
    }
    return others.empty();
  }));
  program.send(SIGTERM);
  program.send(SIGCONT);
  const Outcome stopped = program.wait();
  EXPECT_EQ(stopped.exit_code, 75) << stopped.err;
  EXPECT_THAT(stopped.err, HasSubstr("stopped by a signal; nothing is lost. To resume:"));
  write_text(gate_, "");
  const Outcome last = run_program(folder_.path(), make_words("stopped"), make_environment());
  ASSERT_EQ(last.exit_code, 0) << last.err;
  expect_same_run(folder_ / "whole", folder_ / "stopped");
}

INSTANTIATE_TEST_SUITE_P(Ways, InterruptedProblem, testing::Values("program", "library", "command"),
                         [](const auto& test) { return std::string(test.param); });

}  // namespace
}  // namespace armwright::faults
