// Selects the winner of a run, in the same way for every optimizer. The candidates for the winner
// come from CandidatePool::select(); Selection (run_plan.hpp) says how many there are. All of them
// are evaluated on the validation set, and the winner on the test set. These evaluations are not
// charged to the budget, and no case is cut off.
#pragma once

#include <compare>
#include <cstdint>
#include <optional>
#include <vector>

#include "study/executor/case_executor.hpp"
#include "study/journal/journal.hpp"
#include "study/run/run_observer.hpp"
#include "study/run/run_result.hpp"

namespace armwright {

// The quality of a design on some cases. Smaller is better: the smaller share of failures decides
// (cases without a number, or with an error above ProblemDescription::failure_error), then the
// smaller violation of the constraints, then the smaller objective (of several, the weighted sum).
struct DesignRank {
  double failing_share = 0;
  double violation = 0;
  double objective = 0;

  auto operator<=>(const DesignRank&) const = default;
};

// Returns the rank of a design. If no case has a number, violation and objective are infinite.
DesignRank calc_rank(const ProblemDescription& problem, const Evaluation& evaluation);
// Returns the rank on the validation set; the further cases count for the share of failures alone.
DesignRank calc_rank(const ProblemDescription& problem, const JudgedCandidate& judged);

// Returns the index of the winner: the candidate with the best rank on the validation set, the first
// of equal ones. Returns nothing if no candidate has an objective.
std::optional<std::size_t> choose_winner(const ProblemDescription& problem,
                                         const std::vector<JudgedCandidate>& judged);

// A winner without a failure on N validation cases may fail 1 in N others, and of many candidates at
// the edge of failing one passes by luck. The winner of a single run passes this many times as many.
constexpr std::uint64_t kConfirmationFactor = 10;

// Evaluates the candidates and sets `judged`, `winner`, `test` and `test_summary` of the result. If
// `is_single` (no cell of a comparison), also tests the start and confirms the winner of a problem
// whose cases can fail: further validation cases are simulated, as many at a time as before, up to
// kConfirmationFactor times their number or until one fails; then the next best is the winner. If
// all candidates fail, judges `earlier` as well.
// Takes evaluations from `recorded` where the journal has them, and appends the others to
// `journal`. `training` holds all training evaluations of the run: if the problem has a single
// case, they are the judgements of the decision vectors that they have, and only others are
// simulated. Returns false if it was stopped; the result is incomplete then. Throws Error{bad_data}
// if the recorded run has ended but lacks an evaluation, and Error{io} if the journal cannot be
// written.
bool select_winner(const RunPlan& plan, std::vector<Candidate> candidates,
                   std::vector<Candidate> earlier, const JournalContent& recorded,
                   const RecordedEvaluations& training, CaseExecutor& executor, StopSignal& stop,
                   Journal& journal, RunObserver& observer, bool is_single, RunResult& result);

}  // namespace armwright
