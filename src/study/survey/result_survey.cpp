// Compares a run's result.json with its journal.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/bits.hpp"
#include "study/run/winner_selection.hpp"
#include "study/survey/derived_survey.hpp"

namespace armwright {
namespace {

// Two NaN count as equal: JSON stores every NaN in the same way.
bool same_errors(const std::vector<double>& a, const std::vector<double>& b) {
  return std::ranges::equal(a, b, [](double one, double other) {
    return one == other || (std::isnan(one) && std::isnan(other));
  });
}

bool same_values(const Evaluation& a, const Evaluation& b) {
  return a.status == b.status && a.reason == b.reason && a.failed_cases == b.failed_cases &&
         same_bits(a.objectives, b.objectives) &&
         same_bits(a.constraint_values, b.constraint_values) && same_bits(a.metrics, b.metrics) &&
         same_errors(a.case_errors, b.case_errors);
}

}  // namespace

ResultSurvey::ResultSurvey(RunResult result) : result_(std::move(result)) {
  for (std::size_t i = 0; i < result_.judged.size(); ++i) {
    const Candidate& candidate = result_.judged[i].candidate;
    if (!candidate.recommended) {
      by_evaluation_.emplace(candidate.evaluation, i);
    }
    trained_.push_back(candidate.recommended);
  }
  judged_.resize(result_.judged.size());
  validated_.resize(result_.judged.size());
  further_.resize(result_.judged.size());
}

void ResultSurvey::add(const EvaluationRecord& record) {
  if (record.cases.role == CaseRole::training) {
    const Evaluation& evaluation = record.evaluation;
    if (evaluation.objectives.empty() &&
        (!first_failure_ || record.index < first_failure_->first)) {
      first_failure_ = {record.index, evaluation.reason};
    }
    if (!evaluation.constraint_values.empty()) {
      const double violation = calc_violation(evaluation.constraint_values);
      least_violation_ = std::min(least_violation_.value_or(violation), violation);
    }
    most_generations_ = std::max(most_generations_, record.generation);
    if (is_feasible(record.evaluation)) {
      const std::pair here(calc_scalar(result_.objective_weights, record.evaluation.objectives),
                           record.index);
      best_ = best_ ? std::min(*best_, here) : here;
      if (!last_ || record.index > *last_) {
        last_ = record.index;
        last_generation_ = record.generation;
      }
      has_generations_ = has_generations_ || record.generation > 0;
    }
    const auto [begin, end] = by_evaluation_.equal_range(record.index);
    for (auto judged = begin; judged != end; ++judged) {
      const Candidate& candidate = result_.judged[judged->second].candidate;
      const auto& objectives = record.evaluation.objectives;
      if (same_bits(candidate.x, record.x) && candidate.generation == record.generation &&
          !objectives.empty() &&
          calc_scalar(result_.objective_weights, objectives) == candidate.training_objective) {
        trained_[judged->second] = true;
      }
    }
    return;
  }
  for (std::size_t i = 0; i < result_.judged.size(); ++i) {
    const JudgedCandidate& judged = result_.judged[i];
    if (!same_bits(judged.candidate.x, record.x)) {
      continue;
    }
    const std::vector<std::uint64_t>& cases = record.cases.numbers;
    if (record.cases.role == CaseRole::validation && !cases.empty() && cases.front() > 0) {
      further_[i][{cases.front(), cases.size()}] =
          summarize(record.evaluation.case_errors, get_failure_error(result_)).failures;
    } else if (record.cases.role == CaseRole::validation) {
      judged_[i] = true;
      validated_[i] = validated_[i] || same_values(record.evaluation, judged.validation);
    } else if (result_.winner == i) {
      is_winner_judged_ = true;
      tested_ = tested_ || same_values(record.evaluation, result_.test);
      test_set_ = record.cases.set;
    }
  }
}

// The file has one row per generation, or without generations one row per improvement.
std::optional<std::uint64_t> ResultSurvey::calc_last_row() const {
  if (!last_ || (has_generations_ && last_generation_ == 0)) {
    return std::nullopt;
  }
  return (has_generations_ ? *last_ : best_->second) + 1;
}

std::size_t ResultSurvey::count_lost_judgements() const {
  std::size_t lost = result_.winner && !is_winner_judged_ ? 1 : 0;
  for (std::size_t i = 0; i < result_.judged.size(); ++i) {
    lost += trained_[i] && !judged_[i] ? 1 : 0;
  }
  return lost;
}

bool ResultSurvey::has_further(std::size_t place) const {
  const JudgedCandidate& judged = result_.judged[place];
  const std::uint64_t step = judged.validation.case_errors.size();
  std::uint64_t failures = 0;
  for (std::uint64_t first = step; step > 0 && first < step + judged.further_cases; first += step) {
    const auto found = further_[place].find({first, step});
    if (found == further_[place].end()) {
      return false;
    }
    failures += found->second;
  }
  return failures == judged.further_failures;
}

std::string ResultSurvey::find_difference(const JournalSurvey& journal) const {
  // If a failed run is tried again, its journal may have more evaluations than its result.
  if (result_.failure.empty()) {
    const struct {
      const char* what;
      std::uint64_t here;
      std::uint64_t there;
    } counts[] = {
        {"evaluations", result_.counts.evaluations, journal.evaluations.size()},
        {"cases", result_.counts.cases, journal.counts.cases},
        {"evaluations outside the bounds", result_.counts.clipped, journal.counts.clipped},
        {"failed evaluations", result_.counts.failed, journal.counts.failed},
        {"abandoned evaluations", result_.counts.abandoned, journal.counts.abandoned},
        {"feasible evaluations", result_.counts.feasible, journal.counts.feasible},
    };
    for (const auto& [what, here, there] : counts) {
      if (here != there) {
        return fmt::format("it counts {} {}, and the journal {}", here, what, there);
      }
    }
    if (result_.counts.generations < most_generations_) {
      return fmt::format("it counts {} generations, and the journal {}", result_.counts.generations,
                         most_generations_);
    }
    if (journal.end && journal.end->reason != result_.end_reason) {
      return fmt::format("its end_reason is '{}', and the journal's '{}'", result_.end_reason,
                         journal.end->reason);
    }
    if (result_.first_failure != (first_failure_ ? first_failure_->second : "")) {
      return "its first_failure is not that of the journal";
    }
    if (result_.least_violation && result_.least_violation != least_violation_) {
      return "its least_violation is not that of the journal";
    }
  }
  for (std::size_t i = 0; i < result_.judged.size(); ++i) {
    const char* who = result_.winner == i ? "the winner" : "a judged design";
    if (!trained_[i]) {
      return fmt::format("{} (evaluation {}) is not what the journal records", who,
                         result_.judged[i].candidate.evaluation);
    }
    if (!validated_[i]) {
      return fmt::format("its values of {} on the validation set are not in the journal", who);
    }
    if (!has_further(i)) {
      return fmt::format("its failures of {} on further validation cases are not in the journal",
                         who);
    }
  }
  if (result_.winner && !tested_) {
    return "its values of the winner on the test set are not in the journal";
  }
  ProblemDescription problem;
  problem.objectives = result_.objectives;
  problem.objective_weights = result_.objective_weights;
  problem.failure_error = get_failure_error(result_);
  if (choose_winner(problem, result_.judged) != result_.winner) {
    return "its winner is not the best of the judged designs";
  }
  if (result_.winner && test_set_ != result_.test_set) {
    return fmt::format("its test_set is {}, and the winner was tested on {}", result_.test_set,
                       test_set_);
  }
  return "";
}

}  // namespace armwright
