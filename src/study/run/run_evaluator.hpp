// The run's Evaluator: counts the budget exactly (a batch is cut where it ends, whole candidates
// only), clips points to the bounds and counts that, supplies the training cases, holds the races
// (study/racing.hpp) and breeds cases (study/case_breeder.hpp), answers from the journal what a
// former process has evaluated already, journals the rest as it finishes, and remembers the points
// worth judging.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "optimizers/interface/evaluator.hpp"
#include "study/executor/case_executor.hpp"
#include "study/journal/journal.hpp"
#include "study/run/candidate_pool.hpp"
#include "study/run/case_breeder.hpp"
#include "study/run/racing.hpp"
#include "study/run/run_counts.hpp"
#include "study/run/run_observer.hpp"
#include "study/run/run_plan.hpp"

namespace armwright {
class RunEvaluator final : public Evaluator {
 public:
  RunEvaluator(const RunPlan& plan, CaseRunner& runner, StopSignal& stop, Journal& journal,
               JournalContent recorded, RunObserver& observer);

  const ProblemDescription& problem() const override;
  std::vector<Score> evaluate(std::span<const std::vector<double>> points) override {
    return evaluate(points, false);
  }
  std::vector<Score> evaluate_with_jacobian(std::span<const std::vector<double>> points) override;
  bool stopped() const override;
  std::int64_t remaining() const override;
  void begin_generation() override;
  void recommend(std::span<const double> x) override;

  bool budget_spent() const { return budget_spent_; }
  const RunCounts& counts() const { return counts_; }
  // Why the first evaluation without objectives has none; empty if there is no such.
  const std::string& first_failure() const { return first_failure_; }
  // The smallest of an evaluation; nothing without constraints, or if none had a number.
  std::optional<double> least_violation() const { return least_violation_; }
  // Once the optimizer has returned by itself: Error{bad_data} if the journal holds more
  // evaluations than it asked for; not after a stop.
  void check_replay_complete() const;
  // Once the optimizer has failed: counts and remembers, as if it had asked for them, the
  // evaluations in the journal that it has not come to, those behind a gap too. What an earlier
  // attempt at the run achieved is so not lost to a later one that fails sooner. (Recommendations
  // are not in the journal: those of an earlier attempt only count where this one repeats them.)
  // Error{bad_data} if they belong to a generation before the present one.
  void take_remaining_recorded();
  std::vector<Candidate> select_candidates() const { return candidates_.select(); }

 private:
  // Candidates that are asked for together, and what is known of them.
  struct Batch {
    std::vector<EvaluationRecord> records;
    std::vector<char> answered;  // from the journal or by simulation
    bool with_jacobian = false;
    std::uint64_t replayed_cases = 0;
    double threshold = 0;  // of abandonment
  };
  std::vector<Score> evaluate(std::span<const std::vector<double>> points, bool with_jacobian);
  std::vector<Score> evaluate_batch(std::span<const std::vector<double>> points,
                                    bool with_jacobian);
  bool races(Racing::Kind kind, bool with_jacobian) const;
  std::vector<std::size_t> answer_from_journal(Batch& batch);
  void count_replayed(Batch& batch);  // what the journal has answered
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
  void take(EvaluationRecord record, Score& score);
  void report(std::uint64_t more_cases, std::uint64_t more_replayed);

  const RunPlan& plan_;
  CaseRunner& runner_;
  StopSignal& stop_;
  Journal& journal_;
  RunObserver& observer_;
  const RecordedEvaluations recorded_;
  bool budget_spent_ = false;
  bool stopped_ = false;
  bool journal_ended_;
  RunCounts counts_;
  std::uint64_t replayed_cases_ = 0;  // those of counts_.replayed
  std::string first_failure_;
  std::optional<double> least_violation_;
  CaseBlock block_;
  std::optional<CaseBreeder> breeder_;  // of a schedule that breeds
  CandidatePool candidates_;
};

}  // namespace armwright
