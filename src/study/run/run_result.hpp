// The result of a run, as result.json records it. It depends neither on time, threads nor
// interruptions: a resumed run and an uninterrupted one write the same bytes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sim/tracking/response.hpp"
#include "study/run/candidate_pool.hpp"
#include "study/run/run_plan.hpp"
#include "study/statistics/summary.hpp"

namespace armwright {

// Counts of a run's training evaluations.
struct RunCounts {
  void add(const EvaluationRecord& record);  // does not change `replayed` and `generations`

  std::uint64_t evaluations = 0;
  std::uint64_t cases = 0;      // charged to the budget
  std::uint64_t replayed = 0;   // evaluations that the journal has answered
  std::uint64_t clipped = 0;    // points asked for outside the bounds
  std::uint64_t failed = 0;     // evaluations whose status is neither ok nor abandoned
  std::uint64_t abandoned = 0;  // evaluations that lost a race
  std::uint64_t feasible = 0;   // evaluations with objectives and every constraint met
  std::uint64_t generations = 0;
};

// A candidate and its evaluation on the validation set. Of a candidate that would win, further cases
// of this set were simulated too (winner_selection.hpp).
struct JudgedCandidate {
  Candidate candidate;
  Evaluation validation;
  std::uint64_t further_cases = 0;
  std::uint64_t further_failures = 0;
};

// The problem's start on the cases that the winner was tested on.
struct JudgedStart {
  Evaluation test;
  bool is_worse_than_winner = false;  // by the rule of the winner (winner_selection.hpp)
};

struct RunResult {
  std::string problem;
  std::string optimizer;
  std::uint64_t seed = 1;
  std::string end_reason;  // "budget", "optimizer finished" or "optimizer failed"
  bool ended_by_budget() const { return end_reason == "budget"; }
  // If the optimizer finished: why, in its own words, and how many more evaluations the budget would
  // have paid for. Empty and 0 if that is not known, and in results of runs that version 1.0 began.
  std::string end_detail;
  std::int64_t unused_evaluations = 0;
  // Which optimizer one that chooses has chosen, and why, in two sentences. Empty for all others.
  std::string choice;
  std::string failure;        // how the optimizer failed; empty if it did not
  std::string first_failure;  // the reason of the first evaluation without objectives, if any
  RunCounts counts;           // `replayed` is not recorded
  std::vector<JudgedCandidate> judged;
  std::optional<std::size_t> winner;  // index into judged; nothing if none has an objective
  Evaluation test;                    // the winner's on the test set
  ErrorSummary test_summary;
  // The start is not tested if there is no winner, in a comparison's cells, in told runs and in
  // identifications.
  std::optional<JudgedStart> start;
  // The winner's errors in motion on the test set. Nothing in results of version 1.0, of a
  // comparison's cells and of runs without an arm.
  std::optional<MotionSummary> test_motion;
  // The winner's efforts if a joint slides; otherwise nothing, because the metric total_torque has
  // them. Nothing in results of version 1.0.
  EffortTotals sliding_efforts;
  std::vector<std::string> variable_names;
  // The variables that are not real, with name, type and, for categories, words. Their bounds are
  // not recorded: those of a category follow from its words.
  std::vector<DecisionVariable> discrete_variables;
  std::vector<std::string> metric_names;
  std::vector<Quantity> objectives;
  std::vector<double> objective_weights;  // as in ProblemDescription
  std::vector<Quantity> constraints;      // as in ProblemDescription
  std::vector<Limit> limits;              // as in ProblemDescription
  std::vector<RequiredMetric> requirements;
  // The smallest constraint violation of all training evaluations; nothing if the problem has no
  // constraints or no evaluation had constraint values.
  std::optional<double> least_violation;
  std::string test_set;
  bool tracking = false;  // the problem is a tracking problem
  PublishedWinner published;
};

// Returns a recorded optimizer's name for texts and titles: of a plugin's path only the file's name.
std::string shorten_optimizer(const std::string& optimizer);

// Returns the discrete variable with this index in variable_names, for format_value(); null if that
// variable is real. The pointer is valid as long as the result.
const DecisionVariable* find_discrete(const RunResult& result, std::size_t variable);

// Returns the error above which a test case has failed: kFailureError_m for an arm, infinity for a
// function.
double get_failure_error(const RunResult& result);

// Returns the constraints that the winner violates on the test set, as "g1" or "the limit of total
// torque", without control characters. Empty if there is no winner.
std::vector<std::string> list_violated(const RunResult& result);
// Returns why nobody should use the winner as it is, one sentence each: it fails on the test set,
// violates a constraint there, or is not better than the start. Empty if there is no winner.
std::vector<std::string> list_faults(const RunResult& result);

// Returns the winner's efforts. Those of version 1.0 count sliding joints as if they turned.
EffortTotals get_effort_totals(const RunResult& result);

// Returns whether every constraint is met and every case has an error. Only then may a report call
// the design feasible.
bool is_proven_feasible(const Evaluation& evaluation);

// Returns the quantity that decides the winner: the objective or, of several, the weighted sum.
Quantity get_target(const RunResult& result);
double calc_target(const RunResult& result, const Evaluation& evaluation);

std::string to_json(const RunResult& result);
// Reads the text of `file`. Throws Error{bad_data} if it is not a result that armwright wrote.
RunResult parse_result(const std::string& json, const std::filesystem::path& file);

}  // namespace armwright
