// The findings of a comparison: every number in its tables and its verdict. All are computed from
// the cells alone; the same cells give the same bytes.
//
// Each optimizer has one value per replicate. For one objective it is the winner's value on the
// test set (calc_test_value()). If the plan asks for failures, it is the share of test cases in
// which the winner fails. For several objectives it is the share of the hypervolume that the
// optimizer's front misses. A pair of values belongs to one replicate: both runs had the same
// training cases and start.
//
// Running times come from the trace of a run: its incumbents, each with the exact number of cases
// when it was found and with its value on the test set (CellOutcome::trace). The running time to a
// target is the number of cases from which on every incumbent is at the target or below. On
// functions this is the first evaluation that reaches the target. For several objectives, curves,
// running times and profiles use the weighted sum of the objectives.
//
// Fixed targets on arms are evaluated differently. They model a user who stops a run early and
// takes the design that is best on the validation set at that time (choices.hpp). A run reaches a
// fixed target at the first checkpoint at which this design meets the target on the test set,
// whatever follows. A running time must not depend on how much longer the run went on. Functions
// need no validation, so there the first evaluation counts that meets the target.
//
// Values are compared with the problem's margin (make_margin()).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "study/analysis/pair_comparison.hpp"
#include "study/compare/cell.hpp"
#include "study/statistics/ranking.hpp"
#include "study/statistics/running_time.hpp"
#include "study/statistics/significance.hpp"
#include "study/statistics/summary.hpp"

namespace armwright {

inline constexpr double kIntervalLevel = 0.95;
inline constexpr int kResamples = 2000;
// Targets of expected running times: the share of the distance from the start value to the best
// known value that is left.
inline constexpr double kRunningTimeTargets[] = {0.1, 0.01, 0.001};
// The tolerances of data and performance profiles (Moré and Wild 2009).
inline constexpr double kProfileTolerances[] = {1e-1, 1e-3, 1e-5};

// The running time of one optimizer to one target value.
struct RunningTime {
  double target = 0;    // value on the test set
  int reached = 0;      // number of replicates that reach it
  double expected = 0;  // simulated cases, with restarts; infinite if never reached
  Interval interval;
};

// The running time of one optimizer to one fixed target.
struct TargetTime {
  std::vector<Trial> trials;  // one per replicate
  int reached = 0;            // number of replicates that reach the target
  int kept = 0;               // those whose last choice, the winner, meets the target as well
  double expected = 0;        // simulated cases, with restarts; infinite if never reached
  Interval interval;          // over replicates; infinite if too few of them reach the target
  // The expected running time divided by the reference's; empty if the plan has no reference.
  std::optional<RunningTimeRatio> ratio;
};

// The result of simulating an optimizer's best design (chosen on the validation set) on another
// engine.
struct FinalCheck {
  int replicate = 0;
  std::string engine;
  double value = 0;
  ErrorSummary errors;
};

// The statistics of one optimizer on one problem.
struct OptimizerResult {
  std::vector<double> values;  // one per replicate
  // Only for several objectives: IGD+ of each replicate's front, from the common front of all runs, with
  // its extent as the unit (pareto.hpp). `values` alone decides who is better.
  std::vector<double> igd_plus;
  int successes = 0;   // number of replicates with a success (Margin::is_success())
  int infinite = 0;    // number of replicates without a value
  int infeasible = 0;  // those of them whose winner violates a constraint on the test set
  int failed = 0;      // number of replicates in which the optimizer itself failed
  // Number of replicates whose winner violates a constraint on the test set, or that ended without a
  // winner although the optimizer did not fail.
  int unmet = 0;
  Spread spread;
  Interval median_interval;
  double mean_rank = 0;
  double anytime_area = 0;  // area under the runtime ECDF over all targets
  std::vector<RunningTime> running_times;
  std::vector<TargetTime> target_times;  // one per entry of ProblemResult::fixed_targets
  // Only for arms: the share of test cases in which the winner fails, one per replicate; infinite
  // for a run without a winner.
  std::vector<double> failure_shares;
  Spread failure_spread;
  double failure_mean_rank = 0;  // by these shares, over replicates; 0 if cells are missing
  double mean_failure_share = 0;
  std::vector<double> ecdf;   // at ProblemResult::checkpoints
  std::vector<Spread> curve;  // likewise
  double cases = 0;           // charged to the budget, median over replicates
  std::optional<FinalCheck> final_check;
};

// The statistics of one problem.
struct ProblemResult {
  std::string label;
  Quantity quantity;  // name and unit of the values
  bool has_front = false;
  std::vector<double> reference_point;  // of the hypervolume
  Margin margin;                        // of the values
  // The optimum if it is known, else the best value on the test set in all traces; may be infinite.
  double best_known = 0;
  double start = 0;  // median value of the start points
  std::vector<std::int64_t> checkpoints;
  std::vector<double> targets;
  std::vector<OptimizerResult> optimizers;
  std::optional<FriedmanTest> friedman;    // blocks are replicates; empty for fewer than 2
  std::vector<PairResult> pairs;           // every two optimizers; Holm's correction over all pairs
  std::vector<std::size_t> fixed_targets;  // indices of the plan's targets for this problem
  std::vector<PairResult> failure_pairs;   // as `pairs`, for failure shares; only for arms
  std::vector<std::size_t> order;          // best first (order_optimizers())
};

// A data or performance profile at one tolerance.
struct Profile {
  double tolerance = 0;
  std::vector<std::vector<double>> shares;  // one row per optimizer, one column per abscissa
};

// The statistics over all problems. Each problem counts once, with its medians. Pairs compare the
// share of the distance from the start value to the best known value that the median leaves. This
// share has the same meaning on every problem.
struct OverallResult {
  RankingStability ranking;
  std::optional<FriedmanTest> friedman;
  std::vector<PairResult> pairs;
  std::vector<double> kappas;  // abscissae of data profiles: cost in simplex gradients
  std::vector<double> alphas;  // abscissae of performance profiles: cost / cost of the fastest
  std::vector<Profile> data_profiles;
  std::vector<Profile> performance_profiles;
};

struct StudyResult {
  std::vector<CellOutcome> cells;  // problem by problem, optimizer by optimizer, by replicate
  std::vector<ProblemResult> problems;
  OverallResult overall;
  std::vector<Cell> missing;      // cells that have not ended
  bool missing_left_out = false;  // `cells` lacks the missing ones
};

// Treatment of cells that have not ended.
// - count_as_infinite: they count as if they had found nothing. This is the final result of a
// study. - left_out: they are ignored, which shows the progress of a running study. A problem that
// lacks
//   cells then has neither ranks nor pairs. `overall` covers the other problems and is empty if
//   there are none.
enum class MissingCells { count_as_infinite, left_out };

// Analyzes the cells in the study's folder, which is only read. Throws Error{bad_data} for a cell
// that cannot be read.
StudyResult analyze_study(const StudyPlan& plan, const std::filesystem::path& study,
                          MissingCells missing = MissingCells::count_as_infinite);

// Returns the share of test cases in which the winner fails; infinite if there is no winner.
double calc_failure_share(const CellOutcome& cell);
// Returns the cell as needed by a study that compares failures. Shares of failing test cases
// replace all objectives, those of the curve included.
CellOutcome count_failures_only(CellOutcome cell, const CaseSets& sets);

// Returns the trial of one run to reach a fixed target: its cost in simulated cases and whether it
// reached the target. `points` are the run's designs over the cases, its choices or its trace.
Trial make_target_trial(const StudyPlan& plan, const StudyTarget& target, const CellOutcome& cell,
                        std::span<const CurvePoint> points);

// The functions below are the parts of analyze_study().

// Analyzes one problem. If cells are missing, an optimizer's numbers come from the cells that exist
// (infinite if none exists), and optimizers are not compared.
ProblemResult analyze_problem(const StudyPlan& plan, std::size_t problem,
                              std::span<const CellOutcome> cells);
OverallResult analyze_overall(const StudyPlan& plan, std::span<const ProblemResult> problems,
                              std::span<const CellOutcome> cells);

// Returns the margin of the problem's values: its resolution and optimum. Shares of failing test
// cases and of missed hypervolume have none, so there every difference counts.
Margin make_margin(const StudyPlan& plan, const StudyProblem& problem);

// Returns the quality that a run keeps: for each point of its trace the worst value on the test set
// from there on. The best value so far would be a selection on the test set and profit from luck.
std::vector<TracePoint> make_trace(const CellOutcome& cell);

// Returns the optimizers, best first: by mean rank, then by the number of successes, then by
// median, then in the plan's order. If cells are missing there are no ranks, and the median decides.
std::vector<std::size_t> order_optimizers(std::span<const OptimizerResult> optimizers,
                                          bool complete);

// Set the target times and the failure shares of all optimizers; optimizer `o` has the cells
// `runs[o]`. Pairs are compared only if `complete`.
void add_targets(const StudyPlan& plan, std::span<const std::vector<const CellOutcome*>> runs,
                 bool complete, ProblemResult& result);
void add_failures(std::span<const std::vector<const CellOutcome*>> runs, bool complete,
                  ProblemResult& result);

}  // namespace armwright
