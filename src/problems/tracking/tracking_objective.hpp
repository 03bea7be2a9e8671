// What an evaluation of the tracking problem is judged by: the arithmetic that makes objectives,
// constraints and residuals of what was simulated.
//
// The error e (m) is a statistic of the cases' positional errors e_1, ..., e_L:
//   mean                their mean
//   worst               the largest
//   cvar                the mean of the worst share s of them, the conditional value at risk
//                       (Rockafellar and Uryasev 2000, Optimization of conditional value-at-risk):
//                       sorted from the worst on, the first k = floor(s L) count whole, the next
//                       one s L - k, and the sum is divided by s L. s = 1 is the mean, s = 1/L the
//                       worst, and e is continuous in s and in every e_l.
//   mean_with_failures  their mean + failure_penalty_m times the share of the cases in which the
//                       arm lost its target: e_l above kFailureError_m, or diverged, or without
//                       any number
// Cases without a number (validation and test only) count nowhere else. None of these falls where
// an e_l rises: of lower bounds of the e_l they make a lower bound of e.
//
// Objectives:
//   error              e (m)
//   error_and_torque   e / e_0 + w tau / tau_0, tau the sum over the joints of max(-min, max)
//                      of their effort limits (thesis section 6.3)
//   error_vs_torque    e (m) and tau (N m) as two objectives; as one number, error_and_torque
//   torque_with_error_limit  tau (N m) where e <= e_max
//   error_with_torque_limit  e (m) where tau <= tau_max
// To the first two, w_E E / E_0 + w_T T / T_0 can be added, E the mean over the cases of the
// joints' positive mechanical work (J), T that of their durations (s); `error` then is e / e_0 and
// that. All but error_vs_torque also as their natural logarithm: the same minimiser, but steps of
// equal ratio count alike, which wrapped local methods like.
//
// A limit is one constraint, g = e / e_max - 1 or tau / tau_max - 1, in the logarithm's problem
// too. e counts a training case that was cut off or diverged as the objectives do: 1 m for each
// point from there on. Where no case has a number there is no g either.
//
// Residuals, of the statistic `mean` and the kinds without a limit: sqrt(e_kl / (K_l L)) of each
// point k that counts, K_l of them, in each of L cases l, divided by sqrt(e_0) where the objective
// is a sum of parts without unit; then sqrt(w tau_j / tau_0) of each joint j where it has torque,
// sqrt(w_E E / E_0) and sqrt(w_T T / T_0) where they have a weight. The sum of their squares is the
// objective before the logarithm.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "problems/interface/problem.hpp"
#include "sim/tracking/design.hpp"

namespace armwright {

// A case whose error exceeds this counts as failed in every summary (the arm lost its target).
inline constexpr double kFailureError_m = 0.1;

struct TrackingObjective {
  enum class Kind {
    error,
    error_and_torque,
    error_vs_torque,
    torque_with_error_limit,
    error_with_torque_limit
  };
  enum class Statistic { mean, worst, cvar, mean_with_failures };

  Kind kind = Kind::error;
  bool logarithm = false;             // not of error_vs_torque
  double torque_weight = 0;           // w
  double error_scale_m = 0.0058;      // e_0: the thesis's Q1 winner
  double torque_scale_n_m = 963686;   // tau_0: the same
  double error_limit_m = 0;           // e_max, of torque_with_error_limit
  double total_torque_limit_n_m = 0;  // tau_max, of error_with_torque_limit
  Statistic statistic = Statistic::mean;
  double cvar_share = 0.1;       // s, 0 < s <= 1
  double failure_penalty_m = 1;  // what a case costs in which the arm lost its target
  double energy_weight = 0;      // w_E, of error and error_and_torque
  double energy_scale_j = 1;     // E_0
  double duration_weight = 0;    // w_T, of the same
  double duration_scale_s = 1;   // T_0

  bool has_torque() const { return kind != Kind::error && kind != Kind::error_with_torque_limit; }
  // One number made of parts without unit.
  bool is_sum() const;
  bool has_residuals() const;
};

// What objectives are made of.
struct ObjectiveTerms {
  double error_m = 0;     // e
  double torque_n_m = 0;  // tau
  double energy_j = 0;    // E
  double duration_s = 0;  // T
};

// "error", "worst error", "error of the worst 10 %", "error with failures".
std::string describe_error(const TrackingObjective& objective);
// Names and units, in the order of calc_objectives().
std::vector<Quantity> describe_objectives(const TrackingObjective& objective);

// e of the errors of the cases that have one; there must be one. `lost_share` of all the cases
// count as failures.
double calc_error_statistic(const TrackingObjective& objective, std::span<const double> errors_m,
                            double lost_share);
std::vector<double> calc_objectives(const TrackingObjective& objective,
                                    const ObjectiveTerms& terms);
std::vector<double> calc_constraints(const TrackingObjective& objective,
                                     const ObjectiveTerms& terms);
// Of outcomes whose residuals are the errors (m) of the points that count; `cases` is how many of
// the outcomes have an error.
std::vector<double> calc_residuals(const TrackingObjective& objective, const ArmDesign& design,
                                   const ObjectiveTerms& terms,
                                   std::span<const CaseOutcome> outcomes, double cases);
// The derivatives of calc_residuals()'s `residuals` along `directions` of the design, which change
// neither the arm nor the task; empty if the outcomes carry none. Not of objectives with energy,
// whose derivatives nobody computes.
std::vector<double> calc_jacobian(const TrackingObjective& objective, const ArmDesign& design,
                                  std::span<const ArmDesign> directions,
                                  std::span<const CaseOutcome> outcomes,
                                  std::span<const double> residuals);

}  // namespace armwright
