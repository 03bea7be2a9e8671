#include "study/run/winner_selection.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <mutex>
#include <numeric>
#include <span>
#include <tuple>
#include <utility>

#include "base/bits.hpp"
#include "base/error.hpp"

namespace armwright {
namespace {

CaseBlock make_block(CaseRole role, const std::string& set, int cases) {
  CaseBlock block{role, set, std::vector<std::uint64_t>(static_cast<std::size_t>(cases))};
  std::iota(block.numbers.begin(), block.numbers.end(), std::uint64_t{0});
  return block;
}

bool same_request(const EvaluationRecord& record, std::span<const double> x,
                  const CaseBlock& block) {
  return record.cases.role == block.role && record.cases.set == block.set &&
         record.cases.numbers == block.numbers && same_bits(record.x, x);
}

// Evaluates designs on validation and test cases, with the journal as a cache.
class JournalledEvaluation {
 public:
  JournalledEvaluation(const RunPlan& plan, const JournalContent& recorded, CaseExecutor& executor,
                       StopSignal& stop, Journal& journal, RunObserver& observer)
      : plan_(plan),
        recorded_(recorded),
        executor_(executor),
        stop_(stop),
        journal_(journal),
        observer_(observer) {}

  // Returns one evaluation per design, or nothing if stopped.
  std::optional<std::vector<Evaluation>> evaluate(const std::vector<std::vector<double>>& designs,
                                                  const CaseBlock& block) {
    std::vector<Evaluation> evaluations(designs.size());
    std::vector<std::size_t> missing;
    std::vector<std::span<const double>> candidates;
    for (std::size_t i = 0; i < designs.size(); ++i) {
      const auto found = std::find_if(
          recorded_.judgements.begin(), recorded_.judgements.end(),
          [&](const EvaluationRecord& record) { return same_request(record, designs[i], block); });
      if (found != recorded_.judgements.end()) {
        evaluations[i] = found->evaluation;
      } else {
        missing.push_back(i);
        candidates.emplace_back(designs[i]);
      }
    }
    if (recorded_.ended && !missing.empty()) {
      throw Error(
          ErrorKind::bad_data,
          fmt::format("the recorded run has ended, but judged other designs than those that "
                      "would be judged now ({} on {} is missing). Its journal has lost records, or "
                      "it was made by another version. 'armwright doctor FOLDER' checks the run, "
                      "and --repair makes a copy that can be resumed; or resume it with the other "
                      "version, or start a new run with --new",
                      missing.size() == 1 ? "one judgement" : "judgements", block.set));
    }
    Progress progress;
    progress.phase = block.role;
    progress.total = designs.size() * block.numbers.size();
    progress.done = (designs.size() - missing.size()) * block.numbers.size();
    progress.replayed = progress.done;
    observer_.on_progress(progress);
    std::mutex mutex;
    std::size_t done = 0;
    executor_.evaluate(*plan_.problem.problem, candidates, block, {}, stop_,
                       [&](std::size_t candidate, Evaluation evaluation) {
                         EvaluationRecord record;
                         record.index = missing[candidate];
                         record.x = designs[record.index];
                         record.cases = block;
                         record.evaluation = std::move(evaluation);
                         journal_.append(record);
                         evaluations[record.index] = std::move(record.evaluation);
                         const std::lock_guard lock(mutex);
                         ++done;
                         progress.done += block.numbers.size();
                         observer_.on_progress(progress);
                       });
    journal_.flush();
    return done == missing.size() ? std::optional(std::move(evaluations)) : std::nullopt;
  }

 private:
  const RunPlan& plan_;
  const JournalContent& recorded_;
  CaseExecutor& executor_;
  StopSignal& stop_;
  Journal& journal_;
  RunObserver& observer_;
};

}  // namespace

std::optional<std::size_t> choose_winner(const ProblemDescription& problem,
                                         const std::vector<JudgedCandidate>& judged) {
  const auto rank = [&](const JudgedCandidate& candidate) {
    return std::tuple(candidate.validation.failed_cases,
                      calc_violation(candidate.validation.constraint_values),
                      calc_scalar(problem, candidate.validation.objectives));
  };
  std::optional<std::size_t> winner;
  for (std::size_t i = 0; i < judged.size(); ++i) {
    if (!judged[i].validation.objectives.empty() &&
        (!winner || rank(judged[i]) < rank(judged[*winner]))) {
      winner = i;
    }
  }
  return winner;
}

bool select_winner(const RunPlan& plan, std::vector<Candidate> candidates,
                   const JournalContent& recorded, CaseExecutor& executor, StopSignal& stop,
                   Journal& journal, RunObserver& observer, RunResult& result) {
  const CaseSets& sets = plan.problem.sets;
  JournalledEvaluation evaluation(plan, recorded, executor, stop, journal, observer);
  std::vector<std::vector<double>> designs;
  for (const Candidate& candidate : candidates) {
    designs.push_back(candidate.x);
  }
  auto validated = evaluation.evaluate(
      designs, make_block(CaseRole::validation, sets.validation, sets.validation_cases));
  if (!validated) {
    return false;
  }
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    result.judged.push_back({std::move(candidates[i]), std::move((*validated)[i])});
  }
  result.winner = choose_winner(plan.problem.problem->description(), result.judged);
  if (!result.winner) {
    return true;
  }
  auto tested = evaluation.evaluate({result.judged[*result.winner].candidate.x},
                                    make_block(CaseRole::test, sets.test, sets.test_cases));
  if (!tested) {
    return false;
  }
  result.test = std::move(tested->front());
  result.test_summary = summarize(result.test.case_errors, get_failure_error(result));
  return true;
}

}  // namespace armwright
