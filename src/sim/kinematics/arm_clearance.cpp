#include "sim/kinematics/arm_clearance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <numbers>

#include "base/decompositions.hpp"
#include "base/random.hpp"
#include "base/text.hpp"
#include "sim/kinematics/floor_clearance.hpp"
#include "sim/kinematics/kinematics.hpp"
#include "sim/robot/mesh_file.hpp"

namespace armwright {
namespace {

using Eigen::Vector3d;

constexpr int kSides = 16;
constexpr std::size_t kPostures = 200;
constexpr double kSmallestAxis_m = 1e-9;

void add_vertices(const VisualShape& shape, const std::filesystem::path& file,
                  std::vector<Vector3d>& points) {
  const TriangleMesh mesh = read_mesh(file);
  for (std::size_t i = 0; i + 2 < mesh.positions.size(); i += 3) {
    points.push_back(shape.pose * Vector3d(mesh.positions[i] * shape.size_m.x(),
                                           mesh.positions[i + 1] * shape.size_m.y(),
                                           mesh.positions[i + 2] * shape.size_m.z()));
  }
}

void add_corners(const VisualShape& shape, MeshFinder& meshes, std::vector<Vector3d>& points) {
  const auto add = [&](double x, double y, double z) {
    points.push_back(shape.pose * Vector3d(x, y, z));
  };
  const Vector3d half = shape.size_m / 2;
  switch (shape.kind) {
    case ShapeKind::box:
    case ShapeKind::sphere: {
      const Vector3d edge =
          shape.kind == ShapeKind::box ? half : Vector3d::Constant(shape.size_m.x());
      for (int corner = 0; corner < 8; ++corner) {
        add((corner & 1) != 0 ? edge.x() : -edge.x(), (corner & 2) != 0 ? edge.y() : -edge.y(),
            (corner & 4) != 0 ? edge.z() : -edge.z());
      }
      break;
    }
    case ShapeKind::cylinder:
      for (int side = 0; side < kSides; ++side) {
        const double angle = 2 * std::numbers::pi * side / kSides;
        const double around = shape.size_m.x() / std::cos(std::numbers::pi / kSides);
        for (const double z : {-half.y(), half.y()}) {
          add(around * std::cos(angle), around * std::sin(angle), z);
        }
      }
      break;
    case ShapeKind::mesh:
      if (const auto file = meshes.find(shape.mesh_file)) {
        try {
          add_vertices(shape, *file, points);
        } catch (const std::exception&) {  // a note says that the link has no shapes
        }
      }
      break;
  }
}

Capsule fit_along(std::span<const Vector3d> points, const Vector3d& axis) {
  // The middle across the axis: of the box around the points in a frame along the axis.
  Eigen::Matrix3d frame;
  frame.col(2) = axis;
  frame.col(0) = axis.unitOrthogonal();
  frame.col(1) = axis.cross(frame.col(0));
  Eigen::AlignedBox3d box;
  for (const Vector3d& point : points) {
    box.extend(Vector3d(frame.transpose() * point));
  }
  const Vector3d middle = box.center();
  double radius = 0;
  for (const Vector3d& point : points) {
    const Vector3d seen = frame.transpose() * point - middle;
    radius = std::max(radius, seen.head<2>().norm());
  }
  // The round ends reach beyond the segment, the less the farther a point is from the axis.
  double from = std::numeric_limits<double>::infinity(), to = -from;
  for (const Vector3d& point : points) {
    const Vector3d seen = frame.transpose() * point - middle;
    const double cap = std::sqrt(std::max(0.0, radius * radius - seen.head<2>().squaredNorm()));
    from = std::min(from, seen.z() + cap);
    to = std::max(to, seen.z() - cap);
  }
  if (from > to) {  // all points lie within a sphere
    from = to = (from + to) / 2;
  }
  const auto place = [&](double z) { return Vector3d(frame * (middle + Vector3d(0, 0, z))); };
  return {place(from), place(to), radius};
}

double calc_volume(const Capsule& capsule) {
  const double r = capsule.radius_m;
  return r * r * ((capsule.to_m - capsule.from_m).norm() + 4 * r / 3);
}

}  // namespace

Capsule fit_capsule(std::span<const Vector3d> points_m, std::span<const Vector3d> axes) {
  Vector3d mean = Vector3d::Zero();
  for (const Vector3d& point : points_m) {
    mean += point / static_cast<double>(points_m.size());
  }
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Vector3d& point : points_m) {
    spread += (point - mean) * (point - mean).transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
  std::vector<Vector3d> tried(axes.begin(), axes.end());
  for (int i = 0; i < 3; ++i) {
    tried.emplace_back(solver.eigenvectors().col(i));
  }
  Capsule best;
  double least = std::numeric_limits<double>::infinity();
  for (const Vector3d& axis : tried) {
    if (axis.norm() < kSmallestAxis_m) {
      continue;
    }
    const Capsule capsule = fit_along(points_m, axis.normalized());
    if (calc_volume(capsule) < least) {
      least = calc_volume(capsule);
      best = capsule;
    }
  }
  return best;
}

Obstacle make_obstacle(const VisualShape& shape, std::string name,
                       const std::filesystem::path& mesh) {
  Obstacle obstacle;
  obstacle.name = std::move(name);
  obstacle.pose = shape.pose;
  switch (shape.kind) {
    case ShapeKind::box:
      obstacle.kind = ObstacleKind::box;
      obstacle.half_m = shape.size_m / 2;
      break;
    case ShapeKind::cylinder:
      obstacle.kind = ObstacleKind::cylinder;
      obstacle.half_m = {shape.size_m.x(), shape.size_m.x(), shape.size_m.y() / 2};
      break;
    case ShapeKind::sphere:
      obstacle.kind = ObstacleKind::sphere;
      obstacle.capsule = {shape.pose.translation(), shape.pose.translation(), shape.size_m.x()};
      break;
    case ShapeKind::mesh: {
      std::vector<Vector3d> points;
      add_vertices(shape, mesh, points);
      obstacle.kind = ObstacleKind::capsule;
      obstacle.capsule = fit_capsule(points, {});
      break;
    }
  }
  return obstacle;
}

std::vector<std::optional<Capsule>> fit_link_capsules(const RobotModel& robot, MeshFinder meshes,
                                                      std::vector<std::string>& notes) {
  std::vector<std::optional<Capsule>> capsules;
  const double radius_m = kCapsuleOfLength * calc_arm_length_m(robot);
  std::vector<std::string> bare;
  for (std::size_t body = 0; body <= robot.joint_count(); ++body) {
    const Link& link = body == 0 ? robot.base : robot.links[body - 1];
    const Vector3d end = body < robot.joint_count() ? robot.joints[body].origin.translation()
                                                    : robot.tip_pose.translation();
    std::vector<Vector3d> points;
    for (const VisualShape& shape : link.visuals) {
      add_corners(shape, meshes, points);
    }
    if (!points.empty()) {
      const Vector3d axes[] = {end};
      capsules.emplace_back(fit_capsule(points, axes));
    } else if (body > 0) {
      capsules.emplace_back(Capsule{Vector3d::Zero(), end, radius_m});
      bare.push_back(link.name);
    } else {
      capsules.emplace_back();
    }
  }
  if (!bare.empty()) {
    notes.push_back(
        fmt::format("no shapes were read for {}; a capsule of radius {:.3g} m along "
                    "the line between the joints stands for each",
                    sanitize(join(bare, ", ")), radius_m));
  }
  return capsules;
}

ArmClearance::ArmClearance(const RobotModel& robot, std::vector<std::optional<Capsule>> capsules,
                           std::vector<Obstacle> obstacles, bool self)
    : capsules_(std::move(capsules)), obstacles_(std::move(obstacles)) {
  names_.push_back(robot.base.name);
  for (const Link& link : robot.links) {
    names_.push_back(link.name);
  }
  if (self) {
    find_pairs(robot);
  }
}

ArmClearance ArmClearance::with_capsules(std::vector<std::optional<Capsule>> capsules) const {
  ArmClearance other = *this;
  other.capsules_ = std::move(capsules);
  return other;
}

void ArmClearance::find_pairs(const RobotModel& robot) {
  // Bodies that overlap in every posture touch by design.
  std::vector<std::vector<Capsule>> seen(kPostures);
  RandomStream random("arm clearance/postures", 0);
  for (std::vector<Capsule>& placed : seen) {
    std::vector<double> q;
    for (const Joint& joint : robot.joints) {
      const bool has_range = std::isfinite(joint.upper - joint.lower);
      q.push_back(random.uniform(has_range ? joint.lower : -std::numbers::pi,
                                 has_range ? joint.upper : std::numbers::pi));
    }
    placed = place(calc_link_poses(robot, q));
  }
  for (std::size_t body = 0; body < capsules_.size(); ++body) {
    for (std::size_t other = body + 2; other < capsules_.size(); ++other) {
      if (capsules_[body] && capsules_[other] &&
          std::ranges::any_of(seen, [&](const std::vector<Capsule>& placed) {
            return calc_distance_m(placed[body], placed[other]) > 0;
          })) {
        pairs_.emplace_back(body, other);
      }
    }
  }
}

std::vector<Capsule> ArmClearance::place(std::span<const Eigen::Isometry3d> poses) const {
  std::vector<Capsule> placed(capsules_.size());
  for (std::size_t body = 0; body < capsules_.size(); ++body) {
    if (capsules_[body]) {
      placed[body] = body == 0 ? *capsules_[0] : capsules_[body]->moved(poses[body - 1]);
    }
  }
  return placed;
}

ArmClearance::Nearest ArmClearance::find_nearest(std::span<const Eigen::Isometry3d> poses) const {
  Nearest nearest{.distance_m = std::numeric_limits<double>::infinity()};
  const std::vector<Capsule> placed = place(poses);
  for (std::size_t o = 0; o < obstacles_.size(); ++o) {
    const Obstacle& obstacle = obstacles_[o];
    const Vector3d centre = obstacle.centre_m();
    for (std::size_t body = 1; body < placed.size(); ++body) {
      const Capsule& link = placed[body];
      const double farthest =
          calc_segment_distance_m(link, {centre, centre, 0}) - link.radius_m - obstacle.reach_m();
      if (farthest >= nearest.distance_m) {
        continue;  // the sphere around the obstacle is farther than the nearest pair so far
      }
      const double distance = calc_distance_m(link, obstacle);
      if (distance < nearest.distance_m) {
        nearest = {distance, body, o, true};
      }
    }
  }
  for (const auto& [body, other] : pairs_) {
    const double distance = calc_distance_m(placed[body], placed[other]);
    if (distance < nearest.distance_m) {
      nearest = {distance, body, other, false};
    }
  }
  return nearest;
}

std::string ArmClearance::describe(const Nearest& nearest) const {
  return nearest.is_obstacle
             ? fmt::format("the link '{}' and the obstacle '{}'", sanitize(names_[nearest.body]),
                           sanitize(obstacles_[nearest.other].name))
             : fmt::format("the links '{}' and '{}'", sanitize(names_[nearest.body]),
                           sanitize(names_[nearest.other]));
}

std::string ArmClearance::describe_gap(const Nearest& nearest, double least_m) const {
  return fmt::format(
      "{} are {:.4g} m apart (negative: one inside the other), and {:g} m are asked for",
      describe(nearest), nearest.distance_m, least_m);
}

}  // namespace armwright
