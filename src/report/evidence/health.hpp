// Measures whether an arm works calmly and within its limits, and grades each measure: the health
// card of a winner.
//
// Saturation of a joint: the share (0 to 1) of the control periods of all cases in which the
// controller's effort was clamped to a limit,
//   s = sum_c n_c s_c / sum_c n_c
// with n_c the simulated periods of case c and s_c = TrackingResult::saturated_share.
//
// Ripple of a joint: the part of its effort that oscillates above f_0 = kRippleFloor_hz. With
// u_0, ..., u_(N-1) the efforts (N m or N) at the ends of the control periods, h the period (s) and
// the discrete Fourier transform U_m = sum_k u_k exp(-2 pi i m k / N), whose frequencies are
// f_m = m / (N h) for m <= N / 2,
//   r = sqrt( sum_(m: f_m > f_0) w_m |U_m|^2 ) / N    the root mean square (Parseval's theorem),
// where w_m is 1 for f_m = 1 / (2 h) and 2 otherwise, because each other line also stands for its
// negative frequency. The dominant frequency is the f_m > f_0 with the largest w_m |U_m|^2. The
// share is r / L, with L = calc_largest_effort(), the larger of the two effort limits.
// A sine of amplitude A with whole periods in N h has r = A / sqrt(2) above f_0 and 0 below.
// Source: Oppenheim and Schafer (2010), Discrete-Time Signal Processing, sections 8.5 and 8.6.
// Limits of validity: N is the largest number without prime factors above 5 that the recording
// has, so a few samples at the end may be left out. There is no window. A jump of the effort by D
// has lines above f_0, too: one jump per second adds about D / (pi sqrt(2 f_0 / Hz)), 7 % of D.
// Oscillations above 1 / (2 h) appear at a lower frequency.
//
// Distance of a variable x to its bounds l < u, as a share of its range in its scale:
//   p = (x - l) / (u - l), or ln(x / l) / ln(u / l) on a logarithmic scale
//   d = min(p, 1 - p)
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "problems/interface/problem.hpp"
#include "sim/tracking/simulation.hpp"

namespace armwright {

enum class HealthGrade { good, watch, bad };
const char* to_string(HealthGrade grade);

// A measure is worth watching from the first share on, and bad from the second share on.
struct HealthLimits {
  double watch = 0;
  double bad = 0;
};
inline constexpr HealthLimits kSaturationLimits{0.01, 0.05};  // of the time
inline constexpr HealthLimits kRippleLimits{0.05, 0.20};      // of the effort limit
inline constexpr double kNearBound = 0.01;  // a variable is worth watching up to this distance
inline constexpr double kRippleFloor_hz = 10;

HealthGrade grade(double share, const HealthLimits& limits);

// Returns the saturation of each joint over the cases; empty if no case was simulated.
std::vector<double> calc_saturation(std::span<const TrackingResult> results);

struct Ripple {
  double rms = 0;           // N m or N
  double frequency_hz = 0;  // the dominant one; 0 if the ripple is 0
};
// Returns nothing if the efforts last less than a second, if the control period is so long that it
// shows nothing above the floor, or if an effort is not finite.
std::optional<Ripple> calc_ripple(std::span<const double> efforts, double period_s);

// Returns the largest effort as a share of the limit on its side, at most 1 for a clamped effort.
// Returns nothing without efforts. A limit of 0 has no share.
std::optional<double> calc_used_effort(std::span<const double> efforts, double min, double max);

// A variable's place in its range.
struct BoundDistance {
  double distance = 0;    // d above; below 0 for a value outside its bounds
  bool is_upper = false;  // the nearer bound
};
// Returns nothing if the bounds are equal.
std::optional<BoundDistance> calc_bound_distance(const DecisionVariable& variable, double x);

struct VariablePlace {
  std::size_t variable = 0;  // index into ProblemDescription::variables
  BoundDistance to;
};
// Returns the places of the variables of a decision vector, the nearest to a bound first. Leaves out
// variables with equal bounds, categories, whose words have no order, and integers with two values,
// which are always at a bound.
std::vector<VariablePlace> list_bound_places(std::span<const DecisionVariable> variables,
                                             std::span<const double> x);

}  // namespace armwright
