#include "sim/motion/time_optimal.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/dynamics/arm_equations.hpp"
#include "sim/dynamics/joint_effort.hpp"

namespace armwright {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Rounding that is allowed where two lines meet, as a share of the numbers there.
constexpr double kMeetingRounding = 1e-12;

// a u + b x <= c.
struct Line {
  double a, b, c;
  std::size_t joint;
};

// The range of x at one place, and what limits it.
struct Interval {
  double lower = 0, upper = 0;
  bool empty = true;
};

// Returns the range of u that the lines leave at x.
std::pair<double, double> find_controls(const std::vector<Line>& lines, double x) {
  double lower = -kInfinity, upper = kInfinity;
  for (const Line& line : lines) {
    if (line.a > 0) {
      upper = std::min(upper, (line.c - line.b * x) / line.a);
    } else if (line.a < 0) {
      lower = std::max(lower, (line.c - line.b * x) / line.a);
    }
  }
  return {lower, upper};
}

// Returns the x >= 0 for which some u meets all lines. The feasible (u, x) form a convex polygon, so
// its least and largest x are 0, a limit of x alone, or where two lines meet.
Interval find_range(const std::vector<Line>& lines, double most) {
  double least = 0;
  for (const Line& line : lines) {
    if (line.a == 0 && line.b > 0) {
      most = std::min(most, line.c / line.b);
    } else if (line.a == 0 && line.b < 0) {
      least = std::max(least, line.c / line.b);
    } else if (line.a == 0 && line.c < 0) {
      return {};
    }
  }
  Interval range;
  const auto try_x = [&](double x) {
    if (!(x >= least && x <= most)) {
      return;
    }
    const auto [lower, upper] = find_controls(lines, x);
    const double size = std::isfinite(lower) && std::isfinite(upper)
                            ? std::max(std::abs(lower), std::abs(upper))
                            : 0;
    if (lower > upper + kMeetingRounding * size) {
      return;
    }
    range.lower = range.empty ? x : std::min(range.lower, x);
    range.upper = range.empty ? x : std::max(range.upper, x);
    range.empty = false;
  };
  try_x(least);
  try_x(most);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    for (std::size_t j = i + 1; j < lines.size(); ++j) {
      const Line &one = lines[i], &two = lines[j];
      if (one.a * two.a < 0) {  // one bounds u from above, the other one from below
        const double slope = one.b * two.a - two.b * one.a;
        if (slope != 0) {
          try_x((one.c * two.a - two.c * one.a) / slope);
        }
      }
    }
  }
  return range;
}

}  // namespace

std::vector<PathPlace> sample_path(const Eigen::MatrixXd& positions) {
  // The weights of the five places for the derivative at the first, second and third of them, over 12
  // times the step or its square. At the fourth and fifth, the order is reversed.
  constexpr double kFirst[3][5] = {{-25, 48, -36, 16, -3}, {-3, -10, 18, -6, 1}, {1, -8, 0, 8, -1}};
  constexpr double kSecond[3][5] = {
      {35, -104, 114, -56, 11}, {11, -20, 6, 4, -1}, {-1, 16, -30, 16, -1}};
  const Eigen::Index count = positions.cols();
  const double step = 1 / static_cast<double>(count - 1);
  std::vector<PathPlace> places;
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Index from = std::clamp<Eigen::Index>(i - 2, 0, count - 5);
    const bool is_reversed = i - from > 2;
    const Eigen::Index row = is_reversed ? 4 - (i - from) : i - from;
    PathPlace place{.q = positions.col(i),
                    .q_s = Eigen::VectorXd::Zero(positions.rows()),
                    .q_ss = Eigen::VectorXd::Zero(positions.rows())};
    for (Eigen::Index k = 0; k < 5; ++k) {
      const auto column = positions.col(from + (is_reversed ? 4 - k : k));
      place.q_s += (is_reversed ? -1 : 1) * kFirst[row][k] / (12 * step) * column;
      place.q_ss += kSecond[row][k] / (12 * step * step) * column;
    }
    places.push_back(std::move(place));
  }
  return places;
}

std::vector<PathPlace> measure_path(const MotionCurve& curve, double from_s, double to_s,
                                    std::size_t intervals) {
  const auto n = static_cast<Eigen::Index>(curve.joint_count());
  const auto calc = [&](double t, int order) {
    Eigen::VectorXd values(n);
    curve.calc(t, order, {values.data(), curve.joint_count()});
    return values;
  };
  // The way over time, by the trapezoidal rule on a fine grid, and the times of even ways.
  const std::size_t parts = 20 * intervals;
  const double step_s = (to_s - from_s) / static_cast<double>(parts);
  std::vector<double> way(parts + 1, 0);
  double before = calc(from_s, 1).norm();
  for (std::size_t k = 1; k <= parts; ++k) {
    const double rate = calc(from_s + static_cast<double>(k) * step_s, 1).norm();
    way[k] = way[k - 1] + step_s * (before + rate) / 2;
    before = rate;
  }
  std::vector<PathPlace> places;
  std::size_t part = 0;
  for (std::size_t i = 0; i <= intervals; ++i) {
    const double wanted = way.back() * static_cast<double>(i) / static_cast<double>(intervals);
    while (part + 1 < parts && way[part + 1] < wanted) {
      ++part;
    }
    const double gain = way[part + 1] - way[part];
    const double share = gain > 0 ? std::clamp((wanted - way[part]) / gain, 0.0, 1.0) : 0;
    const double t = from_s + (static_cast<double>(part) + share) * step_s;
    // At rest the direction is undefined; a thousandth of the time away it is not.
    const double margin_s = (to_s - from_s) / 1000;
    const double seen_s = std::clamp(t, from_s + margin_s, to_s - margin_s);
    const Eigen::VectorXd rate = calc(seen_s, 1), acceleration = calc(seen_s, 2);
    const double square = rate.squaredNorm();
    PathPlace place{.q = calc(t, 0), .q_s = Eigen::VectorXd::Zero(n), .q_ss = {}};
    place.q_ss = place.q_s;
    if (square > 0) {
      place.q_s = way.back() / std::sqrt(square) * rate;
      place.q_ss = way.back() * way.back() / square *
                   (acceleration - rate.dot(acceleration) / square * rate);
    }
    places.push_back(std::move(place));
  }
  return places;
}

LeastTime calc_least_time(const RobotModel& robot, double gravity_m_per_s2,
                          const std::vector<PathPlace>& path, const JointLimits& limits) {
  const std::size_t n = robot.joint_count(), last = path.size() - 1;
  const articulated::ChainModel chain(robot, gravity_m_per_s2);
  articulated::ArmEquations equations(chain);
  std::vector<std::vector<Line>> lines(path.size());
  std::vector<double> most(path.size(), kInfinity);
  const std::vector<double> rest(n, 0);
  for (std::size_t place = 0; place <= last; ++place) {
    const PathPlace& at = path[place];
    const std::span<const double> q(at.q.data(), n), q_s(at.q_s.data(), n);
    const auto add = [&](std::size_t joint, double a, double b, double c, double limit) {
      if (std::isfinite(limit)) {
        lines[place].push_back({a, b, limit - c, joint});
        lines[place].push_back({-a, -b, limit + c, joint});
      }
    };
    std::vector<double> gravity(n);
    equations.set(q, rest);
    for (std::size_t i = 0; i < n; ++i) {
      gravity[i] = equations.bias(i);
    }
    equations.set(q, q_s);
    for (std::size_t i = 0; i < n; ++i) {
      const Joint& joint = robot.joints[i];
      const auto row = static_cast<Eigen::Index>(i);
      double a = joint.plant.armature * at.q_s[row];
      double b = equations.bias(i) - gravity[i] + joint.plant.armature * at.q_ss[row];
      for (std::size_t k = 0; k < n; ++k) {
        const auto column = static_cast<Eigen::Index>(k);
        a += equations.mass(i, k) * at.q_s[column];
        b += equations.mass(i, k) * at.q_ss[column];
      }
      const double way = at.q_s[row];
      const double friction = way > 0 ? joint.plant.coulomb : way < 0 ? -joint.plant.coulomb : 0;
      const double c = gravity[i] + joint.plant.offset + friction -
                       articulated::calc_counterbalance(joint, at.q[row]);
      add(i, a, b, c, limits.effort[i]);
      add(i, way, at.q_ss[row], 0, limits.acceleration[i]);
      if (std::isfinite(limits.speed[i]) && way != 0) {
        most[place] = std::min(most[place], limits.speed[i] * limits.speed[i] / (way * way));
      }
    }
  }
  LeastTime result;
  if (std::ranges::all_of(lines, &std::vector<Line>::empty) &&
      std::ranges::all_of(most, [](double x) { return std::isinf(x); })) {
    return result;
  }
  // Backwards: the x from which the end can be reached.
  std::vector<Interval> reachable(path.size());
  reachable[last] = {0, 0, false};
  const double step = 1 / static_cast<double>(last);
  for (std::size_t place = last; place-- > 0;) {
    std::vector<Line> all = lines[place];
    // x + 2 step u lies within the set of the next place.
    all.push_back({2 * step, 1, reachable[place + 1].upper, n});
    all.push_back({-2 * step, -1, -reachable[place + 1].lower, n});
    constexpr double kFastest = 1e12;  // far above any path's
    reachable[place] = find_range(all, std::min(most[place], kFastest));
    if (reachable[place].empty || (place == 0 && reachable[0].lower > 0)) {
      result.stuck_place = place;
      // The joint that is farthest from holding the arm at rest.
      const auto worst = std::ranges::min_element(lines[place], {}, &Line::c);
      result.stuck_joint = worst == lines[place].end() ? 0 : worst->joint;
      return result;
    }
  }
  // Forwards: as fast as the sets allow.
  result.times_s.assign(1, 0);
  result.rates.assign(1, 0);
  double x = 0;
  for (std::size_t place = 0; place < last; ++place) {
    const auto [lower, upper] = find_controls(lines[place], x);
    const Interval& next = reachable[place + 1];
    const double u = std::clamp(upper, lower, std::max(lower, (next.upper - x) / (2 * step)));
    const double reached = std::clamp(x + 2 * step * u, next.lower, next.upper);
    const double rate = std::sqrt(x) + std::sqrt(reached);
    if (!(rate > 0)) {
      result.stuck_place = place;
      return result;
    }
    result.times_s.push_back(result.times_s.back() + 2 * step / rate);
    x = reached;
    result.rates.push_back(std::sqrt(x));
  }
  result.duration_s = result.times_s.back();
  return result;
}

MotionCurve make_fastest_motion(std::span<const std::vector<PathPlace>> paths,
                                std::span<const LeastTime> times) {
  std::size_t pieces = 0;
  for (const std::vector<PathPlace>& path : paths) {
    pieces += path.size() - 1;
  }
  const Eigen::Index rows = paths.front().front().q.size();
  const auto columns = static_cast<Eigen::Index>(pieces);
  std::vector<double> times_s = {0};
  Eigen::MatrixXd positions(rows, columns + 1), rates(rows, columns + 1), first(rows, columns),
      last(rows, columns);
  positions.col(0) = paths.front().front().q;
  rates.col(0).setZero();
  Eigen::Index at = 0;
  for (std::size_t part = 0; part < paths.size(); ++part) {
    const std::vector<PathPlace>& path = paths[part];
    const LeastTime& least = times[part];
    const double begin_s = times_s.back();
    const double step = 1 / static_cast<double>(path.size() - 1);
    for (std::size_t i = 0; i + 1 < path.size(); ++i, ++at) {
      const double rate = least.rates[i], next = least.rates[i + 1];
      const double u = (next * next - rate * rate) / (2 * step);
      times_s.push_back(begin_s + least.times_s[i + 1]);
      positions.col(at + 1) = path[i + 1].q;
      rates.col(at + 1) = path[i + 1].q_s * next;
      first.col(at) = path[i].q_s * u + path[i].q_ss * (rate * rate);
      last.col(at) = path[i + 1].q_s * u + path[i + 1].q_ss * (next * next);
    }
  }
  return {times_s, positions, rates, first, last};
}

}  // namespace armwright
