// Tests Ctrl-C and similar signals: every command ends soon, says how to resume, and resumes to the
// same result.
#include <algorithm>
#include <tuple>

#include "faults/support.hpp"

namespace armwright::faults {
namespace {

using Clock = std::chrono::steady_clock;

// Running simulations are finished, which takes milliseconds. The rest is a margin for a busy
// machine.
constexpr std::chrono::seconds kSoon{5};

// A run of some seconds on one thread.
Words make_long_run(const std::string& out, const std::string& optimizer = "ga") {
  return {"optimize",    "q1-complex",
          "--optimizer", optimizer,
          "--engine",    "ode",
          "--schedule",  "fixed:2",
          "--budget",    "1500",
          "--set",       "workspace.points=4",
          "--set",       "sets.test_cases=4",
          "--set",       "sets.validation_cases=2",
          "--jobs",      "1",
          "--out",       out};
}

class Signals : public testing::Test {
 protected:
  Outcome run(const Words& words, const Environment& environment = {}) {
    return run_program(folder_.path(), words, environment);
  }
  // Waits until its journal grows and it has not ended.
  static bool is_at_work(const Program& program, const std::filesystem::path& journal,
                         std::uintmax_t before = 100) {
    return wait_until([&] { return get_size(journal) > before || !program.is_running(); }) &&
           program.is_running();
  }
  TemporaryFolder folder_;
};

TEST_F(Signals, EachEndsARunSoonWithItsOwnCodeAndTheSameCommandGoesOn) {
  ASSERT_TRUE(has_ended(run(make_long_run("whole"))));
  for (const auto& [signal, code, word] :
       std::vector<std::tuple<int, int, std::string>>{{SIGINT, 130, "interrupted"},
                                                      {SIGTERM, 75, "stopped by a signal"},
                                                      {SIGHUP, 75, "stopped by a signal"}}) {
    SCOPED_TRACE(strsignal(signal));
    const auto before = std::max<std::uintmax_t>(get_size(folder_ / "stopped/journal"), 100);
    Program program(folder_.path(), make_long_run("stopped"));
    ASSERT_TRUE(is_at_work(program, folder_ / "stopped/journal", before));
    const auto begin = Clock::now();
    program.send(signal);
    const Outcome outcome = program.wait();
    EXPECT_LT(Clock::now() - begin, kSoon);
    EXPECT_EQ(outcome.exit_code, code);
    EXPECT_THAT(outcome.err,
                AllOf(HasSubstr("armwright: " + word + "; nothing is lost. To resume:"),
                      HasSubstr("optimize q1-complex"), HasSubstr("--out stopped")));
    EXPECT_EQ(read_journal(folder_ / "stopped/journal").torn_bytes, 0u);
  }
  EXPECT_TRUE(has_ended(run(make_long_run("stopped"))));
  expect_same_run(folder_ / "whole", folder_ / "stopped");
}

TEST_F(Signals, WhoIsStartedWithNohupStays) {
  Program program(folder_.path(), make_long_run("run"), after_shell("trap '' HUP"));
  ASSERT_TRUE(is_at_work(program, folder_ / "run/journal"));
  program.send(SIGHUP);
  EXPECT_TRUE(has_ended(program.wait()));
}

// A single simulation takes a minute, and does not check for signals.
TEST_F(Signals, TheSecondOneEndsAtOnce) {
  Program program(folder_.path(),
                  {"optimize", "q1-complex", "--optimizer", "random", "--schedule", "fixed:1",
                   "--engine", "ode", "--budget", "35", "--set", "workspace.points=1000", "--set",
                   "task.speed_m_per_s=0.02", "--jobs", "1", "--out", "run"});
  ASSERT_TRUE(wait_until([&] { return get_size(folder_ / "run/journal") > 0; }));
  const auto says = [&](const char* text) {
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) {
      if (read_text(entry.path() / "err").find(text) != std::string::npos) {
        return true;
      }
    }
    return false;
  };
  program.send(SIGINT);
  ASSERT_TRUE(wait_until([&] { return says("press Ctrl-C again to stop at once"); }));
  const auto begin = Clock::now();
  program.send(SIGINT);
  EXPECT_EQ(program.wait().exit_code, 130);
  EXPECT_LT(Clock::now() - begin, kSoon);
  EXPECT_EQ(read_journal(folder_ / "run/journal").torn_bytes, 0u);
}

TEST_F(Signals, AnOptimizerThatIgnoresTheStopIsEnded) {
  for (const Words& optimizer : {Words{get_plugin("misbehaving"), "--opt", "how=endless"},
                                 Words{get_plugin("misbehaving"), "--opt", "how=loop"},
                                 Words{"exec:python3 " + get_script("faulty.py") + " never-stops"},
                                 Words{"exec:python3 " + get_script("faulty.py") + " loop"}}) {
    SCOPED_TRACE(optimizer.front() + optimizer.back());
    Environment environment;
    environment.variables = {{"FAULTS_MARK", "stubborn"}};
    Program program(
        folder_.path(),
        Words{"optimize", "sphere", "--budget", "1000000000", "--out", "run", "--optimizer"} +
            optimizer,
        environment);
    ASSERT_TRUE(wait_until([&] { return get_size(folder_ / "run/journal") > 50; }));
    const auto begin = Clock::now();
    program.send(SIGINT);
    const Outcome outcome = program.wait();
    EXPECT_EQ(outcome.exit_code, 130) << outcome.err;
    EXPECT_LT(Clock::now() - begin, kSoon);
    EXPECT_TRUE(wait_until([] { return list_processes("stubborn").empty(); }));
    std::filesystem::remove_all(folder_ / "run");
  }
}

TEST_F(Signals, DuringJudging) {
  const auto make = [](const std::string& out) {
    return Words{"optimize",    "q1-complex",
                 "--optimizer", "ga",
                 "--engine",    "ode",
                 "--budget",    "70",
                 "--set",       "workspace.points=4",
                 "--set",       "sets.test_cases=200",
                 "--set",       "sets.validation_cases=200",
                 "--jobs",      "1",
                 "--out",       out};
  };
  ASSERT_TRUE(has_ended(run(make("whole"))));
  const std::uint64_t trained = read_journal(folder_ / "whole/journal").training.size();
  Program program(folder_.path(), make("stopped"));
  const auto count_judged = [&] {
    const auto file = folder_ / "stopped/journal";
    return get_size(file) == 0 ? 0 : read_journal(file).judgements.size();
  };
  ASSERT_TRUE(wait_until([&] { return count_judged() > 0 || !program.is_running(); }));
  ASSERT_TRUE(program.is_running());
  const auto begin = Clock::now();
  program.send(SIGINT);
  const Outcome outcome = program.wait();
  EXPECT_EQ(outcome.exit_code, 130);
  EXPECT_LT(Clock::now() - begin, kSoon);
  EXPECT_THAT(outcome.err, HasSubstr("nothing is lost. To resume:"));
  EXPECT_EQ(read_journal(folder_ / "stopped/journal").training.size(), trained);
  const Outcome resumed = run(make("stopped"));
  EXPECT_TRUE(has_ended(resumed));
  EXPECT_THAT(resumed.err, HasSubstr(" judgement"));
  expect_same_run(folder_ / "whole", folder_ / "stopped");
}

TEST_F(Signals, AComparisonEndsWithItsWorkers) {
  const auto make = [](const std::string& out) {
    return Words{"compare",    "--problems",
                 "q1-complex", "--optimizers",
                 "ga,cmaes",   "--replicates",
                 "3",          "--budget",
                 "200",        "--no-baselines",
                 "--engine",   "ode",
                 "--set",      "sets.test_cases=4",
                 "--set",      "sets.validation_cases=2",
                 "--set",      "workspace.points=4",
                 "--jobs",     "2",
                 "--out",      out,
                 "--quiet"};
  };
  ASSERT_TRUE(has_ended(run(make("whole"))));
  for (const auto& [signal, code] : {std::pair{SIGINT, 130}, {SIGTERM, 75}, {SIGHUP, 75}}) {
    SCOPED_TRACE(strsignal(signal));
    Environment environment;
    environment.variables = {{"FAULTS_MARK", "signalled"}};
    Program program(folder_.path(), make("stopped"), environment);
    ASSERT_TRUE(wait_until([] { return list_processes("signalled").size() > 2; }));
    const auto begin = Clock::now();
    program.send(signal);
    const Outcome outcome = program.wait();
    EXPECT_EQ(outcome.exit_code, code);
    EXPECT_LT(Clock::now() - begin, kSoon);
    EXPECT_THAT(outcome.err,
                AllOf(HasSubstr("nothing is lost. To resume:"), HasSubstr("--out stopped")));
    EXPECT_TRUE(wait_until([] { return list_processes("signalled").empty(); }));
  }
  EXPECT_TRUE(has_ended(run(make("stopped"))));
  EXPECT_EQ(read_study(folder_ / "whole"), read_study(folder_ / "stopped"));
}

}  // namespace
}  // namespace armwright::faults
