// The objectives of the tracking problem: the arithmetic that turns simulated cases into
// objectives, constraints and residuals.
//
// The error e (m) is a statistic of the cases' positional errors e_1, ..., e_L:
//   mean                their mean
//   worst               the largest of them
//   cvar                the conditional value at risk, the mean of their worst share s
//                       (Rockafellar and Uryasev 2000, Optimization of conditional value-at-risk).
//                       Sorted from the worst on, the first k = floor(s L) errors count whole, the
//                       next one counts s L - k, and the sum is divided by s L. s = 1 is the mean
//                       and s = 1/L the worst. e is continuous in s and in every e_l.
//   mean_with_failures  their mean + failure_penalty_m times the share of the cases in which the
//                       arm lost its target: e_l is above kFailureError_m, or the case diverged or
//                       has no error
// Cases without an error (validation and test only) count nowhere else. No statistic falls if an
// e_l rises, so lower bounds of the e_l give a lower bound of e.
//
// Objectives:
//   error              e (m)
//   error_and_torque   e / e_0 + w tau / tau_0, tau the sum over the joints of max(-min, max)
//                      of their effort limits (thesis section 6.3)
//   torque_with_error_limit  tau (N m) where e <= e_max
//   error_with_torque_limit  e (m) where tau <= tau_max
//   front              two or more of the quantities below, each an objective of its own. As one
//                      number, the sum of weight x quantity / scale. Both limits are possible
// The first two can have the further terms w_E E / E_0 + w_T T / T_0. E is the mean over the cases
// of the joints' positive mechanical work (J), T the mean of the cases' durations (s). With them,
// `error` is e / e_0 plus these terms. Every objective but those of a front can be replaced by its
// natural logarithm: it has the same minimiser, and steps of equal ratio count alike, which suits
// local methods from libraries.
//
// Quantities of a front (TrackingQuantity): e, tau, E and T; the sums over the joints of the largest
// effort of all cases, and of the mean over the cases of the root mean square; the moving mass; the
// deflection of an arm of tubes (tube.hpp). After them, the worst value of each requirement over the
// cases (requirement.hpp).
//
// A limit is one constraint, g = e / e_max - 1 or tau / tau_max - 1, for logarithms too. In e, each
// point of a training case from its cut-off or divergence on counts as the cut-off error (1 m by
// default), as in the objectives. If no case has an error, there is no g.
//
// Residuals exist for the statistic `mean` and the objectives without a limit; for a front, if it has
// the error and nothing but e, tau, E and T. They are, in order:
//   sqrt(e_kl / (K_l L))      for each counted point k of each case l, with K_l counted points and
//                             L cases; e_kl is divided by e_0 first if the objective is a sum of
//                             terms without unit
//   sqrt(w tau_j / tau_0)     for each joint j, if the objective has torque
//   sqrt(w_E E / E_0)         if w_E > 0
//   sqrt(w_T T / T_0)         if w_T > 0
// The weights and scales of a front count as those of the sum; e_0 is then its scale / weight.
// The sum of their squares is the objective before the logarithm.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "problems/interface/problem.hpp"
#include "problems/interface/weighted_quantity.hpp"
#include "sim/tracking/design.hpp"

namespace armwright {

// A case with a larger error counts as failed: the arm lost its target.
inline constexpr double kFailureError_m = 0.1;
// Comparisons count smaller differences of the error e as equal.
inline constexpr double kErrorResolution_m = 1e-6;

// The quantities that a front can have. Those from `requirement` on are the problem's requirements,
// in their order.
enum class TrackingQuantity : std::uint8_t {
  error,
  torque,
  energy,
  duration,
  peak_torque,
  rms_torque,
  moving_mass,
  deflection,
  requirement
};
// Returns the names in the order of the enum, without `requirement`.
const std::vector<std::string>& tracking_quantity_names();

// The choice of objective, and its parameters.
struct TrackingObjective {
  enum class Kind {
    error,
    error_and_torque,
    torque_with_error_limit,
    error_with_torque_limit,
    front
  };
  enum class Statistic { mean, worst, cvar, mean_with_failures };

  Kind kind = Kind::error;
  bool logarithm = false;             // never for a front
  double torque_weight = 0;           // w
  double error_scale_m = 0.0058;      // e_0: of the thesis's Q1 winner
  double torque_scale_n_m = 963686;   // tau_0: of the same winner
  double error_limit_m = 0;           // e_max; 0: no limit
  double total_torque_limit_n_m = 0;  // tau_max; 0: no limit
  Statistic statistic = Statistic::mean;
  double cvar_share = 0.1;                   // s, 0 < s <= 1
  double failure_penalty_m = 1;              // the cost of a case in which the arm lost its target
  double energy_weight = 0;                  // w_E, for error and error_and_torque
  double energy_scale_j = 1;                 // E_0
  double duration_weight = 0;                // w_T, for the same objectives
  double duration_scale_s = 1;               // T_0
  std::vector<WeightedQuantity> front = {};  // set_front() fills it

  // Makes the objective a front, with the weights and scales above where its terms have them.
  void set_front(std::vector<WeightedQuantity> terms);
  bool has_in_front(TrackingQuantity quantity) const;
  bool has_torque() const;
  // Returns true if the objective is one number, a sum of terms without unit.
  bool is_sum() const;
  bool has_residuals() const;
};

// The numbers of an evaluation that objectives and constraints are computed from.
struct ObjectiveTerms {
  double error_m = 0;     // e
  double torque_n_m = 0;  // tau
  double energy_j = 0;    // E
  double duration_s = 0;  // T
  double peak_torque_n_m = 0, rms_torque_n_m = 0;
  double moving_mass_kg = 0;
  double deflection_m = 0;
  std::vector<double> required = {};  // the worst value of each requirement
};

// Returns the name of e: "error", "worst error", "error of the worst 10 %" or
// "error with failures".
std::string describe_error(const TrackingObjective& objective);
// Returns the names and units of the objectives, in the order of calc_objectives(). `required` are
// those of the problem's requirements.
std::vector<Quantity> describe_objectives(const TrackingObjective& objective,
                                          std::span<const Quantity> required = {});

// Returns ProblemDescription::resolution: kErrorResolution_m where the number is an error (m), and
// kErrorResolution_m / e_0 where it is a sum of terms without unit. A total torque (N m) has the
// same share of its scale: tau_0 kErrorResolution_m / e_0. The resolution of a logarithm is that of
// the number before the logarithm. In a front without the error, every difference counts.
double calc_resolution(const TrackingObjective& objective);

// Returns e from the errors of the cases that have one; there must be at least one. `lost_share` is
// the share of all cases in which the arm lost its target.
double calc_error_statistic(const TrackingObjective& objective, std::span<const double> errors_m,
                            double lost_share);
std::vector<double> calc_objectives(const TrackingObjective& objective,
                                    const ObjectiveTerms& terms);
std::vector<double> calc_constraints(const TrackingObjective& objective,
                                     const ObjectiveTerms& terms);
// Returns the residuals. The residuals of the outcomes must be the errors (m) of the counted
// points. `cases` is the number of outcomes that have an error.
std::vector<double> calc_residuals(const TrackingObjective& objective, const ArmDesign& design,
                                   const ObjectiveTerms& terms,
                                   std::span<const CaseOutcome> outcomes, double cases);
// Returns the derivatives of `residuals`, which calc_residuals() returned, along `directions` of
// the design: one row per residual, one column per direction. Empty if the outcomes have no
// derivatives. The directions must change neither the arm nor the task. The objective must have no
// energy term, because its derivatives are not available.
std::vector<double> calc_jacobian(const TrackingObjective& objective, const ArmDesign& design,
                                  std::span<const ArmDesign> directions,
                                  std::span<const CaseOutcome> outcomes,
                                  std::span<const double> residuals);

}  // namespace armwright
