#include "study/compare/choices.hpp"

#include <algorithm>
#include <numeric>

#include "base/bits.hpp"
#include "study/run/candidate_pool.hpp"
#include "study/run/winner_selection.hpp"
#include "study/statistics/summary.hpp"

namespace armwright {
namespace {

// Returns per budget the candidates that would be judged if the run ended there.
std::vector<std::vector<Candidate>> select_along(const RunPlan& run,
                                                 const RecordedEvaluations& training,
                                                 std::span<const std::int64_t> budgets) {
  std::vector<std::vector<Candidate>> selections;
  CandidatePool pool(run);
  std::uint64_t generation = 0;
  std::int64_t cases = 0;
  auto record = training.begin();
  for (const std::int64_t budget : budgets) {
    for (; record != training.end(); ++record) {
      const std::int64_t after = cases + static_cast<std::int64_t>(record->calc_charge());
      if (after > budget) {
        break;
      }
      cases = after;
      if (run.schedule.renews_cases() && record->generation != generation) {
        pool.end_generation();
        generation = record->generation;
      }
      if (is_feasible(record->evaluation)) {
        pool.consider(*record);
      }
    }
    selections.push_back(pool.select());
  }
  return selections;
}

}  // namespace

DesignBench::DesignBench(const LoadedProblem& problem, CaseRole role, CaseExecutor& executor,
                         StopSignal& stop)
    : problem_(*problem.problem), executor_(executor), stop_(stop) {
  const bool is_test = role == CaseRole::test;
  block_.role = role;
  block_.set = is_test ? problem.sets.test : problem.sets.validation;
  const int cases = is_test ? problem.sets.test_cases : problem.sets.validation_cases;
  block_.numbers.resize(static_cast<std::size_t>(cases));
  std::iota(block_.numbers.begin(), block_.numbers.end(), std::uint64_t{0});
}

bool DesignBench::add(std::span<const std::vector<double>> designs) {
  std::vector<std::span<const double>> candidates;
  for (const auto& x : designs) {
    if (find(x) == nullptr &&
        std::ranges::none_of(candidates, [&](const auto& y) { return same_bits(x, y); })) {
      candidates.emplace_back(x);
    }
  }
  const std::size_t first = designs_.size();
  for (const auto& x : candidates) {
    designs_.emplace_back(x.begin(), x.end());
  }
  evaluations_.resize(designs_.size());
  executor_.evaluate(problem_, candidates, block_, {}, stop_,
                     [&](std::size_t candidate, Evaluation evaluation) {
                       evaluations_[first + candidate] = std::move(evaluation);
                     });
  return !stop_.requested();
}

const Evaluation* DesignBench::find(std::span<const double> x) const {
  for (std::size_t i = 0; i < designs_.size(); ++i) {
    if (same_bits(designs_[i], x)) {
      return &evaluations_[i];
    }
  }
  return nullptr;
}

ErrorSummary summarize_errors(const LoadedProblem& problem, const Evaluation& evaluation) {
  return summarize(evaluation.case_errors, problem.problem->description().failure_error);
}

std::optional<std::vector<std::optional<JudgedCandidate>>> make_choices(
    const RunPlan& run, const RecordedEvaluations& training, const RunResult& result,
    std::span<const std::int64_t> budgets, CaseExecutor& executor, StopSignal& stop) {
  const auto selections = select_along(run, training, budgets);
  std::vector<std::vector<double>> designs;
  for (const auto& selection : selections) {
    for (const Candidate& candidate : selection) {
      designs.push_back(candidate.x);
    }
  }
  DesignBench bench(run.problem, CaseRole::validation, executor, stop);
  if (!bench.add(designs)) {
    return std::nullopt;
  }
  std::vector<std::optional<JudgedCandidate>> choices;
  for (std::size_t i = 0; i < budgets.size(); ++i) {
    std::vector<JudgedCandidate> judged;
    if (i > 0 && choices.back()) {
      judged.push_back(*choices.back());
    }
    for (const Candidate& candidate : selections[i]) {
      judged.push_back({candidate, bench.get(candidate.x)});
    }
    if (i + 1 == budgets.size() && result.winner) {
      judged.push_back(result.judged[*result.winner]);
    }
    const auto best = choose_winner(run.problem.problem->description(), judged);
    choices.push_back(best ? std::optional(judged[*best]) : std::nullopt);
  }
  return choices;
}

}  // namespace armwright
