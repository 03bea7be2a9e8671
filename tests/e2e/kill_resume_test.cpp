// What the README promises of resuming, tested on the real program: a run killed with SIGKILL at
// random moments and started again each time has the same evaluations and the same result, bit for
// bit, as one that nobody disturbed, on one thread or on two.
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <filesystem>
#include <thread>

#include "base/bits.hpp"
#include "base/random.hpp"
#include "base/temporary_folder.hpp"
#include "e2e/program.hpp"
#include "study/journal/journal.hpp"

namespace armwright {
namespace {

// 140 evaluations with either engine, for the fast one of a hundred cases each, or in races of 35
// candidates on 3880 cases.
struct Setting {
  const char* name;
  const char* engine;
  const char* schedule;
  const char* racing;
  const char* budget;
};

std::vector<std::string> make_command(const Setting& setting, const std::string& out,
                                      const std::string& jobs) {
  return {"optimize",    "q1-complex",
          "--optimizer", "ga",
          "--engine",    setting.engine,
          "--schedule",  setting.schedule,
          "--racing",    setting.racing,
          "--budget",    setting.budget,
          "--set",       "sets.test_cases=8",
          "--jobs",      jobs,
          "--set",       "sets.validation_cases=5",
          "--out",       out,
          "--quiet"};
}

void expect_same_run(const std::filesystem::path& a, const std::filesystem::path& b) {
  const JournalContent first = read_journal(a / "journal");
  const JournalContent second = read_journal(b / "journal");
  EXPECT_EQ(first.training.size(), 140u);
  ASSERT_EQ(first.training.size(), second.training.size());
  for (std::size_t i = 0; i < first.training.size(); ++i) {
    const EvaluationRecord& one = first.training[i];
    const EvaluationRecord& other = second.training[i];
    ASSERT_EQ(one.index, other.index);
    ASSERT_TRUE(same_bits(one.x, other.x)) << i;
    ASSERT_EQ(one.cases.numbers, other.cases.numbers) << i;
    ASSERT_EQ(one.evaluation.status, other.evaluation.status) << i;
    ASSERT_EQ(one.evaluation.reason, other.evaluation.reason) << i;
    ASSERT_TRUE(same_bits(one.evaluation.objectives, other.evaluation.objectives)) << i;
    ASSERT_TRUE(same_bits(one.evaluation.case_errors, other.evaluation.case_errors)) << i;
    ASSERT_TRUE(same_bits(one.evaluation.metrics, other.evaluation.metrics)) << i;
  }
  for (const auto* file :
       {"result.json", "winner.toml", "convergence.csv", "winner-trajectory.csv"}) {
    EXPECT_EQ(read_text(a / file), read_text(b / file)) << file;
  }
}

class KillAndResume : public testing::TestWithParam<Setting> {};

TEST_P(KillAndResume, TenKillsAndAnyNumberOfThreadsChangeNothing) {
  const TemporaryFolder folder;
  const auto make = [](const std::string& out, const std::string& jobs) {
    return make_command(GetParam(), out, jobs);
  };
  ASSERT_EQ(run_program(folder.path(), make("one", "1")).exit_code, 0);
  const auto began = std::chrono::steady_clock::now();
  ASSERT_EQ(run_program(folder.path(), make("two", "2")).exit_code, 0);
  const std::chrono::duration<double> duration = std::chrono::steady_clock::now() - began;
  expect_same_run(folder / "one", folder / "two");

  // All lives together take half of the time of a run, on average.
  RandomStream random("test/kill-and-resume", 1);
  for (int kills = 0; kills < 10; ++kills) {
    Program program(folder.path(), make("killed", kills % 2 == 0 ? "2" : "1"));
    std::this_thread::sleep_for(random.uniform(0, 0.1) * duration);
    ASSERT_TRUE(program.is_running()) << "the run ended before it could be killed ten times";
    program.send(SIGKILL);
    EXPECT_EQ(program.wait().exit_code, -SIGKILL);
  }
  const Outcome last = run_program(folder.path(), make("killed", "2"));
  EXPECT_EQ(last.exit_code, 0) << last.err;
  EXPECT_FALSE(read_journal(folder / "killed" / "journal").training.empty());
  expect_same_run(folder / "one", folder / "killed");
}

INSTANTIATE_TEST_SUITE_P(
    Engines, KillAndResume,
    testing::Values(Setting{"ode", "ode", "fresh:1", "none", "140"},
                    Setting{"articulated", "articulated", "fresh:100", "none", "14000"},
                    Setting{"races", "articulated", "fixed:400", "halving:40:2", "15520"},
                    Setting{"coevolution", "articulated", "coevolution:100", "none", "14000"}),
    [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace armwright
