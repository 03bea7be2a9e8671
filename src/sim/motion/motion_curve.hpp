// The motion q(t) of all joints of an arm, in closed form: pieces of polynomials, and the splines and
// profiles that are made of them. Nothing here knows dynamics.
//
// In a piece that begins at t_i, with u = t - t_i, the position of a joint is
//   q = sum_k c_k u^k + A cos(w u),   k = 0 .. 7,
// where A is 0 except for the profile `sine`. Positions, rates, accelerations and jerks are the exact
// derivatives of order 0 to 3. Units: rad for a joint that turns, m for one that slides, and s.
//
// Splines through via points, with intervals h_i and a_i the acceleration at knot i:
//   cubic    continuous accelerations that are linear between the knots,
//              v at the start of interval i = (q_(i+1) - q_i) / h_i - h_i (2 a_i + a_(i+1)) / 6
//              v at its end                 = (q_(i+1) - q_i) / h_i + h_i (a_i + 2 a_(i+1)) / 6.
//            With SplineEnds::rest, rates and accelerations are 0 at both ends. The second knot and
//            the one before the last are then virtual: no point is given there (Gasparetto and
//            Zanotto 2008, Optimal trajectory planning for industrial robots, RCIM 24, 415-426).
//            With SplineEnds::clamped, only the rates are 0 at the ends, and every knot is a point.
//   quintic  continuous up to the fourth derivative, rates and accelerations 0 at both ends; every
//            knot is a point.
//
// Profiles from rest to rest over a distance D in a time T, with s = t / T:
//   quintic     D (10 s^3 - 15 s^4 + 6 s^5)
//   septic      D (35 s^4 - 84 s^5 + 70 s^6 - 20 s^7), the polynomial 4-5-6-7
//   bang-bang   jerk +J, -J, -J, +J, each for T / 4: J = 32 D / T^3
//   sine        jerk J sin(4 pi s), of the other sign in the second half: J = 16 pi D / T^3
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace armwright {

// `line` is a straight line of the tool in the least time (time_optimal.hpp): it has no intervals of its
// own.
enum class CurveKind : std::uint8_t { cubic, quintic, rest, line };
enum class SplineEnds : std::uint8_t { rest, clamped };
enum class RestProfile : std::uint8_t { quintic, septic, bang_bang, sine };
const std::vector<std::string>& curve_kind_names();  // each in the order of the enum
const std::vector<std::string>& spline_ends_names();
const std::vector<std::string>& rest_profile_names();

// The form of a curve: all that decides it beside points and intervals.
struct CurveForm {
  CurveKind kind = CurveKind::cubic;
  SplineEnds ends = SplineEnds::rest;          // of cubic splines
  RestProfile profile = RestProfile::quintic;  // of the kind rest: the arm rests at each point
  // Returns how many intervals a curve through `points` points has.
  std::size_t count_intervals(std::size_t points) const;
  // Returns the number of the given point among the knots.
  std::size_t find_knot(std::size_t point, std::size_t points) const;
};

class MotionCurve {
 public:
  static constexpr std::size_t kCoefficients = 8;

  // Makes the curve through the columns of `points` (one row per joint, at least two columns), with
  // the intervals (s, each > 0) of CurveForm::count_intervals().
  MotionCurve(const CurveForm& form, const Eigen::MatrixXd& points,
              std::span<const double> intervals_s);
  // Makes the quintic curve through given positions and rates (one row per joint, one column per time),
  // with the accelerations at the beginning and at the end of each piece (one column per piece), which
  // may jump between pieces. The times (s) rise from 0.
  MotionCurve(std::span<const double> times_s, const Eigen::MatrixXd& positions,
              const Eigen::MatrixXd& rates, const Eigen::MatrixXd& first_accelerations,
              const Eigen::MatrixXd& last_accelerations);

  std::size_t joint_count() const { return joints_; }
  double duration_s() const { return knots_s_.back(); }
  // Returns the beginnings of the pieces and the end, from 0.
  const std::vector<double>& knots_s() const { return knots_s_; }
  // Writes the derivative of order 0 to 3 at t_s into `values`, one number per joint. Before the
  // beginning and after the end, the motion is that at the nearer end.
  void calc(double t_s, int order, std::span<double> values) const;

  struct Peak {
    double lower = 0, upper = 0;      // the least and the largest value
    double lower_s = 0, upper_s = 0;  // when they occur first
    // Returns the largest magnitude and its time.
    double magnitude() const { return upper >= -lower ? upper : -lower; }
    double time_s() const { return upper >= -lower ? upper_s : lower_s; }
  };
  // Returns the extremes of the derivative of order 0 to 3 of a joint over the whole motion.
  Peak find_peak(std::size_t joint, int order) const;
  // Returns the integral of the squared jerk of a joint: rad^2/s^5 or m^2/s^5.
  double calc_jerk_integral(std::size_t joint) const;

 private:
  struct Term {
    std::array<double, kCoefficients> c{};
    double cosine = 0, frequency = 0;  // A and w
  };
  void add_cubic(SplineEnds ends, const Eigen::MatrixXd& points, std::span<const double> h);
  void add_quintic(const Eigen::MatrixXd& points, std::span<const double> h);
  void add_rests(RestProfile profile, const Eigen::MatrixXd& points, std::span<const double> h);
  // Appends a piece of length h_s. The next calls of term() are for it.
  void add_piece(double h_s);
  // Makes the piece's polynomial of positions, rates and accelerations at both ends.
  void set_quintic(std::size_t joint, const Eigen::Vector3d& from, const Eigen::Vector3d& to);
  Term& term(std::size_t joint) { return terms_[terms_.size() - joints_ + joint]; }
  static double calc(const Term& term, double u_s, int order);

  std::size_t joints_;
  std::vector<double> knots_s_{0};
  std::vector<Term> terms_;  // one per piece and joint, by pieces
};

// Returns the least time (s) of a profile over a distance D > 0 (rad or m) with these limits of rate,
// acceleration and jerk, each > 0; infinite ones do not limit it. For bang-bang and sine, the jerk is
// that of the equations above also where another limit decides.
double calc_least_time_s(RestProfile profile, double distance, double rate, double acceleration,
                         double jerk);
// Returns the least time (s) from rest to rest over a distance D > 0 of any motion within these limits,
// each > 0: up to seven pieces of constant jerk, with plateaus of acceleration and rate. Equal to that
// of bang-bang where neither limits.
double calc_jerk_limited_time_s(double distance, double rate, double acceleration, double jerk);

}  // namespace armwright
