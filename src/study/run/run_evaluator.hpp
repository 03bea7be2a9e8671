// The Evaluator of a run. It charges the budget exactly: a batch is cut where the budget ends, to
// whole candidates. It clips points to the bounds and counts them, rounds discrete variables
// (treated_problem.hpp), chooses the training cases,
// races candidates (racing.hpp), breeds cases (case_breeder.hpp) and lets them grow (case_growth.hpp).
// It answers from the journal
// what a former process has evaluated, appends all other evaluations to the journal as they finish,
// and keeps the designs worth judging (candidate_pool.hpp).
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "optimizers/interface/evaluator.hpp"
#include "optimizers/interface/treated_problem.hpp"
#include "study/executor/case_executor.hpp"
#include "study/journal/journal.hpp"
#include "study/run/candidate_pool.hpp"
#include "study/run/case_breeder.hpp"
#include "study/run/case_growth.hpp"
#include "study/run/run_observer.hpp"
#include "study/run/run_plan.hpp"
#include "study/run/run_result.hpp"

namespace armwright {

class RunEvaluator final : public Evaluator {
 public:
  // All references must outlive the evaluator, except `recorded`, the journal's content.
  RunEvaluator(const RunPlan& plan, CaseExecutor& executor, StopSignal& stop, Journal& journal,
               const JournalContent& recorded, RunObserver& observer);

  // Receives the training evaluations of one batch that the journal lacks: requests without answers.
  using Ask = std::function<void(std::span<const EvaluationRecord* const> missing)>;
  // From now on, calls `ask` where candidates would be simulated, and then ends the search as a stop
  // does. The plan must have no racing.
  void ask_instead(Ask ask) { ask_ = std::move(ask); }

  // Calls `begin` once, before the first evaluation that the journal lacks. Until then, what does not
  // replay is explained by the larger budget with which the run is continued.
  void begin_with(std::function<void()> begin) { begin_ = std::move(begin); }

  // Returns the problem as the optimizer can treat it.
  const ProblemDescription& problem() const override { return treated_.description(); }
  // Besides what the Evaluator declares, throws Error{bad_data} if the journal holds another
  // evaluation than the one asked for, and Error{io} if the journal cannot be written.
  std::vector<Score> evaluate(std::span<const std::vector<double>> points) override {
    return evaluate(points, false);
  }
  std::vector<Score> evaluate_with_jacobian(std::span<const std::vector<double>> points) override;
  bool stopped() const override;
  std::int64_t remaining() const override;
  void begin_generation() override;
  bool grow_cases() override;
  std::uint64_t case_changes() const override { return case_changes_; }
  std::size_t cases() const override { return block_.numbers.size(); }
  bool may_change_cases() const override { return plan_.schedule.changes_cases(); }
  void recommend(std::span<const double> x) override;
  void explain_end(std::string_view reason) override;
  void explain_choice(std::string_view sentences) override;

  bool budget_spent() const { return budget_spent_; }
  const RunCounts& counts() const { return counts_; }
  // Returns the reason of the first evaluation without objectives; empty if there is none.
  const std::string& first_failure() const { return first_failure_; }
  // Returns the smallest constraint violation of all evaluations, or nothing if there is none.
  std::optional<double> least_violation() const { return least_violation_; }
  // To be called after the optimizer has returned by itself, not after a stop. Throws
  // Error{bad_data} if the journal holds more evaluations than the optimizer has asked for.
  void check_replay_complete() const;
  // To be called after the optimizer has ended, before select_candidates(). Makes candidates of the
  // decision vectors that it recommended after the budget had ended. A resumed run takes those that
  // the journal has instead; a new one appends its own to the journal. Throws Error{bad_data} if
  // the recorded ones do not fit the problem, and Error{io}.
  void take_late_recommendations();
  // Returns why the optimizer says that it ended; empty if it does not say.
  const std::string& end_detail() const { return end_detail_; }
  // Returns which optimizer it says that it chose, and why; empty if it chooses none.
  const std::string& choice() const { return choice_; }
  // To be called after the optimizer has failed. Counts and keeps the recorded evaluations that the
  // optimizer has not asked for, also those behind a gap, as if it had. An attempt that fails
  // earlier than a former one therefore loses none of its evaluations. (Recommendations before the
  // end of the budget are not in the journal, so those of former attempts are lost unless they are
  // made again.) Throws
  // Error{bad_data} if an evaluation belongs to a generation before the present one.
  void take_remaining_recorded();
  std::vector<Candidate> select_candidates() const { return candidates_.select(); }
  std::vector<Candidate> select_earlier_candidates() const { return candidates_.select_earlier(); }

 private:
  struct Batch;
  std::vector<Score> evaluate(std::span<const std::vector<double>> points, bool with_jacobian);
  std::vector<Score> evaluate_batch(std::span<const std::vector<double>> points,
                                    bool with_jacobian);
  bool races(Racing::Kind kind, bool with_jacobian) const;
  std::vector<std::size_t> answer_from_journal(Batch& batch);
  void count_replayed(Batch& batch);
  void simulate(Batch& batch, const std::vector<std::size_t>& missing);
  void halve(Batch& batch);
  std::uint64_t calc_cases_left() const {
    return static_cast<std::uint64_t>(plan_.budget) - counts_.cases;
  }
  EvaluationRecord make_request(std::span<const double> x) const;
  void check_replay(const EvaluationRecord& request, const EvaluationRecord& recorded,
                    double threshold) const;
  void check_race(const std::vector<EvaluationRecord>& records) const;
  void start_generation();
  [[noreturn]] void refuse_replay(std::uint64_t evaluation, const std::string& difference) const;
  void finish_evaluation(EvaluationRecord record, Score& score);
  void report(std::uint64_t more_cases, std::uint64_t more_replayed);

  const RunPlan& plan_;
  CaseExecutor& executor_;
  StopSignal& stop_;
  Journal& journal_;
  RunObserver& observer_;
  const TreatedProblem treated_;
  Ask ask_;                      // empty if candidates are simulated
  std::function<void()> begin_;  // empty if called, or if the run is not continued
  const RecordedEvaluations recorded_;
  bool budget_spent_ = false;
  bool stopped_ = false;
  bool journal_ended_;
  RunCounts counts_;
  std::uint64_t replayed_cases_ = 0;  // of the evaluations in counts_.replayed
  std::string first_failure_;
  std::string end_detail_;
  std::string choice_;
  std::vector<double> late_;  // recommended after the end of the budget, one after the other
  std::optional<LateRecommendations> recorded_late_;
  std::optional<double> least_violation_;
  CaseBlock block_;
  std::uint64_t case_changes_ = 0;
  std::optional<CaseBreeder> breeder_;  // set if the schedule breeds cases
  std::optional<CaseGrowth> growth_;    // set if the cases grow
  CandidatePool candidates_;
};

}  // namespace armwright
