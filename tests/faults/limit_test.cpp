// Tests inputs that are too large, and systems that grant no more resources. An input is refused
// from an estimate, with the allowed value, before memory is allocated. A run continues with fewer
// resources and reports that, or it ends with a message and a complete journal.
#include "faults/support.hpp"

namespace armwright::faults {
namespace {

namespace fs = std::filesystem;

class Limits : public testing::Test {
 protected:
  Outcome run(const Words& words, const Environment& environment = {}) {
    return run_program(folder_.path(), words, environment);
  }
  // Runs under limits that also apply to root.
  Outcome run_limited(const Words& limits, const Words& words, bool as_ordinary_user = false) {
    Environment environment;
    environment.launcher = as_ordinary_user ? become_ordinary_user() : Words{};
    environment.launcher = environment.launcher + Words{"prlimit"} + limits + Words{"--"};
    return run(words, environment);
  }
  TemporaryFolder folder_;
};

const Words kOneGibibyte = {"--as=1073741824"};

TEST_F(Limits, HugeNumbersAreRefusedWithWhatIsAllowed) {
  const Words optimize = {"optimize", "q1-complex", "--out", "run"};
  for (const auto& [words, message] : std::vector<std::pair<Words, std::string>>{
           {optimize + Words{"--optimizer", "ga", "--opt", "population=1000000000"}, "population"},
           {optimize + Words{"--optimizer", "cmaes", "--opt", "population=1000000000"},
            "population"},
           {optimize + Words{"--optimizer", "de", "--opt", "population=1000000000"}, "population"},
           {optimize + Words{"--optimizer", "pagmo:de", "--opt", "population=1000000000"},
            "population"},
           {optimize + Words{"--optimizer", "random", "--opt", "batch=1000000000"}, "batch"},
           {{"optimize", "sphere", "--optimizer", "ga", "--set", "function.dimension=1000000000"},
            "function.dimension is 1000000000; it must be"},
           {optimize + Words{"--budget", "1000000000000000"}, "--budget is '1000000000000000'"},
           {optimize + Words{"--budget", "99999999999999999999"}, "an integer from 1 to"},
           {optimize + Words{"--schedule", "fixed:1000000000"}, "--schedule is 'fixed:1000000000'"},
           {optimize + Words{"--set", "sets.test_cases=1000000000"},
            "sets.test_cases=1000000000: sets.test_cases is 1000000000"},
           {optimize + Words{"--set", "workspace.points=1000000000"}, "workspace.points"},
           {optimize + Words{"--set", "physics.substeps=1000000000"}, "physics.substeps"},
           {optimize + Words{"--set", "task.speed_m_per_s=0.01", "--set", "control.period_s=1e-5"},
            "periods"},
           {optimize + Words{"--jobs", "1000000"}, "an integer from 1 to 1024"},
           {optimize + Words{"--validation-cases", "1000000000"}, "an integer from 1 to 1000000"},
           {{"compare", "--preset", "smoke", "--replicates", "1000000000"},
            "an integer from 1 to 10000"},
           {{"evaluate", "table-a5", "--problem", "q1-complex", "--cases", "1000000000000"},
            "--cases"},
           {{"testset", "export", "test/2", "--cases", "1000000000000"}, "--cases"},
           {{"sweep", "q4-speed", "--values", "1", "--cases", "1000000000000"}, "--cases"},
           {{"verify", "table-a10", "--cases", "1000000000000"}, "--cases"}}) {
    SCOPED_TRACE(testing::PrintToString(words));
    const Outcome outcome = run_limited(kOneGibibyte, words);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("armwright: error: "), HasSubstr(message)));
    EXPECT_FALSE(fs::exists(folder_ / "run"));
  }
}

// The population and the problem are each allowed, but too large together.
TEST_F(Limits, WhatIsTooMuchTogetherIsRefusedFromAnEstimate) {
  for (const std::string optimizer : {"ga", "cmaes", "de", "pagmo:de"}) {
    const Outcome outcome =
        run_limited(kOneGibibyte, {"optimize", "sphere", "--set", "function.dimension=1000",
                                   "--optimizer", optimizer, "--opt", "population=100000",
                                   "--budget", "200000", "--out", "run"});
    EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("option 'population' is 100000; with 1000 variables and 1 "
                                       "training cases per candidate it must be at most 49950"));
    EXPECT_FALSE(fs::exists(folder_ / "run"));
  }
}

TEST_F(Limits, WithoutMemoryARunEndsWithAMessageAndGoesOnLater) {
  const Words command = {"optimize",    "sphere", "--set", "function.dimension=1000",
                         "--optimizer", "random", "--opt", "batch=20000",
                         "--budget",    "20000",  "--out", "run",
                         "--quiet",     "--jobs", "2"};
  const Outcome outcome = run_limited({"--as=300000000"}, command);
  EXPECT_EQ(outcome.exit_code, 74) << outcome.err;
  EXPECT_THAT(outcome.err,
              HasSubstr("armwright: error: no memory left; use fewer --jobs or a smaller "
                        "problem"));
  EXPECT_EQ(read_journal(folder_ / "run/journal").torn_bytes, 0u);
  EXPECT_TRUE(has_ended(run(command)));
}

// A smaller limit does not suffice to load the program's libraries, which ends with 127; then some of
// them cannot be initialized, or an exception cannot be made. The limits at which the program fails
// itself are just below those at which it works.
TEST_F(Limits, WithHardlyAnyMemoryTheProgramEndsWithAMessageNeverByASignal) {
  constexpr int kStep_kib = 64;
  const auto list_within = [&](int steps) {
    const std::string limit = std::to_string(std::int64_t{steps} * kStep_kib << 10);
    return run_limited({"--as=" + limit}, {"list", "problems"});
  };
  int fails = 1;
  int works = 1 << 13;  // half a gibibyte
  while (works - fails > 1) {
    const int middle = (fails + works) / 2;
    (list_within(middle).exit_code == 0 ? works : fails) = middle;
  }
  bool has_failed = false;
  for (int steps = works - 1; steps > works - 24; --steps) {
    const Outcome outcome = list_within(steps);
    EXPECT_THAT(outcome.exit_code, AnyOf(0, 74, 127)) << steps * kStep_kib << " KiB";
    if (outcome.exit_code == 74) {
      has_failed = true;
      EXPECT_THAT(outcome.err, AnyOf(HasSubstr("armwright: error: no memory left"),
                                     HasSubstr("Cannot allocate memory")));
    }
  }
  EXPECT_TRUE(has_failed);
}

TEST_F(Limits, WhatIsReadBeforeARunHasALimitOfTimeAndMemory) {
  const auto read = [&](const std::string& limit) {
    return run({"optimize", "--robot", "arm7", "--budget", "10", "--read-limit", limit, "--out",
                "run", "--quiet"});
  };
  // Which step is the last within a microsecond or a page depends on the machine.
  const Outcome slow = read("0.000001s");
  EXPECT_EQ(slow.exit_code, 4);
  EXPECT_THAT(slow.err, AllOf(HasSubstr("reading the problem 'robot'"),
                              HasSubstr(" took more than 1e-06 s of processor time, the limit for "
                                        "what is read before a run starts; check the file, or "
                                        "allow more with --read-limit 6e-06s,1GiB")));
  EXPECT_FALSE(fs::exists(folder_ / "run"));
  const Outcome large = read("4KiB");
  EXPECT_EQ(large.exit_code, 4);
  EXPECT_THAT(large.err, HasSubstr("of memory, the limit for what is read before a run starts"));
  const Outcome wrong = read("1GB");
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.err, HasSubstr("--read-limit (ARMWRIGHT_READ_LIMIT) is '1GB'; it must be"));
}

// A hole of a terabyte takes no space on the disk.
TEST_F(Limits, AJournalThatIsNearlyAllHoleIsReadAtOnce) {
  constexpr std::uintmax_t kTerabyte = std::uintmax_t{1} << 40;
  ASSERT_EQ(run(make_run("whole")).exit_code, 0);
  const std::uintmax_t bytes = fs::file_size(folder_ / "whole/journal");
  for (const auto& [name, kept] : {std::pair("run", bytes / 2), std::pair("empty", bytes * 0)}) {
    fs::copy(folder_ / "whole", folder_ / name);
    fs::remove(folder_ / name / "result.json");
    fs::resize_file(folder_ / name / "journal", kept);
    fs::resize_file(folder_ / name / "journal", kTerabyte);
  }
  const double cpu_s = measure_children_s([&] {
    EXPECT_THAT(run({"doctor", "run"}).out, HasSubstr("are an incomplete record"));
    const Outcome damaged = run({"doctor", "empty"});
    EXPECT_EQ(damaged.exit_code, 4) << damaged.out;
    EXPECT_THAT(damaged.out + damaged.err, HasSubstr("holds no intact record"));
    const Outcome resumed = run(make_run("run"));
    EXPECT_EQ(resumed.exit_code, 0) << resumed.err;
  });
  EXPECT_LT(cpu_s, 10);
  ASSERT_LT(fs::file_size(folder_ / "run/journal"), 2 * bytes);
  expect_same_run(folder_ / "whole", folder_ / "run");
  EXPECT_GE(fs::file_size(folder_ / "run/journal.torn-1"), kTerabyte - bytes);
}

Words make_comparison(const std::string& out) {
  return {"compare",
          "--problems",
          "sphere",
          "--optimizers",
          "ga,nlopt:bobyqa",
          "--replicates",
          "2",
          "--budget",
          "50",
          "--jobs",
          "4",
          "--out",
          out,
          "--quiet"};
}

TEST_F(Limits, WithFewerThreadsAndProcessesItGoesOnAndSaysSo) {
  open_to_all(folder_.path());
  const auto limited = [&](int processes, const Words& command) {
    return run_limited({"--nproc=" + std::to_string(processes)}, command, true);
  };
  ASSERT_EQ(run(make_run("whole")).exit_code, 0);
  ASSERT_EQ(run(make_comparison("tables")).exit_code, 0);
  // Other processes of this user count as well, so the limits go from no process to enough.
  const Outcome none = limited(0, make_run("none") + Words{"--jobs", "4"});
  ASSERT_EQ(none.exit_code, 0) << none.err;
  EXPECT_THAT(none.err, HasSubstr("warning: the system grants 1 of 4 threads; the result is the "
                                  "same, but takes longer"));
  expect_same_run(folder_ / "whole", folder_ / "none");
  for (const Words& optimizer :
       {Words{"nlopt:newuoa_bound"}, Words{"exec:python3 " + get_script("good.py")}}) {
    const Outcome outcome =
        limited(0, Words{"optimize", "sphere", "--budget", "20", "--out", "alone", "--optimizer"} +
                       optimizer);
    EXPECT_EQ(outcome.exit_code, 74);
    EXPECT_THAT(outcome.err,
                AllOf(HasSubstr("cannot start a"), HasSubstr("Resource temporarily unavailable")));
    fs::remove_all(folder_ / "alone");
  }
  for (int processes = 0; processes < 14; ++processes) {
    SCOPED_TRACE(processes);
    const Outcome outcome = limited(processes, make_comparison("study"));
    if (outcome.exit_code == 0) {
      EXPECT_EQ(read_study(folder_ / "tables"), read_study(folder_ / "study"));
    } else {
      EXPECT_EQ(outcome.exit_code, 74);
      EXPECT_THAT(outcome.err, HasSubstr("cannot start a child process: Resource temporarily"));
    }
    fs::remove_all(folder_ / "study");
  }
}

TEST_F(Limits, WithFewDescriptorsItGoesOnOrSaysWhy) {
  ASSERT_EQ(run(make_run("whole")).exit_code, 0);
  ASSERT_EQ(run(make_comparison("tables")).exit_code, 0);
  bool has_failed = false;
  bool has_succeeded = false;
  for (int descriptors = 4; descriptors < 16;
       ++descriptors) {  // with fewer the program cannot be loaded
    SCOPED_TRACE(descriptors);
    const Words limit = {"--nofile=" + std::to_string(descriptors)};
    const Outcome single = run_limited(limit, make_run("run"));
    const Outcome study = run_limited(limit, make_comparison("study"));
    const Outcome plugin =
        run_limited(limit, {"optimize", "sphere", "--budget", "20", "--out", "plugin", "--quiet",
                            "--optimizer", "exec:python3 " + get_script("good.py")});
    for (const Outcome* outcome : {&single, &study, &plugin}) {
      EXPECT_THAT(outcome->exit_code, AnyOf(0, 74)) << outcome->err;
      if (outcome->exit_code == 74) {
        EXPECT_THAT(outcome->err, AnyOf(HasSubstr("Too many open files"),
                                        HasSubstr("unable to open database file")));
      }
      has_failed |= outcome->exit_code != 0;
      has_succeeded |= outcome->exit_code == 0;
    }
    if (single.exit_code == 0) {
      expect_same_run(folder_ / "whole", folder_ / "run");
    }
    if (study.exit_code == 0) {
      EXPECT_EQ(read_study(folder_ / "tables"), read_study(folder_ / "study"));
    }
    for (const char* folder : {"run", "study", "plugin"}) {
      fs::remove_all(folder_ / folder);
    }
  }
  EXPECT_TRUE(has_failed && has_succeeded);
}

TEST_F(Limits, OfFileSizeAndProcessorTimeEndARunResumably) {
  ASSERT_EQ(run(make_run("whole")).exit_code, 0);
  for (const char* bytes : {"0", "5000", "30000", "60000", "110000"}) {
    SCOPED_TRACE(bytes);
    // The output is not a file, because the limit would apply to it as well.
    Environment environment;
    environment.launcher = {
        "sh", "-c",
        std::string("prlimit --fsize=") + bytes + " -- \"$@\" 2>&1 >/dev/null | cat >&2; exit 7",
        "sh"};
    const Outcome outcome = run(make_run("run"), environment);
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("armwright: error: run/"),
                                   AnyOf(HasSubstr("File too large"), HasSubstr("disk I/O"))));
    EXPECT_EQ(run(make_run("run")).exit_code, 0);
    expect_same_run(folder_ / "whole", folder_ / "run");
    fs::remove_all(folder_ / "run");
  }
  const Words endless = {"optimize", "q1-complex", "--optimizer", "ga",   "--engine", "ode",
                         "--budget", "10000000",   "--out",       "long", "--quiet"};
  const Outcome outcome = run_limited({"--cpu=1:30"}, endless);
  EXPECT_EQ(outcome.exit_code, 75);
  EXPECT_THAT(outcome.err, HasSubstr("stopped by a signal; nothing is lost. To resume:"));
  EXPECT_GT(read_journal(folder_ / "long/journal").training.size(), 0u);
}

}  // namespace
}  // namespace armwright::faults
