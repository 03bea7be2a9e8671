// Chooses the winner, for every optimizer alike: the candidates meet the validation set, the best
// of them the test set. Neither is charged to the budget, and nothing is cut off there. What a
// former process has judged already is taken from the journal.
#pragma once

#include <optional>
#include <vector>

#include "study/executor/case_executor.hpp"
#include "study/journal/journal.hpp"
#include "study/run/run_observer.hpp"
#include "study/run/run_result.hpp"

namespace armwright {

class Judge {
 public:
  Judge(const RunPlan& plan, CaseRunner& runner, Journal& journal,
        std::vector<EvaluationRecord> recorded, bool journal_ended, RunObserver& observer);

  // One judgement a candidate, or nothing if stopped.
  std::optional<std::vector<JudgedCandidate>> validate(std::vector<Candidate> candidates);
  // The winner: fewest cases without number, then feasible, then the best first objective; nothing
  // if none has an objective.
  static std::optional<std::size_t> choose_winner(const ProblemDescription& problem,
                                                  const std::vector<JudgedCandidate>& judged);
  // The winner on the test set, or nothing if stopped.
  std::optional<Evaluation> test(const Candidate& winner);

 private:
  std::optional<std::vector<Evaluation>> evaluate(const std::vector<std::vector<double>>& designs,
                                                  const CaseBlock& block, Progress::Phase phase);

  const RunPlan& plan_;
  CaseRunner& runner_;
  Journal& journal_;
  std::vector<EvaluationRecord> recorded_;
  bool journal_ended_;
  RunObserver& observer_;
};

}  // namespace armwright
