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

// Writes the derivatives of a value into the gradient; zeros if they are not known.
void write_gradient(const std::vector<std::vector<double>>& derivatives, std::size_t value,
                    std::span<double> gradient) {
  for (std::size_t i = 0; i < gradient.size(); ++i) {
    gradient[i] = derivatives.empty() ? 0 : derivatives[i][value];
  }
}

}  // namespace

NloptAdapter::NloptAdapter(const NloptSettings& settings, Evaluator& evaluator)
    : settings_(settings), function_(evaluator) {
  if (settings.differences) {
    // A failure counts as its penalty here too, so that a failed start has slopes to leave it by.
    differenced_.emplace(
        evaluator, [this](const Score& score) { return list_values(score); },
        *settings.differences);
  }
}

void NloptAdapter::begin(std::function<void()> stop_solver) {
  stop_solver_ = std::move(stop_solver);
  calls_ = 0;
  nan_sequence_ = 0;
  objective_unit_ = 0;
}

void NloptAdapter::rethrow() const {
  if (exception_) {
    std::rethrow_exception(exception_);
  }
}

double NloptAdapter::ask_objective(std::span<const double> coordinates,
                                   std::span<double> gradient) {
  ++calls_;
  Answer* answer = find(coordinates);
  // A differenced function has no place evaluated twice.
  const bool needs_slopes = !gradient.empty() || (differenced_ && objective_unit_ == 0);
  if (answer == nullptr || (answer->is_objective_used && !differenced_) ||
      (needs_slopes && answer->derivatives.empty())) {
    answer = evaluate(coordinates, needs_slopes);
  }
  if (answer == nullptr) {
    write_gradient({}, 0, gradient);
    return worst_objective_ / (objective_unit_ > 0 ? objective_unit_ : 1);
  }
  answer->is_objective_used = true;
  if (!differenced_) {
    return answer->objective;
  }
  if (objective_unit_ == 0) {
    for (const std::vector<double>& slopes : answer->derivatives) {
      objective_unit_ = std::max(objective_unit_, std::abs(slopes[0]));
    }
    objective_unit_ = objective_unit_ > 0 ? objective_unit_ : 1;
  }
  write_gradient(answer->derivatives, 0, gradient);
  for (double& slope : gradient) {
    slope /= objective_unit_;
  }
  return answer->objective / objective_unit_;
}

double NloptAdapter::ask_constraint(std::span<const double> coordinates, std::size_t index,
                                    std::span<double> gradient) {
  ++calls_;
  const Answer* answer = find(coordinates);
  if (answer == nullptr || (!gradient.empty() && answer->derivatives.empty())) {
    answer = evaluate(coordinates, !gradient.empty());
  }
  if (answer == nullptr) {
    write_gradient({}, 0, gradient);
    return kFailedConstraint;
  }
  write_gradient(answer->derivatives, index + 1, gradient);
  return answer->constraint_values[index];
}

NloptAdapter::Answer* NloptAdapter::find(std::span<const double> coordinates) {
  const auto found = std::ranges::find_if(
      answers_, [&](const Answer& answer) { return same_bits(answer.coordinates, coordinates); });
  return found == answers_.end() ? nullptr : &*found;
}

NloptAdapter::Answer* NloptAdapter::evaluate(std::span<const double> coordinates,
                                             bool with_derivatives) {
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
    return differenced_
               ? &evaluate_place({coordinates.begin(), coordinates.end()}, with_derivatives)
               : &remember(coordinates, list_values(function_.evaluate_point(point)));
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

NloptAdapter::Answer& NloptAdapter::evaluate_place(const std::vector<double>& coordinates,
                                                   bool with_derivatives) {
  const auto& place = differenced_->evaluate_place(coordinates, with_derivatives);
  Answer& answer = remember(coordinates, place.values);
  answer.derivatives = place.derivatives;
  return answer;
}

std::vector<double> NloptAdapter::list_values(const Score& score) const {
  const ProblemDescription& problem = function_.evaluator().problem();
  if (!settings_.takes_constraints) {
    return {calc_merit(problem, score, settings_.constraint_weight)};
  }
  std::vector<double> values = {calc_scalar(problem, score.objectives)};
  values.insert(values.end(), score.constraint_values.begin(), score.constraint_values.end());
  values.resize(1 + problem.constraints.size(), kFailedConstraint);
  return values;
}

NloptAdapter::Answer& NloptAdapter::remember(std::span<const double> coordinates,
                                             std::span<const double> values) {
  Answer& answer = answers_[next_answer_];
  next_answer_ = (next_answer_ + 1) % answers_.size();
  answer.coordinates.assign(coordinates.begin(), coordinates.end());
  answer.is_objective_used = false;
  answer.derivatives.clear();
  answer.objective = values.front();
  answer.constraint_values.assign(values.begin() + 1, values.end());
  answer.violation = calc_violation(answer.constraint_values);
  const bool is_first = !has_best();
  if (is_first || std::pair{answer.violation, answer.objective} < best_rank()) {
    best_ = answer;
  }
  worst_objective_ = is_first ? answer.objective : std::max(worst_objective_, answer.objective);
  return answer;
}

}  // namespace armwright
