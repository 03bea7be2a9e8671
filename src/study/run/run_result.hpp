// What a run has found, as recorded in result.json. Nothing in it depends on time, threads or
// interruptions: a resumed run and an uninterrupted one write the same bytes.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "study/run/candidate_pool.hpp"
#include "study/run/run_counts.hpp"
#include "study/run/run_plan.hpp"
#include "study/statistics/summary.hpp"

namespace armwright {

// A candidate and what the validation set says of it.
struct JudgedCandidate {
  Candidate candidate;
  Evaluation validation;
};

struct RunResult {
  std::string problem;
  std::string optimizer;
  std::uint64_t seed = 1;
  std::string end_reason;  // "budget", "optimizer finished" or "optimizer failed"
  std::string failure;     // how the optimizer failed; empty if it did not
  std::string
      first_failure;  // why the first evaluation without objectives has none, if there is one
  RunCounts counts;   // `replayed` is not recorded
  std::vector<JudgedCandidate> judged;
  std::optional<std::size_t> winner;  // index into judged; nothing if none has an objective
  Evaluation test;                    // the winner's
  ErrorSummary test_summary;
  std::vector<std::string> variable_names;
  std::vector<std::string> metric_names;
  std::vector<Quantity> objectives;
  std::vector<double> objective_weights;  // as in ProblemDescription
  std::vector<Quantity> constraints;      // likewise
  std::vector<Limit> limits;              // likewise
  std::vector<RequiredMetric> requirements;
  // Of all training evaluations the smallest, where the problem has constraints; nothing if none
  // had a number.
  std::optional<double> least_violation;
  std::string test_set;
  bool tracking = false;  // the problem is an arm's
  PublishedWinner published;
};

// Above which error a test case has failed: kFailureError_m for an arm, never for a function.
double get_failure_error(const RunResult& result);

// Every constraint is met, and no case is without a number: what a result may call feasible.
bool is_proven_feasible(const Evaluation& evaluation);

// What the winner was chosen by: the objective, or the weighted sum of several.
Quantity get_target(const RunResult& result);
double calc_target(const RunResult& result, const Evaluation& evaluation);

std::string to_json(const RunResult& result);
RunResult parse_result(const std::string& json, const std::filesystem::path& file);

}  // namespace armwright
