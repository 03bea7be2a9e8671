// Answers the questions of one NLopt search, one point at a time. NLopt asks for the objective and
// for each constraint in separate calls; this class keeps the latest evaluations to answer them. It
// holds the exceptions of the evaluator until the C code has returned. It does not need nlopt.h.
//
// NLopt gets finite numbers only. A failed evaluation answers with its penalty and with strongly
// violated constraints. A point with a coordinate that is not finite (some algorithms ask for NaN)
// is not evaluated; it gets the worst objective so far. Gradients are finite differences.
#pragma once

#include <array>
#include <cstdint>
#include <exception>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "optimizers/interface/differences.hpp"
#include "optimizers/interface/scalar_function.hpp"
#include "optimizers/nlopt/nlopt_backend.hpp"

namespace armwright {

class NloptAdapter {
 public:
  NloptAdapter(const NloptSettings& settings, Evaluator& evaluator);

  const SearchSpace& space() const { return function_.space(); }
  // Begins a search. Calls `stop_solver` when the evaluator has stopped or thrown.
  void begin(std::function<void()> stop_solver);
  bool has_ended() const { return has_stopped_ || exception_ != nullptr; }
  // Throws the exception that the evaluator threw, if it did.
  void rethrow() const;

  bool has_best() const { return !best_.coordinates.empty(); }
  const std::vector<double>& best_coordinates() const { return best_.coordinates; }
  std::pair<double, double> best_rank() const { return {best_.violation, best_.objective}; }

  // Answer NLopt. Every call for the objective is one evaluation, as with NLopt alone, unless a
  // constraint at the same point was asked for before.
  // Fill the gradient unless it is empty; it has one number per coordinate.
  double ask_objective(std::span<const double> coordinates, std::span<double> gradient = {});
  double ask_constraint(std::span<const double> coordinates, std::size_t index,
                        std::span<double> gradient = {});

 private:
  struct Answer {
    std::vector<double> coordinates = {};
    double objective = 0;
    std::vector<double> constraint_values = {};
    double violation = 0;
    bool is_objective_used = false;
    // Per coordinate, those of the objective and of each constraint. Empty if they are not known.
    std::vector<std::vector<double>> derivatives = {};
  };

  Answer* find(std::span<const double> coordinates);
  // Returns null for a point with a coordinate that is not finite, and after the end of the search.
  Answer* evaluate(std::span<const double> coordinates, bool with_derivatives);
  Answer& evaluate_place(const std::vector<double>& coordinates, bool with_derivatives);
  // Returns the objective that NLopt gets, and then the constraints.
  std::vector<double> list_values(const Score& score) const;
  Answer& remember(std::span<const double> coordinates, std::span<const double> values);
  void stop_solver();

  const NloptSettings& settings_;
  ScalarFunction function_;
  std::optional<DifferencedFunction> differenced_;  // if NLopt gets gradients
  // NLopt gets the objective in units of its largest slope at the search's first place: its first step is
  // as long as the gradient, and would otherwise depend on the objective's unit. 0: not known yet.
  double objective_unit_ = 0;
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
