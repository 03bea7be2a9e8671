// Tests SIGKILL at any moment: a resumed run or comparison ends with the same bits as an
// undisturbed one.
#include "base/random.hpp"
#include "faults/support.hpp"

namespace armwright::faults {
namespace {

using Fault = FailingFiles::Fault;

class Kill : public testing::Test {
 protected:
  Outcome run(const Words& words, const Environment& environment = {}) {
    return run_program(folder_.path(), words, environment);
  }
  TemporaryFolder folder_;
};

// Kills the process at every write and rename, from the manifest to the last derived file. When it
// dies, half of the bytes are written.
TEST_F(Kill, AtEveryWriteAndEveryRenameOfARun) {
  std::filesystem::create_directory(folder_ / "runs");
  ASSERT_TRUE(has_ended(run(make_run("runs/whole"))));
  for (const char* call : {"write", "rename"}) {
    FailingFiles files(folder_ / "runs", call);
    int kills = 0;
    // There are a few renames, and many writes.
    const std::uint64_t step = std::string(call) == "write" ? sample_or_all(3, 1) : 1;
    for (std::uint64_t at = 1;; at += step) {
      SCOPED_TRACE(call + std::to_string(at));
      const std::string out = std::string("runs/") + call + std::to_string(at);
      const Outcome killed = run(make_run(out), files.make_environment(Fault::kill, at, 0));
      if (has_ended(killed)) {
        EXPECT_LT(files.count(), at);
        break;
      }
      ASSERT_EQ(killed.exit_code, -SIGKILL) << killed.err;
      ++kills;
      // A kill looks like no damage: without a manifest it is no run yet.
      const bool is_run = std::filesystem::exists(folder_ / out / "manifest.json");
      EXPECT_EQ(run({"doctor", out}).exit_code, is_run ? 0 : 2) << run({"doctor", out}).out;
      const Outcome resumed = run(make_run(out));
      ASSERT_TRUE(has_ended(resumed)) << resumed.err;
      expect_same_run(folder_ / "runs/whole", folder_ / out);
      EXPECT_THAT(run({"doctor", out}).out, Not(HasSubstr("nothing covers")));
    }
    // manifest.json and five derived files; SQLite renames its own file with the same call.
    EXPECT_GE(kills, 5) << call;
  }
}

// Kills the process while it continues a run that has ended: either the smaller budget's command or
// the larger one's goes on from there, and the larger one's ends as if it had begun the run.
TEST_F(Kill, AtEveryWriteAndEveryRenameOfARunThatIsContinued) {
  std::filesystem::create_directory(folder_ / "runs");
  ASSERT_TRUE(has_ended(run(make_run("runs/small", "70"))));
  ASSERT_TRUE(has_ended(run(make_run("runs/large", "105"))));
  for (const char* call : {"write", "rename"}) {
    FailingFiles files(folder_ / "runs", call);
    int kills = 0;
    const std::uint64_t step = std::string(call) == "write" ? sample_or_all(3, 1) : 1;
    for (std::uint64_t at = 1;; at += step) {
      SCOPED_TRACE(call + std::to_string(at));
      const std::string out = std::string("runs/") + call + std::to_string(at);
      std::filesystem::copy(folder_ / "runs/small", folder_ / out,
                            std::filesystem::copy_options::recursive);
      const Outcome killed = run(make_run(out, "105"), files.make_environment(Fault::kill, at, 0));
      if (has_ended(killed)) {
        EXPECT_LT(files.count(), at);
        break;
      }
      ASSERT_EQ(killed.exit_code, -SIGKILL) << killed.err;
      ++kills;
      EXPECT_EQ(run({"doctor", out}).exit_code, 0) << run({"doctor", out}).out;
      const Outcome before = run(make_run(out, "70"));
      if (has_ended(before)) {
        // The killed process may have left a file beside those of the run.
        EXPECT_TRUE(read_text(folder_ / "runs/small/result.json") ==
                    read_text(folder_ / out / "result.json"));
      } else {
        EXPECT_THAT(before.err, HasSubstr("run.budget: recorded 105, now 70"));
      }
      const Outcome resumed = run(make_run(out, "105"));
      ASSERT_TRUE(has_ended(resumed)) << resumed.err;
      // The journal has more judgements: those of the smaller budget.
      for (const char* file : {"result.json", "winner.toml", "winner-trajectory.csv",
                               "convergence.csv", "results.sqlite"}) {
        EXPECT_TRUE(read_text(folder_ / "runs/large" / file) == read_text(folder_ / out / file))
            << file;
      }
      EXPECT_THAT(run({"doctor", out}).out, Not(HasSubstr("nothing covers")));
    }
    EXPECT_GE(kills, 5) << call;
  }
}

// Kills the comparison or its worker at every rename. No kill looks like damage, neither after it nor
// after the comparison has gone on.
TEST_F(Kill, AtEveryRenameOfAComparison) {
  std::filesystem::create_directory(folder_ / "runs");
  const auto make = [](const std::string& out) {
    return Words{"compare", "--problems", "sphere", "--optimizers",   "ga",     "--replicates",
                 "2",       "--budget",   "40",     "--no-baselines", "--jobs", "1",
                 "--out",   out,          "--quiet"};
  };
  ASSERT_EQ(run(make("runs/whole")).exit_code, 0);
  FailingFiles files(folder_ / "runs", "rename");
  for (std::uint64_t at = 1;; at += sample_or_all(3, 1)) {
    SCOPED_TRACE(at);
    const std::string out = "runs/" + std::to_string(at);
    run(make(out), files.make_environment(Fault::kill, at, 0));
    if (files.count() < at) {
      EXPECT_GT(at, 20u);
      break;
    }
    const bool is_study = std::filesystem::exists(folder_ / out / "study.toml");
    const Outcome after = run({"doctor", out});
    ASSERT_EQ(after.exit_code, is_study ? 0 : 2) << after.out;
    // Made again from the cells that are there: a study that has grown since.
    Words more = make(out);
    more[6] = "3";
    ASSERT_EQ(run(at % 2 == 0 ? more : make(out)).exit_code, 0);
    const Outcome last = run({"doctor", out});
    ASSERT_TRUE(has_ended(last)) << last.out;
    EXPECT_THAT(last.out, Not(HasSubstr("nothing covers")));
  }
}

// An optimizer, how often its run is killed, and a budget per kill that takes longer than a life of
// the process.
struct Setting {
  const char* name;
  std::string optimizer;
  const char* schedule;
  int budget_per_kill;
  int most_kills;
  int most_writes = 8;  // per life, at least 5; one write may hold several answers of a batch
};

void PrintTo(const Setting& setting, std::ostream* out) {
  *out << setting.name;
}

int choose_kills(const Setting& setting) {
  return sample_or_all(10, setting.most_kills);
}

Words make_command(const Setting& setting, const std::string& out, int jobs) {
  return {"optimize",
          "q1-complex",
          "--optimizer",
          setting.optimizer,
          "--engine",
          "ode",
          "--schedule",
          setting.schedule,
          "--budget",
          std::to_string(setting.budget_per_kill * choose_kills(setting)),
          "--set",
          "workspace.points=4",
          "--set",
          "sets.test_cases=4",
          "--set",
          "sets.validation_cases=2",
          "--out",
          out,
          "--quiet",
          "--jobs",
          std::to_string(jobs)};
}

std::size_t count_records(const std::filesystem::path& journal) {
  if (get_size(journal) == 0) {
    return 0;
  }
  const JournalContent content = read_journal(journal);
  return content.training.size() + content.judgements.size();
}

class KillAgainAndAgain : public testing::TestWithParam<Setting> {};

// Two of five lives end during a write, one of the first. Two more end during a write that is
// certainly one of the work. The others end at a random time, which may be before the first write.
TEST_P(KillAgainAndAgain, AndResumeEachTime) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "runs");
  const Outcome whole = run_program(folder.path(), make_command(GetParam(), "whole", 2));
  ASSERT_TRUE(has_ended(whole)) << whole.err;
  const auto journal = folder / "runs/killed/journal";
  FailingFiles files(folder / "runs", "write");
  RandomStream random("test/kill-again-and-again", 1);
  const int kills = choose_kills(GetParam());
  int kills_during_work = 0;
  for (int kill = 0; kill < kills; ++kill) {
    const std::size_t before = count_records(journal);
    const bool at_a_write = kill % 5 != 4;
    // The writes before the work are the lock and the torn end of the previous life; in the first
    // life the lock, the checksum of the manifest, the manifest and the beginning of the journal.
    const std::uint64_t first_of_work = kill == 0 ? 6 : 5;
    const int first = kill % 5 < 2 ? 2 : 5;
    const auto at = static_cast<std::uint64_t>(random.uniform(first, GetParam().most_writes + 1));
    Program program(folder.path(), make_command(GetParam(), "runs/killed", 1 + kill % 2),
                    at_a_write ? files.make_environment(Fault::kill, at, 0) : Environment{});
    if (!at_a_write) {
      std::this_thread::sleep_for(
          std::chrono::microseconds(static_cast<long>(random.uniform(0, 60'000))));
      ASSERT_TRUE(program.is_running()) << "the run ended before its kill " << kill;
      program.send(SIGKILL);
    }
    ASSERT_EQ(program.wait().exit_code, -SIGKILL) << "the run ended before its kill " << kill;
    const bool during_work = count_records(journal) > before;
    kills_during_work += during_work ? 1 : 0;
    EXPECT_TRUE(during_work || !at_a_write || at < first_of_work)
        << "kill " << kill << " at write " << at;
  }
  EXPECT_GE(kills_during_work, kills * 2 / 5);
  EXPECT_LT(count_records(journal), count_records(folder / "whole/journal"))
      << "the last kills came when all work was done";
  const Outcome last = run_program(folder.path(), make_command(GetParam(), "runs/killed", 2));
  ASSERT_TRUE(has_ended(last)) << last.err;
  expect_same_run(folder / "whole", folder / "runs/killed");
}

INSTANTIATE_TEST_SUITE_P(Optimizers, KillAgainAndAgain,
                         testing::Values(Setting{"ga", "ga", "fresh:1", 30, 30},
                                         Setting{"cmaes", "cmaes", "fixed:1", 30, 100},
                                         Setting{"bobyqa", "nlopt:bobyqa", "fixed:1", 30, 30},
                                         Setting{"de", "pagmo:de", "fixed:1", 30, 30},
                                         Setting{"lm", "ceres:lm", "fixed:3", 45, 30},
                                         Setting{"library", get_plugin("good"), "fixed:1", 30, 30},
                                         Setting{"program", "exec:python3 " + get_script("good.py"),
                                                 "fresh:1", 30, 100, 5}),
                         [](const auto& test) { return test.param.name; });

// The bytes in all journals of a study; one that does not exist yet has none.
std::uintmax_t get_size_of_journals(const std::filesystem::path& study) {
  std::uintmax_t size = 0;
  for (const char* optimizer : {"cmaes", "ga", "nlopt%3Aneldermead", "random"}) {
    for (const char* replicate : {"r01", "r02", "r03", "r04"}) {
      size += get_size(study / "cells/q1-complex" / optimizer / replicate / "journal");
    }
  }
  return size;
}

// Kills the whole process group, as a closing terminal does, or the parent alone. Its workers must
// then neither continue to write nor keep the locks. A life is measured in work done, because no
// machine says how long the comparison takes: a tenth of it at most, so that four lives never
// finish it.
TEST_F(Kill, AComparisonWithItsWorkersOrWithoutThem) {
  ASSERT_EQ(run(make_arm_comparison("whole")).exit_code, 0);
  const auto tenth = static_cast<double>(get_size_of_journals(folder_ / "whole")) / 10;
  ASSERT_GT(tenth, 0);
  RandomStream random("test/kill-a-comparison", 1);
  int kills = 0;
  for (int life = 0; life < 12; ++life) {
    Environment environment;
    environment.own_group = true;
    environment.variables = {{"FAULTS_MARK", "comparison"}};
    const std::uintmax_t enough = get_size_of_journals(folder_ / "killed") +
                                  static_cast<std::uintmax_t>(random.uniform(0, tenth));
    Program program(folder_.path(), make_arm_comparison("killed"), environment);
    ASSERT_TRUE(wait_until(
        [&] { return get_size_of_journals(folder_ / "killed") > enough || !program.is_running(); },
        std::chrono::milliseconds(0)));
    kills += program.is_running() ? 1 : 0;
    if (life % 2 == 0) {
      program.send_group(SIGKILL);
    } else {
      program.send(SIGKILL);
    }
    program.wait();
    ASSERT_TRUE(wait_until([] { return list_processes("comparison").empty(); }))
        << "workers outlive the comparison";
  }
  EXPECT_GE(kills, 4);
  const Outcome last = run(make_arm_comparison("killed"));
  EXPECT_TRUE(has_ended(last)) << last.err;
  EXPECT_EQ(read_study(folder_ / "whole"), read_study(folder_ / "killed"));
}

}  // namespace
}  // namespace armwright::faults
