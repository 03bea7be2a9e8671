// Problems that have only a description, for ask and tell.
#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "problems/problem_folder.hpp"
#include "problems/user/user_problem.hpp"

namespace armwright {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* kBench = R"(kind = "external"
title = "A bench"
[[variable]]
name = "gain"
lower = 0.1
upper = 10
scale = "logarithmic"
[[variable]]
name = "steps"
type = "integer"
lower = 1
upper = 8
[[variable]]
name = "oil"
type = "category"
choices = ["thin", "thick, old"]
start = "thick, old"
[[objective]]
name = "error"
unit = "mm"
[[constraint]]
name = "heat"
limit = 60
[[metric]]
name = "noise"
)";

TEST(ExternalProblem, HasADescriptionAndNeitherAProgramNorSeveralCases) {
  const ProblemFolder folder;
  folder.write("bench.toml", kBench);
  const LoadedProblem loaded = folder.load("bench.toml");
  EXPECT_EQ(loaded.name, "bench");
  EXPECT_EQ(loaded.title, "A bench");
  EXPECT_THAT(loaded.program, IsEmpty()) << "it needs no consent";
  const ProblemDescription& problem = loaded.problem->description();
  EXPECT_TRUE(problem.has_single_case);
  ASSERT_EQ(problem.variables.size(), 3u);
  EXPECT_EQ(problem.variables[0].start, 1);
  EXPECT_EQ(problem.variables[2].start, 1);
  EXPECT_EQ(problem.metrics.front().name, "noise");
  const LoadedProblem recorded = load_recorded_problem(loaded.resolved_json, "bench", "/nowhere");
  EXPECT_EQ(recorded.resolved_json, loaded.resolved_json);
}

// Then the numbers of all constraints are g, and that of a limit is value / limit - 1.
TEST(ExternalProblem, AConstraintWithALimitBesideOneWithoutHasNoUnit) {
  const ProblemFolder folder;
  folder.write("bench.toml", std::string(kBench) +
                                 "[[constraint]]\nname = \"sag\"\nunit = \"mm\"\nlimit = 3\n"
                                 "[[constraint]]\nname = \"gap\"\nunit = \"mm\"\n");
  const LoadedProblem loaded = folder.load("bench.toml");
  const ProblemDescription& problem = loaded.problem->description();
  EXPECT_THAT(problem.limits, IsEmpty());
  ASSERT_EQ(problem.constraints.size(), 3u);
  EXPECT_EQ(problem.constraints[1].unit, "");
  EXPECT_EQ(problem.constraints[2].unit, "mm");
}

TEST(ExternalProblem, CannotBeSimulatedAndSaysWhatToDo) {
  const ProblemFolder folder;
  folder.write("bench.toml", kBench);
  const LoadedProblem loaded = folder.load("bench.toml");
  const auto refusal = usage_error_of([&] { require_server(*loaded.problem); });
  EXPECT_THAT(refusal, HasSubstr("problem 'bench': its file has kind = \"external\", so armwright "
                                 "cannot compute it. 'armwright ask RUN --problem FILE'"));
  EXPECT_EQ(usage_error_of([&] {
              const std::vector<double> x = {1, 1, 0};
              loaded.problem->evaluate(x, {CaseRole::training, "train/1", {0}});
            }),
            refusal);
}

TEST(ExternalProblem, BadFilesAreRefusedWithTheirLine) {
  const ProblemFolder folder;
  const std::string good = kBench;
  const auto refuse = [&](const std::string& what, const std::string& with) {
    std::string text = good;
    text.replace(text.find(what), what.size(), with);
    return folder.refusal_of(text);
  };
  EXPECT_THAT(refuse("lower = 0.1", "lower = 11"),
              HasSubstr("p.toml:5: variable[0].lower is 11; it must be less than upper"));
  EXPECT_THAT(refuse("lower = 0.1", "lower = 0"), HasSubstr("variable[0]"));
  EXPECT_THAT(refuse("type = \"integer\"", "type = \"whole\""),
              HasSubstr("p.toml:10: unknown variable[1].type 'whole'"));
  EXPECT_THAT(refuse("start = \"thick, old\"", "start = \"thick\""),
              HasSubstr("it must be one of its choices: thin, thick, old"));
  EXPECT_THAT(refuse("name = \"steps\"", "name = \"gain\""),
              HasSubstr("p.toml:9: variable[1].name is 'gain', which another one has"));
  EXPECT_THAT(refuse("name = \"noise\"", "name = \"missing\""),
              HasSubstr("p.toml:25: metric[0].name is \"missing\"; the tables of armwright ask"));
  EXPECT_THAT(refuse("unit = \"mm\"", "json = \"/error\""),
              HasSubstr("p.toml:20: unknown key objective[0].json"));
  EXPECT_THAT(refuse("limit = 60", "limit = -1"), HasSubstr("constraint[0].limit is -1"));
  EXPECT_THAT(folder.refusal_of(good + "[command]\nrun = \"true\"\n"), HasSubstr("unknown key"));
  EXPECT_THAT(folder.refusal_of(good + "[cases]\ntraining = 3\n"), HasSubstr("unknown key"));
  EXPECT_THAT(folder.refusal_of(good.substr(0, good.find("[[objective]]"))),
              HasSubstr("[[objective]] is empty; a problem needs one objective or more"));
}

}  // namespace
}  // namespace armwright
