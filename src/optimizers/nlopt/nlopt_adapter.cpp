#include "optimizers/nlopt/nlopt_adapter.hpp"

#include <algorithm>
#include <cmath>

#include "base/bits.hpp"

namespace armwright {
namespace {

// The violation of every constraint by a failed evaluation: larger than that of any design, and
// small enough for linear models of the constraints.
constexpr double kFailedConstraint = 1e9;

// COBYLA and PRAXIS can ask for NaN without end once they have begun. After so many consecutive NaN
// the search from this start ends.
constexpr std::int64_t kLongestNanSequence = 1000;

bool is_finite(std::span<const double> values) {
  return std::ranges::all_of(values, [](double value) { return std::isfinite(value); });
}

}  // namespace

void NloptAdapter::begin(std::function<void()> stop_solver) {
  stop_solver_ = std::move(stop_solver);
  calls_ = 0;
  nan_sequence_ = 0;
}

void NloptAdapter::rethrow() const {
  if (exception_) {
    std::rethrow_exception(exception_);
  }
}

double NloptAdapter::ask_objective(std::span<const double> coordinates) {
  ++calls_;
  Answer* answer = find(coordinates);
  if (answer == nullptr || answer->is_objective_used) {
    answer = evaluate(coordinates);
  }
  if (answer == nullptr) {
    return worst_objective_;
  }
  answer->is_objective_used = true;
  return answer->objective;
}

double NloptAdapter::ask_constraint(std::span<const double> coordinates, std::size_t index) {
  ++calls_;
  const Answer* answer = find(coordinates);
  if (answer == nullptr) {
    answer = evaluate(coordinates);
  }
  return answer == nullptr ? kFailedConstraint : answer->constraint_values[index];
}

NloptAdapter::Answer* NloptAdapter::find(std::span<const double> coordinates) {
  const auto found = std::ranges::find_if(
      answers_, [&](const Answer& answer) { return same_bits(answer.coordinates, coordinates); });
  return found == answers_.end() ? nullptr : &*found;
}

NloptAdapter::Answer* NloptAdapter::evaluate(std::span<const double> coordinates) {
  if (has_ended()) {
    stop_solver();
    return nullptr;
  }
  const std::vector<double> point = space().to_point(coordinates);
  if (!is_finite(point)) {
    if (++nan_sequence_ >= kLongestNanSequence) {
      stop_solver();
    }
    return nullptr;
  }
  nan_sequence_ = 0;
  try {
    return &remember(coordinates, function_.evaluate_point(point));
  } catch (const EvaluatorStopped&) {
    has_stopped_ = true;
  } catch (...) {
    exception_ = std::current_exception();  // C code lies between here and who waits for it
  }
  stop_solver();
  return nullptr;
}

// Does not stop at the first point: ORIG_DIRECT would then read memory that it has not written, and
// sometimes crash. It is stopped at the second point.
void NloptAdapter::stop_solver() {
  const std::int64_t calls_a_point = 1 + std::ssize(function_.evaluator().problem().constraints);
  if (calls_ > calls_a_point) {
    stop_solver_();
  }
}

NloptAdapter::Answer& NloptAdapter::remember(std::span<const double> coordinates,
                                             const Score& score) {
  const ProblemDescription& problem = function_.evaluator().problem();
  Answer& answer = answers_[next_answer_];
  next_answer_ = (next_answer_ + 1) % answers_.size();
  answer.coordinates.assign(coordinates.begin(), coordinates.end());
  answer.is_objective_used = false;
  if (settings_.takes_constraints) {
    answer.objective = calc_scalar(problem, score.objectives);
    answer.constraint_values = score.constraint_values;
    answer.constraint_values.resize(problem.constraints.size(), kFailedConstraint);
    answer.violation = calc_violation(answer.constraint_values);
  } else {
    answer.objective = calc_merit(problem, score, settings_.constraint_weight);
  }
  const bool is_first = !has_best();
  if (is_first || std::pair{answer.violation, answer.objective} < best_rank()) {
    best_ = answer;
  }
  worst_objective_ = is_first ? answer.objective : std::max(worst_objective_, answer.objective);
  return answer;
}

}  // namespace armwright
