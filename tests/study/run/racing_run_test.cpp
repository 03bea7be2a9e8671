// Tests whole runs with races: exact budgets, the same result after interruptions and on any number
// of threads, and the benefit of races.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "base/expect_error.hpp"
#include "optimizers/table/optimizer_table.hpp"
#include "study/racing_support.hpp"
#include "study/run/run_folder.hpp"

namespace armwright {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr int kCases = 6;

RunPlan make_bowl_plan(const std::string& optimizer, std::int64_t budget, const std::string& racing,
                       const std::string& schedule = "fixed:6") {
  const std::vector<std::string> options =
      optimizer == "ga" ? std::vector<std::string>{"population=8"} : std::vector<std::string>{};
  return make_mean_plan(make_noisy_bowl(2, 0.5), optimizer, budget, schedule, racing, options);
}

std::uint64_t count_cases(const JournalContent& journal) {
  std::uint64_t cases = 0;
  for (const EvaluationRecord& record : journal.training) {
    cases += record.cases.numbers.size();
    EXPECT_EQ(record.evaluation.case_errors.size(), record.cases.numbers.size());
  }
  return cases;
}

class RacingOptimizers : public RunTest, public testing::WithParamInterface<std::string> {};

TEST_P(RacingOptimizers, NeverSpendMoreThanTheBudget) {
  const OptimizerRow& row = find_optimizer(GetParam());
  if (!row.unavailable.empty()) {
    GTEST_SKIP() << row.unavailable;
  }
  for (const std::string racing : {"halving:1:2", "abandonment:1:2"}) {
    const RunPlan plan = make_bowl_plan(GetParam(), 401, racing);
    if (!explain_unsuitable(row, plan.problem.problem->description()).empty()) {
      GTEST_SKIP() << "not for a problem of this kind";
    }
    const auto result = run(plan, racing);
    ASSERT_TRUE(result);
    EXPECT_EQ(result->failure, "");
    EXPECT_LE(result->counts.cases, 401u);
    const JournalContent journal = read(racing);
    EXPECT_EQ(count_cases(journal), result->counts.cases);
    for (const JudgedCandidate& judged : result->judged) {
      if (!judged.candidate.recommended) {
        EXPECT_EQ(journal.training[judged.candidate.evaluation].cases.numbers.size(), 6u);
      }
    }
    if (result->end_reason == "budget") {  // the rest of the budget was too small for a candidate
      EXPECT_GT(result->counts.cases + kCases, 401u);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Table, RacingOptimizers, testing::ValuesIn(optimizer_names()),
                         [](const auto& parameters) {
                           std::string name = parameters.param;
                           std::ranges::replace_if(
                               name, [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
                           return name;
                         });

struct Setting {
  std::string optimizer, schedule, racing;
};

std::vector<Setting> list_settings() {
  return {{"ga", "fixed:6", "halving"},         {"ga", "fresh:6", "halving"},
          {"ga", "coevolution:6", "none"},      {"ga", "coevolution:6", "halving:2:2"},
          {"random", "fixed:6", "halving:2:3"}, {"random", "fixed:6", "abandonment:1:2"},
          {"ga", "fresh:6", "abandonment:1:2"}};
}

TEST_F(RunTest, RacesDoNotDependOnThreadsOrInterruptions) {
  int number = 0;
  for (const auto& [optimizer, schedule, racing] : list_settings()) {
    SCOPED_TRACE(optimizer + " " + schedule + " " + racing);
    const RunPlan plan = make_bowl_plan(optimizer, 500, racing, schedule);
    const std::string one = std::to_string(++number);
    ASSERT_TRUE(run(plan, one, 1));
    ASSERT_TRUE(run(plan, one + "-threads", 3));
    expect_same_evaluations(read(one), read(one + "-threads"));
    EXPECT_EQ(read_result(one), read_result(one + "-threads"));
    int starts = 0;
    for (bool done = false; !done; ++starts) {
      ASSERT_LT(starts, 100);
      StopSignal stop;
      // More than a race costs; otherwise each life would start the same race again.
      StoppingObserver observer(stop, optimizer == "random" ? 250 : 60);
      done = execute_run({plan, temporary_ / (one + "-pieces"), 2, {}}, stop, observer).has_value();
    }
    EXPECT_GT(starts, 1) << "the run was never interrupted";
    expect_same_evaluations(read(one), read(one + "-pieces"));
    EXPECT_EQ(read_result(one), read_result(one + "-pieces"));
  }
}

// A kill while a race is written leaves such journals.
TEST_F(RunTest, ARaceThatIsRecordedInPartIsHeldAgain) {
  for (const auto& [optimizer, schedule, racing] : list_settings()) {
    SCOPED_TRACE(optimizer + " " + schedule + " " + racing);
    const RunPlan plan = make_bowl_plan(optimizer, 500, racing, schedule);
    const std::string whole = optimizer + schedule + racing;
    const std::string torn = whole + "-torn";
    ASSERT_TRUE(run(plan, whole));
    ASSERT_TRUE(run(plan, torn));
    const JournalContent content = read(whole);
    for (const std::size_t kept : {3U, 12U, 21U}) {
      std::filesystem::remove(temporary_ / torn / "journal");
      std::filesystem::remove(temporary_ / torn / "result.json");
      {
        JournalContent none;
        Journal journal(temporary_ / torn / "journal", none);
        for (std::size_t i = 0; i < kept; ++i) {
          journal.append(content.training[i]);
        }
        journal.append(content.training[kept + 1]);  // threads leave gaps
        journal.close();
      }
      ASSERT_TRUE(run(plan, torn));
      expect_same_evaluations(content, read(torn));
      EXPECT_EQ(read_result(whole), read_result(torn));
    }
  }
}

TEST_F(RunTest, AJournalOfAnotherRaceIsRefused) {
  for (const std::string racing : {"halving:1:2", "abandonment:1:2"}) {
    const RunPlan plan = make_bowl_plan("ga", 300, racing);
    ASSERT_TRUE(run(plan, racing));
    const JournalContent content = read(racing);
    const auto lost = std::ranges::find_if(content.training, [](const EvaluationRecord& record) {
      return record.evaluation.status == EvaluationStatus::abandoned;
    });
    ASSERT_NE(lost, content.training.end());
    const std::size_t at = lost.number();
    const auto resume_with = [&](const std::function<void(EvaluationRecord&)>& change) {
      std::filesystem::remove(temporary_ / racing / "journal");
      std::filesystem::remove(temporary_ / racing / "result.json");
      JournalContent none;
      Journal journal(temporary_ / racing / "journal", none);
      for (EvaluationRecord record : content.training) {
        if (record.index == at) {
          change(record);
        }
        journal.append(record);
      }
      journal.close();
      return error_of(ErrorKind::bad_data, [&] { run(plan, racing); });
    };
    EXPECT_THAT(resume_with([](EvaluationRecord& record) { record.cases.numbers.front() = 77; }),
                HasSubstr("its training cases differ"));
    EXPECT_THAT(resume_with([](EvaluationRecord& record) {
                  record.evaluation.status = EvaluationStatus::ok;
                }),
                HasSubstr("its training cases differ"));
    if (racing == "halving:1:2") {
      EXPECT_THAT(resume_with([](EvaluationRecord& record) {
                    record.cases.numbers = {0, 1, 2, 3, 4, 5};
                    record.evaluation.status = EvaluationStatus::ok;
                  }),
                  HasSubstr("the race that it was in went otherwise"));
    }
  }
}

TEST_F(RunTest, ThoseThatLoseAreNeverIncumbents) {
  const auto result = run(make_bowl_plan("ga", 600, "halving"), "a");
  ASSERT_TRUE(result && result->winner);
  EXPECT_GT(result->counts.abandoned, 0u);
  EXPECT_EQ(result->counts.failed, 0u);
  EXPECT_EQ(result->counts.feasible + result->counts.abandoned, result->counts.evaluations);
  EXPECT_EQ(parse_result(read_result("a"), "a").counts.abandoned, result->counts.abandoned);
  double best = std::numeric_limits<double>::infinity();
  for (const EvaluationRecord& record : read("a").training) {
    if (record.cases.numbers.size() == 6) {
      best = std::min(best, record.evaluation.objectives.front());
    }
  }
  double least = std::numeric_limits<double>::infinity();
  for (const JudgedCandidate& judged : result->judged) {
    least = std::min(least, judged.candidate.training_objective);
  }
  EXPECT_EQ(least, best);
}

TEST_F(RunTest, RacingIsPartOfThePlan) {
  ASSERT_TRUE(run(make_bowl_plan("ga", 100, "halving"), "a"));
  std::filesystem::remove(temporary_ / "a" / "result.json");
  EXPECT_THAT(usage_error_of([&] { run(make_bowl_plan("ga", 100, "none"), "a"); }),
              HasSubstr("run.racing: recorded \"halving:1:2\", now absent"));
}

TEST(RacingPlan, WhatCannotBeRankedIsRefused) {
  const auto check = [](const std::string& problem, const std::string& racing) {
    RunPlan plan;
    plan.problem = load_problem(problem);
    plan.optimizer = load_optimizer("cmaes");
    plan.schedule = {.kind = Schedule::Kind::fixed, .cases = 5};
    plan.racing = *read_racing(racing);
    return usage_error_of([&] { check_plan(plan); });
  };
  EXPECT_THAT(
      check("constrained", "halving"),
      AllOf(HasSubstr("racing halving ranks candidates by one number"), HasSubstr("constraints")));
  EXPECT_THAT(check("sphere", "abandonment"), HasSubstr("not have; use racing halving"));
}

TEST(RacingPlan, OfWhichNothingComesIsRefusedOrSaid) {
  RunPlan plan;
  plan.problem = load_problem("sphere");
  plan.optimizer = load_optimizer("cmaes");
  plan.schedule = {.kind = Schedule::Kind::fixed, .cases = 5};
  plan.racing = *read_racing("halving:4");
  check_plan(plan);
  plan.racing = *read_racing("halving:5");
  EXPECT_THAT(usage_error_of([&] { check_plan(plan); }),
              HasSubstr("racing halving:5:2 gives every candidate 5 cases to begin with, and "
                        "schedule fixed:5 has no more: there is no race"));
  const auto explain = [&](const std::string& optimizer, const std::string& racing) {
    return explain_no_race(load_optimizer(optimizer), *read_racing(racing), plan.schedule);
  };
  for (const std::string optimizer : {"cmaes", "ga", "random"}) {
    EXPECT_EQ(explain(optimizer, "halving:2"), "");
  }
  EXPECT_THAT(explain("nlopt:cobyla", "halving:2"), HasSubstr("within a generation or a sample"));
  EXPECT_EQ(explain("nlopt:cobyla", "abandonment"), "");
  EXPECT_EQ(explain("nlopt:cobyla", "none"), "");
  EXPECT_THAT(explain("cmaes", "abandonment:1:5"), HasSubstr("leave nothing of fixed:5"));
  if (load_optimizer("ceres:lm").unavailable.empty()) {
    EXPECT_THAT(explain("ceres:lm", "halving:2"), HasSubstr("the errors of all cases"));
    EXPECT_THAT(explain("ceres:lm", "abandonment"), HasSubstr("the errors of all cases"));
  }
}

// Returns the true objective without its constant: the winner's squared distance from (1, ..., 1).
double calc_distance(const RunResult& result) {
  double square = 0;
  for (const double xi : result.judged[*result.winner].candidate.x) {
    square += (xi - 1) * (xi - 1);
  }
  return square;
}

TEST_F(RunTest, HalvingFindsAsGoodADesignWithFewerCases) {
  const auto find_median = [&](std::int64_t budget, const std::string& racing) {
    std::vector<double> distances;
    for (std::uint64_t seed = 1; seed <= 9; ++seed) {
      RunPlan plan =
          make_mean_plan(make_noisy_bowl(4, 0.5), "cmaes", budget, "fixed:32", racing, {});
      plan.problem.sets.validation_cases = 100;
      plan.seed = seed;
      const auto result = run(plan, racing + std::to_string(budget) + std::to_string(seed));
      distances.push_back(calc_distance(*result));
    }
    std::ranges::sort(distances);
    return distances[4];
  };
  EXPECT_LE(find_median(1600, "halving:4:2"), find_median(3200, "none"));
}

}  // namespace
}  // namespace armwright
