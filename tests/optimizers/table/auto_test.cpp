#include "optimizers/table/auto.hpp"

#include <gmock/gmock.h>

#include <algorithm>

#include "base/expect_error.hpp"
#include "base/file.hpp"
#include "base/temporary_folder.hpp"
#include "optimizers/run_optimizer.hpp"
#include "optimizers/table/auto_probe.hpp"
#include "optimizers/table/auto_rules.hpp"
#include "optimizers/test_problems.hpp"
#include "problems/analytic/analytic.hpp"
#include "study/contract/contract_checks.hpp"

namespace armwright {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

constexpr const char* kLast = "[[rule]]\nuse = \"cmaes\"\nwhy = \"It is for all.\"\n";

class AutoRules : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& text) const {
    const auto file = folder_ / "my.toml";
    write_file_atomically(file, text);
    return file;
  }
  std::vector<AutoRule> read(const std::string& text) const { return load_auto_rules(write(text)); }
  // Returns the message without the folder.
  std::string refuse(const std::string& text) const {
    const std::string message = usage_error_of([&] { read(text); });
    EXPECT_THAT(message, StartsWith((folder_ / "my.toml").string()));
    return message.substr(folder_.path().string().size() + 1);
  }
  TemporaryFolder folder_;
};

std::string choose(const std::vector<AutoRule>& rules, const ProblemDescription& problem,
                   std::int64_t evaluations = 500, bool may_change_cases = false) {
  AutoFeatures features = calc_auto_features(problem, evaluations, may_change_cases);
  return describe_used(choose_rule(rules, features, problem, [] { return false; }));
}

ProblemDescription make_description(std::size_t variables = 3) {
  ProblemDescription problem;
  problem.objectives = {{"f", ""}};
  for (std::size_t i = 0; i < variables; ++i) {
    problem.variables.push_back({"x" + std::to_string(i), "", 1, 9, 5, Scale::linear});
  }
  return problem;
}

TEST_F(AutoRules, TheFirstRuleThatHoldsWins) {
  const auto rules = read(
      "[[rule]]\nevaluations_at_least = 100\nevaluations_at_most = 200\nuse = \"ga\"\n"
      "why = \"One.\"\n[[rule]]\nevaluations_at_least = 200\nuse = \"random\"\nwhy = \"Two.\"\n" +
      std::string(kLast));
  const ProblemDescription problem = make_description();
  EXPECT_EQ(choose(rules, problem, 99), "cmaes");
  EXPECT_EQ(choose(rules, problem, 100), "ga");
  EXPECT_EQ(choose(rules, problem, 200), "ga");
  EXPECT_EQ(choose(rules, problem, 201), "random");
}

// Every condition, on a problem that meets it and on one that does not.
TEST_F(AutoRules, EveryConditionIsOfItsFeature) {
  const ProblemDescription plain = make_description();
  const auto rule_of = [&](const std::string& condition) {
    return read("[[rule]]\n" + condition + "\nuse = \"ga\"\nwhy = \"One.\"\n" + kLast);
  };
  const auto expect = [&](const std::string& condition, const ProblemDescription& met,
                          const ProblemDescription& not_met) {
    EXPECT_EQ(choose(rule_of(condition), met), "ga") << condition;
    EXPECT_EQ(choose(rule_of(condition), not_met), "cmaes") << condition;
  };
  ProblemDescription other = make_description();
  other.has_residuals = true;
  expect("residuals = true", other, plain);
  expect("residuals = false", plain, other);
  other = make_description();
  other.constraints = {{"g", ""}};
  expect("constraints = true", other, plain);
  other = make_description();
  other.objectives.push_back({"g", ""});
  expect("objectives_at_least = 2", other, plain);
  other = make_description();
  other.variables[1].type = VariableType::integer;
  expect("integers = true", other, plain);
  other.variables[1].type = VariableType::category;
  expect("categories = true", other, plain);
  other = make_description();
  other.variables[0].scale = Scale::logarithmic;
  const ProblemDescription mixed = other;
  for (DecisionVariable& variable : other.variables) {
    variable.scale = Scale::logarithmic;
  }
  expect("logarithmic = true", other, mixed);
  expect("variables_at_most = 2", make_description(2), plain);
  expect("variables_at_least = 4", make_description(4), plain);
  expect("evaluations_per_variable_at_least = 200", make_description(2), plain);  // 500 evaluations
  const auto changing = rule_of("changing_cases = true");
  EXPECT_EQ(choose(changing, plain, 500, true), "ga");
  EXPECT_EQ(choose(changing, plain, 500, false), "cmaes");
}

TEST_F(AutoRules, SkipOptimizersThatCannotWork) {
  const auto rules = [&](const std::string& name) {
    return read("[[rule]]\nvariables_at_least = 1\nuse = \"" + name + "\"\nwhy = \"One.\"\n" +
                kLast);
  };
  ProblemDescription problem = make_description();
  EXPECT_EQ(choose(rules("dfls"), problem), "cmaes");  // no residuals
  problem.has_residuals = true;
  EXPECT_EQ(choose(rules("dfls"), problem), "dfls");
  EXPECT_EQ(choose(rules("dfls"), problem, 500, true), "cmaes");  // no generations
  EXPECT_EQ(choose(rules("turbo"), problem, 2000), "turbo");
  EXPECT_EQ(choose(rules("turbo"), problem, 2001), "cmaes");  // too many evaluations
  EXPECT_EQ(choose(rules("turbo"), make_description(41)), "cmaes");
}

TEST_F(AutoRules, ProbeOnlyIfTheAnswerDecides) {
  const auto rules = read(
      "[[rule]]\nrugged = true\nresiduals = true\nuse = \"ga\"\nwhy = \"One.\"\n"
      "[[rule]]\nrugged = false\nresiduals = true\nuse = \"random\"\nwhy = \"Two.\"\n" +
      std::string(kLast));
  ProblemDescription problem = make_description();
  int probes = 0;
  const auto choose_on = [&](bool is_rugged) {
    AutoFeatures features = calc_auto_features(problem, 500, false);
    const auto probe = [&] {
      ++probes;
      return is_rugged;
    };
    return describe_used(choose_rule(rules, features, problem, probe));
  };
  EXPECT_EQ(choose_on(true), "cmaes");
  EXPECT_EQ(probes, 0);
  problem.has_residuals = true;
  EXPECT_EQ(choose_on(true), "ga");
  EXPECT_EQ(choose_on(false), "random");
  EXPECT_EQ(probes, 2);
}

TEST(AutoProbe, TellsRuggedFromSmoothWithAtMostATwentiethOfTheBudget) {
  const auto probe = [](const char* name, std::uint64_t seed, std::int64_t budget) {
    const auto problem = make_analytic(name);
    MemoryEvaluator evaluator(*problem, {.budget = budget});
    const bool answer = is_rugged(evaluator, seed, evaluator.remaining());
    EXPECT_LE(20 * evaluator.charged(), budget);
    EXPECT_LE(evaluator.batch_sizes().size(), 1u);
    return answer;
  };
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    EXPECT_TRUE(probe("rastrigin", seed, 1000));
    for (const char* smooth : {"sphere", "ellipsoid", "rosenbrock"}) {
      EXPECT_FALSE(probe(smooth, seed, 1000)) << smooth;
    }
  }
  EXPECT_FALSE(probe("rastrigin", 1, 399));  // too few for a probe
}

TEST_F(AutoRules, RefuseWhatIsWrongWithFileAndLine) {
  EXPECT_THAT(refuse("[[rule]]\nvariabels_at_most = 3\nuse = \"ga\"\nwhy = \"A.\"\n"),
              AllOf(HasSubstr("my.toml:2"), HasSubstr("variabels_at_most"),
                    HasSubstr("did you mean 'rule[0].variables_at_most'")));
  EXPECT_THAT(refuse("[[rule]]\nuse = \"cmeas\"\nwhy = \"A.\"\n"),
              AllOf(HasSubstr("my.toml:2: rule[0].use is \"cmeas\""), HasSubstr("cmaes")));
  EXPECT_THAT(refuse("[[rule]]\nuse = \"auto\"\nwhy = \"A.\"\n"),
              HasSubstr("my.toml:2: rule[0].use is \"auto\"; it must be another optimizer"));
  EXPECT_THAT(refuse("[[rule]]\nuse = \"multistart:ga\"\nwhy = \"A.\"\n"),
              HasSubstr("'ga' is no local optimizer"));
  EXPECT_THAT(refuse("[[rule]]\nuse = \"ga\"\noptions = [\"sigma=1\"]\nwhy = \"A.\"\n"),
              AllOf(HasSubstr("my.toml:3: rule[0].options: optimizer 'ga'"), HasSubstr("sigma")));
  EXPECT_THAT(refuse("[[rule]]\nuse = \"ga\"\nwhy = \"no period\"\n"),
              HasSubstr("my.toml:3: rule[0].why is \"no period\"; it must be a sentence"));
  EXPECT_THAT(refuse("[[rule]]\nuse = \"ga\"\n"), HasSubstr("why"));
  EXPECT_THAT(refuse(std::string(kLast) + kLast),
              HasSubstr("my.toml:5: rule[1].use is \"cmaes\"; it must stand before the rule "
                        "without conditions"));
  EXPECT_THAT(refuse("[[rule]]\nresiduals = true\nuse = \"ga\"\nwhy = \"A.\"\n"),
              HasSubstr("the last rule must have no conditions, so that one always holds; it has: "
                        "residuals"));
  EXPECT_THAT(refuse("[[rule]]\nuse = \"turbo\"\nwhy = \"A.\"\n"),
              HasSubstr("the last rule must have an optimizer for every problem"));
  EXPECT_THAT(refuse("[[rule]]\nevaluations_at_least = 9\nevaluations_at_most = 8\nuse = \"ga\"\n"
                     "why = \"A.\"\n"),
              HasSubstr("evaluations_at_most is 8; it must be at least evaluations_at_least, which "
                        "is 9"));
  EXPECT_THAT(refuse("rule = []\n"), HasSubstr("has no rule"));
}

// One problem per rule of the shipped file, so that no rule is hidden by those before it.
TEST(ShippedAutoRules, EveryRuleIsChosenForSomeProblem) {
  const auto rules = load_auto_rules(find_auto_rules(""));
  std::vector<std::string> chosen;
  const auto add = [&](const ProblemDescription& problem, std::int64_t evaluations,
                       bool may_change_cases = false) {
    chosen.push_back(choose(rules, problem, evaluations, may_change_cases));
  };
  ProblemDescription front = make_description();
  front.objectives.push_back({"g", ""});
  add(front, 500);
  add(make_description(), 500, true);
  ProblemDescription arm = make_description();
  arm.has_residuals = true;
  for (DecisionVariable& variable : arm.variables) {
    variable.scale = Scale::logarithmic;
  }
  add(arm, 18);
  ProblemDescription fit = make_description();
  fit.has_residuals = true;
  add(fit, 500);
  add(arm, 19);
  add(make_description(), 201);
  add(make_description(26), 500);
#ifdef ARMWRIGHT_WITH_PAGMO
  EXPECT_EQ(chosen.front(), "pagmo:maco");
#endif
  chosen.erase(chosen.begin());
  EXPECT_THAT(chosen, ElementsAre("cmaes", "dfls", "multistart:dfls", "turbo",
                                  "cmaes with surrogate=quadratic", "cmaes"));
}

TEST_F(AutoRules, SayWhatHeld) {
  ProblemDescription problem = make_description(1);
  problem.constraints = {{"g", ""}};
  EXPECT_EQ(describe_features(calc_auto_features(problem, 200, false)),
            "1 variable, 1 objective, 200 evaluations and constraints");
  const auto rules = read(
      "[[rule]]\nconstraints = false\nvariables_at_most = 20\nuse = \"cmaes\"\n"
      "options = [\"surrogate=quadratic\", \"sigma=0.1\"]\nwhy = \"A.\"\n" +
      std::string(kLast));
  EXPECT_EQ(describe_conditions(rules[0]), "variables <= 20, no constraints");
  EXPECT_EQ(describe_used(rules[0]), "cmaes with surrogate=quadratic, sigma=0.1");
  EXPECT_EQ(describe_conditions(rules[1]), "always");
}

// Runs auto with a file of rules and returns what it says.
class SayingEvaluator : public MemoryEvaluator {
 public:
  using MemoryEvaluator::MemoryEvaluator;
  void explain_choice(std::string_view sentences) override { said.emplace_back(sentences); }
  std::vector<std::string> said;
};

TEST_F(AutoRules, AutoSaysInTwoSentencesWhatItChoseAndRunsIt) {
  const auto file = write(kLast);
  const auto problem = make_analytic("sphere");
  SayingEvaluator evaluator(*problem, {.budget = 60});
  minimize_with("auto", evaluator, 3, {"rules=" + file.string()});
  EXPECT_THAT(evaluator.said,
              ElementsAre("auto chose cmaes for 10 variables, 1 objective, 60 evaluations and "
                          "residuals. It is for all."));
  const MemoryEvaluator chosen = run_optimizer("cmaes", *problem, {.budget = 60}, 3);
  EXPECT_EQ(evaluator.trace(), chosen.trace());
}

// Its variables are integers and categories, and Latin hypercubes treat both as real variables.
TEST_F(AutoRules, TheChosenOptimizerGetsTheVariablesThatItCanTreat) {
  const auto file = write("[[rule]]\nvariables_at_least = 1\nuse = \"pagmo:de\"\nwhy = \"A.\"\n" +
                          std::string(kLast));
  const OptimizerRow& row = find_optimizer("auto");
  const auto problem = make_contract_problems(row).back();
  ASSERT_EQ(problem->description().name, "mixed_bowl");
  MemoryEvaluator evaluator(*problem, {.budget = 200});
  minimize_with("auto", evaluator, 3, {"rules=" + file.string()});
  ASSERT_EQ(evaluator.trace().size(), 200u);
  std::vector<double> words;
  for (const auto& entry : evaluator.trace()) {
    EXPECT_EQ(entry.asked, entry.evaluated);
    words.push_back(entry.asked[0]);
  }
  EXPECT_THAT(words, testing::IsSupersetOf({0.0, 1.0, 2.0, 3.0, 4.0}));
}

TEST_F(AutoRules, AMissingFileIsRefusedBeforeTheRun) {
  const OptimizerRow& row = find_optimizer("auto");
  const auto optimizer = row.make(Options::parse("auto", row.options, {{"rules=none.toml"}}));
  EXPECT_THAT(error_of(ErrorKind::io, [&] { optimizer->check_problem({}); }),
              HasSubstr("none.toml"));
}

}  // namespace
}  // namespace armwright
