// What NLopt asks about, point by point: objective and constraints in separate calls, and whatever
// the evaluator does in between has to wait until C code has returned. Knows nothing of nlopt.h.
//
// NLopt is answered in finite numbers only: a failed evaluation by its penalty and by constraints
// violated beyond measure, a point that is none (some of the algorithms ask about NaN) by the worst
// objective seen, without an evaluation.
#pragma once

#include <array>
#include <cstdint>
#include <exception>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "optimizers/interface/scalar_function.hpp"
#include "optimizers/nlopt/nlopt_backend.hpp"

namespace armwright {

class NloptQuestions {
 public:
  NloptQuestions(const NloptSettings& settings, Evaluator& evaluator)
      : settings_(settings), function_(evaluator) {}

  const SearchSpace& space() const { return function_.space(); }
  // A search begins; `stop_solver` is called when there is no more to come for it.
  void begin(std::function<void()> stop_solver);
  bool has_ended() const { return has_stopped_ || exception_ != nullptr; }
  // What the evaluator threw, if it did.
  void rethrow() const;

  bool has_best() const { return !best_.coordinates.empty(); }
  const std::vector<double>& best_coordinates() const { return best_.coordinates; }
  std::pair<double, double> best_rank() const { return {best_.violation, best_.objective}; }

  // Every question for the objective is an evaluation, as it is to the bare library, unless the
  // constraints at that point came first.
  double ask_objective(std::span<const double> coordinates);
  double ask_constraint(std::span<const double> coordinates, std::size_t index);

 private:
  struct Answer {
    std::vector<double> coordinates = {};
    double objective = 0;
    std::vector<double> constraint_values = {};
    double violation = 0;
    bool is_objective_used = false;
  };

  Answer* find(std::span<const double> coordinates);
  // Null if there is no answer: nobody is asked about points that are none, nor after the end.
  Answer* evaluate(std::span<const double> coordinates);
  Answer& remember(std::span<const double> coordinates, const Score& score);
  void stop_solver();

  const NloptSettings& settings_;
  ScalarFunction function_;
  std::function<void()> stop_solver_;
  std::array<Answer, 8> answers_;  // the latest
  std::size_t next_answer_ = 0;
  Answer best_;
  double worst_objective_ = 0;
  std::int64_t calls_ = 0;  // of the current search, for objective or constraint
  std::int64_t nan_sequence_ = 0;
  bool has_stopped_ = false;
  std::exception_ptr exception_;
};

}  // namespace armwright
