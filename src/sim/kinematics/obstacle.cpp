#include "sim/kinematics/obstacle.hpp"

#include <algorithm>
#include <cmath>

namespace armwright {
namespace {

using Eigen::Vector3d;

// Returns the signed distance of a point from a box with these half edges, or from an upright
// cylinder with the radius x and the half height z, around the origin.
double calc_box_distance(const Vector3d& point, const Vector3d& half) {
  const Vector3d beyond = point.cwiseAbs() - half;
  const double outside = beyond.cwiseMax(0).norm();
  return outside > 0 ? outside : beyond.maxCoeff();
}
double calc_cylinder_distance(const Vector3d& point, const Vector3d& half) {
  const double beside = std::hypot(point.x(), point.y()) - half.x();
  const double above = std::abs(point.z()) - half.z();
  const double outside = std::hypot(std::max(beside, 0.0), std::max(above, 0.0));
  return outside > 0 ? outside : std::max(beside, above);
}

// Returns the minimum of a convex function between 0 and 1, by golden sections.
template <class Function>
double find_least(const Function& function) {
  constexpr double kGolden = 0.6180339887498949;
  constexpr int kSections = 50;  // 0.618^50 = 4e-11
  double from = 0, to = 1;
  double left = to - kGolden * (to - from), right = from + kGolden * (to - from);
  double at_left = function(left), at_right = function(right);
  double least = std::min({function(0), function(1), at_left, at_right});
  for (int i = 0; i < kSections; ++i) {
    if (at_left < at_right) {
      to = right;
      right = left;
      at_right = at_left;
      left = to - kGolden * (to - from);
      at_left = function(left);
      least = std::min(least, at_left);
    } else {
      from = left;
      left = right;
      at_left = at_right;
      right = from + kGolden * (to - from);
      at_right = function(right);
      least = std::min(least, at_right);
    }
  }
  return least;
}

}  // namespace

const std::vector<std::string>& obstacle_kind_names() {
  static const std::vector<std::string> names = {"sphere", "capsule", "box", "cylinder"};
  return names;
}

double Obstacle::reach_m() const {
  if (kind == ObstacleKind::sphere || kind == ObstacleKind::capsule) {
    return (capsule.to_m - capsule.from_m).norm() / 2 + capsule.radius_m;
  }
  return kind == ObstacleKind::box ? half_m.norm() : std::hypot(half_m.x(), half_m.z());
}

Vector3d Obstacle::centre_m() const {
  return kind == ObstacleKind::sphere || kind == ObstacleKind::capsule
             ? Vector3d((capsule.from_m + capsule.to_m) / 2)
             : Vector3d(pose.translation());
}

// The nearest points of two segments p + s u and q + t v, with s and t in [0, 1]: of the lines, then
// moved into the segments (Ericson 2005, Real-Time Collision Detection, section 5.1.9).
double calc_segment_distance_m(const Capsule& a, const Capsule& b) {
  const Vector3d u = a.to_m - a.from_m, v = b.to_m - b.from_m, r = a.from_m - b.from_m;
  const double uu = u.squaredNorm(), vv = v.squaredNorm(), uv = u.dot(v);
  const double ur = u.dot(r), vr = v.dot(r);
  const auto unit = [](double value) { return std::clamp(value, 0.0, 1.0); };
  double s = 0, t = 0;
  if (uu > 0 && vv > 0) {
    const double across = uu * vv - uv * uv;  // 0 for parallel segments
    s = across > 0 ? unit((uv * vr - ur * vv) / across) : 0;
    t = (uv * s + vr) / vv;
    if (t < 0 || t > 1) {
      t = unit(t);
      s = unit((uv * t - ur) / uu);
    }
  } else if (uu > 0) {
    s = unit(-ur / uu);
  } else if (vv > 0) {
    t = unit(vr / vv);
  }
  return (r + s * u - t * v).norm();
}

double calc_distance_m(const Capsule& a, const Capsule& b) {
  return calc_segment_distance_m(a, b) - a.radius_m - b.radius_m;
}

double calc_distance_m(const Capsule& capsule, const Obstacle& obstacle) {
  if (obstacle.kind == ObstacleKind::sphere || obstacle.kind == ObstacleKind::capsule) {
    return calc_distance_m(capsule, obstacle.capsule);
  }
  const Capsule seen = capsule.moved(obstacle.pose.inverse());
  const Vector3d way = seen.to_m - seen.from_m;
  const auto calc = obstacle.kind == ObstacleKind::box ? calc_box_distance : calc_cylinder_distance;
  return find_least([&](double s) { return calc(seen.from_m + s * way, obstacle.half_m); }) -
         capsule.radius_m;
}

}  // namespace armwright
