#include "report/formats/export_functions.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "problems/config/problem_loader.hpp"

namespace armwright {
namespace {

// Returns a problem of a study's plan with that many variables.
ProblemRuns make_problem(const std::string& label, std::size_t place, const std::string& name,
                         const std::string& settings, std::size_t variables = 1) {
  ProblemRuns problem;
  problem.name = label;
  problem.place = place;
  problem.function = {name, settings, {}};
  problem.names.variables.assign(variables, "x");
  return problem;
}

std::vector<std::string> describe(const CollectedRuns& runs) {
  std::vector<std::string> lines;
  for (const ExportFunction& function : number_functions(runs)) {
    lines.push_back(std::to_string(function.id) + " " + function.name + ":");
    for (const ProblemRuns* problem : function.problems) {
      lines.back() += " " + problem->name;
    }
  }
  return lines;
}

TEST(FunctionNumbers, AreGivenToEveryShippedProblemOnce) {
  std::set<std::size_t> numbers;
  for (const ProblemTitle& problem : list_problems()) {
    const auto number = find_function_id(problem.name);
    // Three are for any robot, and each is a problem of its own with every robot. The others came after
    // 1.0, and COCO's numbers end soon: they are numbered in each export.
    const std::set<std::string> unnumbered = {"robot",      "identify",         "irb4600",
                                              "excite",     "abdessemed-fuzzy", "subudhi-flexible",
                                              "gasparetto", "gasparetto-front", "saravanan-puma",
                                              "shiakolas",  "chaiyaratana-line"};
    EXPECT_EQ(number.has_value(), !unnumbered.contains(problem.name)) << problem.name;
    if (number) {
      EXPECT_GE(*number, 25u) << problem.name;
      EXPECT_LT(*number, kFirstOwnFunction) << problem.name;
      EXPECT_TRUE(numbers.insert(*number).second) << problem.name;
    }
  }
  EXPECT_EQ(find_function_id("sphere"), 25u);
  EXPECT_EQ(find_function_id("q1-complex"), 40u);
  EXPECT_FALSE(find_function_id("mine"));
}

TEST(FunctionNumbers, AreThoseOfShippedProblemsOnlyWithTheirOwnSettings) {
  const std::string plain = make_function_settings(load_problem("sphere").resolved_json);
  const std::vector<std::string> words = {"function.dimension=20"};
  EXPECT_EQ(make_function_settings(load_problem("sphere", words).resolved_json), plain);
  CollectedRuns runs;
  runs.problems = {make_problem("large", 1, "sphere", plain, 20),
                   make_problem("other", 2, "sphere", "{}", 5),
                   make_problem("small", 0, "sphere", plain, 5)};
  EXPECT_THAT(describe(runs), testing::ElementsAre("25 sphere: small large", "72 other: other"));
}

TEST(FunctionNumbers, OfOtherProblemsFollowThePlan) {
  CollectedRuns runs;
  runs.problems = {make_problem("a", 2, "mine", "1"), make_problem("b", 0, "mine", "2"),
                   make_problem("c", 1, "mine", "1", 7)};
  EXPECT_THAT(describe(runs), testing::ElementsAre("72 b: b", "73 mine: a c"));
}

TEST(FunctionNumbers, TellTwoProblemsOfTheSameFunctionAndDimensionApart) {
  CollectedRuns runs;
  runs.problems = {make_problem("a", 0, "mine", "1"), make_problem("A", 0, "yours", "1"),
                   make_problem("b", 1, "mine", "1")};
  EXPECT_THAT(describe(runs), testing::ElementsAre("72 a: a", "73 A-2: A", "74 b: b"));
}

TEST(FunctionSettings, LeaveOutWhatDoesNotDecideAnObjective) {
  EXPECT_EQ(make_function_settings(
                R"({"title":"t","run":{},"sets":{"training":"train/x"},"replicate":{"start":[1]},
                    "physics":{"engine":"ode","simd":"avx2"},
                    "function":{"name":"f","dimension":5,"instance":3,"instance_per_replicate":true}})"),
            R"({"function":{"name":"f"},"physics":{"engine":"ode"}})");
}

}  // namespace
}  // namespace armwright
