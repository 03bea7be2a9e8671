// The check of a run's winner: its rule on hand-made numbers, its file, and the check of a tiny run.
#include "study/verification/winner_check.hpp"

#include <gmock/gmock.h>

#include <limits>

#include "base/error.hpp"
#include "base/folder_checksums.hpp"
#include "base/text.hpp"
#include "study/run/run_folder.hpp"
#include "study/run_support.hpp"

namespace armwright {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

TEST(CheckLimit, IsThreeTimesItsOwnErrorOrTheFloor) {
  EXPECT_DOUBLE_EQ(calc_check_limit_m(0.001, 0.0002, 0), 0.003);
  EXPECT_DOUBLE_EQ(calc_check_limit_m(0.00001, 0.0002, 0), 0.0002);
  EXPECT_DOUBLE_EQ(calc_check_limit_m(std::nullopt, 0.0002, 0), 0.0002);
}

TEST(CheckLimit, IsTheProblemsOwnWhereItHasOne) {
  EXPECT_DOUBLE_EQ(calc_check_limit_m(0.001, 0.0002, 0.0005), 0.0005);
  EXPECT_DOUBLE_EQ(calc_check_limit_m(0.001, 0.0002, 0.02), 0.02);
}

TEST(CheckVerdict, FailsOnAnyFailedCaseAndIsWorseAboveTheLimit) {
  const auto judge = [](std::vector<double> errors_m) {
    return judge_absolutely(summarize(errors_m, kFailureError_m), 0.003);
  };
  EXPECT_EQ(judge({0.001, 0.005}), Verdict::holds);  // the mean is the limit
  EXPECT_EQ(judge({0.001, 0.0051}), Verdict::worse);
  EXPECT_EQ(judge({0.0001, 0.0001, 0.101}), Verdict::fails);
  EXPECT_EQ(judge({0.0001, kNoNumber}), Verdict::fails);
  EXPECT_EQ(judge({kNoNumber}), Verdict::fails);
}

TEST(CheckVerdict, OfAnotherEngineIsWorseIfTheEnginesDifferByMoreThanTheyDoElsewhere) {
  const auto judge = [](double error_m) {
    return judge_engine(summarize(std::vector{error_m}, kFailureError_m), 0.003, 0.001);
  };
  EXPECT_EQ(judge(0.00104), Verdict::holds);
  EXPECT_EQ(judge(0.00096), Verdict::holds);
  EXPECT_EQ(judge(0.00106), Verdict::worse);
  EXPECT_EQ(judge(0.00094), Verdict::worse);
  EXPECT_EQ(judge(0.2), Verdict::fails);
}

TEST(CheckWords, SayWhatIsDifferentAndWhatComesOfIt) {
  const VerifySetting own{"articulated", 1, 1, ""};
  EXPECT_EQ(name_setting({"ode", 1, 1, ""}, own), "engine ode");
  EXPECT_EQ(name_setting({"articulated", 2, 1, ""}, own), "2 physics steps per control period");
  EXPECT_EQ(name_setting({"articulated", 1, 0.9, ""}, own), "masses -10 %");
  EXPECT_EQ(name_setting({"articulated", 1, 1, kFrictionPreset}, own), "friction in the joints");
  EXPECT_EQ(name_setting({"articulated", 1, 1, kSensorPreset}, own), "a coarse and late sensor");

  CheckedSetting checked;
  const auto describe = [&](Verdict verdict, std::optional<double> ratio) {
    checked.verdict = verdict;
    checked.ratio = ratio;
    return describe_outcome(checked, 0.003);
  };
  EXPECT_EQ(describe(Verdict::holds, 1.5), "works");
  checked.summary.mean = 0.004;  // above the limit
  EXPECT_EQ(describe(Verdict::worse, 3.24), "3.2 times its own error");
  EXPECT_EQ(describe(Verdict::worse, 1895.3), "1895 times its own error");
  checked.summary.mean = 0.001;  // another engine, within the limit
  EXPECT_EQ(describe(Verdict::worse, 0.941), "error 6 % smaller");
  EXPECT_EQ(describe(Verdict::worse, 1.254), "error 25 % larger");
  checked.summary.cases = 10;
  checked.summary.failures = 3;
  EXPECT_EQ(describe(Verdict::fails, 9), "fails in 3 of 10 cases");
  EXPECT_EQ(describe(Verdict::missing, {}), "not simulated");
}

TEST(CheckWords, ListTheConditionsUnderWhichAWinnerIsNotShownToWork) {
  const auto make = [](const std::string& name, Verdict verdict, std::optional<double> mean_m) {
    CheckedSetting checked;
    checked.name = name;
    checked.verdict = verdict;
    checked.summary.cases = 10;
    checked.summary.mean = mean_m;
    checked.ratio = mean_m ? std::optional(*mean_m / 0.001) : std::nullopt;
    return checked;
  };
  WinnerCheck check;
  check.own.cases = 10;
  check.limit_m = 0.003;
  check.settings = {make("masses +10 %", Verdict::holds, 0.002),
                    make("engine ode", Verdict::worse, 0.002)};  // within the limit
  EXPECT_EQ(list_weaknesses(check), "");
  check.settings.push_back(make("friction\n", Verdict::worse, 0.004));
  check.settings.push_back(make("engine mujoco", Verdict::missing, {}));
  check.settings.push_back(make("a sensor", Verdict::fails, 0.2));
  check.settings.back().summary.cases = 3;
  check.settings.back().summary.failures = 2;
  EXPECT_EQ(list_weaknesses(check),
            "a sensor, 3 cases (fails in 2 of 3 cases), " + sanitize("friction\n") +
                " (4.0 times its own error), engine mujoco (not simulated)");
}

WinnerCheck make_example() {
  WinnerCheck check{.test_set = "test/2",
                    .own = summarize(std::vector<double>{0.001, 0.002}, kFailureError_m),
                    .limit_m = 0.0045,
                    .settings = {}};
  CheckedSetting& fails = check.settings.emplace_back();
  fails.setting = {"ode", 2, 1.1, "sensor"};
  fails.summary = summarize(std::vector<double>{0.2, kNoNumber}, kFailureError_m);
  fails.ratio = 133;
  fails.verdict = Verdict::fails;
  fails.name = "masses +10 %";
  CheckedSetting& missing = check.settings.emplace_back();
  missing.verdict = Verdict::missing;
  missing.fault = "no such engine";
  return check;
}

TEST(CheckFile, IsReadAsItWasWritten) {
  const WinnerCheck check = make_example();
  const WinnerCheck read = parse_check(to_json(check), "check.json");
  EXPECT_EQ(to_json(read), to_json(check));
  ASSERT_EQ(read.settings.size(), 2u);
  EXPECT_EQ(read.settings[0].setting, check.settings[0].setting);
  EXPECT_EQ(read.settings[0].verdict, Verdict::fails);
  EXPECT_EQ(read.settings[1].fault, "no such engine");
}

TEST(CheckFile, IsRefusedIfItIsDamaged) {
  const std::string text = to_json(make_example());
  const auto refuse = [&](const std::string& from, const std::string& to) {
    std::string other = text;
    other.replace(other.find(from), from.size(), to);
    try {
      parse_check(other, "there/check.json");
      ADD_FAILURE() << from;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::bad_data);
      EXPECT_THAT(error.what(), AllOf(HasSubstr("there/check.json: is not a check"),
                                      HasSubstr("the command that began the run makes it again")));
    }
  };
  refuse("\"format\": 1", "\"format\": 9");
  refuse("\"fails\"", "\"flies\"");
  refuse("\"cases\": 2", "\"cases\": -2");
  refuse("{", "");
}

class CheckWinner : public RunTest {
 protected:
  CheckWinner() { plan_.problem = load({}); }
  static LoadedProblem load(const std::vector<std::string>& changes) {
    std::vector<std::string> overrides = {"workspace.points=4", "sets.validation_cases=3",
                                          "sets.test_cases=4"};
    if (changes.empty()) {
      overrides.emplace_back("physics.engine=articulated");
    }
    overrides.insert(overrides.end(), changes.begin(), changes.end());
    return load_problem("q1-complex", overrides);
  }
  RunRequest request(const std::string& folder, unsigned jobs = 2) {
    return {plan_, temporary_ / folder, jobs, {"armwright", "optimize"}};
  }
  bool check(const std::string& folder, unsigned jobs = 2) {
    StopSignal stop;
    return check_winner(request(folder, jobs), load_result(temporary_ / folder), load, stop,
                        observer_);
  }
  std::string read_check(const std::string& folder) {
    return read_file(temporary_ / folder / kCheckFile, 1 << 20);
  }
  RunPlan plan_ = make_small_plan();
};

TEST_F(CheckWinner, HasEverySettingAndIsCovered) {
  const RunResult result = run(plan_, "a").value();
  EXPECT_FALSE(load_check(temporary_ / "a"));
  ASSERT_TRUE(check("a"));
  const WinnerCheck made = load_check(temporary_ / "a").value();
  EXPECT_EQ(made.test_set, "test/2");
  EXPECT_EQ(made.own.cases, 4u);
  EXPECT_EQ(made.own.mean, result.test_summary.mean);
  std::vector<std::string> names;
  for (const CheckedSetting& checked : made.settings) {
    names.push_back(checked.name);
    EXPECT_EQ(checked.summary.cases, 4u) << checked.name << ": " << checked.fault;
    EXPECT_EQ(checked.verdict, checked.setting.engine == "articulated"
                                   ? judge_absolutely(checked.summary, made.limit_m)
                                   : judge_engine(checked.summary, made.limit_m, made.own.mean))
        << checked.name;
  }
  for (const char* name :
       {"engine ode", "2 physics steps per control period", "10 physics steps per control period",
        "masses -10 %", "masses +10 %", "friction in the joints", "a coarse and late sensor"}) {
    EXPECT_THAT(names, Contains(name));
  }
  EXPECT_TRUE(FolderChecksums(temporary_ / "a").covers(kCheckFile));
}

TEST_F(CheckWinner, IsTheSameForAnyNumberOfThreadsAndMadeOnce) {
  run(plan_, "a");
  ASSERT_TRUE(check("a", 1));
  const std::string one = read_check("a");
  std::filesystem::remove(temporary_ / "a" / kCheckFile);
  ASSERT_TRUE(check("a", 3));
  EXPECT_EQ(read_check("a"), one);
  const auto time = std::filesystem::last_write_time(temporary_ / "a" / kCheckFile);
  ASSERT_TRUE(check("a"));
  EXPECT_EQ(std::filesystem::last_write_time(temporary_ / "a" / kCheckFile), time);
}

TEST_F(CheckWinner, WritesNothingIfItIsStoppedAndIsMadeLater) {
  const RunResult result = run(plan_, "a").value();
  StopSignal stop;
  StoppingObserver observer(stop, 6);  // in the second setting
  EXPECT_FALSE(check_winner(request("a"), result, load, stop, observer));
  EXPECT_FALSE(load_check(temporary_ / "a"));
  EXPECT_TRUE(run(plan_, "a"));  // the run is complete
  ASSERT_TRUE(check("a"));
  EXPECT_TRUE(load_check(temporary_ / "a"));
}

TEST_F(CheckWinner, IsRemovedWithTheResultThatItBelongsTo) {
  run(plan_, "a");
  ASSERT_TRUE(check("a"));
  std::filesystem::remove(temporary_ / "a" / "result.json");
  run(plan_, "a");
  EXPECT_FALSE(load_check(temporary_ / "a"));
}

TEST_F(CheckWinner, SaysWhichSettingCouldNotBeSimulated) {
  run(plan_, "a");
  const ProblemLoader without_ode = [](const std::vector<std::string>& changes) {
    if (std::ranges::count(changes, "physics.engine=ode") > 0) {
      throw Error(ErrorKind::usage, "no ode today");
    }
    return load(changes);
  };
  StopSignal stop;
  ASSERT_TRUE(
      check_winner(request("a"), load_result(temporary_ / "a"), without_ode, stop, observer_));
  const CheckedSetting ode = load_check(temporary_ / "a")->settings.front();
  EXPECT_EQ(ode.verdict, Verdict::missing);
  EXPECT_EQ(ode.fault, "no ode today");
}

TEST_F(CheckWinner, LeavesAFunctionAlone) {
  RunPlan plan = make_small_plan();
  plan.problem = load_problem("rastrigin");
  plan.schedule = choose_schedule(plan.problem, plan.optimizer);
  const RunResult result = run(plan, "a").value();
  StopSignal stop;
  EXPECT_TRUE(check_winner({plan, temporary_ / "a", 1, {}}, result, load, stop, observer_));
  EXPECT_FALSE(load_check(temporary_ / "a"));
}

}  // namespace
}  // namespace armwright
