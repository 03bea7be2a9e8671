// The program started by mpirun: any number of ranks and threads, ranks that die or hang, and the
// same bytes on disk.
#include <gmock/gmock.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <map>
#include <optional>
#include <ostream>
#include <thread>

#include "base/hash.hpp"
#include "base/temporary_folder.hpp"
#include "e2e/processes.hpp"
#include "e2e/program.hpp"
#include "wait_until.hpp"

namespace armwright {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

// Root may start ranks only if it says so, and a machine with few cores needs to be told that more
// ranks are wanted all the same.
Environment make_ranks(int count, const std::vector<std::string>& flags = {"--enable-recovery"}) {
  Environment environment;
  environment.variables = {{"OMPI_ALLOW_RUN_AS_ROOT", "1"},
                           {"OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1"}};
  environment.launcher = {"mpirun.openmpi",     "--oversubscribe", "--bind-to", "none", "-n",
                          std::to_string(count)};
  environment.launcher.insert(environment.launcher.end(), flags.begin(), flags.end());
  environment.own_group = true;
  return environment;
}

bool has_mpirun() {
  return std::system("command -v mpirun.openmpi >/dev/null 2>&1") == 0 &&
         std::system("ldd " ARMWRIGHT_BINARY " | grep -q libmpi") == 0;
}

class Mpi : public testing::Test {
 protected:
  void SetUp() override {
    if (!has_mpirun()) {
      GTEST_SKIP() << "there is no mpirun.openmpi, or the program was built without MPI: install "
                      "openmpi-bin and libopenmpi-dev (scripts/setup --tests) and build again";
    }
  }

  // The process of a rank.
  static std::optional<int> find_rank(int mpirun, int rank) {
    for (const int pid : list_processes_with("OMPI_COMM_WORLD_RANK=" + std::to_string(rank))) {
      if (find_parent(pid) == mpirun) {
        return pid;
      }
    }
    return std::nullopt;
  }

  // In the midst of a run: some has been evaluated beyond what the journal had.
  bool wait_for_evaluations(const std::string& run, std::size_t journal_bytes) const {
    return wait_until(
        [&] { return read_text(folder_ / run / "journal").size() > journal_bytes + 5'000; });
  }

  // The hash of every file that a run leaves.
  static std::map<std::string, std::string> read_run(const std::filesystem::path& run) {
    std::map<std::string, std::string> files;
    for (const char* name : {"result.json", "winner.toml", "winner-trajectory.csv",
                             "convergence.csv", "results.sqlite"}) {
      files[name] = calc_sha256_hex(read_text(run / name));
    }
    return files;
  }

  const TemporaryFolder folder_;
};

struct RankSetting {
  const char* name;
  std::vector<std::string> words;
};

std::ostream& operator<<(std::ostream& out, const RankSetting& setting) {
  return out << setting.name;
}

class MpiRuns : public Mpi, public testing::WithParamInterface<RankSetting> {};

std::string get_name(const testing::TestParamInfo<RankSetting>& setting) {
  return setting.param.name;
}

INSTANTIATE_TEST_SUITE_P(Settings, MpiRuns,
                         testing::Values(RankSetting{"Races",
                                                     {"--engine", "articulated", "--optimizer",
                                                      "cmaes", "--schedule", "fresh:32", "--racing",
                                                      "halving:4:2", "--budget", "1000"}},
                                         RankSetting{"Jacobians",
                                                     {"--engine", "articulated", "--optimizer",
                                                      "ceres:lm", "--budget", "100"}}),
                         get_name);
INSTANTIATE_TEST_SUITE_P(
    Long, MpiRuns,
    testing::Values(
        RankSetting{"Ode", {"--budget", "70"}},
        RankSetting{"Lanes",
                    {"--engine", "articulated", "--schedule", "fresh:20", "--budget", "2800"}},
        RankSetting{"Races",
                    {"--engine", "articulated", "--optimizer", "cmaes", "--schedule", "fresh:32",
                     "--racing", "halving:4:2", "--budget", "4000"}},
        RankSetting{"Jacobians",
                    {"--engine", "articulated", "--optimizer", "ceres:lm", "--budget", "300"}},
        RankSetting{"OneAfterTheOther",
                    {"--engine", "articulated", "--optimizer", "nlopt:bobyqa", "--budget", "100"}}),
    get_name);

TEST_P(MpiRuns, WriteTheSameOnAnyNumberOfRanksAndThreads) {
  const auto make_command = [&](const std::string& out, const char* jobs) {
    std::vector<std::string> words = {"optimize", "q1-complex",
                                      "--set",    "sets.test_cases=20",
                                      "--set",    "sets.validation_cases=5",
                                      "--quiet",  "--jobs",
                                      jobs,       "--out",
                                      out};
    words.insert(words.end(), GetParam().words.begin(), GetParam().words.end());
    if (std::ranges::count(words, "--optimizer") == 0) {
      words.insert(words.end(), {"--optimizer", "ga"});
    }
    return words;
  };
  ASSERT_TRUE(has_ended(run_program(folder_.path(), make_command("one", "1"))));
  const auto expected = read_run(folder_ / "one");
  ASSERT_EQ(run_program(folder_.path(), make_command("two", "2")).exit_code, 0);
  EXPECT_EQ(read_run(folder_ / "two"), expected);
  for (const int ranks : {1, 2, 3}) {
    const std::string out = "ranks" + std::to_string(ranks);
    const Outcome outcome =
        run_program(folder_.path(), make_command(out, ranks == 2 ? "2" : "1"), make_ranks(ranks));
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(outcome.err, "");
    EXPECT_EQ(read_run(folder_ / out), expected) << ranks;
  }
}

struct UserProblem {
  const char* name;
  const char* problem;
  const char* optimizers;
  const char* requirement =
      "true";  // a command of the shell that succeeds where the problem can run
  const char* budget = "20";
  const char* replicates = "1";
};

std::ostream& operator<<(std::ostream& out, const UserProblem& problem) {
  return out << problem.name;
}

constexpr const char* kEight =
    "ga,cmaes,lhs,nlopt:cobyla,nlopt:sbplx,nlopt:isres,pagmo:de,pagmo:pso";

class MpiUserProblem : public Mpi, public testing::WithParamInterface<UserProblem> {};

constexpr const char* kResiduals =
    "exec:python3 " ARMWRIGHT_TEST_PLUGINS_SOURCE "/problem.py slow-squares";

std::string get_problem_name(const testing::TestParamInfo<UserProblem>& problem) {
  return problem.param.name;
}

INSTANTIATE_TEST_SUITE_P(Problems, MpiUserProblem,
                         testing::Values(UserProblem{"Residuals", kResiduals,
                                                     "ga,nlopt:bobyqa,ceres:lm"}),
                         get_problem_name);
INSTANTIATE_TEST_SUITE_P(
    Long, MpiUserProblem,
    testing::Values(
        UserProblem{"Residuals", kResiduals,
                    "ga,cmaes,lhs,nlopt:cobyla,nlopt:bobyqa,pagmo:de,pagmo:pso,ceres:lm", "true",
                    "60", "2"},
        UserProblem{"Motor",
                    "exec:/usr/bin/python3 " ARMWRIGHT_CONFIGS "/../examples/dc-motor/motor.py",
                    kEight, "/usr/bin/python3 -c 'import scipy'"},
        UserProblem{"CartPole", ARMWRIGHT_TEST_LIBRARIES "/libcart_pole.so", kEight,
                    "test -e " ARMWRIGHT_TEST_LIBRARIES "/libcart_pole.so"},
        UserProblem{"Filter", ARMWRIGHT_CONFIGS "/../examples/filter/filter.toml", kEight,
                    "command -v ngspice"}),
    get_problem_name);

// Every rank starts the processes of the problem for itself.
TEST_P(MpiUserProblem, ComparesOptimizersWithTheSameBytesForAnyThreadsAndRanks) {
  const UserProblem& user = GetParam();
  if (std::system((std::string(user.requirement) + " >/dev/null 2>&1").c_str()) != 0) {
    GTEST_SKIP() << "the problem cannot run here, because this fails: " << user.requirement
                 << " (scripts/setup --tests installs scipy, ngspice and MuJoCo)";
  }
  const auto make_command = [&](const std::string& out, const char* jobs) {
    return std::vector<std::string>{
        "compare",      "--problems",    user.problem, "--optimizers", user.optimizers,
        "--replicates", user.replicates, "--budget",   user.budget,    "--jobs",
        jobs,           "--out",         out,          "--quiet"};
  };
  const Outcome one = run_program(folder_.path(), make_command("one", "1"));
  ASSERT_EQ(one.exit_code, 0) << one.err;
  EXPECT_THAT(one.out, HasSubstr("Verdict"));
  const auto expected = read_study(folder_ / "one");
  const Outcome two = run_program(folder_.path(), make_command("two", "2"));
  ASSERT_EQ(two.exit_code, 0) << two.err;
  EXPECT_EQ(read_study(folder_ / "two"), expected);
  const Outcome ranks = run_program(folder_.path(), make_command("three", "1"), make_ranks(3));
  EXPECT_EQ(ranks.exit_code, 0) << ranks.err;
  EXPECT_EQ(read_study(folder_ / "three"), expected);
}

// Evaluations of several milliseconds each.
std::vector<std::string> make_long_command(const std::string& out) {
  return {"optimize",    "q1-complex",
          "--optimizer", "ga",
          "--engine",    "ode",
          "--budget",    "210",
          "--set",       "sets.test_cases=8",
          "--set",       "sets.validation_cases=5",
          "--jobs",      "1",
          "--out",       out};
}

TEST_F(Mpi, RanksThatDieOrHangChangeNothing) {
  ASSERT_EQ(run_program(folder_.path(), make_long_command("one")).exit_code, 0);
  for (const int signal : {SIGKILL, SIGSTOP}) {
    const std::string out = "signal" + std::to_string(signal);
    Program program(folder_.path(), make_long_command(out), make_ranks(3));
    ASSERT_TRUE(wait_for_evaluations(out, 0));
    const auto rank = find_rank(program.pid(), 2);
    ASSERT_TRUE(rank);
    ::kill(*rank, signal);
    const Outcome outcome = program.wait();
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("rank 2 on"), HasSubstr("others do its work"),
                                   HasSubstr("MPI cannot end in order")));
    EXPECT_EQ(read_run(folder_ / out), read_run(folder_ / "one"));
    EXPECT_FALSE(is_alive(*rank));
  }
}

// What mpirun does without --enable-recovery, when it is killed, or when the machine goes down.
TEST_F(Mpi, AKilledJobGoesOnWithAnyNumberOfRanks) {
  ASSERT_EQ(run_program(folder_.path(), make_long_command("one")).exit_code, 0);
  for (const int ranks : {3, 2}) {
    const std::size_t before = read_text(folder_ / "killed/journal").size();
    Program program(folder_.path(), make_long_command("killed"), make_ranks(ranks, {}));
    ASSERT_TRUE(wait_for_evaluations("killed", before));
    const auto rank = find_rank(program.pid(), ranks - 1);
    ASSERT_TRUE(rank);
    ::kill(*rank, SIGKILL);
    EXPECT_NE(program.wait().exit_code, 0);
  }
  const Outcome last = run_program(folder_.path(), make_long_command("killed"));
  EXPECT_EQ(last.exit_code, 0) << last.err;
  EXPECT_THAT(last.err, HasSubstr("resuming"));
  EXPECT_EQ(read_run(folder_ / "killed"), read_run(folder_ / "one"));
}

TEST_F(Mpi, AskedToEndItStopsAndGoesOn) {
  ASSERT_EQ(run_program(folder_.path(), make_long_command("one")).exit_code, 0);
  Program program(folder_.path(), make_long_command("asked"), make_ranks(2));
  ASSERT_TRUE(wait_for_evaluations("asked", 0));
  program.send(SIGTERM);
  program.wait();
  const Outcome last = run_program(folder_.path(), make_long_command("asked"), make_ranks(2));
  EXPECT_EQ(last.exit_code, 0) << last.err;
  EXPECT_THAT(last.err, HasSubstr("resuming"));
  EXPECT_EQ(read_run(folder_ / "asked"), read_run(folder_ / "one"));
}

// While the optimizer thinks, here behind a gate.
TEST_F(Mpi, RanksWithoutWorkSleep) {
  const auto gate = folder_ / "gate";
  std::ofstream(gate) << "closed\n";
  Environment environment = make_ranks(2);
  environment.variables.emplace_back("PATIENT_GATE", gate.string());
  const std::string patient =
      "exec:python3 " + std::string(ARMWRIGHT_TEST_PLUGINS_SOURCE) + "/patient.py";
  Program program(folder_.path(),
                  {"optimize", "sphere", "--optimizer", patient, "--budget", "20", "--jobs", "1",
                   "--quiet", "--out", "patient"},
                  environment);
  ASSERT_TRUE(wait_until([&] { return read_text(folder_ / "patient/journal").size() > 500; }));
  constexpr std::chrono::seconds kIdle{3};
  for (const int number : {0, 1}) {
    const auto rank = find_rank(program.pid(), number);
    ASSERT_TRUE(rank);
    const double before_s = measure_cpu_s(*rank);
    std::this_thread::sleep_for(kIdle);
    EXPECT_LT(measure_cpu_s(*rank) - before_s, 0.05 * std::chrono::duration<double>(kIdle).count())
        << "rank " << number;
  }
  std::filesystem::remove(gate);
  EXPECT_EQ(program.wait().exit_code, 0);
}

TEST_F(Mpi, ComparisonsHaveTheSameTables) {
  const auto make_command = [](const std::string& out, const char* jobs) {
    return std::vector<std::string>{"compare",
                                    "--problems",
                                    "q1-complex",
                                    "--optimizers",
                                    "ga,ceres:lm",
                                    "--replicates",
                                    "3",
                                    "--budget",
                                    "400",
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
  };
  const Outcome one = run_program(folder_.path(), make_command("one", "1"));
  ASSERT_EQ(one.exit_code, 0) << one.err;
  for (const int ranks : {2, 3}) {
    const std::string out = "ranks" + std::to_string(ranks);
    const Outcome outcome = run_program(folder_.path(), make_command(out, "1"), make_ranks(ranks));
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(outcome.err, "");
    EXPECT_EQ(read_study(folder_ / out), read_study(folder_ / "one")) << ranks;
  }
}

// The first rank asks for the consent, and no other runs a plugin.
TEST_F(Mpi, APluginOfAForeignStudyNeedsConsentOnTheFirstRank) {
  const std::string library = std::string(ARMWRIGHT_TEST_PLUGINS) + "/libgood.so";
  std::vector<std::string> command = {"compare", "--problems",   "sphere", "--optimizers",
                                      library,   "--replicates", "2",      "--budget",
                                      "30",      "--out",        "one",    "--quiet"};
  const Outcome one = run_program(folder_.path(), command);
  ASSERT_EQ(one.exit_code, 0) << one.err;
  std::filesystem::create_directory(folder_ / "study");
  std::filesystem::copy_file(folder_ / "one/study.toml", folder_ / "study/study.toml");
  command = {"compare", "study/study.toml", "--out", "study", "--quiet"};
  Environment ranks = make_ranks(3, {});
  ranks.variables.emplace_back("XDG_STATE_HOME", folder_ / "another-user");
  const Outcome refused = run_program(folder_.path(), command, ranks);
  EXPECT_EQ(refused.exit_code, 2) << refused.err;
  EXPECT_THAT(refused.err, AllOf(HasSubstr("libgood.so"), HasSubstr("--trust")));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "study/cells"));
  command.emplace_back("--trust");
  const Outcome trusted = run_program(folder_.path(), command, ranks);
  EXPECT_EQ(trusted.exit_code, 0) << trusted.err;
  EXPECT_EQ(read_study(folder_ / "study"), read_study(folder_ / "one"));
}

TEST_F(Mpi, WhatIsSaidIsSaidOnce) {
  const auto count = [](const std::string& text, const std::string& words) {
    std::size_t times = 0;
    for (std::size_t at = text.find(words); at != std::string::npos;
         at = text.find(words, at + 1)) {
      ++times;
    }
    return times;
  };
  for (const std::vector<std::string>& wrong :
       {std::vector<std::string>{"optimize", "no-such-problem"},
        {"optimise", "q1-complex"},
        {"compare", "--problems", "no-such-problem", "--optimizers", "ga"}}) {
    const Outcome outcome = run_program(folder_.path(), wrong, make_ranks(3, {}));
    EXPECT_EQ(outcome.exit_code, 2) << wrong[0] << outcome.err;
    EXPECT_EQ(count(outcome.err, "armwright: error:"), 1u) << outcome.err;
  }
  const Outcome list = run_program(folder_.path(), {"list", "engines"}, make_ranks(3));
  EXPECT_EQ(list.exit_code, 0);
  EXPECT_EQ(count(list.out, "Open Dynamics Engine"), 1u);
  EXPECT_THAT(list.err, HasSubstr("only the first of 3 ranks works"));
  const Outcome optimized =
      run_program(folder_.path(),
                  {"optimize", "sphere", "--optimizer", "ga", "--budget", "100", "--out", "run"},
                  make_ranks(2, {}));
  EXPECT_EQ(optimized.exit_code, 0) << optimized.err;
  EXPECT_EQ(count(optimized.err, "on each of 2 ranks"), 1u) << optimized.err;
  EXPECT_THAT(optimized.err, HasSubstr("without mpirun's --enable-recovery"));
  EXPECT_THAT(optimized.out, Not(HasSubstr("\033")));  // mpirun's terminal is none
}

}  // namespace
}  // namespace armwright
