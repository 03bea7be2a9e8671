// The interface through which an optimizer evaluates decision vectors. It is the optimizer's only
// access to a problem. A run implements it (study/run/run_evaluator.hpp): it counts the budget,
// moves points into the bounds, chooses the training cases, writes the journal and remembers the
// best feasible point. An optimizer returns no result; it may recommend points.
//
// A point is a decision vector: one number per decision variable, in the variable's own unit and
// not scaled to 0..1. In a run, a coordinate outside its bounds is replaced by the nearest bound,
// and NaN by the variable's start value. Coordinates of discrete variables are then rounded
// (treated_problem.hpp). A point with another number of coordinates is an OptimizerFailure.
#pragma once

#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "problems/interface/problem.hpp"

namespace armwright {

// The evaluation of one point as an optimizer gets it. All numbers are finite. An evaluation
// without objectives (Evaluation::objectives is empty) is called failed here.
struct Score {
  // One number per objective. A failed evaluation has the problem's penalty_objectives() here.
  std::vector<double> objectives;
  // One number g per constraint, met if g <= 0. Empty for a failed evaluation. The optimizer must
  // then treat every constraint as violated, by more than for any other point.
  std::vector<double> constraint_values;
  // Empty if the evaluation failed or was abandoned, if the problem has no residuals, and if the
  // optimizer declares no use of residuals.
  std::vector<double> residuals;
  // Derivatives of the residuals: one row per residual, one column per decision variable,
  // row-major. Empty for evaluate() and for a failed evaluation.
  std::vector<double> jacobian;
  EvaluationStatus status = EvaluationStatus::ok;
  bool clipped = false;  // the point was moved into the bounds before it was evaluated
};

// An optimizer in a process of its own is told that the run has stopped. It then has this many
// seconds to recommend points and to end.
inline constexpr double kFarewell_s = 1;

// Returns the price of one evaluation with exact derivatives, in evaluations: 1 for the values, and
// 1 for every four variables (rounded up).
constexpr std::int64_t calc_jacobian_charge(std::size_t variables) {
  return 1 + static_cast<std::int64_t>((variables + 3) / 4);
}

// An evaluator answers the requests of one optimizer. It is not thread-safe: one thread at a time
// may call it. It distributes the points of a batch over threads by itself.
class Evaluator {
 public:
  virtual ~Evaluator() = default;
  // Returns the problem as the optimizer can treat it: discrete variables are real ones if its
  // capabilities do not include their type.
  virtual const ProblemDescription& problem() const = 0;

  // Evaluates the points and returns one score per point, in the same order. Returns only the first
  // scores if the budget ends, the time limit is reached or the user stops the run within the
  // batch. From then on stopped() is true, and every further call returns an empty vector. Blocks
  // until the points are evaluated.
  virtual std::vector<Score> evaluate(std::span<const std::vector<double>> points) = 0;
  // Does the same as evaluate(), and also fills Score::jacobian. Each point is charged as
  // calc_jacobian_charge() evaluations. The batch is cut before the first point that the rest of
  // the budget does not cover. Throws std::logic_error if the problem has no Jacobian, or if this
  // class of evaluator does not offer derivatives.
  virtual std::vector<Score> evaluate_with_jacobian(
      std::span<const std::vector<double>> /*points*/) {
    throw std::logic_error("this evaluator has no derivatives to give");
  }
  // Returns true if no further point will be evaluated. The optimizer must then return.
  virtual bool stopped() const = 0;

  // Returns how many more points evaluate() can evaluate with the rest of the budget, if each is
  // simulated on all training cases that the schedule gives to one candidate. With racing there may
  // be more.
  virtual std::int64_t remaining() const = 0;

  // An optimizer with generations calls this before each generation, also before the first. In a
  // run, the schedules `fresh`, `coevolution` and `growing` change the training cases at this call.
  virtual void begin_generation() = 0;
  // An optimizer without generations, but with the capability `growing`, calls this when it makes no
  // more progress. With the schedule `growing` the run may then add training cases. Returns true if
  // it has.
  virtual bool grow_cases() { return false; }
  // Returns how often the training cases have changed. Objectives and residuals from before a change
  // cannot be compared with later ones.
  virtual std::uint64_t case_changes() const { return 0; }
  // Returns the number of training cases per candidate. The residuals of a candidate are those of
  // its cases, one case after the other and equally many of each, then those that all cases share.
  virtual std::size_t cases() const { return 1; }
  // Returns whether the training cases may change at all.
  virtual bool may_change_cases() const { return false; }
  // Recommends a point as a candidate for the winner, for example the mean of a distribution. The
  // run already knows the evaluated points. The call simulates nothing and costs no budget. It
  // counts also after the budget has ended, until minimize() returns or the optimizer's process has
  // had kFarewell_s. A run that the user has stopped ignores it: the resumed run asks again.
  virtual void recommend(std::span<const double> x) = 0;
  // Says why the optimizer ends before the evaluator has stopped, in a few words without a period:
  // "its steps are smaller than xtol_rel". The last call before minimize() returns counts.
  virtual void explain_end(std::string_view /*reason*/) {}
  // Says in two sentences which optimizer was chosen and why, for optimizers that choose among
  // others. The last call counts.
  virtual void explain_choice(std::string_view /*sentences*/) {}
};

}  // namespace armwright
