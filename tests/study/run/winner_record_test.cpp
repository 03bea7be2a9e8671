// Tests the files of a winner of a user's problem.
#include "study/run/winner_record.hpp"

#include <filesystem>

#include "base/error.hpp"
#include "problems/config/values_file.hpp"
#include "study/own_problem.hpp"
#include "study/run_support.hpp"

namespace armwright {
namespace {

class WinnerRecord : public RunTest {
 protected:
  RunPlan make_plan(bool has_records) {
    UserDescription description = describe_own();
    description.has_records = has_records;
    RunPlan plan;
    plan.problem = make_own_problem(description, std::make_shared<OwnProblemCounts>());
    plan.optimizer = load_optimizer("lhs");
    plan.options = Options::parse("lhs", plan.optimizer.options, {});
    plan.budget = 10;
    plan.schedule = plan.problem.schedule;
    return plan;
  }
  std::string read_text(const std::string& name) {
    return read_file(temporary_ / name, std::size_t{1} << 20);
  }
};

TEST_F(WinnerRecord, IsWrittenAndMadeAgainWhereItIsMissing) {
  ASSERT_TRUE(run(make_plan(true), "run"));
  const std::string csv = read_text("run/winner-record.csv");
  EXPECT_EQ(csv.substr(0, csv.find('\n')), "time [s],speed [rad/s]");
  for (const char* name : {"run/winner-files/note.txt", "run/winner-record.csv"}) {
    std::filesystem::remove(temporary_ / name);
    ASSERT_TRUE(run(make_plan(true), "run"));
    EXPECT_EQ(read_text("run/winner-files/note.txt"), "the best\n");
    EXPECT_EQ(read_text("run/winner-record.csv"), csv);
  }
}

TEST_F(WinnerRecord, AReplicateOfAComparisonHasTheSameFiles) {
  RunPlan plan = make_plan(true);
  plan.problem = make_replicate(plan.problem, 1, "train/study-1", {1, 2});
  ASSERT_NE(find_user_description(*plan.problem.problem), nullptr);
  ASSERT_TRUE(run(plan, "run"));
  EXPECT_NE(read_text("run/winner.toml").find("name = \"n\""), std::string::npos);
  EXPECT_TRUE(path_exists(temporary_ / "run/winner-record.csv"));
  plan.problem = make_replicate(make_own_problem(describe_own(), nullptr), 1, "train/1", {1, 2});
  EXPECT_THROW(require_server(*plan.problem.problem), Error);
}

TEST_F(WinnerRecord, IsAbsentIfTheProblemRecordsNothing) {
  ASSERT_TRUE(run(make_plan(false), "run"));
  EXPECT_FALSE(path_exists(temporary_ / "run/winner-record.csv"));
}

TEST_F(WinnerRecord, TheWinnersFileReadsBackBitForBit) {
  const auto result = run(make_plan(false), "run");
  ASSERT_TRUE(result && result->winner);
  const auto file = temporary_ / "run/winner.toml";
  DecisionVariable any = describe_own().variables[0];
  DecisionVariable other = any;
  other.name = "n";
  const auto x = result->judged[*result->winner].candidate.x;
  EXPECT_TRUE(same_bits(read_values(load_values(file), file, {any, other}), x));
  EXPECT_THROW(read_values(load_values(file), file, {any}), Error);  // of another problem
}

}  // namespace
}  // namespace armwright
