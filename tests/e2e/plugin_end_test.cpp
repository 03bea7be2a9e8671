// How runs of plugins end, for programs and for libraries in C++ and C alike: recommendations after
// the end of the budget, an end before it, and a plugin that does nothing.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "base/temporary_folder.hpp"
#include "e2e/program.hpp"

namespace armwright {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

class CliPluginEnd : public testing::Test {
 protected:
  static std::string library(const std::string& name) {
    return std::string(ARMWRIGHT_TEST_PLUGINS) + "/lib" + name + ".so";
  }
  static std::string script() {
    return "exec:python3 " + std::string(ARMWRIGHT_TEST_PLUGINS_SOURCE) + "/late.py";
  }
  Outcome optimize(const std::string& optimizer, const std::vector<std::string>& more = {},
                   const std::string& budget = "20") {
    std::vector<std::string> words = {"optimize", "sphere",  "--optimizer", optimizer, "--budget",
                                      budget,     "--quiet", "--out",       "run",     "--new"};
    words.insert(words.end(), more.begin(), more.end());
    return run_program(folder_.path(), words);
  }
  TemporaryFolder folder_;
};

TEST_F(CliPluginEnd, ARecommendationAfterTheBudgetWins) {
  for (const std::string& optimizer : {script(), library("late"), library("c_late")}) {
    const Outcome outcome = optimize(optimizer, {"--json"});
    ASSERT_EQ(outcome.exit_code, 0) << optimizer << outcome.err;
    const json result = json::parse(outcome.out);
    const json& winner = result["candidates"][result["winner"]["candidate"].get<std::size_t>()];
    EXPECT_EQ(winner.value("recommended", false), true) << optimizer;
    EXPECT_EQ(winner["x"], json(std::vector<double>(10))) << optimizer << winner;
    EXPECT_EQ(result["counts"]["evaluations"], 20) << optimizer;
    EXPECT_EQ(result["end_reason"], "budget") << optimizer;
  }
}

TEST_F(CliPluginEnd, AWrongRecommendationAfterTheBudgetIsAFault) {
  const Outcome outcome = optimize(script(), {"--opt", "end=bad"});
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.err, HasSubstr("it sent a recommended point of 9 coordinates"));
}

TEST_F(CliPluginEnd, AnEarlyEndSaysWhyAndHowMuchIsLeft) {
  for (const auto& [optimizer, unused] : std::vector<std::pair<std::string, std::string>>{
           {script(), "19"}, {library("late"), "17"}}) {
    const Outcome outcome = optimize(optimizer, {"--opt", "end=early"});
    EXPECT_TRUE(has_ended(outcome)) << outcome.err;
    const std::string said =
        "the optimizer left " + unused + " evaluations of the budget unused: all is seen";
    EXPECT_THAT(outcome.out, HasSubstr(said));
    EXPECT_THAT(outcome.err,
                AllOf(HasSubstr("note: " + said), HasSubstr("armwright list optimizers")));
  }
  const Outcome outcome = optimize("nlopt:cobyla", {"--set", "function.dimension=2"}, "3000");
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("evaluations of the budget unused: "),
                                 HasSubstr("ended by: optimizer finished")));
  EXPECT_THAT(outcome.err, HasSubstr("--optimizer multistart:nlopt:cobyla"));
}

TEST_F(CliPluginEnd, APluginThatEvaluatesNothingIsAFailureWithAWayOut) {
  for (const std::string& optimizer : {script(), library("late")}) {
    const Outcome outcome = optimize(optimizer, {"--opt", "end=at_once"});
    EXPECT_EQ(outcome.exit_code, 3);
    EXPECT_THAT(outcome.err,
                AllOf(HasSubstr("returned without evaluating a point, although the budget pays for "
                                "20; its reason: no licence"),
                      HasSubstr("armwright check-plugin"), HasSubstr("--new")));
  }
}

}  // namespace
}  // namespace armwright
