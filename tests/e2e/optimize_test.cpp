// Runs as a user meets them: made once, found again, interrupted, resumed, refused.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "base/temporary_folder.hpp"
#include "e2e/program.hpp"

namespace armwright {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

class CliOptimize : public testing::Test {
 protected:
  Outcome run(const std::vector<std::string>& arguments, const Environment& environment = {}) {
    return run_program(folder_.path(), arguments, environment);
  }
  bool has(const std::string& file) { return std::filesystem::exists(folder_.path() / file); }
  std::string read(const std::string& file) { return read_text(folder_.path() / file); }
  // Until the run has recorded something; a run that ends before has failed.
  void wait_for_records(const Program& program, const std::string& run_folder) {
    const auto journal = folder_.path() / run_folder / "journal";
    std::error_code ignored;
    // A journal of nothing is 8 bytes long.
    while (program.is_running() && !(std::filesystem::exists(journal, ignored) &&
                                     std::filesystem::file_size(journal, ignored) > 8)) {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    ASSERT_TRUE(program.is_running());
  }
  TemporaryFolder folder_;
  const std::vector<std::string> sphere_ = {"optimize", "sphere",   "--optimizer",
                                            "ga",       "--budget", "300"};
};

TEST_F(CliOptimize, MakesARunOnceAndFindsItAgain) {
  const Outcome first = run(sphere_);
  ASSERT_EQ(first.exit_code, 0) << first.err;
  EXPECT_THAT(first.err,
              AllOf(HasSubstr("optimizer ga, seed 1, budget 300 cases, schedule fixed:1"),
                    HasSubstr("folder results/sphere-ga-seed1 (new)")));
  EXPECT_THAT(first.out, AllOf(HasSubstr("300 evaluations on 300 cases"), HasSubstr("Winner"),
                               HasSubstr("result.json"), HasSubstr("armwright show results/")));
  const std::string recorded = read("results/sphere-ga-seed1/result.json");

  const Outcome again = run(sphere_);
  EXPECT_EQ(again.exit_code, 0);
  EXPECT_THAT(again.err, HasSubstr("this run is complete; use --new for another one"));
  EXPECT_EQ(again.out, first.out);

  EXPECT_EQ(run(sphere_ + std::vector<std::string>{"--new"}).exit_code, 0);
  EXPECT_EQ(read("results/sphere-ga-seed1-002/result.json"), recorded);
  EXPECT_EQ(run(sphere_ + std::vector<std::string>{"--seed", "2"}).exit_code, 0);
  EXPECT_TRUE(has("results/sphere-ga-seed2/result.json"));
  EXPECT_NE(read("results/sphere-ga-seed2/result.json"), recorded);
  EXPECT_EQ(run(sphere_, {{{"ARMWRIGHT_SEED", "5"}}, ""}).exit_code, 0);
  EXPECT_TRUE(has("results/sphere-ga-seed5/result.json"));

  EXPECT_EQ(run(sphere_ + std::vector<std::string>{"--json", "--quiet"}).out, recorded);
  EXPECT_EQ(run({"show", "results/sphere-ga-seed1", "--json"}).out, recorded);
  EXPECT_THAT(run({"show", "results/sphere-ga-seed1"}).out,
              HasSubstr("Judged on the validation set"));
}

// The problem of the first tutorial: the numbers of its run are those of perturbed plants, and the
// winner is better than the start on them.
TEST_F(CliOptimize, JudgesTheArmOfTheFirstTutorialOnPerturbedPlants) {
  const std::vector<std::string> few = {
      "--set", "sets.validation_cases=4", "--set", "sets.test_cases=10", "--json", "--quiet"};
  const Outcome made =
      run(std::vector<std::string>{"optimize", "irb4600", "--budget", "640", "--out", "run"} + few);
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const json recorded = json::parse(made.out)["winner"]["test_summary"];
  EXPECT_EQ(recorded["cases"], 10);
  EXPECT_EQ(recorded["failures"], 0);
  const auto judge = [&](const std::string& design, const std::string& where) {
    const Outcome judged = run(std::vector<std::string>{"evaluate", design, "--problem", "irb4600",
                                                        "--set", "perturbation.apply_to=" + where} +
                               few);
    EXPECT_EQ(judged.exit_code, 0) << judged.err;
    return json::parse(judged.out)["summary"]["mean_error_m"].get<double>();
  };
  const std::string winner = "run/winner.toml";
  EXPECT_EQ(judge(winner, "everywhere"), recorded["mean"]);
  // The encoder's steps alone make more of an error than the nominal arm has.
  EXPECT_LT(judge(winner, "training"), recorded["mean"]);
  EXPECT_LT(recorded["mean"], judge("irb4600-start", "everywhere"));
}

// Version 1.0 made this run with `optimize sphere -o random --set function.dimension=2 --budget 20`.
TEST_F(CliOptimize, ARunOfVersion1IsRefusedInOneSentenceAndStaysAsItIs) {
  const auto folder = folder_.path() / "old";
  std::filesystem::copy(std::filesystem::path(ARMWRIGHT_TEST_DATA) / "runs" / "sphere-1.0", folder);
  const std::string journal = read_text(folder / "journal");
  const Outcome outcome = run({"optimize", "sphere", "-o", "random", "--set",
                               "function.dimension=2", "--budget", "20", "--out", "old"});
  EXPECT_EQ(outcome.exit_code, 4);
  EXPECT_THAT(outcome.err, HasSubstr("old/manifest.json: version 1.0 of armwright began this run"));
  EXPECT_TRUE(read_text(folder / "journal") == journal);
  for (const std::vector<std::string>& reading :
       {std::vector<std::string>{"show", "old"}, {"report", "old"}, {"doctor", "old"}}) {
    const Outcome read = run(reading);
    EXPECT_NE(read.exit_code, 0) << reading[0];
    EXPECT_THAT(read.out + read.err, HasSubstr("version 1.0 of armwright began this run"));
  }
}

TEST_F(CliOptimize, RefusesToGoOnWithAnotherConfiguration) {
  ASSERT_EQ(run(sphere_).exit_code, 0);
  const Outcome outcome = run({"optimize", "sphere", "--optimizer", "ga", "--budget", "299"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.out, IsEmpty());
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("run.budget: recorded 300, now 299"),
                                 HasSubstr("A larger budget can continue a run")));
}

TEST_F(CliOptimize, ALargerBudgetContinuesTheRun) {
  ASSERT_EQ(run(sphere_).exit_code, 0);
  const std::vector<std::string> larger = {"optimize", "sphere",   "--optimizer",
                                           "ga",       "--budget", "700"};
  const Outcome whole = run(larger + std::vector<std::string>{"--out", "whole"});
  ASSERT_EQ(whole.exit_code, 0) << whole.err;
  const Outcome continued = run(larger);
  ASSERT_EQ(continued.exit_code, 0) << continued.err;
  EXPECT_THAT(continued.err, HasSubstr("continuing with a budget of 700 in place of 300"));
  for (const char* file : {"result.json", "winner.toml", "convergence.csv", "results.sqlite"}) {
    EXPECT_TRUE(read(std::string("results/sphere-ga-seed1/") + file) ==
                read(std::string("whole/") + file))
        << file;
  }
  const Outcome doctor = run({"doctor", "results/sphere-ga-seed1"});
  EXPECT_EQ(doctor.exit_code, 0) << doctor.out;
  EXPECT_THAT(doctor.out, testing::Not(HasSubstr("nothing covers")));
}

TEST_F(CliOptimize, RunsWithOtherSettingsHaveOtherFolders) {
  ASSERT_EQ(run(sphere_).exit_code, 0);
  const Outcome other = run(sphere_ + std::vector<std::string>{"--set", "function.dimension=2",
                                                               "--opt", "population=20"});
  ASSERT_EQ(other.exit_code, 0) << other.err;
  EXPECT_TRUE(has("results/sphere-ga-seed1-dimension2-population20/result.json")) << other.err;
}

TEST_F(CliOptimize, TunesTheArm) {
  const Outcome outcome = run({"optimize", "q1-complex", "--optimizer", "ga", "--budget", "70",
                               "--validation-cases", "1", "--set", "sets.test_cases=2", "--set",
                               "task.ik_bug=true", "--quiet", "--out", "deep/q1/"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(
      outcome.out,
      AllOf(HasSubstr("p [N m/rad]"), HasSubstr("joint_4"), HasSubstr("total torque"),
            HasSubstr("Beside the published winner (thesis, Table 6.1)"), HasSubstr("963686"),
            HasSubstr("armwright evaluate deep/q1/winner.toml --problem q1-complex")));
  const json result = json::parse(read("deep/q1/result.json"));
  // The winner's design is the file that evaluate reads: the same cases give the same errors, bit
  // for bit.
  const Outcome evaluated = run({"evaluate", "deep/q1/winner.toml", "--problem", "q1-complex",
                                 "--set", "task.ik_bug=true", "--cases", "2", "--json", "--quiet"});
  const json cases = json::parse(evaluated.out).at("cases");
  EXPECT_EQ(cases[0].at("mean_error_m"), result.at("winner").at("test").at("case_errors")[0]);
  EXPECT_EQ(cases[1].at("mean_error_m"), result.at("winner").at("test").at("case_errors")[1]);
}

TEST_F(CliOptimize, InterruptedItResumesToTheSameResult) {
  // One thread, so that some seconds of work are ahead when the first record is seen; the reference
  // uses two.
  const std::vector<std::string> common = {
      "optimize", "q1-complex",         "--optimizer", "ga",    "--budget",
      "350",      "--validation-cases", "1",           "--set", "sets.test_cases=1",
      "--out"};
  Program interrupted(folder_.path(),
                      common + std::vector<std::string>{"it's here", "--jobs", "1"});
  wait_for_records(interrupted, "it's here");
  interrupted.send(SIGINT);
  const Outcome stopped = interrupted.wait();
  ASSERT_EQ(stopped.exit_code, 130) << stopped.err;
  EXPECT_THAT(stopped.out, IsEmpty());
  const std::string command =
      "armwright optimize q1-complex --optimizer ga --budget 350 --validation-cases 1 --set "
      "sets.test_cases=1 "
      "--out 'it'\\''s here' --jobs 1";
  EXPECT_THAT(stopped.err, AllOf(HasSubstr("interrupted; nothing is lost"), HasSubstr(command)));
  EXPECT_FALSE(has("it's here/result.json"));
  EXPECT_THAT(run({"show", "it's here"}).out,
              AllOf(HasSubstr("is not complete"), HasSubstr("of 350 cases"), HasSubstr(command)));

  const Outcome resumed = run(common + std::vector<std::string>{"it's here", "--jobs", "1"});
  ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
  EXPECT_THAT(resumed.err, HasSubstr("resuming: "));
  const Outcome whole = run(common + std::vector<std::string>{"whole", "--jobs", "2"});
  ASSERT_EQ(whole.exit_code, 0) << whole.err;
  for (const char* file : {"result.json", "convergence.csv", "winner-trajectory.csv"}) {
    EXPECT_EQ(read(std::string("it's here/") + file), read(std::string("whole/") + file)) << file;
  }
}

TEST_F(CliOptimize, AFolderInUseAndATerminatedRun) {
  const std::vector<std::string> endless = {"optimize", "q1-complex", "--optimizer", "ga",
                                            "--budget", "1000000",    "--out",       "busy",
                                            "--jobs",   "1"};
  Program first(folder_.path(), endless);
  wait_for_records(first, "busy");
  const Outcome second = run(endless);
  EXPECT_EQ(second.exit_code, 5);
  EXPECT_THAT(second.err, HasSubstr("busy is in use by process "));
  first.send(SIGTERM);
  const Outcome stopped = first.wait();
  EXPECT_EQ(stopped.exit_code, 75) << stopped.err;
  EXPECT_THAT(
      stopped.err,
      HasSubstr("armwright optimize q1-complex --optimizer ga --budget 1000000 --out busy"));
}

TEST_F(CliOptimize, StopsAtATimeLimitAndNamesTheFolderOfANewRun) {
  ASSERT_EQ(run(sphere_).exit_code, 0);
  const Outcome outcome = run({"optimize", "sphere", "--optimizer", "ga", "--budget",
                               "100000000000", "--time-limit", "0.2s", "--new"},
                              {{{"ARMWRIGHT_SEED", "1"}}, ""});
  EXPECT_EQ(outcome.exit_code, 75) << outcome.err;
  EXPECT_THAT(
      outcome.err,
      AllOf(HasSubstr("the time limit is reached"),
            HasSubstr(
                "armwright optimize sphere --optimizer ga --budget 100000000000 --time-limit 0.2s "
                "--out results/sphere-ga-seed1-002")));
}

TEST_F(CliOptimize, TheBarFitsTheTerminalAndLosesWholePiecesOnly) {
  const std::string shown = run_on_terminal(folder_.path(),
                                            {"optimize", "sphere", "--optimizer", "ga", "--budget",
                                             "100000000000", "--time-limit", "0.5s"},
                                            {}, 40);
  std::istringstream lines(shown);
  int bars = 0;
  for (std::string line; std::getline(lines, line, '\r');) {
    const std::size_t end = line.find("\x1b[K");
    if (end == std::string::npos || end == 0) {
      continue;
    }
    line.resize(end);
    EXPECT_LT(line.size(), 40) << line;
    EXPECT_THAT(line, testing::MatchesRegex("(training)?( \\[[#-]+\\])? 0 %( [0-9]+/100000000000)?"
                                            "(  [0-9.e+]+/s)?(  ETA [0-9:]+( s)?)?(  gen [0-9]+)?"
                                            "(  best [0-9.e-]+)?"));
    ++bars;
  }
  EXPECT_GE(bars, 2);  // the first is drawn at once, more every 0.1 s
}

TEST_F(CliOptimize, AFolderThatCannotBeMadeIsAnIoError) {
  std::ofstream(folder_.path() / "file") << "text";
  const Outcome outcome = run(sphere_ + std::vector<std::string>{"--out", "file/below"});
  EXPECT_EQ(outcome.exit_code, 74);
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("file/below"), HasSubstr("Not a directory")));
}

TEST_F(CliOptimize, ShowRefusesWhatIsNoRun) {
  const Outcome outcome = run({"show", "."});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("is not the folder of a run"), HasSubstr("of a study")));
  EXPECT_THAT(run({"show", "nothere"}).err, HasSubstr("nothere: there is no such folder"));
}

TEST_F(CliOptimize, ABudgetOfNothingIsRefused) {
  const Outcome outcome = run({"optimize", "sphere", "--optimizer", "ga", "--budget", "0"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("--budget is '0'; it must be an integer from 1"));
}

TEST_F(CliOptimize, ACompleteRunWithoutItsJournalIsWarnedOf) {
  ASSERT_EQ(run(sphere_).exit_code, 0);
  std::filesystem::remove(folder_.path() / "results/sphere-ga-seed1/journal");
  const Outcome outcome = run(sphere_);
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.err, HasSubstr("warning: the journal holds 0 of the "));
}

// Four points and few cases, so that it is quick; the limit is one that a good deal of designs
// keep.
TEST_F(CliOptimize, SaysWhetherTheWinnerKeepsTheLimit) {
  const std::vector<std::string> small = {"optimize", "q2-torque",
                                          "--engine", "articulated",
                                          "--budget", "2000",
                                          "--set",    "workspace.points=4",
                                          "--set",    "sets.validation_cases=5",
                                          "--set",    "sets.test_cases=10"};
  const Outcome kept = run(
      small + std::vector<std::string>{"--set", "objective.error_limit_m=0.02", "--out", "kept"});
  ASSERT_EQ(kept.exit_code, 0) << kept.err << kept.out;
  EXPECT_THAT(kept.out,
              AllOf(HasSubstr("Constraints"), HasSubstr("20.00 mm"), HasSubstr("% below)")));
  const json result = json::parse(read("kept/result.json"));
  EXPECT_EQ(result["constraints"][0]["limit"]["value"], 0.02);
  EXPECT_EQ(result["constraints"][0]["limit"]["unit"], "m");
  EXPECT_EQ(result["winner"]["test"]["feasible"], true);
  EXPECT_LE(result["winner"]["test"]["metrics"][0], 0.02);
  EXPECT_EQ(result["least_violation"], 0);
  EXPECT_THAT(run({"show", "kept"}).out, HasSubstr("feasible"));

  const std::vector<std::string> impossible = {"--set", "objective.error_limit_m=1e-9"};
  const Outcome missed = run(small + impossible + std::vector<std::string>{"--new"});
  EXPECT_EQ(missed.exit_code, 3);  // a design that the optimizer recommends is judged all the same
  EXPECT_THAT(missed.out, AllOf(HasSubstr("% above)"), HasSubstr("NOT feasible")));
  const Outcome none = run(small + impossible +
                           std::vector<std::string>{"--optimizer", "ga", "--out", "results/none"});
  EXPECT_EQ(none.exit_code, 3) << none.err;  // done, but something failed
  EXPECT_THAT(none.out, AllOf(HasSubstr("No design met the constraints"),
                              HasSubstr("The nearest had error ")));
  EXPECT_GT(json::parse(read("results/none/result.json"))["least_violation"], 0);
}

// The thesis's design A.10 is tuned to one step of the physics per control period.
TEST_F(CliOptimize, SaysThatAWinnerFailsWithMorePhysicsSteps) {
  const std::vector<std::string> command = {"optimize",    "q1-complex",
                                            "--engine",    "articulated",
                                            "--optimizer", "nlopt:neldermead",
                                            "--budget",    "10",
                                            "--set",       "variables.start=table-a10",
                                            "--set",       "sets.validation_cases=2",
                                            "--set",       "sets.test_cases=2",
                                            "--out",       "run"};
  const Outcome first = run(command);
  ASSERT_EQ(first.exit_code, 3) << first.err;  // the winner is the start
  EXPECT_THAT(
      first.out,
      AllOf(HasSubstr("Under other conditions (the first 2 cases of test/2; own error"),
            testing::ContainsRegex("engine ode +works"),
            testing::ContainsRegex("2 physics steps per control period +fails in 2 of 2 cases"),
            HasSubstr("check.json"), HasSubstr("armwright verify run/winner.toml")));
  const std::string check = read("run/check.json");
  const json settings = json::parse(run({"report", "run", "--json"}).out)
                            .at("/arm/health/check/settings"_json_pointer);
  EXPECT_GT(std::ranges::count(settings, json("bad"), [](const json& one) { return one["grade"]; }),
            0);
  const json shown = json::parse(run({"show", "run", "--json"}).out);
  EXPECT_EQ(shown["winner"]["check"], json::parse(check));

  // The same command makes it again, and a folder without it says so.
  std::filesystem::remove(folder_.path() / "run/check.json");
  EXPECT_THAT(run({"show", "run"}).out, HasSubstr("not checked"));
  EXPECT_EQ(run(command).out, first.out);
  EXPECT_EQ(read("run/check.json"), check);
}

TEST_F(CliOptimize, NamesWhoSeesConstraintsWhereAnotherCannot) {
  const Outcome refused = run({"optimize", "q2-torque", "--optimizer", "ceres:lm"});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, testing::AnyOf(HasSubstr("these see constraints: auto, ga, "),
                                          HasSubstr("built without Ceres Solver")));
}

}  // namespace
}  // namespace armwright
