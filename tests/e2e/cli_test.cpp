// The program as a user meets it: help, mistakes, and the commands that need no optimization.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "base/temporary_folder.hpp"
#include "e2e/program.hpp"

namespace armwright {
namespace {

using Words = std::vector<std::string>;
using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

class Cli : public testing::Test {
 protected:
  Outcome run(const std::vector<std::string>& arguments, const Environment& environment = {}) {
    return run_program(folder_.path(), arguments, environment);
  }
  // What must fail before anything is computed: nothing on stdout, one message on stderr.
  void expect_refused(const std::vector<std::string>& arguments, int exit_code,
                      const std::vector<std::string>& parts, const Environment& environment = {}) {
    const Outcome outcome = run(arguments, environment);
    EXPECT_EQ(outcome.exit_code, exit_code) << outcome.err;
    EXPECT_THAT(outcome.out, IsEmpty());
    EXPECT_THAT(outcome.err, HasSubstr("armwright: error: "));
    for (const std::string& part : parts) {
      EXPECT_THAT(outcome.err, HasSubstr(part));
    }
  }
  std::filesystem::path write(const std::string& name, const std::string& text) {
    const auto file = folder_.path() / name;
    std::ofstream(file) << text;
    return file;
  }
  TemporaryFolder folder_;
};

TEST_F(Cli, EveryCommandExplainsItselfWithAnExample) {
  for (const std::vector<std::string>& command : {std::vector<std::string>{},
                                                  {"list"},
                                                  {"optimize"},
                                                  {"evaluate"},
                                                  {"sweep"},
                                                  {"verify"},
                                                  {"reproduce"},
                                                  {"testset"},
                                                  {"testset", "export"},
                                                  {"testset", "import"},
                                                  {"testset", "hash"},
                                                  {"show"},
                                                  {"export"},
                                                  {"import"}}) {
    auto arguments = command;
    arguments.push_back("--help");
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_THAT(outcome.err, IsEmpty());
    std::string called = "armwright";
    for (const std::string& word : command) {
      called += " " + word;
    }
    EXPECT_THAT(outcome.out, HasSubstr("Usage: " + called));
    EXPECT_THAT(outcome.out, HasSubstr("Examples:\n  " + called));
  }
  EXPECT_THAT(run({"--help"}).out,
              AllOf(HasSubstr("75   stopped"), HasSubstr("130  interrupted"), HasSubstr("74   ")));
}

TEST_F(Cli, TellsItsVersionAndWhatItWasBuiltFrom) {
  const Outcome outcome = run({"--version"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.out,
              AllOf(StartsWith("armwright 1."), HasSubstr("compiler"), HasSubstr("ode")));
}

TEST_F(Cli, NamesTheNearestOfWhatItDoesNotKnow) {
  expect_refused({"optimise", "sphere"}, 2,
                 {"unknown command 'optimise'; did you mean 'optimize'?"});
  expect_refused({"optimize", "sphere", "--sed=3"}, 2,
                 {"unknown flag '--sed'; did you mean '--seed'?"});
  expect_refused({"testset", "expot", "x"}, 2, {"unknown command 'expot'; did you mean 'export'?"});
  expect_refused({"optimize", "spere"}, 2,
                 {"unknown problem 'spere'; did you mean 'sphere'?", "Valid: sphere, ",
                  "which 'armwright list problems' lists"});
  expect_refused({"optimize", "sphere", "--optimizer", "gaa"}, 2,
                 {"unknown optimizer 'gaa'; did you mean 'ga'?",
                  "more, which 'armwright list optimizers' lists"});
  expect_refused({"optimize", "sphere", "--optimizer", "CMA-ES"}, 2, {"did you mean 'cmaes'?"});
  expect_refused({"optimize", "sphere", "--optimizer", "Nelder-Mead"}, 2,
                 {"did you mean 'nlopt:neldermead'?"});
  expect_refused({"optimize", "sphere", "--optimizer", "NLOPT:Cobyla"}, 2,
                 {"did you mean 'nlopt:cobyla'?"});
  expect_refused({"optimize", "sphere", "--optimizer", "ga", "--opt", "populaton=4"}, 2,
                 {"unknown option 'populaton'; did you mean 'population'?"});
  expect_refused({"optimize", "q1-complex", "--engine", "od"}, 2,
                 {"unknown engine 'od'; did you mean 'ode'?"});
  expect_refused({"reproduce", "--simd", "avx3"}, 2,
                 {"unknown SIMD level 'avx3'; did you mean 'avx2'?"});
  expect_refused({"evaluate", "tabel-a5"}, 2,
                 {"unknown design 'tabel-a5'; did you mean 'table-a5'?"});
  expect_refused({"reproduce", "--table", "A.12"}, 2,
                 {"unknown table 'A.12'; did you mean 'A.10'?"});
  expect_refused({"list", "optimizer"}, 2,
                 {"unknown kind 'optimizer'; did you mean 'optimizers'?"});
  expect_refused({"list", "signals", "stepp"}, 2, {"unknown signal 'stepp'; did you mean 'step'?"});
  expect_refused({"testset"}, 2, {"a command is missing. Valid: export"});
  expect_refused({"list", "signals", "step", "more"}, 2, {"unexpected argument 'more'"});
  expect_refused({"optimize"}, 2, {"PROBLEM is required", "armwright optimize --help"});
}

TEST_F(Cli, AloneItPrintsAShortGuide) {
  const Outcome outcome = run({});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.err, IsEmpty());
  EXPECT_LE(std::ranges::count(outcome.out, '\n'), 15);
  EXPECT_THAT(outcome.out,
              AllOf(HasSubstr("armwright list problems"), HasSubstr("armwright optimize irb4600"),
                    HasSubstr("armwright report results/"), HasSubstr("armwright --help")));
}

TEST_F(Cli, ACommandOfTheUserIsAnsweredWithExec) {
  write("mine.py", "");
  const auto expect_optimizer = [&](const std::vector<std::string>& words, const char* command) {
    expect_refused(std::vector<std::string>{"optimize"} + words, 2,
                   {"a program of your own needs exec: before its command, as in --optimizer \"" +
                    std::string(command) + "\""});
  };
  expect_optimizer({"sphere", "--optimizer", "python3", "mine.py"}, "exec:python3 mine.py");
  expect_optimizer({"--optimizer", "python3", "mine.py"}, "exec:python3 mine.py");
  expect_optimizer({"--optimizer", "python3", "mine.py", "sphere"}, "exec:python3 mine.py");
  expect_optimizer({"sphere", "--optimizer", "python3", "-u", "mine.py"},
                   "exec:python3 -u mine.py");
  expect_optimizer({"sphere", "--optimizer", "python3 mine.py"}, "exec:python3 mine.py");
  expect_optimizer({"sphere", "--optimizer", "mine.py"}, "exec:python3 mine.py");
  expect_optimizer({"sphere", "--optimizer", "./mine.py"}, "exec:python3 mine.py");
  expect_optimizer({"sphere", "--optimizer", "python3"}, "exec:python3 mine.py");
  const auto expect_problem = [&](const std::vector<std::string>& words) {
    expect_refused(std::vector<std::string>{"optimize"} + words, 2,
                   {"unknown problem ",
                    "a program of your own needs exec: before its command, as "
                    "in \"exec:python3 mine.py\""});
  };
  expect_problem({"python3 mine.py"});
  expect_problem({"python3", "mine.py"});
  expect_problem({"mine.py"});
  expect_problem({"./mine.py"});
}

TEST_F(Cli, CountsMayBeWrittenWithAnExponentOrKOrM) {
  const Outcome outcome = run({"optimize", "sphere", "--optimizer", "ga", "--opt",
                               "population=0.02k", "--budget", "1e2", "--schedule", "fixed:1e0",
                               "--set", "sets.test_cases=1e0", "--json", "--out", "run"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("budget 100 cases, schedule fixed:1,"));
  // The same numbers in other words are the same run.
  EXPECT_THAT(run({"optimize", "sphere", "--optimizer", "ga", "--opt", "population=20", "--budget",
                   "100", "--set", "sets.test_cases=1", "--json", "--out", "run"})
                  .err,
              HasSubstr("this run is complete"));
  expect_refused({"optimize", "sphere", "--budget", "1.5"}, 2,
                 {"--budget is '1.5'; it must be an integer from 1 to 1000000000000; 1e3, 10k and "
                  "2M are integers too"});
  expect_refused({"optimize", "sphere", "--budget", "1e-3"}, 2, {"--budget is '1e-3'"});
  expect_refused({"optimize", "sphere", "--budget", "2000000M"}, 2, {"--budget is '2000000M'"});
}

TEST_F(Cli, RefusesEmptyValues) {
  for (const std::vector<std::string>& words :
       std::vector<std::vector<std::string>>{{"--budget", ""}, {"--budget=", "100"}}) {
    std::vector<std::string> arguments = {"optimize", "sphere"};
    arguments.insert(arguments.end(), words.begin(), words.end());
    expect_refused(arguments, 2, {"--budget has an empty value; give it a value or leave it out"});
  }
  expect_refused({"doctor", ""}, 2, {"has an empty value"});
  expect_refused({"new-plugin", ""}, 2, {"has an empty value"});
}

TEST_F(Cli, ARobotsFileInPlaceOfAProblemIsNamedWithItsFlag) {
  expect_refused({"optimize", "arm.urdf"}, 2,
                 {"'arm.urdf' is the file of a robot", "--robot arm.urdf"});
}

TEST_F(Cli, AsksWhetherALengthIsInMillimetres) {
  expect_refused({"optimize", "q1-complex", "--set", "workspace.radius_m=450"}, 2,
                 {"450 m: were millimetres meant? Then write 0.45"});
  const Outcome far = run({"evaluate", "table-a5", "--problem", "q1-complex", "--cases", "1",
                           "--set", "workspace.centre_m=[900,0,500]"});
  EXPECT_THAT(far.out + far.err, HasSubstr("were millimetres meant?"));
}

TEST_F(Cli, NamesTheVariablesOfTheWinnerThatLieAtABound) {
  const Outcome outcome =
      run({"optimize", "q1-complex", "--optimizer", "ga", "--engine", "articulated", "--budget",
           "30", "--schedule", "fixed:1", "--set", "variables.bounds_factor=1.0001", "--set",
           "sets.test_cases=1", "--validation-cases", "1"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.err,
              AllOf(HasSubstr(" bound ("),
                    HasSubstr("; if the bound is not physical, widen the box with --set "
                              "variables.bounds_factor=10.001 (it is 1.0001)")));
  // The page of the run and what the terminal calls Next.
  EXPECT_THAT(outcome.out, HasSubstr("Next\n  "));
  EXPECT_LT(outcome.out.find(" report results/"), outcome.out.find(" show results/"));
}

TEST_F(Cli, RefusesWrongValuesAndSaysWhatIsAllowed) {
  const auto refuse = [&](std::vector<std::string> flags, const std::vector<std::string>& parts) {
    flags.insert(flags.begin(), {"optimize", "q1-complex", "--optimizer", "ga"});
    expect_refused(flags, 2, parts);
  };
  refuse({"--seed", "1.5"}, {"--seed", "'1.5'", "an integer from 0 to"});
  refuse({"--seed"}, {"--seed needs a value"});
  refuse({"--seed", "1", "--seed", "2"}, {"--seed is given more than once"});
  refuse({"--jobs", "0"}, {"--jobs", "'0'", "an integer from 1 to 1024"});
  refuse({"--jobs", "2x"}, {"'2x'"});
  refuse({"--budget", "-1"}, {"--budget is '-1'"});
  refuse({"--time-limit", "5d"}, {"--time-limit is '5d'", "10m"});
  refuse({"--schedule", "fresh:0"}, {"--schedule is 'fresh:0'", "fixed:K"});
  refuse({"--set", "speed"}, {"--set speed", "KEY=VALUE"});
  refuse({"--set", "task.sped_m_per_s=2"}, {"did you mean 'task.speed_m_per_s'?"});
  refuse({"--set", "task.speed_m_per_s=-2"}, {"task.speed_m_per_s", "-2"});
  refuse({"--opt", "population=1"}, {"population", "'1'"});
  refuse({"--engine", "ode", "--set", "physics.engine=ode"},
         {"--set physics.engine=ode", "give only one"});
  refuse({"--engine", "ode", "--simd", "scalar"}, {"--simd scalar: ", "'ode' has none to choose"});
  refuse({"--engine", "ode", "--precision", "float"},
         {"--precision float: ", "'ode' always computes in double"});
  refuse({"--tip", "tol"}, {"error: --tip tol: ", ".urdf: unknown link 'tol'"});
  expect_refused({"optimize", "sphere", "--simd", "scalar"}, 2,
                 {"error: --simd scalar: this problem has no setting physics.simd"});
  expect_refused({"evaluate", "table-a5", "--simd", "scalar"}, 2, {"'ode' has none to choose"});
  expect_refused({"evaluate", "table-a5", "--precision", "float"}, 2, {"unknown flag"});
  expect_refused({"sweep", "q1-complex", "--design", "table-a5", "--engine", "ode", "--parameter",
                  "physics.engine", "--values", "ode"},
                 2, {"--parameter physics.engine takes several values"});
  refuse({"--color", "pink"}, {"unknown --color 'pink'", "auto, always, never"});
  expect_refused({"optimize", "sphere"}, 2, {"ARMWRIGHT_SEED", "'one'"},
                 {{{"ARMWRIGHT_SEED", "one"}}, ""});
  expect_refused({"evaluate", "table-a1"}, 2, {"--problem is missing"});
  expect_refused({"evaluate", "table-a5", "--problem", "sphere"}, 2,
                 {"'sphere' is an analytic function"});
  expect_refused({"sweep", "q1-complex"}, 2, {"--parameter is missing"});
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "results"));
}

TEST_F(Cli, EscapeCodesInArgumentsDoNotReachTheTerminal) {
  const Outcome outcome = run({"optimize", "\x1b[31mred"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("red"), Not(HasSubstr("\x1b"))));
}

TEST_F(Cli, ListsEverythingAsJson) {
  for (const char* kind :
       {"problems", "optimizers", "robots", "engines", "designs", "signals", "controllers"}) {
    const Outcome outcome = run({"list", kind, "--json"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const json list = json::parse(outcome.out);
    ASSERT_FALSE(list.empty()) << kind;
    const std::string first = list[0].at("name");
    const Outcome one = run({"list", kind, first, "--json"});
    ASSERT_EQ(one.exit_code, 0) << one.err;
    EXPECT_FALSE(json::parse(one.out).at("name").get<std::string>().empty());
    EXPECT_THAT(run({"list", kind, first}).out, HasSubstr(": ")) << kind;
  }
}

TEST_F(Cli, GivesTheLimitsOfARobotsJointsTheirUnits) {
  const std::string file = ARMWRIGHT_TEST_DATA "/urdf/rail_and_pole.urdf";
  const json joints = json::parse(run({"list", "robots", file, "--json"}).out).at("joints");
  ASSERT_EQ(joints.size(), 2);
  EXPECT_EQ(joints[0].at("kind"), "prismatic");
  EXPECT_EQ(joints[0].at("lower_m"), -0.4);
  EXPECT_EQ(joints[0].at("upper_m"), 1.5);
  EXPECT_EQ(joints[0].at("speed_limit_m_per_s"), 2);
  EXPECT_EQ(joints[0].at("effort_limit_n"), 300);
  EXPECT_EQ(joints[1].at("kind"), "revolute");
  EXPECT_TRUE(joints[1].at("lower_rad").is_null());
  const std::string table = run({"list", "robots", file}).out;
  for (const char* limit : {"-0.4000 m", "1.500 m", "2.000 m/s", "300.0 N", "none"}) {
    EXPECT_THAT(table, HasSubstr(limit));
  }
  const std::string arm = run({"list", "robots", "irb4600_40_255"}).out;
  for (const char* limit : {"-180.0 deg", "150.0 deg", " rad/s", " N m"}) {
    EXPECT_THAT(arm, HasSubstr(limit));
  }
}

TEST_F(Cli, GivesThePlantOfARobotsJointsInNumbersAndInWords) {
  const std::string file = ARMWRIGHT_TEST_DATA "/urdf/cell.urdf";
  const json joints = json::parse(run({"list", "robots", file, "--json"}).out).at("joints");
  ASSERT_EQ(joints[1].at("name"), "turn");
  const json& plant = joints[1].at("plant");
  EXPECT_EQ(plant.at("viscous_n_m_s_per_rad"), 0.5);
  EXPECT_EQ(plant.at("coulomb_n_m"), 0.25);
  EXPECT_EQ(plant.at("armature_kg_m2"), 0);
  EXPECT_THAT(run({"list", "robots", file}).out,
              HasSubstr("turn: viscous friction 0.5 N m s/rad, Coulomb friction 0.25 N m"));
}

TEST_F(Cli, ExplainsAProblem) {
  const json problem = json::parse(run({"list", "problems", "q1-complex", "--json"}).out);
  ASSERT_EQ(problem.at("variables").size(), 20);
  const json& p = problem["variables"][0];
  EXPECT_EQ(p.at("name"), "joint_1.p");
  EXPECT_EQ(p.at("start"), 45000);
  EXPECT_EQ(p.at("lower"), 450);  // bounds_factor 100
  EXPECT_EQ(p.at("upper"), 4500000);
  const json& min = problem["variables"][3];
  EXPECT_EQ(min.at("name"), "joint_1.effort_min");
  EXPECT_EQ(min.at("lower"), -2000000);
  EXPECT_EQ(min.at("upper"), -200);
  EXPECT_THAT(
      run({"list", "problems", "q1-complex"}).out,
      AllOf(HasSubstr("N m/(rad s)"), HasSubstr("task.speed_m_per_s"), HasSubstr("4500000")));
  EXPECT_THAT(
      run({"list", "optimizers", "ga"}).out,
      AllOf(HasSubstr("tournament_probability"), HasSubstr("0.7"), HasSubstr("  Source  ")));
}

TEST_F(Cli, EvaluatesTheOracleCases) {
  const std::string file = std::string(ARMWRIGHT_TEST_DATA) + "/tracking-oracle.json";
  const Outcome outcome = run({"evaluate", "table-a5", "--test-cases", file, "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const json answer = json::parse(outcome.out);
  ASSERT_EQ(answer.at("cases").size(), 3);
  const json oracle = json::parse(read_text(file));
  int compared = 0;
  for (const json& expected : oracle.at("results")) {
    if (expected.at("design") != "A.5" || expected.at("signal") != "complex" ||
        expected.at("ik_bug") != true || expected.at("load_kg") != 0) {
      continue;
    }
    const json& found = answer["cases"][expected.at("case").get<std::size_t>()];
    EXPECT_EQ(found.at("case"), expected.at("case"));
    EXPECT_EQ(found.at("status"), "ok");
    EXPECT_EQ(found.at("point_error_m").size(), 25);
    // Both implementations do the same arithmetic in another order; the oracle's file has 12
    // digits.
    const double mean_m = expected.at("mean_error_m");
    EXPECT_NEAR(found.at("mean_error_m").get<double>(), mean_m, 1e-6 * mean_m);
    ++compared;
  }
  EXPECT_GE(compared, 1);
  const json& summary = answer.at("summary");
  EXPECT_EQ(summary.at("failures"), 0);
  EXPECT_NEAR(summary.at("total_torque_n_m").get<double>(), 963686, 0.5);  // published in whole N m
  for (const char* key : {"mean_error_m", "median_error_m", "worst_error_m"}) {
    EXPECT_TRUE(summary.at(key).is_number()) << key;
  }
}

// A design with efforts in advance brings its controller along.
TEST_F(Cli, EvaluatesDesignsOfAnyController) {
  const std::string made_with = "control.controller=pid_computed_torque";
  const std::string folder = folder_.path() / "run";
  const Outcome made =
      run({"optimize", "q2-e6", "--optimizer", "ga", "--set", made_with, "--engine", "articulated",
           "--budget", "35", "--set", "sets.test_cases=2", "--set", "sets.validation_cases=1",
           "--out", folder});
  ASSERT_TRUE(has_ended(made)) << made.err;
  std::vector<std::string> evaluate = {"evaluate", folder + "/winner.toml", "--problem", "q2-e6",
                                       "--engine", "articulated",           "--cases",   "2",
                                       "--json"};
  const Outcome alone = run(evaluate);
  EXPECT_EQ(alone.exit_code, 0) << alone.err;
  evaluate.insert(evaluate.end(), {"--set", made_with});
  EXPECT_EQ(alone.out, run(evaluate).out);
}

TEST_F(Cli, AnUnreachableTargetIsNamedAndHasNoNumber) {
  const auto file = write("far.csv",
                          "case,point,x_m,y_m,z_m\n0,0,1.4,0,0.9\n0,1,1.4,0.3,0.9\n"
                          "1,0,1.4,0,0.9\n1,1,9,0,0.9\n");
  const Outcome outcome = run({"evaluate", "table-a5", "--problem", "q1-complex", "--test-cases",
                               file, "--json", "--set", "task.count_first_point=true"});
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("case 1: on the way to point 1: target ("),
                                 HasSubstr("out of reach")));
  const json answer = json::parse(outcome.out);
  EXPECT_EQ(answer["cases"][0].at("status"), "ok");
  EXPECT_EQ(answer["cases"][1].at("status"), "unreachable");
  EXPECT_TRUE(answer["cases"][1].at("mean_error_m").is_null());
  EXPECT_TRUE(answer["summary"].at("worst_error_m").is_null());
  EXPECT_EQ(answer["summary"].at("failures"), 1);
  EXPECT_THAT(outcome.out, Not(HasSubstr("nan")));
}

TEST_F(Cli, WritesCasesAndATrajectoryAsCsv) {
  const Outcome outcome = run({"evaluate", "table-a10", "--cases", "2", "--csv", "cases.csv",
                               "--trajectory", "arm.csv", "--trajectory-case", "7", "--quiet"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("mean error"), HasSubstr("0.8 to 1.2 m")));
  EXPECT_THAT(read_text(folder_.path() / "cases.csv"),
              AllOf(StartsWith("case,status,mean_error_m,"), HasSubstr("\n1,ok,")));
  EXPECT_THAT(read_text(folder_.path() / "arm.csv"), StartsWith("time_s,"));
  expect_refused({"evaluate", "table-a10", "--trajectory", "arm.csv"}, 2,
                 {"must be given together"});
  // The former name of --trajectory-case.
  expect_refused({"evaluate", "table-a10", "--case", "7"}, 2, {"must be given together"});
}

TEST_F(Cli, BadTestCasesAreBadData) {
  const auto file = write("bad.json", "{\"cases\": [[[1.4, 0, 0.9], [1.4, \"x\", 0.9]]]}");
  expect_refused({"evaluate", "table-a5", "--problem", "q1-complex", "--test-cases", file}, 4,
                 {"bad.json", "point 1"});
  expect_refused({"testset", "import", file}, 4, {"bad.json"});
  expect_refused({"testset", "import", "absent.json"}, 74, {"absent.json"});
}

TEST_F(Cli, TestSetsKeepTheirHashThroughEveryFormat) {
  ASSERT_EQ(run({"testset", "export", "test/2", "--cases", "4", "--out", "a.csv"}).exit_code, 0);
  ASSERT_EQ(run({"testset", "import", "a.csv", "--out", "b.json"}).exit_code, 0);
  const auto hash = [&](const std::vector<std::string>& arguments) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("4 cases"));
    return outcome.out.substr(0, 64);
  };
  const std::string expected = hash({"testset", "hash", "test/2", "--cases", "4"});
  EXPECT_EQ(hash({"testset", "hash", "a.csv"}), expected);
  EXPECT_EQ(hash({"testset", "hash", "b.json"}), expected);
  EXPECT_NE(hash({"testset", "hash", "test/1", "--cases", "4"}), expected);
  expect_refused({"testset", "export", "tset/2", "--cases", "4"}, 2, {"'tset/2' is no test set"});
}

TEST_F(Cli, ReproducesOneTable) {
  const Outcome outcome =
      run({"reproduce", "--cases", "3", "--table", "A.10", "--csv", "-", "--quiet"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, IsEmpty());
  EXPECT_THAT(outcome.out,
              AllOf(StartsWith("label,design,problem,set,published_error_m,cases,"),
                    HasSubstr("\nA.10 (E6),table-a10,q2-e6,physics.engine=ode,8.3e-05,3,"),
                    HasSubstr("task.load_kg=20"), Not(HasSubstr("table-a5"))));
}

TEST_F(Cli, KeepsAReproductionAndGoesOnWithIt) {
  const std::vector<std::string> command = {"reproduce", "--cases", "2", "--table", "A.8"};
  const std::string printed = run(command).out;
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "results"));
  auto kept = command;
  kept.emplace_back("--out");
  EXPECT_EQ(run(kept).out, printed);
  EXPECT_TRUE(
      std::filesystem::exists(folder_.path() / "results" / "reproduction" / "reproduction.json"));
  const Outcome again = run(kept);
  EXPECT_EQ(again.out, printed);
  EXPECT_THAT(again.err, HasSubstr("results/reproduction (1 of 1 results exist already)"));
  kept.emplace_back("--new");
  EXPECT_THAT(run(kept).err, HasSubstr("results/reproduction-002 "));
  const Outcome stopped = run({"reproduce", "--cases", "500", "--table", "A.10", "--out", "slow",
                               "--time-limit", "1", "--quiet"});
  EXPECT_EQ(stopped.exit_code, 75);
  EXPECT_THAT(stopped.err, HasSubstr("nothing is lost. To resume:"));
  expect_refused({"reproduce", "--cases", "3", "--out"}, 2, {"other settings", "--new"});
  std::filesystem::create_directory(folder_.path() / "run");
  write("run/manifest.json", "{}");
  expect_refused({"reproduce", "--cases", "2", "--out", "run"}, 2,
                 {"'manifest.json' but no reproduction.json"});
}

TEST_F(Cli, SweepsTheSpeed) {
  const Outcome outcome =
      run({"sweep", "q4-speed", "--values", "0.5,1.5", "--cases", "2", "--json", "--quiet"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const json rows = json::parse(outcome.out).at("rows");
  ASSERT_EQ(rows.size(), 2);
  EXPECT_EQ(rows[0].at("value"), 0.5);
  // The error of this design grows with the speed (thesis, Fig. 6.16).
  EXPECT_LT(rows[0].at("mean_error_m").get<double>(), rows[1].at("mean_error_m").get<double>());
  EXPECT_THAT(run({"sweep", "q4-speed", "--values", "0.5,1.5", "--cases", "2"}).out,
              AllOf(HasSubstr("task.speed_m_per_s"), HasSubstr("#")));
  expect_refused({"sweep", "q4-speed", "--values", "0.5,-1"}, 2, {"task.speed_m_per_s=-1"});
}

// A design for one step per control period diverges with twenty.
TEST_F(Cli, ASweepInWhichOnlyTheFirstValueFailsHasFailed) {
  const Words sweep = {
      "sweep",   "q2-e6", "--design", "table-a10",  "--parameter", "physics.substeps",
      "--cases", "5",     "--engine", "articulated"};
  const Outcome outcome = run(sweep + Words{"--values", "20,1"});
  EXPECT_EQ(outcome.exit_code, 3) << outcome.out;
  EXPECT_THAT(outcome.err, HasSubstr("physics.substeps=20"));
  EXPECT_EQ(run(sweep + Words{"--values", "1"}).exit_code, 0);
}

TEST_F(Cli, AFullDiskBelowStdoutIsSaid) {
  const Outcome outcome = run({"list", "signals"}, {{}, "/dev/full"});
  EXPECT_EQ(outcome.exit_code, 74);
  EXPECT_THAT(outcome.err, HasSubstr("standard output: cannot write it: No space left on device"));
}

TEST_F(Cli, ColoursAndBarsAreForTerminalsOnly) {
  const std::vector<std::string> command = {"evaluate", "table-a10", "--cases", "2"};
  EXPECT_THAT(run(command).out + run(command).err, Not(HasSubstr("\x1b")));
  const std::string shown = run_on_terminal(folder_.path(), command);
  EXPECT_THAT(shown, AllOf(HasSubstr("\rtest "), HasSubstr("2/2"), HasSubstr("\x1b[1m")));
  EXPECT_THAT(run_on_terminal(folder_.path(), command, {{{"NO_COLOR", "1"}}, ""}),
              AllOf(HasSubstr("\rtest "), Not(HasSubstr("\x1b[1m"))));
  auto always = command;
  always.insert(always.end(), {"--color", "always"});
  EXPECT_THAT(run(always).out, HasSubstr("\x1b[1m"));
  EXPECT_THAT(run_on_terminal(folder_.path(), {"evaluate", "table-a10", "--cases", "2", "--quiet"}),
              Not(HasSubstr("\rtest ")));
}

}  // namespace
}  // namespace armwright
