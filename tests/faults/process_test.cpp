// Tests several processes: two writers of one folder, lock holders and workers that are killed,
// suspended processes, clocks that jump.
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>

#include "base/random.hpp"
#include "faults/support.hpp"

namespace armwright::faults {
namespace {

// A small problem that keeps a run busy until it is killed.
Words make_endless_run(const std::string& out, const Words& optimizer) {
  return Words{"optimize", "q1-complex", "--engine", "ode",        "--schedule",
               "fixed:5",  "--budget",   "10000000", "--jobs",     "1",
               "--out",    out,          "--quiet",  "--optimizer"} +
         optimizer;
}

class Processes : public testing::Test {
 protected:
  Outcome run(const Words& words, const Environment& environment = {}) {
    return run_program(folder_.path(), words, environment);
  }
  static std::string get_host() {
    char name[256] = "";
    ::gethostname(name, sizeof name - 1);
    return name;
  }
  static Environment mark(const std::string& mark) {
    Environment environment;
    environment.variables = {{"FAULTS_MARK", mark}};
    return environment;
  }
  TemporaryFolder folder_;
};

TEST_F(Processes, TheSecondWriterOfARunIsToldWhoTheFirstIs) {
  const Words command = make_endless_run("run", {"ga"});
  Program first(folder_.path(), command);
  ASSERT_TRUE(wait_until([&] { return get_size(folder_ / "run/journal") > 100; }));
  const std::string manifest = read_text(folder_ / "run/manifest.json");
  const Outcome second = run(command);
  EXPECT_EQ(second.exit_code, 5);
  EXPECT_THAT(second.err,
              HasSubstr("error: run is in use by process " + std::to_string(first.pid()) + " on " +
                        get_host() + "; wait for it, stop it, or use --out/--new"));
  EXPECT_TRUE(first.is_running());
  EXPECT_EQ(read_text(folder_ / "run/manifest.json"), manifest);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "run/result.json"));
  first.send(SIGKILL);
  first.wait();
  Program third(folder_.path(), command);  // free at once
  const auto before = get_size(folder_ / "run/journal");
  EXPECT_TRUE(wait_until([&] { return get_size(folder_ / "run/journal") > before; }));
  EXPECT_TRUE(third.is_running());
}

Words make_slow_comparison(const std::string& out, const std::string& optimizers) {
  return {
      "compare",      "--problems", "q1-complex",        "--optimizers", optimizers,
      "--replicates", "2",          "--budget",          "100000",       "--engine",
      "ode",          "--set",      "sets.test_cases=4", "--set",        "sets.validation_cases=2",
      "--jobs",       "2",          "--no-baselines",    "--out",        out,
      "--quiet"};
}

TEST_F(Processes, TheSecondWriterOfAStudyIsToldWhoTheFirstIs) {
  const Words command = make_slow_comparison("study", "ga,cmaes");
  Program first(folder_.path(), command);
  ASSERT_TRUE(wait_until([&] { return std::filesystem::exists(folder_ / "study/cells"); }));
  const Outcome second = run(command);
  EXPECT_EQ(second.exit_code, 5);
  EXPECT_THAT(second.err, HasSubstr("error: study is in use by process " +
                                    std::to_string(first.pid()) + " on " + get_host()));
  EXPECT_TRUE(first.is_running());
}

// All processes that the holder has started end with it, also those that ignore signals. The folder
// is then free.
TEST_F(Processes, NothingOutlivesAKilledRun) {
  for (const Words& optimizer : {Words{"nlopt:newuoa_bound"}, Words{get_plugin("good")},
                                 Words{get_plugin("misbehaving"), "--opt", "how=loop"},
                                 Words{"exec:python3 " + get_script("good.py")},
                                 Words{"exec:python3 " + get_script("faulty.py") + " loop"},
                                 Words{"exec:python3 " + get_script("faulty.py") + " silent"}}) {
    SCOPED_TRACE(optimizer.back());
    Program program(folder_.path(), make_endless_run("run", optimizer), mark("orphan"));
    ASSERT_TRUE(wait_until([&] { return get_size(folder_ / "run/journal") > 100; }));
    ASSERT_TRUE(wait_until([] { return list_processes("orphan").size() == 2; }));
    program.send(SIGKILL);
    program.wait();
    EXPECT_TRUE(wait_until([] { return list_processes("orphan").empty(); }));
    const auto size = get_size(folder_ / "run/journal");
    Program next(folder_.path(), make_endless_run("run", optimizer));
    EXPECT_TRUE(wait_until([&] { return get_size(folder_ / "run/journal") >= size; }));
    EXPECT_TRUE(wait_until(
        [&] { return read_text(folder_ / "run/lock").find(std::to_string(next.pid())) == 8; }));
    next.send(SIGKILL);
    next.wait();
    std::filesystem::remove_all(folder_ / "run");
  }
}

TEST_F(Processes, NothingOutlivesAKilledComparison) {
  const Words command = make_slow_comparison("study", "nlopt:newuoa_bound," + get_plugin("good") +
                                                          ",exec:python3 " + get_script("good.py"));
  for (int kill = 0; kill < 3; ++kill) {
    Program program(folder_.path(), command, mark("study-orphan"));
    // The parent, two workers, and one process of the optimizer of each.
    ASSERT_TRUE(wait_until([] { return list_processes("study-orphan").size() == 5; }))
        << list_processes("study-orphan").size() << " processes at start " << kill
        << (program.is_running() ? "" : ", and the comparison has ended");
    program.send(SIGKILL);
    program.wait();
    EXPECT_TRUE(wait_until([] { return list_processes("study-orphan").empty(); }));
  }
}

std::vector<int> list_children(int parent) {
  std::vector<int> children;
  std::istringstream words(read_text("/proc/" + std::to_string(parent) + "/task/" +
                                     std::to_string(parent) + "/children"));
  for (int child = 0; words >> child;) {
    children.push_back(child);
  }
  return children;
}

// If a worker dies, at most its cell is lost, and is run again. A cell whose process dies twice is
// marked as failed, and the same command runs it again.
TEST_F(Processes, WorkersOfAComparisonThatAreKilledChangeNoTable) {
  ASSERT_TRUE(has_ended(run(make_arm_comparison("whole"))));
  RandomStream random("test/kill-workers", 1);
  Program program(folder_.path(), make_arm_comparison("killed"));
  int kills = 0;
  while (program.is_running() && kills < 6) {
    std::this_thread::sleep_for(
        std::chrono::microseconds(static_cast<long>(random.uniform(1000, 60'000))));
    const auto children = list_children(program.pid());
    if (!children.empty() && program.is_running()) {
      const auto which =
          static_cast<std::size_t>(random.uniform(0, static_cast<double>(children.size())));
      kills += ::kill(children[which], SIGKILL) == 0 ? 1 : 0;
    }
  }
  const Outcome outcome = program.wait();
  EXPECT_GT(kills, 0);
  EXPECT_THAT(outcome.exit_code, AnyOf(0, 3)) << outcome.err;
  const Outcome again = run(make_arm_comparison("killed"));
  EXPECT_TRUE(has_ended(again)) << again.err;
  EXPECT_EQ(read_study(folder_ / "whole"), read_study(folder_ / "killed"));
}

// Only cell.json says that a cell is done, not the exit of its worker.
TEST_F(Processes, ACellIsDoneOnlyByItsOwnRecord) {
  ASSERT_TRUE(has_ended(run(make_arm_comparison("study"))));
  const auto tables = read_study(folder_ / "study");
  const auto cell = folder_ / "study/cells/q1-complex/ga/r02";
  for (const char* file : {"cell.json", "result.json", ""}) {  // the last one: the whole folder
    SCOPED_TRACE(file);
    std::filesystem::remove(cell / "cell.json");
    std::filesystem::remove_all(cell / file);
    const Outcome again = run(make_arm_comparison("study"));
    EXPECT_TRUE(has_ended(again)) << again.err;
    EXPECT_TRUE(std::filesystem::exists(cell / "cell.json"));
    EXPECT_EQ(read_study(folder_ / "study"), tables);
  }
}

// The bytes are the same for any number of workers, also after kills.
TEST_F(Processes, AComparisonDoesNotDependOnTheNumberOfItsWorkers) {
  ASSERT_TRUE(has_ended(run(make_arm_comparison("one", "1"))));
  const auto tables = read_study(folder_ / "one");
  for (const std::string jobs : {"2", "8"}) {
    ASSERT_TRUE(has_ended(run(make_arm_comparison(jobs, jobs))));
    EXPECT_EQ(read_study(folder_ / jobs), tables) << jobs;
  }
}

struct Kind {
  const char* name;
  std::string optimizer;
  const char* schedule;
};

void PrintTo(const Kind& kind, std::ostream* out) {
  *out << kind.name;
}

class JobsAndKind : public testing::TestWithParam<Kind> {};

TEST_P(JobsAndKind, GiveTheSameRun) {
  const TemporaryFolder folder;
  const auto make = [](const std::string& jobs) {
    return Words{"optimize",    "q1-complex",
                 "--optimizer", GetParam().optimizer,
                 "--engine",    "articulated",
                 "--schedule",  GetParam().schedule,
                 "--budget",    "700",
                 "--set",       "workspace.points=4",
                 "--set",       "sets.test_cases=4",
                 "--set",       "sets.validation_cases=2",
                 "--jobs",      jobs,
                 "--out",       jobs,
                 "--quiet"};
  };
  for (const std::string jobs : {"1", "2", "8"}) {
    const Outcome outcome = run_program(folder.path(), make(jobs));
    ASSERT_TRUE(has_ended(outcome)) << outcome.err;
    expect_same_run(folder / "1", folder / jobs);
  }
  // The comparison is resumed with another number of workers.
  std::filesystem::remove(folder / "1/result.json");
  std::filesystem::resize_file(folder / "1/journal", get_size(folder / "1/journal") / 2);
  std::filesystem::rename(folder / "1", folder / "resumed");
  std::filesystem::rename(folder / "8", folder / "whole");
  std::filesystem::rename(folder / "resumed", folder / "8");
  ASSERT_TRUE(has_ended(run_program(folder.path(), make("8"))));
  expect_same_run(folder / "whole", folder / "8");
}

INSTANTIATE_TEST_SUITE_P(
    Optimizers, JobsAndKind,
    testing::Values(Kind{"ga", "ga", "fresh:2"}, Kind{"cmaes", "cmaes", "fresh:2"},
                    Kind{"de", "de", "fixed:2"}, Kind{"random", "random", "fixed:2"},
                    Kind{"bobyqa", "nlopt:bobyqa", "fixed:20"},
                    Kind{"pagmo", "pagmo:sade", "fixed:2"}, Kind{"lm", "ceres:lm", "fixed:4"},
                    Kind{"multistart", "multistart:nlopt:neldermead", "fixed:2"},
                    Kind{"library", get_plugin("good"), "fixed:2"},
                    Kind{"program", "exec:python3 " + get_script("good.py"), "fresh:2"}),
    [](const auto& test) { return test.param.name; });

// The wall clock jumps back and forth by days. No wait depends on it.
TEST_F(Processes, AWallClockThatJumpsChangesNothing) {
  const auto make = [](const std::string& out) {
    Words words = make_run(out, "700") + Words{"--opt", "silence_s=5", "--time-limit", "1h"};
    *std::ranges::find(words, "ga") = "exec:python3 " + get_script("good.py");
    return words;
  };
  ASSERT_TRUE(has_ended(run(make("whole"))));
  Environment environment;
  environment.variables = {{"LD_PRELOAD", ARMWRIGHT_SHIFTED_CLOCK},
                           {"SHIFTED_CLOCK_FILE", folder_ / "shift_s"}};
  write_text(folder_ / "shift_s", "-864000");
  Program program(folder_.path(), make("jumping"), environment);
  for (int jump = 0; program.is_running(); ++jump) {
    write_text(folder_ / "next", jump % 2 == 0 ? "864000" : "-864000");
    std::filesystem::rename(folder_ / "next", folder_ / "shift_s");
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  const Outcome outcome = program.wait();
  EXPECT_TRUE(has_ended(outcome)) << outcome.err;
  expect_same_run(folder_ / "whole", folder_ / "jumping");
  // The library was loaded: the date in the manifest is ten days off, in either direction.
  const auto get_year_and_day = [&](const char* folder) {
    const std::string text = read_text(folder_ / folder / "manifest.json");
    const std::size_t at = text.find("\"started\": \"");
    return at == std::string::npos ? folder : text.substr(at + 12, 10);
  };
  EXPECT_NE(get_year_and_day("jumping"), get_year_and_day("whole"));
}

// The run and all its processes are suspended for longer than a plugin may be silent.
TEST_F(Processes, ASuspendedRunBlamesNobodyForTheSilence) {
  const auto make = [](const std::string& out, const Words& optimizer) {
    return Words{"optimize",    "q1-complex",
                 "--engine",    "ode",
                 "--set",       "workspace.points=4",
                 "--schedule",  "fixed:20",
                 "--budget",    "1000",
                 "--set",       "sets.test_cases=4",
                 "--set",       "sets.validation_cases=2",
                 "--quiet",     "--out",
                 out,           "--opt",
                 "silence_s=1", "--optimizer"} +
           optimizer;
  };
  int number = 0;
  for (const Words& optimizer :
       {Words{get_plugin("good")}, Words{"exec:python3 " + get_script("good.py")}}) {
    const std::string name = std::to_string(++number);
    ASSERT_TRUE(has_ended(run(make("whole-" + name, optimizer))));
    Program program(folder_.path(), make("suspended-" + name, optimizer), mark("suspended"));
    ASSERT_TRUE(wait_until([&] {
      return get_size(folder_ / ("suspended-" + name) / "journal") > 2000 || !program.is_running();
    }));
    ASSERT_TRUE(program.is_running());
    // The parent is resumed last, as by a debugger or a batch system: its child is then late
    // already.
    auto processes = list_processes("suspended");
    for (auto pid = processes.rbegin(); pid != processes.rend(); ++pid) {
      ::kill(*pid, SIGSTOP);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(2500));
    for (const int pid : processes) {
      ::kill(pid, SIGCONT);
    }
    const Outcome outcome = program.wait();
    EXPECT_TRUE(has_ended(outcome)) << outcome.err;
    expect_same_run(folder_ / ("whole-" + name), folder_ / ("suspended-" + name));
  }
}

}  // namespace
}  // namespace armwright::faults
