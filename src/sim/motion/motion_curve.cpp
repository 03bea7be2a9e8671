#include "sim/motion/motion_curve.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "base/decompositions.hpp"

namespace armwright {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using std::numbers::pi;

constexpr std::size_t kDegree = MotionCurve::kCoefficients - 1;
using Polynomial = std::array<double, kDegree + 1>;

double calc_value(const Polynomial& c, std::size_t degree, double u) {
  double value = c[degree];
  for (std::size_t k = degree; k > 0; --k) {
    value = value * u + c[k - 1];
  }
  return value;
}

Polynomial differentiate(const Polynomial& c) {
  Polynomial derivative{};
  for (std::size_t k = 1; k <= kDegree; ++k) {
    derivative[k - 1] = static_cast<double>(k) * c[k];
  }
  return derivative;
}

std::size_t find_degree(const Polynomial& c) {
  std::size_t degree = kDegree;
  while (degree > 0 && c[degree] == 0) {
    --degree;
  }
  return degree;
}

// Returns the roots between 0 and `end`. The roots of the derivative divide the range into parts in
// which the polynomial rises or falls, so each part has at most one root, which is bisected.
std::vector<double> find_roots(const Polynomial& c, double end) {
  const std::size_t degree = find_degree(c);
  if (degree == 0) {
    return {};
  }
  if (degree == 1) {
    const double root = -c[0] / c[1];
    return root > 0 && root < end ? std::vector<double>{root} : std::vector<double>{};
  }
  std::vector<double> turns = find_roots(differentiate(c), end);
  turns.push_back(end);
  std::vector<double> roots;
  double from = 0, at_from = calc_value(c, degree, 0);
  for (const double to : turns) {
    const double at_to = calc_value(c, degree, to);
    if ((at_from < 0) != (at_to < 0)) {
      double left = from, right = to;
      for (;;) {
        const double middle = left + (right - left) / 2;
        if (middle <= left || middle >= right) {
          break;
        }
        ((calc_value(c, degree, middle) < 0) == (at_from < 0) ? left : right) = middle;
      }
      roots.push_back(right);
    }
    from = to;
    at_from = at_to;
  }
  return roots;
}

}  // namespace

const std::vector<std::string>& curve_kind_names() {
  static const std::vector<std::string> names = {"cubic", "quintic", "rest", "line"};
  return names;
}

const std::vector<std::string>& spline_ends_names() {
  static const std::vector<std::string> names = {"rest", "clamped"};
  return names;
}

const std::vector<std::string>& rest_profile_names() {
  static const std::vector<std::string> names = {"quintic", "septic", "bang-bang", "sine"};
  return names;
}

std::size_t CurveForm::count_intervals(std::size_t points) const {
  if (kind == CurveKind::line) {
    return 0;
  }
  return points - 1 + (kind == CurveKind::cubic && ends == SplineEnds::rest ? 2 : 0);
}

std::size_t CurveForm::find_knot(std::size_t point, std::size_t points) const {
  if (kind != CurveKind::cubic || ends != SplineEnds::rest || point == 0) {
    return point;
  }
  return point + 1 == points ? points + 1 : point + 1;
}

MotionCurve::MotionCurve(const CurveForm& form, const MatrixXd& points,
                         std::span<const double> intervals_s)
    : joints_(static_cast<std::size_t>(points.rows())) {
  assert(points.cols() >= 2 && form.kind != CurveKind::line);
  assert(intervals_s.size() == form.count_intervals(static_cast<std::size_t>(points.cols())));
  switch (form.kind) {
    case CurveKind::cubic:
      add_cubic(form.ends, points, intervals_s);
      break;
    case CurveKind::quintic:
      add_quintic(points, intervals_s);
      break;
    case CurveKind::rest:
      add_rests(form.profile, points, intervals_s);
      break;
    case CurveKind::line:
      break;
  }
}

MotionCurve::MotionCurve(std::span<const double> times_s, const MatrixXd& positions,
                         const MatrixXd& rates, const MatrixXd& first_accelerations,
                         const MatrixXd& last_accelerations)
    : joints_(static_cast<std::size_t>(positions.rows())) {
  assert(times_s.size() >= 2);
  for (std::size_t i = 0; i + 1 < times_s.size(); ++i) {
    add_piece(times_s[i + 1] - times_s[i]);
    knots_s_.back() = times_s[i + 1];  // not a sum of differences
    for (std::size_t joint = 0; joint < joints_; ++joint) {
      const auto j = static_cast<Index>(joint), k = static_cast<Index>(i);
      set_quintic(joint, {positions(j, k), rates(j, k), first_accelerations(j, k)},
                  {positions(j, k + 1), rates(j, k + 1), last_accelerations(j, k)});
    }
  }
}

void MotionCurve::add_piece(double h_s) {
  knots_s_.push_back(knots_s_.back() + h_s);
  terms_.resize(terms_.size() + joints_);
}

void MotionCurve::set_quintic(std::size_t joint, const Eigen::Vector3d& from,
                              const Eigen::Vector3d& to) {
  const double h = knots_s_.back() - knots_s_[knots_s_.size() - 2];
  // The distance of the end from the parabola of the beginning, in units of a piece of length 1.
  const double d = to[0] - (from[0] + h * (from[1] + h * from[2] / 2));
  const double dv = (to[1] - (from[1] + h * from[2])) * h;
  const double da = (to[2] - from[2]) * h * h;
  const double h3 = h * h * h;
  term(joint).c = {from[0],
                   from[1],
                   from[2] / 2,
                   (10 * d - 4 * dv + da / 2) / h3,
                   (-15 * d + 7 * dv - da) / (h3 * h),
                   (6 * d - 3 * dv + da / 2) / (h3 * h * h)};
}

void MotionCurve::add_cubic(SplineEnds ends, const MatrixXd& points, std::span<const double> h) {
  const auto intervals = static_cast<Index>(h.size());
  const Index knots = intervals + 1;
  const bool rests = ends == SplineEnds::rest;
  // The unknowns: the accelerations at all knots but, at rest, the ends; then the virtual positions.
  const Index first = rests ? 1 : 0;
  const Index accelerations = knots - 2 * first;
  const Index unknowns = accelerations + (rests ? 2 : 0);
  const auto is_virtual = [&](Index knot) { return rests && (knot == 1 || knot == knots - 2); };
  const auto get_point = [&](Index knot) {
    return !rests || knot == 0 ? knot : knot == knots - 1 ? knot - 2 : knot - 1;
  };
  MatrixXd a = MatrixXd::Zero(unknowns, unknowns);
  MatrixXd b = MatrixXd::Zero(unknowns, points.rows());
  const auto add_position = [&](Index row, Index knot, double factor) {
    if (is_virtual(knot)) {
      a(row, accelerations + (knot == 1 ? 0 : 1)) += factor;
    } else {
      b.row(row) -= factor * points.col(get_point(knot)).transpose();
    }
  };
  const auto add_acceleration = [&](Index row, Index knot, double factor) {
    if (knot >= first && knot < first + accelerations) {
      a(row, knot - first) += factor;
    }
  };
  // Adds `sign` times the rate at an end of an interval to an equation.
  const auto add_rate = [&](Index row, Index interval, bool at_end, double sign) {
    const double width = h[static_cast<std::size_t>(interval)];
    add_position(row, interval + 1, sign / width);
    add_position(row, interval, -sign / width);
    const double share = sign * width / 6;
    add_acceleration(row, interval, at_end ? share : -2 * share);
    add_acceleration(row, interval + 1, at_end ? 2 * share : -share);
  };
  add_rate(0, 0, false, 1);
  for (Index knot = 1; knot + 1 < knots; ++knot) {
    add_rate(knot, knot - 1, true, 1);
    add_rate(knot, knot, false, -1);
  }
  add_rate(knots - 1, intervals - 1, true, 1);
  const MatrixXd x = a.partialPivLu().solve(b);
  const auto get_position = [&](Index knot, Index joint) {
    return is_virtual(knot) ? x(accelerations + (knot == 1 ? 0 : 1), joint)
                            : points(joint, get_point(knot));
  };
  const auto get_acceleration = [&](Index knot, Index joint) {
    return knot >= first && knot < first + accelerations ? x(knot - first, joint) : 0.0;
  };
  for (Index i = 0; i < intervals; ++i) {
    const double width = h[static_cast<std::size_t>(i)];
    add_piece(width);
    for (Index joint = 0; joint < points.rows(); ++joint) {
      const double from = get_position(i, joint), to = get_position(i + 1, joint);
      const double a0 = get_acceleration(i, joint), a1 = get_acceleration(i + 1, joint);
      term(static_cast<std::size_t>(joint)).c = {
          from, (to - from) / width - width * (2 * a0 + a1) / 6, a0 / 2, (a1 - a0) / (6 * width)};
    }
  }
}

void MotionCurve::add_quintic(const MatrixXd& points, std::span<const double> h) {
  const auto intervals = static_cast<Index>(h.size());
  const Index inner = intervals - 1;
  // The unknowns are the rates and the accelerations at the inner knots. Two equations per knot: the
  // third and the fourth derivative of the piece before equal those of the piece behind.
  MatrixXd a = MatrixXd::Zero(2 * inner, 2 * inner);
  MatrixXd b = MatrixXd::Zero(2 * inner, points.rows());
  const auto add = [&](Index row, Index knot, bool acceleration, double factor) {
    if (knot > 0 && knot < intervals) {
      a(row, 2 * (knot - 1) + (acceleration ? 1 : 0)) += factor;
    }
  };
  for (Index knot = 1; knot <= inner; ++knot) {
    for (Index order : {3, 4}) {
      const Index row = 2 * (knot - 1) + order - 3;
      for (const bool before : {true, false}) {
        const Index i = before ? knot - 1 : knot;
        const double w = h[static_cast<std::size_t>(i)];
        const double sign = before ? 1 : -1;
        // In a piece from (q0, v0, a0) to (q1, v1, a1), with D = q1 - q0:
        //   q'''(h)  = (60 D - 24 v0 h - 36 v1 h - 3 a0 h^2 + 9 a1 h^2) / h^3
        //   q'''(0)  = (60 D - 36 v0 h - 24 v1 h - 9 a0 h^2 + 3 a1 h^2) / h^3
        //   q''''(h) = (360 D - 168 v0 h - 192 v1 h - 24 a0 h^2 + 36 a1 h^2) / h^4
        //   q''''(0) = (-360 D + 192 v0 h + 168 v1 h + 36 a0 h^2 - 24 a1 h^2) / h^4
        const double third[2][5] = {{60, -36, -24, -9, 3}, {60, -24, -36, -3, 9}};
        const double fourth[2][5] = {{-360, 192, 168, 36, -24}, {360, -168, -192, -24, 36}};
        const auto& part = order == 3 ? third[before] : fourth[before];
        const double scale = sign / std::pow(w, static_cast<double>(order));
        b.row(row) -= scale * part[0] * (points.col(i + 1) - points.col(i)).transpose();
        add(row, i, false, scale * part[1] * w);
        add(row, i + 1, false, scale * part[2] * w);
        add(row, i, true, scale * part[3] * w * w);
        add(row, i + 1, true, scale * part[4] * w * w);
      }
    }
  }
  const MatrixXd x = inner > 0 ? MatrixXd(a.partialPivLu().solve(b)) : b;
  const auto get = [&](Index knot, Index joint) {
    const bool is_end = knot == 0 || knot == intervals;
    return Eigen::Vector3d(points(joint, knot), is_end ? 0 : x(2 * (knot - 1), joint),
                           is_end ? 0 : x(2 * (knot - 1) + 1, joint));
  };
  for (Index i = 0; i < intervals; ++i) {
    add_piece(h[static_cast<std::size_t>(i)]);
    for (Index joint = 0; joint < points.rows(); ++joint) {
      set_quintic(static_cast<std::size_t>(joint), get(i, joint), get(i + 1, joint));
    }
  }
}

void MotionCurve::add_rests(RestProfile profile, const MatrixXd& points,
                            std::span<const double> h) {
  for (std::size_t i = 0; i < h.size(); ++i) {
    const double t = h[i];
    const auto from = static_cast<Index>(i);
    const auto for_joints = [&](const auto& set) {
      for (std::size_t joint = 0; joint < joints_; ++joint) {
        const auto row = static_cast<Index>(joint);
        set(term(joint), points(row, from), points(row, from + 1) - points(row, from));
      }
    };
    switch (profile) {
      case RestProfile::quintic:
      case RestProfile::septic: {
        add_piece(t);
        const bool septic = profile == RestProfile::septic;
        const Polynomial unit =
            septic ? Polynomial{0, 0, 0, 0, 35, -84, 70, -20} : Polynomial{0, 0, 0, 10, -15, 6};
        for_joints([&](Term& its, double position, double distance) {
          double power = 1;
          for (std::size_t k = 0; k <= kDegree; ++k, power *= t) {
            its.c[k] = distance * unit[k] / power;
          }
          its.c[0] = position;
        });
        break;
      }
      case RestProfile::bang_bang:
        for (int quarter = 0; quarter < 4; ++quarter) {
          add_piece(t / 4);
          for_joints([&](Term& its, double position, double distance) {
            const double jerk = 32 * distance / (t * t * t);
            const double peak = jerk * t / 4;       // acceleration after the first quarter
            const double rate = jerk * t * t / 32;  // after the first quarter
            const double way = distance / 12;       // the same: J (T / 4)^3 / 6
            const double starts[4][3] = {{0, 0, 0},
                                         {way, rate, peak},
                                         {distance / 2, 2 * rate, 0},
                                         {distance - way, rate, -peak}};
            const auto& start = starts[quarter];
            const double sign = quarter == 0 || quarter == 3 ? 1 : -1;
            its.c = {position + start[0], start[1], start[2] / 2, sign * jerk / 6};
          });
        }
        break;
      case RestProfile::sine:
        for (const bool second : {false, true}) {
          add_piece(t / 2);
          for_joints([&](Term& its, double position, double distance) {
            // With w = 4 pi / T, the acceleration of the first half is J / w (1 - cos(w u)), so the
            // rate is J / w (u - sin(w u) / w) and the way J / w (u^2 / 2 + (cos(w u) - 1) / w^2).
            const double w = 4 * pi / t;
            const double a = 4 * distance / (t * t);  // J / w with J = 16 pi D / T^3
            its.frequency = w;
            its.cosine = second ? -a / (w * w) : a / (w * w);
            const double sign = second ? -1 : 1;
            its.c = {position + (second ? distance / 2 : 0) - sign * a / (w * w),
                     second ? a * t / 2 : 0, sign * a / 2};
          });
        }
        break;
    }
  }
}

double MotionCurve::calc(const Term& term, double u_s, int order) {
  double sum = 0;
  for (std::size_t k = kDegree + 1; k-- > static_cast<std::size_t>(order);) {
    double factor = 1;
    for (int i = 0; i < order; ++i) {
      factor *= static_cast<double>(k) - i;
    }
    sum = sum * u_s + factor * term.c[k];
  }
  if (term.cosine != 0) {
    const double angle = term.frequency * u_s;
    const double parts[] = {std::cos(angle), -std::sin(angle), -std::cos(angle), std::sin(angle)};
    sum += term.cosine * std::pow(term.frequency, order) * parts[order];
  }
  return sum;
}

void MotionCurve::calc(double t_s, int order, std::span<double> values) const {
  assert(values.size() == joints_);
  const double t = std::clamp(t_s, 0.0, duration_s());
  const auto next = std::upper_bound(knots_s_.begin() + 1, knots_s_.end() - 1, t);
  const auto piece = static_cast<std::size_t>(next - knots_s_.begin()) - 1;
  for (std::size_t joint = 0; joint < joints_; ++joint) {
    values[joint] = calc(terms_[piece * joints_ + joint], t - knots_s_[piece], order);
  }
}

MotionCurve::Peak MotionCurve::find_peak(std::size_t joint, int order) const {
  Peak peak{.lower = std::numeric_limits<double>::infinity(),
            .upper = -std::numeric_limits<double>::infinity()};
  for (std::size_t piece = 0; piece + 1 < knots_s_.size(); ++piece) {
    const Term& its = terms_[piece * joints_ + joint];
    const double h = knots_s_[piece + 1] - knots_s_[piece];
    std::vector<double> places;
    if (its.cosine != 0) {
      // Position, rate, acceleration and jerk of the profile turn at quarters of its period only.
      for (int quarter = 0; quarter <= 4; ++quarter) {
        places.push_back(h * quarter / 4);
      }
    } else {
      Polynomial c = its.c;
      for (int i = 0; i <= order; ++i) {
        c = differentiate(c);
      }
      places = find_roots(c, h);
      places.push_back(0);
      places.push_back(h);
    }
    std::ranges::sort(places);
    for (const double u : places) {
      const double value = calc(its, u, order);
      if (value < peak.lower) {
        peak.lower = value;
        peak.lower_s = knots_s_[piece] + u;
      }
      if (value > peak.upper) {
        peak.upper = value;
        peak.upper_s = knots_s_[piece] + u;
      }
    }
  }
  return peak;
}

double MotionCurve::calc_jerk_integral(std::size_t joint) const {
  double integral = 0;
  for (std::size_t piece = 0; piece + 1 < knots_s_.size(); ++piece) {
    const Term& its = terms_[piece * joints_ + joint];
    const double h = knots_s_[piece + 1] - knots_s_[piece];
    const Polynomial jerk = differentiate(differentiate(differentiate(its.c)));
    const std::size_t degree = find_degree(jerk);
    for (std::size_t i = 0; i <= degree; ++i) {
      for (std::size_t k = 0; k <= degree; ++k) {
        const auto power = static_cast<double>(i + k + 1);
        integral += jerk[i] * jerk[k] * std::pow(h, power) / power;
      }
    }
    // The jerk of a sine profile is a whole period of A w^3 sin(w u).
    const double amplitude = its.cosine * its.frequency * its.frequency * its.frequency;
    integral += amplitude * amplitude * h / 2;
  }
  return integral;
}

double calc_least_time_s(RestProfile profile, double distance, double rate, double acceleration,
                         double jerk) {
  // The peaks of the profile over a distance of 1 in a time of 1.
  struct Peaks {
    double rate, acceleration, jerk;
  };
  const auto peaks = [&]() -> Peaks {
    switch (profile) {
      case RestProfile::quintic:
        return {15.0 / 8, 10 / std::sqrt(3), 60};
      case RestProfile::septic:
        return {35.0 / 16, 84 * std::sqrt(5) / 25, 52.5};
      case RestProfile::bang_bang:
        return {2, 8, 32};
      case RestProfile::sine:
        return {2, 8, 16 * pi};
    }
    return {};
  }();
  return std::max({distance * peaks.rate / rate,
                   std::sqrt(distance * peaks.acceleration / acceleration),
                   std::cbrt(distance * peaks.jerk / jerk)});
}

double calc_jerk_limited_time_s(double distance, double rate, double acceleration, double jerk) {
  const double ramp_s = acceleration / jerk;
  // How long it takes to reach the limit of the rate; on the way the mean rate is half of it.
  const double rise_s =
      rate >= acceleration * ramp_s ? rate / acceleration + ramp_s : 2 * std::sqrt(rate / jerk);
  if (distance >= rate * rise_s) {
    return distance / rate + rise_s;
  }
  if (distance >= 2 * acceleration * ramp_s * ramp_s) {
    return ramp_s + 2 * std::sqrt(ramp_s * ramp_s / 4 + distance / acceleration);
  }
  return std::cbrt(32 * distance / jerk);
}

}  // namespace armwright
