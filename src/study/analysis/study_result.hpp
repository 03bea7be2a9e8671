// What a comparison has found: every number that its tables and its verdict show, computed from the
// cells and nothing else. The same cells give the same bytes.
//
// Each optimizer has one value a replicate: of one objective the winner's on the test set
// (calc_test_value()), or the share of test cases in which it fails if the plan asks for that; of
// several the share of the hypervolume that its front misses. Pairs are
// replicates: the same training cases and the same start. Running times come from curves on the
// test set: the budget from which on every incumbent, re-simulated there, is at the target or
// below; they are as coarse as the checkpoints. Of several objectives curves, running times and
// profiles are of their weighted sum.
//
// Fixed targets are another thing: there a run counts as somebody uses it who stops it early and
// takes the design that is best on the validation set by then (choices.hpp). It has reached the
// target at the first checkpoint at which the design so chosen meets it on the test set, whatever
// comes after: a running time must not depend on how much longer the run was given.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "study/compare/cell.hpp"
#include "study/statistics/ranking.hpp"
#include "study/statistics/running_time.hpp"
#include "study/statistics/significance.hpp"
#include "study/statistics/summary.hpp"

namespace armwright {

inline constexpr double kSignificance = 0.05;
// Of fewer pairs no outcome is significant: 2 / 2^5 > 0.05.
inline constexpr int kFewestPairs = 6;
inline constexpr double kIntervalLevel = 0.95;
inline constexpr int kResamples = 2000;
// Targets of expected running times: this share of the way from the start to the best known is
// left.
inline constexpr double kRunningTimeTargets[] = {0.1, 0.01, 0.001};
// Of profiles (Moré and Wild 2009).
inline constexpr double kProfileTolerances[] = {1e-1, 1e-3, 1e-5};

struct RunningTime {
  double target = 0;    // the value
  int reached = 0;      // replicates
  double expected = 0;  // simulated cases, with restarts; infinite if never reached
  Interval interval;
};

// To a fixed target.
struct TargetTime {
  std::vector<Trial> trials;  // one a replicate
  int reached = 0;
  int kept = 0;         // of these, runs whose last choice, the winner, meets it as well
  double expected = 0;  // simulated cases, with restarts; infinite if never reached
  Interval interval;    // over replicates; infinite where too few of them reached it
  // Of the plan's reference, if it has one: the expected running time divided by the reference's.
  std::optional<RunningTimeRatio> ratio;
};

// The best design of an optimizer on a problem, by the validation set, on another engine.
struct FinalCheck {
  int replicate = 0;
  std::string engine;
  double value = 0;
  ErrorSummary errors;
};

struct OptimizerResult {
  std::vector<double> values;  // one a replicate
  int infinite = 0;            // replicates without a value
  int infeasible = 0;          // of these, whose winner violates a constraint on the test set
  int failed = 0;              // in which the optimizer itself failed
  Spread spread;
  Interval median_interval;
  double mean_rank = 0;
  double anytime_area = 0;  // of the runtime ECDF over all targets
  std::vector<RunningTime> running_times;
  std::vector<TargetTime> target_times;  // of ProblemResult::fixed_targets
  // Of arms: in which share of the test cases the winner fails, one a replicate; infinite for a run
  // without one.
  std::vector<double> failure_shares;
  Spread failure_spread;
  double mean_failure_share = 0;
  std::vector<double> ecdf;   // at ProblemResult::checkpoints
  std::vector<Spread> curve;  // likewise
  double cases = 0;           // of the budget that were used, median
  std::optional<FinalCheck> final_check;
};

struct PairResult {
  std::size_t a = 0;  // optimizers; a's median is not worse than b's
  std::size_t b = 0;
  SignedRankTest test;
  double p_holm = 1;
  double a12 = 0.5;  // that a run of a is better than one of b
  WinTieLoss wins;
  bool is_significant() const {
    return test.pairs + test.zeros >= kFewestPairs && p_holm < kSignificance;
  }
  // And in which direction: the pairs may say otherwise than the medians.
  bool is_beaten_by(std::size_t winner) const {
    const bool a_is_better = test.negative_rank_sum > test.positive_rank_sum;
    return is_significant() && winner == (a_is_better ? a : b);
  }
};

struct ProblemResult {
  std::string label;
  Quantity quantity;  // what the values are
  bool has_front = false;
  std::vector<double> reference_point;  // of the hypervolume
  double best_known = 0;  // of all values on the way, on the test set; may be infinite
  double start = 0;       // median value of the starts
  std::vector<std::int64_t> checkpoints;
  std::vector<double> targets;
  std::vector<OptimizerResult> optimizers;
  std::optional<FriedmanTest> friedman;    // blocks are replicates; nothing of fewer than 2
  std::vector<PairResult> pairs;           // every two, Holm's correction over all of the problem
  std::vector<std::size_t> fixed_targets;  // of the plan, those that are asked of this problem
  std::vector<PairResult> failure_pairs;   // as `pairs`, of failure shares; of arms alone
  std::vector<std::size_t> order;          // by median, then mean rank, then the plan's order
};

struct Profile {
  double tolerance = 0;
  std::vector<std::vector<double>> shares;  // a row an optimizer, at the abscissae
};

// Over problems, each counting once, by its medians. What pairs compare is the share of the way
// from the start to the best known that the median leaves, which means the same on every problem.
struct OverallResult {
  RankingStability ranking;
  std::optional<FriedmanTest> friedman;
  std::vector<PairResult> pairs;
  std::vector<double> kappas;  // abscissae of data profiles: simplex gradients
  std::vector<double> alphas;  // and of performance profiles: times the quickest's cost
  std::vector<Profile> data_profiles;
  std::vector<Profile> performance_profiles;
};

struct StudyResult {
  std::vector<CellOutcome> cells;  // problem by problem, optimizer by optimizer, by replicate
  std::vector<ProblemResult> problems;
  OverallResult overall;
  std::vector<Cell> missing;      // that have not ended
  bool missing_left_out = false;  // they are not in `cells`
};

// What becomes of cells that have not ended: they count as if they had found nothing, which is the
// final word on a study; or they are left out, which shows a study that is under way as far as it
// is. Then a problem without all its cells has neither ranks nor pairs, and `overall` is of the
// others (nothing is in it if there is none).
enum class MissingCells { count_as_infinite, left_out };

// From the study's folder, which is only read. Error{bad_data} for a cell that cannot be read.
StudyResult analyze_study(const StudyPlan& plan, const std::filesystem::path& study,
                          MissingCells missing = MissingCells::count_as_infinite);

// The share of test cases in which the winner fails; infinite if there is none.
double calc_failure_share(const CellOutcome& cell);
// The cell as a study whose value is failures sees it: shares of failing test cases instead of
// objectives, on the way as well.
CellOutcome count_failures_only(CellOutcome cell, const CaseSets& sets);

// The try that a run is to reach a target: what it cost, and whether it did.
Trial make_target_trial(const StudyPlan& plan, const StudyTarget& target, const CellOutcome& cell);

// The parts of it. Of a problem without all its cells, an optimizer's numbers are of those that are
// there, infinite if none is, and nothing is compared.
ProblemResult analyze_problem(const StudyPlan& plan, std::size_t problem,
                              std::span<const CellOutcome> cells);
OverallResult analyze_overall(const StudyPlan& plan, std::span<const ProblemResult> problems,
                              std::span<const CellOutcome> cells);

}  // namespace armwright
