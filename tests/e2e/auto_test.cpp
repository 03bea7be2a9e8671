// The optimizer `auto` on the command line: what it says, where its choice stands, its rules.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "base/temporary_folder.hpp"
#include "e2e/program.hpp"

namespace armwright {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

class CliAuto : public testing::Test {
 protected:
  Outcome run(const std::vector<std::string>& words) { return run_program(folder_.path(), words); }
  void write_rules(const std::string& use) {
    std::ofstream(folder_ / "rules.toml")
        << "[[rule]]\nuse = \"" + use + "\"\nwhy = \"It is ours.\"\n";
  }
  const TemporaryFolder folder_;
};

TEST_F(CliAuto, SaysWhatItChoseAndTheResultKeepsIt) {
  const Outcome made = run({"optimize", "branin", "--optimizer", "auto", "--budget", "60"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const std::string choice =
      "auto chose turbo for 2 variables, 1 objective and 60 evaluations. With so few evaluations";
  EXPECT_THAT(made.err, HasSubstr(choice));
  const std::string result = read_text(folder_ / "results/branin-auto-seed1/result.json");
  EXPECT_THAT(json::parse(result).at("choice").get<std::string>(), testing::StartsWith(choice));
  EXPECT_THAT(run({"show", "results/branin-auto-seed1"}).out, HasSubstr("auto chose turbo for"));
}

TEST_F(CliAuto, AnyNumberOfThreadsGivesTheSameResult) {
  for (const char* jobs : {"1", "3"}) {
    ASSERT_EQ(run({"optimize", "rastrigin", "--optimizer", "auto", "--budget", "450", "--quiet",
                   "--jobs", jobs, "--out", jobs})
                  .exit_code,
              0);
  }
  EXPECT_EQ(read_text(folder_ / "1/result.json"), read_text(folder_ / "3/result.json"));
}

TEST_F(CliAuto, RulesOfTheUserHoldAndARunWithOthersIsRefused) {
  write_rules("ga");
  const std::vector<std::string> words = {"optimize", "sphere",           "--optimizer", "auto",
                                          "--opt",    "rules=rules.toml", "--budget",    "30"};
  const Outcome made = run(words);
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_THAT(made.err, HasSubstr("auto chose ga for 10 variables, 1 objective, 30 "
                                  "evaluations and residuals. It is ours."));
  write_rules("cmaes");
  const Outcome changed = run(words);
  EXPECT_EQ(changed.exit_code, 2);
  EXPECT_THAT(changed.err, HasSubstr("the input 'rules.toml' has changed"));
  write_rules("turbo");
  EXPECT_THAT(run(words).err, AllOf(HasSubstr("rules.toml:2: rule[0].use is \"turbo\""),
                                    HasSubstr("must have an optimizer for every problem")));
}

TEST_F(CliAuto, AContinuedRunKeepsItsChoice) {
  const std::vector<std::string> words = {"optimize", "branin", "--optimizer", "auto", "--budget"};
  ASSERT_EQ(run(words + std::vector<std::string>{"60"}).exit_code, 0);
  const Outcome continued = run(words + std::vector<std::string>{"220"});
  ASSERT_EQ(continued.exit_code, 0) << continued.err;
  EXPECT_THAT(continued.err,
              AllOf(HasSubstr("continuing with a budget of 220 in place of 60"),
                    HasSubstr("kept turbo, which auto chose for 2 variables, 1 objective and 60 "
                              "evaluations.")));
  EXPECT_THAT(run({"show", "results/branin-auto-seed1"}).out, HasSubstr("kept turbo, which auto"));
}

TEST_F(CliAuto, ListShowsItsRules) {
  const std::string text = run({"list", "optimizers", "auto"}).out;
  EXPECT_THAT(text, AllOf(HasSubstr("pagmo:maco"), HasSubstr("variables <= 25"),
                          HasSubstr("configs/auto.toml")));
  const json rules = json::parse(run({"list", "optimizers", "auto", "--json"}).out).at("rules");
  EXPECT_EQ(rules.front().at("conditions").at("objectives").at("at_least"), 2);
  EXPECT_EQ(rules.front().at("conditions").at("constraints"), false);
  EXPECT_EQ(rules.back().at("conditions"), json::object());
}

}  // namespace
}  // namespace armwright
