// The interface of every optimization problem: robot arms and analytic functions.
//
// The unit of cost is the simulated test case. Problem::simulate() takes any mixture of (decision
// vector, case) pairs in any order, so threads, ranks and SIMD lanes can share the pairs freely.
// Problem::aggregate() makes one evaluation from the case outcomes of one decision vector. Both
// functions are const, thread-safe and pure: each result depends on its own input only.
//
// Errors of cases (CaseOutcome::error, Evaluation::case_errors, ProblemDescription::failure_error,
// CaseJob::abandon_above) all have the same unit: m for an arm, none for an analytic function.
//
// Three properties of a case sound alike:
// - A case without an error yielded no number (CaseOutcome::has_error is false).
//   Evaluation::failed_cases counts these cases only.
// - A failure is a case without an error, or a case with an error above
//   ProblemDescription::failure_error. Reports and studies count failures (summarize() in
//   study/statistics/summary.hpp).
// - EvaluationStatus::failed is one of several statuses. A case with another status, for example
//   diverged, can also be a case without an error.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/batch_size.hpp"

namespace armwright {

class TrackingProblem;

// How a variable spans its box. For `logarithmic`, both bounds and the start value have the same
// sign and none of them is zero.
enum class Scale { linear, logarithmic };

// The values that a variable can have: every real number within the bounds, whole numbers, or one
// of a list of words.
enum class VariableType : std::uint8_t { real, integer, category };

// One entry of the decision vector.
struct DecisionVariable {
  std::string name;  // "joint_2.p"
  std::string unit;
  double lower = 0;
  double upper = 0;
  double start = 0;
  Scale scale = Scale::linear;
  VariableType type = VariableType::real;  // of others, bounds and start are whole numbers
  // The words of a category. Its number in a decision vector is the place of the word, from 0, so
  // its bounds are 0 and choices.size() - 1.
  std::vector<std::string> choices = {};
  // Messages name the setting that moves a bound outwards, such as
  // "--set variables.bounds_factor=1000 (it is 100)". Empty if no setting does.
  std::string lower_widening = {};
  std::string upper_widening = {};
};

// The name and the unit of a number.
struct Quantity {
  std::string name;
  std::string unit;
};

// A quantity and the value that it shall not exceed.
struct Limit {
  Quantity quantity;
  double value = 0;  // > 0
};

// A metric that shall not exceed a limit. Reports always show and grade it (requirement_grade.hpp).
// If it is a constraint, ProblemDescription::limits has the same limit.
struct RequiredMetric {
  std::size_t metric = 0;  // index into ProblemDescription::metrics
  Limit limit;             // limit.quantity.name is in words
  bool is_constraint = false;
};

// The properties of a problem that never change. Objectives are minimised. A constraint g is met
// if g <= 0.
struct ProblemDescription {
  std::string name;
  std::string summary;
  std::vector<DecisionVariable> variables;
  std::vector<Quantity> objectives;  // at least one
  std::vector<Quantity> constraints;
  // One limit per constraint, in the order of `constraints`: g = quantity / value - 1. Empty if the
  // problem computes g in another way.
  std::vector<Limit> limits;
  // Converts violations into the unit of calc_scalar(). An optimizer that adds the violation of the
  // constraints to the objective first multiplies it by this number.
  double violation_scale = 1;
  std::vector<Quantity> metrics;  // the further numbers of an evaluation, beside the objectives
  std::vector<RequiredMetric> requirements;
  std::string cost_unit;  // the name of one case: "simulated test case"
  // A case with a larger error is a failure. Infinity if no error is so large that the case is a
  // failure.
  double failure_error = std::numeric_limits<double>::infinity();
  std::vector<double> known_optimum;  // a minimiser of an analytic function; empty if unknown
  // The smallest value of calc_scalar() that a feasible decision vector has; nothing if unknown.
  std::optional<double> optimum;
  // A difference of calc_scalar() that matters; smaller differences count as equal in comparisons.
  // If calc_scalar() is a logarithm, the difference is one of the number before the logarithm. In
  // the unit of that number; 0 if every difference matters.
  double resolution = 0;
  // True if the problem has one case only and gives the same answer each time. A run then judges
  // its candidates by their training evaluations and simulates only what was not evaluated.
  bool has_single_case = false;
  // The weights of calc_scalar(), one per objective. If empty, calc_scalar() returns the first
  // objective.
  std::vector<double> objective_weights;
  // True if evaluations have residuals: calc_scalar() of the objectives is the sum of the squared
  // residuals, or the logarithm of that sum. If false, `residuals_advice` tells the user how to get
  // residuals; it is empty if there is no way.
  bool has_residuals = false;
  std::string residuals_advice;
  // True if the exact derivatives of the residuals are available (CaseJob::jacobian). If false,
  // `jacobian_advice` tells the user how to get them; it is empty if there is no way.
  bool has_jacobian = false;
  std::string jacobian_advice;
};

// The purpose of a set of cases.
enum class CaseRole : std::uint8_t { training, validation, test };

// The cases that a decision vector is evaluated on. A problem may end a bad simulation early in
// training, but never in validation or test.
struct CaseBlock {
  CaseRole role = CaseRole::training;
  std::string set;  // "train/1"
  std::vector<std::uint64_t> numbers;
};

enum class EvaluationStatus : std::uint8_t {
  ok,           // every case ran to its end or, in training, to its cut-off
  diverged,     // at least one simulation diverged
  unreachable,  // at least one case has a target that the arm cannot reach
  timed_out,
  failed,     // at least one simulation ended in another way; the reason describes it
  abandoned,  // at least one case was ended early because its job allowed that, or was never
              // started because the candidate had lost a race; the numbers are lower bounds or
              // cover some of the cases only
};
const char* to_string(EvaluationStatus status);

// One decision vector to be simulated on one case. The caller owns `x` and `block`.
struct CaseJob {
  std::span<const double> x;
  const CaseBlock* block = nullptr;
  std::uint64_t number = 0;
  bool residuals = false;  // asks for residuals, if the problem has them
  bool jacobian = false;   // asks for the derivatives of the residuals, if the problem has them
  // The simulation may end as soon as the error of the case is certain to exceed this bound. The
  // outcome of a case that runs to its end does not depend on the bound.
  double abandon_above = std::numeric_limits<double>::infinity();
};

// The result of one CaseJob.
struct CaseOutcome {
  EvaluationStatus status = EvaluationStatus::ok;
  std::string reason;  // empty if the status is ok
  // The error of the case; finite. 0 without meaning if `has_error` is false. If the status is
  // `abandoned`, the true error is at least this number, and this number is larger than
  // CaseJob::abandon_above.
  double error = 0;
  // False if the simulation yielded no number for the error. In training, a problem may give such a
  // case a large error instead; has_error is then true.
  bool has_error = true;
  std::vector<double> metrics;  // the layout is private to the problem; `aggregate` reads it
  // The residuals of the case, if the job asked for them; empty if the case was abandoned.
  std::vector<double> residuals;
  // The derivatives of the residuals, if the job asked for them. Row-major: one row per residual,
  // one column per decision variable.
  std::vector<double> jacobian;
};

// What a simulation of one case left beside its numbers. Reports show it for the winner.
struct CaseRecord {
  // A recorded signal. `values` has one number per entry of the record's `abscissa`.
  struct Series {
    Quantity quantity;
    std::vector<double> values;
  };
  struct File {
    std::string name;  // a plain file name, "step.png"
    std::string bytes;
  };
  Quantity abscissa;  // of all series: "time" in s
  std::vector<double> abscissa_values;
  std::vector<Series> series;
  std::vector<File> files;
};

// The result of one decision vector on all cases of a block. If the status is `abandoned`, the
// objectives and the errors of the abandoned cases are lower bounds, the metrics of these cases
// cover the simulated part only, and there are no residuals.
struct Evaluation {
  EvaluationStatus status = EvaluationStatus::ok;
  std::string reason;                     // of the first case with that status
  std::vector<double> objectives;         // finite; empty if no case has an error
  std::vector<double> constraint_values;  // g, one per constraint; finite
  // One error per case, in the order of the block. NaN for a case without an error; user interfaces
  // never show it as a number.
  std::vector<double> case_errors;
  // One number per entry of ProblemDescription::metrics, in its order and units; finite. Empty if
  // the objectives are empty.
  std::vector<double> metrics;
  std::vector<double> residuals;  // if the outcomes have them
  std::vector<double> jacobian;   // of the residuals, laid out as in CaseOutcome
  int failed_cases = 0;           // the number of cases without an error
};

// Returns the name of a type: "real", "integer" or "category".
const char* to_string(VariableType type);
// Returns the value of the variable's type that is nearest to `value`, within the bounds. Returns a
// real variable's value as it is, moved into the bounds. `value` is a number.
double settle_value(const DecisionVariable& variable, double value);
// Returns the value as a user reads it: the word of a category, or the shortest text of the number
// that reads back the same.
std::string format_value(const DecisionVariable& variable, double value);
// Returns the start of every variable.
std::vector<double> list_starts(std::span<const DecisionVariable> variables);
// Returns whether a problem has a variable that is not real.
bool has_discrete(std::span<const DecisionVariable> variables);

// Returns the objectives as one number: the sum of weight times objective. Without weights, returns
// the first objective.
double calc_scalar(std::span<const double> weights, std::span<const double> objectives);
double calc_scalar(const ProblemDescription& problem, std::span<const double> objectives);
// Returns the name and the unit of that number.
Quantity get_scalar_quantity(std::span<const Quantity> objectives);

// Returns true if the evaluation has objectives, is not abandoned, and meets every constraint.
bool is_feasible(const Evaluation& evaluation);
// Returns the total violation of the constraints: the sum of max(0, g).
double calc_violation(std::span<const double> constraint_values);

// An optimization problem.
class Problem {
 public:
  virtual ~Problem() = default;
  // Returns the description. The reference is valid as long as this object lives.
  virtual const ProblemDescription& description() const = 0;

  // Returns the tracking problem that this problem is or wraps; null for all other problems. The
  // pointer is valid as long as this object lives.
  virtual const TrackingProblem* tracking() const { return nullptr; }

  // Returns how many jobs one call of simulate() should get if there are many cases of that role.
  virtual BatchSize batch_size(CaseRole /*role*/) const { return {}; }

  // Returns one outcome per job, in the order of the jobs. Each x must lie within the bounds. A
  // failed simulation is a status, never an exception. Fastest if neighbouring jobs share their
  // decision vector or their case.
  virtual std::vector<CaseOutcome> simulate(std::span<const CaseJob> jobs) const = 0;
  // Returns the evaluation of `x` from the outcomes of all cases of a block, in the block's order.
  virtual Evaluation aggregate(std::span<const double> x,
                               std::span<const CaseOutcome> outcomes) const = 0;

  // Returns calc_scalar() of the objectives that `x` would have on each case of `evaluation` alone, as
  // far as its errors tell: what else enters an objective counts as in the evaluation. One number per
  // case, NaN for a case without an error.
  virtual std::vector<double> calc_case_objectives(std::span<const double> /*x*/,
                                                   const Evaluation& evaluation) const {
    return evaluation.case_errors;
  }

  // Returns a lower bound of calc_scalar() of the objectives of `x` on a block of `cases` cases.
  // `outcomes` are those of the block's first cases; there may be none. Returns nothing if the
  // problem knows no bound, because a further case could make the objectives smaller. Whether there
  // is a bound depends on the problem only, not on the outcomes.
  virtual std::optional<double> calc_lower_bound(std::span<const double> /*x*/,
                                                 std::span<const CaseOutcome> /*outcomes*/,
                                                 std::size_t /*cases*/) const {
    return std::nullopt;
  }

  // Returns the objectives that an optimizer gets for an evaluation without objectives: finite, and
  // worse than those of any design that works.
  virtual std::vector<double> penalty_objectives() const = 0;

  // Simulates one case again and returns what it leaves beside its numbers; empty if the problem
  // records none. Throws Error{bad_data} if the simulation fails.
  virtual CaseRecord record_case(std::span<const double> /*x*/, const CaseBlock& /*block*/,
                                 std::uint64_t /*number*/) const {
    return {};
  }

  // Frees the data that the problem caches per case. Later calls compute the data again; results do
  // not change. Thread-safe.
  virtual void forget_cases() const {}

  // Simulates one decision vector on all cases of a block and aggregates the outcomes. Asks for
  // residuals always, and for their derivatives if `jacobian`.
  Evaluation evaluate(std::span<const double> x, const CaseBlock& block,
                      bool jacobian = false) const;
};

}  // namespace armwright
