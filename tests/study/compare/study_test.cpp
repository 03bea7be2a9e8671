#include <gmock/gmock.h>

#include <algorithm>
#include <fstream>

#include "base/expect_error.hpp"
#include "base/remove_checksums.hpp"
#include "study/analysis/study_result.hpp"
#include "study/analysis/verdict.hpp"
#include "study/compare/study_support.hpp"
#include "study/run/run_observer.hpp"

namespace armwright {
namespace {

using testing::Contains;
using testing::HasSubstr;

TEST_F(StudyTest, TablesAreTheSameBytesForAnyNumberOfProcesses) {
  const StudyPlan plan = make_study_plan(make_small_request());
  study(plan, "one", 1);
  study(plan, "three", 3);
  EXPECT_EQ(read_tree(temporary_ / "one" / "tables"), read_tree(temporary_ / "three" / "tables"));
  EXPECT_EQ(read_cells("one"), read_cells("three"));
  EXPECT_EQ(read_cells("one").size(), 2u * 60u);
}

TEST_F(StudyTest, AnOptimizerAddedLaterHasTheCellsItWouldHaveHadAtOnce) {
  StudyRequest request = make_small_request();
  study(make_study_plan(request), "grown");
  const auto before = read_cells("grown");
  request.optimizers.push_back("lhs");
  request.replicates = 7;
  const StudyPlan larger = make_study_plan(request);
  study(larger, "grown");
  study(larger, "at-once");
  EXPECT_EQ(read_cells("grown"), read_cells("at-once"));
  EXPECT_EQ(read_tree(temporary_ / "grown" / "tables"),
            read_tree(temporary_ / "at-once" / "tables"));
  const auto after = read_cells("grown");
  for (const auto& [path, text] : before) {
    EXPECT_EQ(after.at(path), text) << path;
  }
  EXPECT_TRUE(std::filesystem::exists(temporary_ / "grown" / "study-001.toml"));
}

TEST_F(StudyTest, AStoppedStudyGoesOnToTheSameTables) {
  const StudyPlan plan = make_study_plan(make_small_request());
  study(plan, "whole");
  const auto path = temporary_ / "stopped";
  class StopAfterTenCells final : public SilentObserver {
   public:
    StopAfterTenCells(StopSignal& stop, std::uint64_t budget) : stop_(stop), budget_(budget) {}
    void on_progress(const Progress& progress) override {
      if (progress.done >= 10 * budget_) {
        stop_.request(StopReason::interrupted);
      }
    }

   private:
    StopSignal& stop_;
    std::uint64_t budget_;
  };
  {
    StudyFolder folder(path, plan);
    StopSignal stop;
    StopAfterTenCells observer(stop, static_cast<std::uint64_t>(plan.budget));
    EXPECT_FALSE(run_cells(plan, path, 2, stop, observer));
  }
  EXPECT_FALSE(analyze_study(plan, path).missing.empty());
  study(plan, "stopped");
  EXPECT_EQ(read_tree(path / "tables"), read_tree(temporary_ / "whole" / "tables"));
}

TEST_F(StudyTest, WhatWouldMakeCellsIncomparableIsRefusedWithTheDifference) {
  StudyRequest request = make_small_request();
  study(make_study_plan(request), "study");
  const auto expect = [&](const StudyRequest& changed, const std::string& message) {
    EXPECT_THAT(
        usage_error_of([&] { StudyFolder(temporary_ / "study", make_study_plan(changed)); }),
        HasSubstr(message));
  };
  StudyRequest changed = request;
  changed.budget = 121;
  expect(changed, "budget: recorded 120, now 121");
  expect(changed, "Another budget needs another study, because every value, curve and rank");
  changed = request;
  changed.replicates = 5;
  expect(changed, "replicates: recorded 6, now 5");
  changed = request;
  changed.optimizers = {"ga"};
  expect(changed, "optimizer cmaes is in the recorded plan, but not in this one");
  changed = request;
  changed.settings = {"function.dimension=4"};
  expect(changed, "problem sphere: function.dimension: recorded 3, now 4");
  changed = request;
  changed.seed = 2;
  expect(changed, "seed: recorded 1, now 2");
}

TEST_F(StudyTest, TheVerdictFollowsFromTheStatistics) {
  StudyRequest request = make_small_request();
  request.replicates = 9;  // enough for six pairs
  const StudyPlan plan = make_study_plan(request);
  const StudyResult result = study(plan, "study");
  const auto verdict = describe_verdict(plan, result);
  for (const ProblemResult& problem : result.problems) {
    const std::size_t best = problem.order.front();
    for (const PairResult& pair : problem.pairs) {
      if (pair.a != best && pair.b != best) {
        continue;
      }
      const std::string& other = plan.optimizers[pair.a == best ? pair.b : pair.a].label;
      const std::string beats =
          "On " + problem.label + " at 120 simulations " + plan.optimizers[best].label + " beats ";
      const bool says_so = std::ranges::any_of(verdict, [&](const std::string& sentence) {
        return sentence.starts_with(beats) && sentence.find(other) != std::string::npos;
      });
      EXPECT_EQ(says_so, pair.is_won_by(best)) << problem.label << " " << other;
    }
  }
  EXPECT_THAT(verdict,
              Contains(HasSubstr("with 2 problems, fewer than 6, no pair of optimizers can be "
                                 "decided over problems")));
}

TEST_F(StudyTest, OfFewerThanSixPairsNoPairIsDecided) {
  StudyRequest request = make_small_request();
  request.replicates = 5;
  const StudyPlan plan = make_study_plan(request);
  const StudyResult result = study(plan, "study");
  for (const ProblemResult& problem : result.problems) {
    for (const PairResult& pair : problem.pairs) {
      EXPECT_FALSE(pair.is_significant());
    }
  }
  EXPECT_THAT(describe_verdict(plan, result),
              Contains(HasSubstr("no pair of optimizers can be decided: with 5 replicates and ")));
}

TEST_F(StudyTest, WhereNoDifferenceCouldBeSignificantTheVerdictSaysSo) {
  StudyRequest request = make_small_request();
  request.optimizers = {"ga", "cmaes"};  // with the baselines ten pairs: 10 x 2 / 2^6 > 0.05
  const StudyPlan plan = make_study_plan(request);
  EXPECT_THAT(describe_verdict(plan, study(plan, "study")),
              Contains(HasSubstr("with 6 replicates and 10 pairs of optimizers no difference, "
                                 "however clear, is significant after Holm's correction; 9 "
                                 "replicates would do")));
}

TEST_F(StudyTest, TheVerdictSaysWhomRacingHasNoEffectOn) {
  StudyRequest request = make_small_request();
  request.optimizers = {"cmaes", "nlopt:cobyla"};
  request.settings.insert(request.settings.end(), {"racing.kind=halving", "racing.first_cases=2"});
  request.schedule = Schedule{.kind = Schedule::Kind::fixed, .cases = 5};
  const StudyPlan plan = make_study_plan(request);
  EXPECT_THAT(describe_verdict(plan, analyze_study(plan, temporary_ / "none")),
              testing::Contains("Racing has no effect on nlopt:cobyla: candidates race within a "
                                "generation or a sample, and there are none."));
}

TEST_F(StudyTest, TheVerdictSaysThatBaselinesWereLeftOut) {
  StudyRequest request = make_small_request();
  request.baselines = false;
  const StudyPlan plan = make_study_plan(request);
  EXPECT_THAT(
      describe_verdict(plan, study(plan, "study")),
      Contains(HasSubstr("baselines (the start, random search and a local search) were left out")));
}

TEST_F(StudyTest, ABaselineStaysWhenAnotherOfItsKindComes) {
  StudyRequest request = make_small_request();
  study(make_study_plan(request), "study");
  request.optimizers.insert(request.optimizers.end(), {"nlopt:cobyla", "random"});
  StudyPlan plan = make_study_plan(request);
  adopt_recorded(temporary_ / "study", plan);
  EXPECT_NO_THROW(study(plan, "study"));
  EXPECT_EQ(plan.optimizers.size(), 6u);  // with the baselines start and nlopt:neldermead
}

TEST_F(StudyTest, ACellOfAnotherOptimizerIsRefused) {
  const StudyPlan plan = make_study_plan(make_small_request());
  study(plan, "study");
  const auto get_file = [&](std::size_t optimizer) {
    return temporary_ / "study" / make_cell_path(plan, {0, optimizer, 1}) / "cell.json";
  };
  std::filesystem::copy_file(get_file(0), get_file(1),
                             std::filesystem::copy_options::overwrite_existing);
  EXPECT_THAT(error_of(ErrorKind::bad_data, [&] { analyze_study(plan, temporary_ / "study"); }),
              HasSubstr(get_file(1).string() + ": was changed after it was written"));
  remove_checksums(temporary_ / "study");
  EXPECT_THAT(error_of(ErrorKind::bad_data, [&] { analyze_study(plan, temporary_ / "study"); }),
              HasSubstr("is of another cell (ga on sphere, replicate 1"));
}

TEST_F(StudyTest, ARecordedPlanThatWasChangedIsRefused) {
  const StudyPlan plan = make_study_plan(make_small_request());
  study(plan, "study");
  const auto file = temporary_ / "study" / "study.toml";
  std::string text = read_file(file, 1 << 20);
  text.replace(text.find("population=35"), 13, "population=36");
  std::ofstream(file) << text;
  EXPECT_THAT(error_of(ErrorKind::bad_data, [&] { StudyFolder(temporary_ / "study", plan); }),
              HasSubstr("study.toml: was changed after it was written"));
  remove_checksums(temporary_ / "study");
  EXPECT_THAT(error_of(ErrorKind::bad_data, [&] { StudyFolder(temporary_ / "study", plan); }),
              HasSubstr("a resolved plan that somebody has changed"));
}

TEST_F(StudyTest, WithoutAllCellsThereIsNoVerdict) {
  const StudyPlan plan = make_study_plan(make_small_request());
  study(plan, "study");
  std::filesystem::remove(temporary_ / "study" / make_cell_path(plan, {1, 2, 3}) / "cell.json");
  const StudyResult result = analyze_study(plan, temporary_ / "study");
  ASSERT_EQ(result.missing.size(), 1u);
  const auto verdict = describe_verdict(plan, result);
  EXPECT_THAT(verdict, Contains(HasSubstr("On rosenbrock at 120 simulations there is no verdict")));
  EXPECT_THAT(verdict, Contains(HasSubstr("1 of 60 cells have not ended")));
}

TEST_F(StudyTest, FrontsAreComparedByTheHypervolumeTheyMiss) {
  StudyRequest request;
  request.problems = {"q2-pareto"};
  request.optimizers = {"pagmo:maco", "cmaes"};
  request.settings = {"physics.engine=articulated", "workspace.points=4", "sets.validation_cases=3",
                      "sets.test_cases=4"};
  request.replicates = 3;
  request.budget = 1000;
  request.baselines = false;
  const StudyPlan plan = make_study_plan(request);
  const StudyResult result = study(plan, "study");
  const ProblemResult& problem = result.problems.front();
  EXPECT_TRUE(problem.has_front);
  EXPECT_EQ(problem.reference_point.size(), 2u);
  for (const OptimizerResult& one : problem.optimizers) {
    for (const double value : one.values) {
      EXPECT_GT(value, 0);
      EXPECT_LE(value, 1);
    }
  }
  EXPECT_LT(problem.optimizers[0].spread.median, 1);
  EXPECT_LT(problem.optimizers[1].spread.median, 1);
  const auto tables = read_tree(temporary_ / "study" / "tables");
  EXPECT_TRUE(tables.contains("fronts.csv"));
  EXPECT_THAT(
      tables.at("indicators.csv"),
      testing::StartsWith("problem,optimizer,replicate,missed_hypervolume,igd_plus\nq2-pareto,"));
  EXPECT_EQ(std::ranges::count(tables.at("indicators.csv"), '\n'), 1 + 2 * 3);
  for (const OptimizerResult& one : problem.optimizers) {
    ASSERT_EQ(one.igd_plus.size(), 3u);
    for (const double value : one.igd_plus) {
      EXPECT_GE(value, 0);
      EXPECT_LT(value, 100);
    }
  }
  EXPECT_THAT(tables.at("metrics.csv"),
              HasSubstr("q2-pareto,pagmo:maco,1,metric,total_torque,N m,"));
  EXPECT_GT(std::ranges::count(tables.at("attainment.csv"), '\n'), 2);
}

}  // namespace
}  // namespace armwright
