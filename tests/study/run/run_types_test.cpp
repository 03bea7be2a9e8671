// Tests runs on a problem with discrete variables: the problem gets values of their types only, and
// the journal has what the optimizer asked for.
#include <gmock/gmock.h>
#include <sqlite3.h>

#include <array>
#include <functional>

#include "base/expect_error.hpp"
#include "base/random.hpp"
#include "study/contract/contract_checks.hpp"
#include "study/run/run.hpp"
#include "study/run_support.hpp"

namespace armwright {
namespace {

using testing::AllOf;
using testing::Each;
using testing::HasSubstr;
using testing::IsEmpty;

class CalledOptimizer : public Optimizer {
 public:
  explicit CalledOptimizer(const std::function<void(Evaluator&)>& body) : body_(body) {}
  void minimize(Evaluator& evaluator, std::uint64_t /*seed*/) override { body_(evaluator); }

 private:
  const std::function<void(Evaluator&)>& body_;
};

// Draws points uniformly between the bounds that the optimizer is given.
void draw_points(Evaluator& evaluator) {
  RandomStream random("test/types");
  while (!evaluator.stopped()) {
    std::vector<std::vector<double>> points(8);
    for (std::vector<double>& point : points) {
      for (const DecisionVariable& variable : evaluator.problem().variables) {
        point.push_back(random.uniform(variable.lower, variable.upper));
      }
    }
    evaluator.evaluate(points);
  }
}

class VariableTypes : public RunTest {
 protected:
  RunPlan make_plan(Capabilities capabilities = {}) {
    RunPlan plan;
    plan.optimizer.name = "called";
    plan.optimizer.capabilities = capabilities;
    plan.optimizer.make = [this](const Options&) {
      return std::make_unique<CalledOptimizer>(body_);
    };
    plan.problem.problem = make_contract_problems(plan.optimizer).back();  // mixed_bowl
    plan.problem.name = plan.problem.problem->description().name;
    plan.problem.resolved_json = "{}";
    plan.budget = 60;
    return plan;
  }

  std::function<void(Evaluator&)> body_ = draw_points;
};

TEST_F(VariableTypes, TheJournalHasBothWhatWasAskedForAndWhatWasEvaluated) {
  const RunPlan plan = make_plan();
  const auto result = run(plan, "a");
  ASSERT_TRUE(result);
  EXPECT_EQ(result->counts.evaluations, 60u);
  EXPECT_EQ(result->counts.clipped, 0u) << "the wider bounds are the optimizer's own";
  const auto& variables = plan.problem.problem->description().variables;
  for (const EvaluationRecord& record : read("a").training) {
    ASSERT_EQ(record.proposed.size(), variables.size());
    for (std::size_t i = 0; i < variables.size(); ++i) {
      EXPECT_EQ(record.x[i], settle_value(variables[i], record.proposed[i]));
    }
    EXPECT_EQ(record.x[1], record.proposed[1]) << "a real variable";
  }
}

TEST_F(VariableTypes, WholePointsHaveNoProposal) {
  body_ = [](Evaluator& evaluator) {
    const std::vector<std::vector<double>> points(4, {3, 0.25, 7, 100});
    while (!evaluator.stopped()) {
      evaluator.evaluate(points);
    }
  };
  for (const Capabilities& capabilities :
       {Capabilities{}, Capabilities{.integer = true, .categorical = true}}) {
    const std::string folder = capabilities.integer ? "native" : "rounded";
    run(make_plan(capabilities), folder);
    for (const EvaluationRecord& record : read(folder).training) {
      EXPECT_EQ(record.x, (std::vector<double>{3, 0.25, 7, 100}));
      EXPECT_THAT(record.proposed, IsEmpty());
    }
  }
}

TEST_F(VariableTypes, ABrokenPromiseOfWholeNumbersIsRoundedToo) {
  ASSERT_TRUE(run(make_plan({.integer = true, .categorical = true}), "a"));
  const EvaluationRecord record = read("a").training.front();
  EXPECT_NE(record.x[0], record.proposed[0]);
}

// A proposal that rounds to the same point is still another request.
TEST_F(VariableTypes, ARunIsContinuedOnlyWithTheSameProposals) {
  double shift = 0;
  body_ = [&](Evaluator& evaluator) {
    for (int i = 0; !evaluator.stopped(); ++i) {
      evaluator.evaluate(std::vector<std::vector<double>>{{1.25 + shift, 0.5, 3, 1 + 1.0 * i}});
    }
  };
  StopSignal stop;
  StoppingObserver observer(stop, 20);
  ASSERT_FALSE(execute_run({make_plan(), temporary_ / "a", 1, {}}, stop, observer));
  shift = 0.125;
  EXPECT_THAT(error_of(ErrorKind::bad_data, [&] { run(make_plan(), "a"); }),
              AllOf(HasSubstr("evaluation 0 of the journal is not what optimizer 'called' asks"),
                    HasSubstr("oil was 1.25 and is now 1.375")));
  shift = 0;
  EXPECT_TRUE(run(make_plan(), "a"));
}

TEST_F(VariableTypes, RecommendationsAreRoundedBeforeAndAfterTheEnd) {
  body_ = [](Evaluator& evaluator) {
    evaluator.recommend(std::vector<double>{2.375, 0.3, 6.75, 90.25});
    draw_points(evaluator);
    evaluator.recommend(std::vector<double>{1.75, 0.3125, 7.25, 89.75});
  };
  const auto result = run(make_plan(), "a");
  ASSERT_TRUE(result && result->winner);
  int recommended = 0;
  for (const JudgedCandidate& judged : result->judged) {
    if (judged.candidate.recommended) {
      ++recommended;
      EXPECT_THAT(
          (std::vector{judged.candidate.x[0], judged.candidate.x[2], judged.candidate.x[3]}),
          testing::ElementsAre(2, 7, 90));
    }
  }
  EXPECT_EQ(recommended, 2);
  EXPECT_TRUE(result->judged[*result->winner].candidate.recommended);
}

// Returns the rows of a query, the columns of each joined by '|'.
std::vector<std::string> query(const std::filesystem::path& file, const char* sql) {
  sqlite3* database = nullptr;
  EXPECT_EQ(sqlite3_open_v2(file.c_str(), &database, SQLITE_OPEN_READONLY, nullptr), SQLITE_OK);
  std::vector<std::string> rows;
  const auto add_row = [](void* list, int columns, char** values, char** /*names*/) {
    std::string row;
    for (int i = 0; i < columns; ++i) {
      row += std::string(i == 0 ? "" : "|") + (values[i] == nullptr ? "NULL" : values[i]);
    }
    static_cast<std::vector<std::string>*>(list)->push_back(row);
    return 0;
  };
  EXPECT_EQ(sqlite3_exec(database, sql, add_row, &rows, nullptr), SQLITE_OK) << sql;
  sqlite3_close(database);
  return rows;
}

TEST_F(VariableTypes, TheDatabaseHasTypesAndProposals) {
  body_ = [](Evaluator& evaluator) {
    evaluator.evaluate(std::vector<std::vector<double>>{{2, 0.5, 3, 10}, {1.25, 0.5, 3, 9.75}});
  };
  ASSERT_TRUE(run(make_plan(), "a"));
  const auto file = temporary_ / "a" / "results.sqlite";
  EXPECT_THAT(query(file, "SELECT * FROM discrete_variable ORDER BY position"),
              testing::ElementsAre(R"(0|category|["thin","light","medium","heavy","thick"])",
                                   "2|integer|[]", "3|integer|[]"));
  EXPECT_THAT(query(file, "SELECT * FROM proposal"), testing::ElementsAre("1|[1.25,0.5,3.0,9.75]"));
  EXPECT_THAT(query(file, "SELECT number, x FROM evaluation WHERE role = 'training'"),
              testing::ElementsAre("0|[2.0,0.5,3.0,10.0]", "1|[1.0,0.5,3.0,10.0]"));
}

TEST_F(VariableTypes, TheResultNamesTypesAndTheFrontHasWords) {
  body_ = [](Evaluator& evaluator) {
    evaluator.evaluate(std::vector<std::vector<double>>{{3, 0.5, -3, 10}});
  };
  const auto result = run(make_plan(), "a");
  ASSERT_TRUE(result && result->winner);
  const RunResult read_back = parse_result(read_result("a"), "result.json");
  EXPECT_EQ(to_json(read_back), read_result("a"));
  ASSERT_EQ(read_back.discrete_variables.size(), 3u);
  EXPECT_EQ(find_discrete(read_back, 1), nullptr) << "a real variable";
  EXPECT_EQ(format_value(*find_discrete(read_back, 0), 3), "heavy");
  EXPECT_EQ(format_value(*find_discrete(read_back, 2), -3), "-3");
  EXPECT_THAT(read_file(temporary_ / "a" / "front.csv", 1 << 16), HasSubstr(",heavy,0.5,-3,10\n"));
  run(make_small_plan(), "real");
  EXPECT_THAT(read_result("real"), testing::Not(HasSubstr("discrete_variables")));
}

TEST_F(VariableTypes, AResultWithDamagedTypesIsRefused) {
  ASSERT_TRUE(run(make_plan(), "a"));
  const std::string result = read_result("a");
  for (const auto& [from, to, reason] : std::vector<std::array<std::string, 3>>{
           {R"("type": "integer")", R"("type": "word")", "unknown type"},
           {R"("name": "teeth",)", R"("name": "tooth",)", "is none of its variables"},
           {R"("thin",)", R"("thin", 3,)", "type must be string"}}) {
    std::string damaged = result;
    const std::size_t place = damaged.rfind(from);
    ASSERT_NE(place, std::string::npos) << from;
    damaged.replace(place, from.size(), to);
    EXPECT_THAT(error_of(ErrorKind::bad_data, [&] { parse_result(damaged, "result.json"); }),
                HasSubstr(reason));
  }
}

TEST_F(VariableTypes, TheDatabaseOfRealVariablesHasTheTablesOfVersionOne) {
  run(make_small_plan(), "a");
  EXPECT_THAT(query(temporary_ / "a" / "results.sqlite",
                    "SELECT name FROM sqlite_master WHERE type = 'table' ORDER BY name"),
              testing::ElementsAre("case_error", "evaluation", "metric", "variable"));
}

}  // namespace
}  // namespace armwright
