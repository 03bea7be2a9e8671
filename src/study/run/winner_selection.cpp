#include "study/run/winner_selection.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <mutex>
#include <numeric>
#include <span>
#include <utility>

#include "base/bits.hpp"
#include "base/error.hpp"
#include "study/statistics/values.hpp"

namespace armwright {
namespace {

CaseBlock make_block(CaseRole role, const std::string& set, int cases, std::uint64_t first = 0) {
  CaseBlock block{role, set, std::vector<std::uint64_t>(static_cast<std::size_t>(cases))};
  std::iota(block.numbers.begin(), block.numbers.end(), first);
  return block;
}

bool same_request(const EvaluationRecord& record, std::span<const double> x,
                  const CaseBlock& block) {
  return record.cases.role == block.role && record.cases.set == block.set &&
         record.cases.numbers == block.numbers && same_bits(record.x, x);
}

// Returns the first training evaluation of each design, made a judgement of the same case; nothing
// for a design that has none. Judgements know no penalties: a failed case is a case without an error.
std::vector<std::optional<Evaluation>> find_evaluated(
    const std::vector<std::vector<double>>& designs, const RecordedEvaluations& training) {
  std::vector<std::optional<Evaluation>> found(designs.size());
  std::size_t missing = designs.size();
  for (auto record = training.begin(); missing > 0 && record != training.end(); ++record) {
    for (std::size_t i = 0; i < designs.size(); ++i) {
      if (found[i] || !same_bits(record->x, designs[i])) {
        continue;
      }
      Evaluation& evaluation = found[i].emplace(record->evaluation);
      evaluation.residuals.clear();
      evaluation.jacobian.clear();
      if (evaluation.objectives.empty()) {
        evaluation.failed_cases = static_cast<int>(evaluation.case_errors.size());
        std::ranges::fill(evaluation.case_errors, std::numeric_limits<double>::quiet_NaN());
      }
      --missing;
    }
  }
  return found;
}

std::vector<std::vector<double>> list_designs(const std::vector<Candidate>& candidates) {
  std::vector<std::vector<double>> designs;
  for (const Candidate& candidate : candidates) {
    designs.push_back(candidate.x);
  }
  return designs;
}

// Removes the candidates that have no training evaluation.
void drop_unevaluated(const RecordedEvaluations& training, std::vector<Candidate>& candidates) {
  const auto found = find_evaluated(list_designs(candidates), training);
  std::size_t i = 0;
  std::erase_if(candidates, [&](const Candidate&) { return !found[i++]; });
}

// Evaluates designs on validation and test cases, with the journal as a cache.
class JournalledEvaluation {
 public:
  JournalledEvaluation(const RunPlan& plan, const JournalContent& recorded,
                       const RecordedEvaluations& training, CaseExecutor& executor,
                       StopSignal& stop, Journal& journal, RunObserver& observer)
      : plan_(plan),
        recorded_(recorded),
        training_(training),
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
    const auto finish = [&](std::size_t design, Evaluation evaluation) {
      EvaluationRecord record;
      record.index = design;
      record.x = designs[design];
      record.cases = block;
      record.evaluation = std::move(evaluation);
      journal_.append(record);
      evaluations[design] = std::move(record.evaluation);
      const std::lock_guard lock(mutex);
      ++done;
      progress.done += block.numbers.size();
      observer_.on_progress(progress);
    };
    const std::size_t wanted = missing.size();
    if (is_same_case(block)) {
      take_evaluated(designs, missing, candidates, finish);
    }
    executor_.evaluate(*plan_.problem.problem, candidates, block, {}, stop_,
                       [&](std::size_t candidate, Evaluation evaluation) {
                         finish(missing[candidate], std::move(evaluation));
                       });
    journal_.flush();
    if (done < wanted) {
      return std::nullopt;
    }
    if (is_same_case(block)) {
      judged_designs_ = designs;
      judgements_ = evaluations;
    }
    return evaluations;
  }

 private:
  // Returns whether a training evaluation has the outcome of this block.
  bool is_same_case(const CaseBlock& block) const {
    return plan_.problem.problem->description().has_single_case && block.numbers.size() == 1;
  }

  // Finishes the missing designs that have a training evaluation or a judgement. Leaves the others.
  void take_evaluated(const std::vector<std::vector<double>>& designs,
                      std::vector<std::size_t>& missing,
                      std::vector<std::span<const double>>& candidates,
                      const std::function<void(std::size_t, Evaluation)>& finish) const {
    std::vector<std::vector<double>> wanted;
    for (const std::size_t design : missing) {
      wanted.push_back(designs[design]);
    }
    auto found = find_evaluated(wanted, training_);
    std::vector<std::size_t> left;
    candidates.clear();
    for (std::size_t i = 0; i < missing.size(); ++i) {
      const auto judged = std::ranges::find_if(
          judged_designs_, [&](const auto& x) { return same_bits(x, wanted[i]); });
      if (!found[i] && judged != judged_designs_.end()) {
        found[i] = judgements_[static_cast<std::size_t>(judged - judged_designs_.begin())];
      }
      if (found[i]) {
        finish(missing[i], std::move(*found[i]));
      } else {
        left.push_back(missing[i]);
        candidates.emplace_back(designs[missing[i]]);
      }
    }
    missing = std::move(left);
  }

  const RunPlan& plan_;
  const JournalContent& recorded_;
  const RecordedEvaluations& training_;
  CaseExecutor& executor_;
  StopSignal& stop_;
  Journal& journal_;
  RunObserver& observer_;
  // Of a problem with a single case: what was judged on the validation set.
  std::vector<std::vector<double>> judged_designs_;
  std::vector<Evaluation> judgements_;
};

std::uint64_t count_failures(const ProblemDescription& problem, const Evaluation& evaluation) {
  return summarize(evaluation.case_errors, problem.failure_error).failures;
}

double calc_share(std::uint64_t failures, std::uint64_t cases) {
  return cases > 0 ? static_cast<double>(failures) / static_cast<double>(cases) : 0;
}

}  // namespace

DesignRank calc_rank(const ProblemDescription& problem, const Evaluation& evaluation) {
  DesignRank rank{.failing_share = calc_share(count_failures(problem, evaluation),
                                              evaluation.case_errors.size()),
                  .violation = kInfinity,
                  .objective = kInfinity};
  if (!evaluation.objectives.empty()) {
    rank.violation = calc_violation(evaluation.constraint_values);
    rank.objective = calc_scalar(problem, evaluation.objectives);
  }
  return rank;
}

DesignRank calc_rank(const ProblemDescription& problem, const JudgedCandidate& judged) {
  DesignRank rank = calc_rank(problem, judged.validation);
  rank.failing_share =
      calc_share(count_failures(problem, judged.validation) + judged.further_failures,
                 judged.validation.case_errors.size() + judged.further_cases);
  return rank;
}

std::optional<std::size_t> choose_winner(const ProblemDescription& problem,
                                         const std::vector<JudgedCandidate>& judged) {
  std::optional<std::size_t> winner;
  std::optional<DesignRank> best;
  for (std::size_t i = 0; i < judged.size(); ++i) {
    if (judged[i].validation.objectives.empty()) {
      continue;
    }
    const DesignRank rank = calc_rank(problem, judged[i]);
    if (!best || rank < *best) {
      winner = i;
      best = rank;
    }
  }
  return winner;
}

bool select_winner(const RunPlan& plan, std::vector<Candidate> candidates,
                   std::vector<Candidate> earlier, const JournalContent& recorded,
                   const RecordedEvaluations& training, CaseExecutor& executor, StopSignal& stop,
                   Journal& journal, RunObserver& observer, bool is_single, RunResult& result) {
  const CaseSets& sets = plan.problem.sets;
  JournalledEvaluation evaluation(plan, recorded, training, executor, stop, journal, observer);
  const ProblemDescription& description = plan.problem.problem->description();
  const auto judge = [&](std::vector<Candidate>& some) {
    if (plan.selection.evaluated_only) {
      drop_unevaluated(training, some);
    }
    auto validated = evaluation.evaluate(
        list_designs(some),
        make_block(CaseRole::validation, sets.validation, sets.validation_cases));
    for (std::size_t i = 0; validated && i < some.size(); ++i) {
      result.judged.push_back({std::move(some[i]), std::move((*validated)[i])});
    }
    result.winner = choose_winner(description, result.judged);
    return validated.has_value();
  };
  const auto fails = [&] {
    return !result.winner ||
           calc_rank(description, result.judged[*result.winner]).failing_share > 0;
  };
  const bool can_fail = std::isfinite(description.failure_error) && !description.has_single_case;
  const auto most_further = static_cast<std::uint64_t>(sets.validation_cases) *
                            (is_single && can_fail ? kConfirmationFactor - 1 : 0);
  // Returns false if stopped.
  const auto confirm = [&] {
    while (!fails() && result.judged[*result.winner].further_cases < most_further) {
      JudgedCandidate& best = result.judged[*result.winner];
      const auto first = static_cast<std::uint64_t>(sets.validation_cases) + best.further_cases;
      const auto further = evaluation.evaluate(
          {best.candidate.x},
          make_block(CaseRole::validation, sets.validation, sets.validation_cases, first));
      if (!further) {
        return false;
      }
      best.further_cases += static_cast<std::uint64_t>(sets.validation_cases);
      best.further_failures += count_failures(description, further->front());
      result.winner = choose_winner(description, result.judged);
    }
    return true;
  };
  if (!judge(candidates) || !confirm()) {
    return false;
  }
  if (!earlier.empty() && fails() && (!judge(earlier) || !confirm())) {
    return false;
  }
  if (!result.winner) {
    return true;
  }
  const std::vector<double>& winner = result.judged[*result.winner].candidate.x;
  const std::vector<double> start = list_starts(description.variables);
  std::vector<std::vector<double>> designs_to_test = {winner};
  if (is_single && !same_bits(start, winner)) {
    designs_to_test.push_back(start);
  }
  auto tested =
      evaluation.evaluate(designs_to_test, make_block(CaseRole::test, sets.test, sets.test_cases));
  if (!tested) {
    return false;
  }
  result.test = tested->front();
  result.test_summary = summarize(result.test.case_errors, get_failure_error(result));
  if (is_single) {
    const bool is_better =
        calc_rank(description, result.test) < calc_rank(description, tested->back());
    result.start = JudgedStart{.test = tested->back(), .is_worse_than_winner = is_better};
  }
  return true;
}

}  // namespace armwright
