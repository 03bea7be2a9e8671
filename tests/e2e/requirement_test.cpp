// What `armwright evaluate`, `list problems` and `show` say of what is required of an arm.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "base/temporary_folder.hpp"
#include "e2e/program.hpp"

namespace armwright {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

class CliRequirements : public testing::Test {
 protected:
  // The published design of Q1 on some cases of the shipped problem, with these limits of its own.
  Outcome evaluate(const std::string& requirements, std::vector<std::string> more = {}) {
    std::vector<std::string> words = {"evaluate",
                                      "table-a5",
                                      "--problem",
                                      "q1-requirements",
                                      "--cases",
                                      "20",
                                      "--quiet",
                                      "--set",
                                      "workspace.points=8",
                                      "--set",
                                      "requirement=[" + requirements + "]"};
    words.insert(words.end(), more.begin(), more.end());
    return run_program(folder_.path(), words);
  }
  TemporaryFolder folder_;
};

constexpr const char* kMet =
    "{quantity='overshoot', limit_relative=0.2, use='constraint'}, "
    "{quantity='peak_torque', limit_n_m=1e5}";
constexpr const char* kMissed =
    "{quantity='overshoot', limit_relative=0.2, use='constraint'}, "
    "{quantity='peak_torque', joint='joint_2', limit_n_m=1000, use='constraint'}";

TEST_F(CliRequirements, OfADesignThatMeetsThemAreGreen) {
  const Outcome table = evaluate(kMet);
  EXPECT_EQ(table.exit_code, 0) << table.err;
  EXPECT_THAT(table.out, AllOf(HasSubstr("Requirements, on the worst case"),
                               ContainsRegex("overshoot +constraint +20.00 % .* case [0-9]+, "
                                             "point [0-9]+ +met"),
                               ContainsRegex("peak torque +report +100000 N m .*joint_2 +met"),
                               Not(HasSubstr("MISSED"))));
  const json found = json::parse(evaluate(kMet, {"--json"}).out).at("requirements");
  ASSERT_EQ(found.size(), 2u);
  for (const json& one : found) {
    EXPECT_EQ(one["grade"], "met");
    EXPECT_EQ(one["light"], "green");
    EXPECT_NEAR(one["ratio"].get<double>(), one["value"].get<double>() / one["limit"].get<double>(),
                1e-12);
  }
  EXPECT_EQ(found[0]["unit"], "1");
  EXPECT_EQ(found[1]["worst_joint"], "joint_2");
  EXPECT_TRUE(found[1]["worst_point"].is_null());
}

TEST_F(CliRequirements, OfADesignThatMissesOneAreRedAndBind) {
  const Outcome table = evaluate(kMissed);
  EXPECT_EQ(table.exit_code, 3) << table.err;
  EXPECT_THAT(table.out,
              AllOf(ContainsRegex("overshoot .* met\n"),
                    ContainsRegex("peak torque of joint_2 .* MISSED; this limit binds")));
  const json found = json::parse(evaluate(kMissed, {"--json"}).out).at("requirements");
  EXPECT_EQ(found[0]["light"], "green");
  EXPECT_EQ(found[0]["binds"], false);
  EXPECT_EQ(found[1]["light"], "red");
  EXPECT_EQ(found[1]["grade"], "missed");
  EXPECT_EQ(found[1]["binds"], true);
  // One that is only reported makes nobody fail.
  EXPECT_EQ(evaluate("{quantity='energy', limit_j=1}").exit_code, 0);
}

TEST_F(CliRequirements, AreShownWithTheProblem) {
  const Outcome listed = run_program(folder_.path(), {"list", "problems", "q1-requirements"});
  EXPECT_EQ(listed.exit_code, 0) << listed.err;
  EXPECT_THAT(listed.out,
              AllOf(HasSubstr("4 constraints"), ContainsRegex("overshoot +10.00 % +constraint"),
                    ContainsRegex("settling time to 5 mm +0.2000 s +constraint"),
                    ContainsRegex("energy +50000 J +report")));
}

TEST_F(CliRequirements, AreShownOfARunsWinner) {
  const Outcome run = run_program(
      folder_.path(),
      {"optimize",
       "q1-requirements",
       "--optimizer",
       "ga",
       "--budget",
       "200",
       "--out",
       "a",
       "--set",
       "schedule.cases=2",
       "--set",
       "workspace.points=4",
       "--set",
       "sets.validation_cases=2",
       "--set",
       "sets.test_cases=2",
       "--set",
       "variables.bounds_factor=1.2",
       "--set",
       "requirement=[{quantity='energy', limit_j=1}, {quantity='tip_error', limit_m=10}]"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  const auto check = AllOf(HasSubstr("Requirements, on the worst case"),
                           ContainsRegex("energy +report +1.000 J .* MISSED; this limit binds"),
                           ContainsRegex("tip error +report .* met"));
  EXPECT_THAT(run.out, check);
  EXPECT_THAT(run_program(folder_.path(), {"show", "a"}).out, check);
}

}  // namespace
}  // namespace armwright
