// What every optimization problem looks like to the rest of the program: robots and analytic
// functions alike.
//
// The work is cut along its unit of cost, the simulated test case: `simulate` takes any mixture of
// (decision vector, case) pairs in any order, so that threads, ranks or SIMD lanes can share it out
// freely; `aggregate` makes one evaluation of a candidate's case outcomes. Both are const,
// thread-safe and pure: a result depends on its own pair only.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/batch_size.hpp"

namespace armwright {

enum class Scale {
  linear,
  logarithmic
};  // logarithmic: bounds and start have one sign and are not zero

struct DecisionVariable {
  std::string name;  // "joint_2.p"
  std::string unit;
  double lower = 0;
  double upper = 0;
  double start = 0;
  Scale scale = Scale::linear;
};

struct Quantity {
  std::string name;
  std::string unit;
};

// A quantity that shall not exceed a value.
struct Limit {
  Quantity quantity;
  double value = 0;  // > 0
};

// A metric that shall not exceed a limit: always shown and judged (requirement_grade.hpp), and
// where it is a constraint, one of `limits` too.
struct RequiredMetric {
  std::size_t metric = 0;  // index into the metrics
  Limit limit;             // its name in words
  bool is_constraint = false;
};

// What is fixed about a problem. Objectives are minimised; a constraint g is met where g <= 0.
struct ProblemDescription {
  std::string name;
  std::string summary;
  std::vector<DecisionVariable> variables;
  std::vector<Quantity> objectives;  // at least one
  std::vector<Quantity> constraints;
  // What the constraints stand for, as many as there are: g = quantity / value - 1. Empty: nothing
  // is known of them but g.
  std::vector<Limit> limits;
  // What a violation of 1 is worth in units of calc_scalar(): optimizers that add violations to the
  // objective multiply them by it, whatever unit the objective has.
  double violation_scale = 1;
  std::vector<Quantity> metrics;  // of an evaluation, beside the objectives
  std::vector<RequiredMetric> requirements;
  std::string cost_unit;              // what one case is: "simulated test case"
  std::vector<double> known_optimum;  // analytic functions: a minimiser; empty if unknown
  // Several objectives as one number, where one is needed: the sum of weight times objective. As
  // many as objectives; empty: the first objective alone.
  std::vector<double> objective_weights;
  // Evaluations carry residuals: calc_scalar() of the objectives is the sum of their squares, or
  // the logarithm of that sum. Otherwise what to do about it, if anything can be done.
  bool has_residuals = false;
  std::string residuals_advice;
  // The residuals' exact derivatives can be asked for (CaseJob::jacobian); otherwise what to do
  // about it, if anything can be done.
  bool has_jacobian = false;
  std::string jacobian_advice;
};

enum class CaseRole : std::uint8_t { training, validation, test };

// Which cases a candidate is evaluated on. In training a problem may cut hopeless cases off; in
// validation and test it never does.
struct CaseBlock {
  CaseRole role = CaseRole::training;
  std::string set;  // "train/1"
  std::vector<std::uint64_t> numbers;
};

enum class EvaluationStatus : std::uint8_t {
  ok,           // every case ran to its end (in training: or to its cut-off)
  diverged,     // at least one simulation diverged
  unreachable,  // at least one case has a target that the arm cannot reach
  timed_out,
  failed,     // anything else; the reason says what
  abandoned,  // at least one case was given up, as its job allowed, or never begun, as the
              // candidate had lost a race: the numbers are bounds, or of some cases only
};
const char* to_string(EvaluationStatus status);

struct CaseJob {
  std::span<const double> x;
  const CaseBlock* block = nullptr;
  std::uint64_t number = 0;
  bool residuals = false;  // the outcome shall carry them, where the problem has them
  bool jacobian = false;   // with their derivatives, likewise
  // A case may be given up as soon as its error is certain to exceed this; outcomes of cases that
  // are not given up do not depend on it. For callers who have no use for the exact number then.
  double abandon_above = std::numeric_limits<double>::infinity();
};

struct CaseOutcome {
  EvaluationStatus status = EvaluationStatus::ok;
  std::string reason;  // for every status but ok
  double error = 0;    // the case's own error, finite whenever `has_error`; of an abandoned case
                       // what it is at least, above its job's bound
  bool has_error =
      true;  // false: the simulation failed and, outside training, no number stands for it
  std::vector<double> metrics;    // the problem's own; `aggregate` knows what they mean
  std::vector<double> residuals;  // what the error is made of, if asked for; never of a case that
                                  // was abandoned
  // Their derivatives, if asked for: a row a residual, a column a decision variable, row after row.
  std::vector<double> jacobian;
};

// Of an evaluation with status `abandoned` the objectives and the errors of abandoned cases are
// lower bounds, the metrics those up to where the cases were abandoned, and there are no residuals.
struct Evaluation {
  EvaluationStatus status = EvaluationStatus::ok;
  std::string reason;                     // of the first case with that status
  std::vector<double> objectives;         // finite; empty if no case yielded a number
  std::vector<double> constraint_values;  // g, one a constraint; finite
  std::vector<double> case_errors;  // one a case, in the block's order; a case without error: NaN,
                                    // never shown as a number
  std::vector<double> metrics;      // as described; finite, or empty with the objectives
  std::vector<double> residuals;    // if the outcomes carry them
  std::vector<double> jacobian;     // of the residuals, like an outcome's, if the outcomes have one
  int failed_cases = 0;             // cases that yielded no error
};

// One number for what may be several objectives: their weighted sum.
double calc_scalar(std::span<const double> weights, std::span<const double> objectives);
double calc_scalar(const ProblemDescription& problem, std::span<const double> objectives);
// What that number is.
Quantity get_scalar_quantity(std::span<const Quantity> objectives);

// It has objectives, which are no mere bounds, and every constraint is met.
bool is_feasible(const Evaluation& evaluation);
// By how much constraints are violated: the sum of max(0, g).
double calc_violation(std::span<const double> constraint_values);

class Problem {
 public:
  virtual ~Problem() = default;
  virtual const ProblemDescription& description() const = 0;

  // How many jobs one call of simulate() should get where cases of that role are many.
  virtual BatchSize batch_size(CaseRole /*role*/) const { return {}; }

  // One outcome a job, in the jobs' order. Never throws for what a decision vector does; x lies
  // within the bounds. Quickest where neighbours share their decision vector or their case.
  virtual std::vector<CaseOutcome> simulate(std::span<const CaseJob> jobs) const = 0;
  virtual Evaluation aggregate(std::span<const double> x,
                               std::span<const CaseOutcome> outcomes) const = 0;

  // What calc_scalar() of the objectives on all `cases` of a block is at least, given the outcomes
  // of the first of them (or of none). Nothing if the objectives are not known to grow with the
  // errors of further cases; whether there is a bound does not depend on the outcomes.
  virtual std::optional<double> calc_lower_bound(std::span<const double> /*x*/,
                                                 std::span<const CaseOutcome> /*outcomes*/,
                                                 std::size_t /*cases*/) const {
    return std::nullopt;
  }

  // What an optimizer is told of an evaluation that yielded no objectives: finite and worse than
  // any design that works.
  virtual std::vector<double> penalty_objectives() const = 0;

  // Gives back what is kept of cases for the next time, which costs time alone. Thread-safe.
  virtual void forget_cases() const {}

  // Both steps for one candidate on all cases of a block, residuals included.
  Evaluation evaluate(std::span<const double> x, const CaseBlock& block,
                      bool jacobian = false) const;
};

}  // namespace armwright
