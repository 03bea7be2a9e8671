// Tests the contract (study/contract/contract.hpp) of every optimizer in the table, also of future
// ones, and tests that the suite itself finds broken promises.
#include <gmock/gmock.h>

#include <algorithm>
#include <cctype>
#include <memory>
#include <thread>

#include "optimizers/table/optimizer_table.hpp"
#include "study/contract/contract.hpp"

namespace armwright {
namespace {

using testing::HasSubstr;

std::string make_test_name(std::string text) {
  std::ranges::replace_if(
      text, [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; }, '_');
  return text;
}

const ContractCheck& find_check(const std::string& name) {
  return *std::ranges::find(contract_checks(), name, &ContractCheck::name);
}

std::vector<std::string> check_names() {
  std::vector<std::string> names;
  std::ranges::transform(contract_checks(), std::back_inserter(names),
                         [](const ContractCheck& check) { return std::string(check.name); });
  return names;
}

class OptimizerContract : public testing::TestWithParam<std::tuple<std::string, std::string>> {};

TEST_P(OptimizerContract, Holds) {
  const OptimizerRow& row = find_optimizer(std::get<0>(GetParam()));
  if (!row.unavailable.empty()) {
    GTEST_SKIP() << row.unavailable;
  }
  const Options options = Options::parse(row.name, row.options, {});
  const ContractFinding finding =
      run_contract_check(find_check(std::get<1>(GetParam())), row, options);
  EXPECT_NE(finding.outcome, ContractOutcome::broken) << finding.detail;
}

INSTANTIATE_TEST_SUITE_P(Table, OptimizerContract,
                         testing::Combine(testing::ValuesIn(optimizer_names()),
                                          testing::ValuesIn(check_names())),
                         [](const auto& parameters) {
                           return make_test_name(std::get<0>(parameters.param) + "_" +
                                                 std::get<1>(parameters.param));
                         });

class OptimizerRowContract : public testing::TestWithParam<std::string> {};

TEST_P(OptimizerRowContract, DescribesItself) {
  const OptimizerRow& row = find_optimizer(GetParam());
  EXPECT_FALSE(row.summary.empty());
  EXPECT_FALSE(row.source.empty());
  EXPECT_EQ(std::ranges::count(optimizer_names(), row.name), 1);
}

TEST_P(OptimizerRowContract, EveryDefaultIsAllowedAndReadsBack) {
  const OptimizerRow& row = find_optimizer(GetParam());
  std::vector<std::string> assignments;
  for (const OptionSpec& spec : row.options) {
    EXPECT_FALSE(spec.description.empty()) << spec.name;
    assignments.push_back(spec.name + "=" + to_text(spec.fallback));
  }
  const Options given = Options::parse(row.name, row.options, assignments);
  EXPECT_EQ(given.values(), Options::parse(row.name, row.options, {}).values());
}

INSTANTIATE_TEST_SUITE_P(Table, OptimizerRowContract, testing::ValuesIn(optimizer_names()),
                         [](const auto& parameters) { return make_test_name(parameters.param); });

// Optimizers that break one promise each. The suite must find all of them.
using Minimize = std::function<void(Evaluator&, std::uint64_t)>;

class FunctionOptimizer : public Optimizer {
 public:
  explicit FunctionOptimizer(Minimize minimize) : minimize_(std::move(minimize)) {}
  void minimize(Evaluator& evaluator, std::uint64_t seed) override { minimize_(evaluator, seed); }

 private:
  Minimize minimize_;
};

OptimizerRow make_row(Minimize minimize, Capabilities capabilities = {}) {
  OptimizerRow row;
  row.name = "broken";
  row.capabilities = capabilities;
  row.make = [minimize](const Options&) { return std::make_unique<FunctionOptimizer>(minimize); };
  return row;
}

std::vector<double> get_start(const Evaluator& evaluator) {
  std::vector<double> start;
  for (const DecisionVariable& variable : evaluator.problem().variables) {
    start.push_back(variable.start);
  }
  return start;
}

void ask(Evaluator& evaluator, const std::vector<double>& x) {
  evaluator.evaluate({&x, 1});
}

ContractFinding find(const char* check, const OptimizerRow& row) {
  return run_contract_check(find_check(check), row, Options::parse(row.name, row.options, {}));
}

#define EXPECT_BROKEN(check, row, text)                  \
  {                                                      \
    const ContractFinding finding = find(check, row);    \
    EXPECT_EQ(finding.outcome, ContractOutcome::broken); \
    EXPECT_THAT(finding.detail, HasSubstr(text));        \
  }

TEST(ContractSuite, FindsOutWhoIgnoresTheEnd) {
  const OptimizerRow row = make_row([](Evaluator& evaluator, std::uint64_t) {
    for (int i = 0; i < 300; ++i) {
      ask(evaluator, get_start(evaluator));
    }
  });
  EXPECT_BROKEN("Budget", row, "on sphere: with a budget of 1 it went on asking 299 times");
  EXPECT_BROKEN("ZeroBudget", row, "without a budget");
  EXPECT_BROKEN("Stop", row, "stopped after 1 evaluations");
}

TEST(ContractSuite, FindsOutWhoIsSlowToStop) {
  const OptimizerRow row = make_row([](Evaluator& evaluator, std::uint64_t) {
    ask(evaluator, get_start(evaluator));
    std::this_thread::sleep_for(std::chrono::milliseconds(1200));
  });
  EXPECT_BROKEN("Stop", row, "s to return");
}

TEST(ContractSuite, FindsOutWhoAsksForNonsense) {
  const auto asking_for = [](double value) {
    return make_row([value](Evaluator& evaluator, std::uint64_t) {
      std::vector<double> x = get_start(evaluator);
      x[0] = value;
      ask(evaluator, x);
    });
  };
  EXPECT_BROKEN("Points", asking_for(NAN), "no finite number");
  EXPECT_BROKEN("Points", asking_for(1e9), "outside the bounds");
  EXPECT_BROKEN("Points", make_row([](Evaluator& e, std::uint64_t) { ask(e, {}); }), "dimension");
}

TEST(ContractSuite, FindsOutWhoAsksForFractions) {
  const auto asking_for = [](std::size_t place, Capabilities capabilities) {
    return make_row(
        [place](Evaluator& evaluator, std::uint64_t) {
          std::vector<double> x = get_start(evaluator);
          x[place % x.size()] += 0.25;
          ask(evaluator, x);
        },
        capabilities);
  };
  EXPECT_BROKEN("Types", asking_for(2, {.integer = true}),
                "on mixed_bowl: evaluation 0 asks for teeth = 20.25, and it declares 'integer'");
  EXPECT_BROKEN("Types", asking_for(0, {.categorical = true}),
                "asks for oil = 0.25, and it declares 'categorical'");
  EXPECT_EQ(find("Types", asking_for(0, {})).outcome, ContractOutcome::exempt);
}

TEST(ContractSuite, FindsOutWhoIsNotRepeatable) {
  auto calls = std::make_shared<int>(0);
  const OptimizerRow row = make_row([calls](Evaluator& evaluator, std::uint64_t) {
    std::vector<double> x = get_start(evaluator);
    x[0] += 1e-3 * ++*calls;
    ask(evaluator, x);
  });
  EXPECT_BROKEN("Repeatable", row, "on sphere: evaluation 0 differs");
  EXPECT_BROKEN("Memory", row, "evaluation 0 differs");
  EXPECT_BROKEN("Seed", row, "does not declare 'stochastic'");
}

TEST(ContractSuite, FindsOutWhoMisdeclares) {
  const Minimize one = [](Evaluator& evaluator, std::uint64_t) {
    ask(evaluator, get_start(evaluator));
  };
  EXPECT_BROKEN("Seed", make_row(one, {.stochastic = true}), "give the same run");
  EXPECT_BROKEN("Batches", make_row(one, {.batch = true}), "one point at a time");
  EXPECT_BROKEN("Batches", make_row(one, {.generations = true}), "begins none");
  EXPECT_BROKEN("Learning", make_row(one), "no better than random search");
  EXPECT_EQ(find("Constraints", make_row(one)).outcome, ContractOutcome::exempt);
  EXPECT_BROKEN("Constraints", make_row(one, {.constraints = true}),
                "on constrained: its best feasible value is 38.75");
}

TEST(ContractSuite, FindsOutWhoPlansWithTheBudget) {
  const OptimizerRow row = make_row([](Evaluator& evaluator, std::uint64_t) {
    std::vector<double> x = get_start(evaluator);
    x[0] += 1e-6 * static_cast<double>(evaluator.remaining());
    ask(evaluator, x);
  });
  EXPECT_BROKEN("Beginning", row, "declare 'paced'");
  OptimizerRow honest = row;
  honest.capabilities.paced = true;
  EXPECT_EQ(find("Beginning", honest).outcome, ContractOutcome::exempt);
}

TEST(ContractSuite, FindsOutWhoSwallowsExceptions) {
  const OptimizerRow row = make_row([](Evaluator& evaluator, std::uint64_t) {
    try {
      ask(evaluator, get_start(evaluator));
    } catch (...) {
    }
  });
  EXPECT_BROKEN("Exceptions", row, "swallowed");
}

TEST(ContractSuite, FindsOutWhoGivesUp) {
  const OptimizerRow row = make_row([](Evaluator&, std::uint64_t) {});
  EXPECT_BROKEN("Budget", row, "no evaluation at all");
  EXPECT_BROKEN("Failures", row, "found nothing");
}

TEST(ContractSuite, FindsOutWhoLeaks) {
  auto kept = std::make_shared<std::vector<std::unique_ptr<std::vector<double>>>>();
  const OptimizerRow row = make_row([kept](Evaluator& evaluator, std::uint64_t) {
    kept->push_back(std::make_unique<std::vector<double>>(100));
    ask(evaluator, get_start(evaluator));
  });
#if defined(__SANITIZE_ADDRESS__)
  GTEST_SKIP() << "the sanitizer's allocator keeps no such account";
#endif
  EXPECT_BROKEN("Leaks", row, "bytes behind");
}

TEST(ContractSuite, FindsOutWhoCannotBeResumed) {
  auto calls = std::make_shared<int>(0);
  const OptimizerRow row = make_row([calls](Evaluator& evaluator, std::uint64_t) {
    std::vector<double> x = get_start(evaluator);
    x[0] += 1e-3 * ++*calls;
    while (!evaluator.stopped()) {
      ask(evaluator, x);
    }
  });
  EXPECT_BROKEN("Resume", row, "is not what optimizer 'broken' asks for now");
}

}  // namespace
}  // namespace armwright
