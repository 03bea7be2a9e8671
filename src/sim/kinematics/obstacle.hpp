// Obstacles in the arm's cell, and their distances from capsules. A capsule is the set of all points
// within a radius of a segment. Distances are signed: a negative distance is how deep the capsule's
// nearest point lies inside. All are exact to rounding, except that those of boxes and cylinders come
// from a search over the segment; the distance from a convex body is convex along a segment, so the
// search finds its minimum to 1e-10 of the segment's length.
//
// Coordinates are in the world's frame, in m.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <string>
#include <vector>

namespace armwright {

// A segment with a radius; a sphere if both ends are the same point.
struct Capsule {
  Eigen::Vector3d from_m = Eigen::Vector3d::Zero(), to_m = Eigen::Vector3d::Zero();
  double radius_m = 0;

  // Returns the capsule moved by a pose.
  Capsule moved(const Eigen::Isometry3d& pose) const {
    return {pose * from_m, pose * to_m, radius_m};
  }
};

enum class ObstacleKind : std::uint8_t { sphere, capsule, box, cylinder };
const std::vector<std::string>& obstacle_kind_names();  // in the order of the enum

struct Obstacle {
  std::string name;
  ObstacleKind kind = ObstacleKind::sphere;
  Capsule capsule;  // of a sphere and a capsule
  // The centre and the axes of a box or a cylinder. The axis of a cylinder is z.
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  Eigen::Vector3d half_m = Eigen::Vector3d::Zero();  // half edges; radius, radius, half height

  // Returns the radius (m) of a sphere around the obstacle, and that sphere's centre.
  double reach_m() const;
  Eigen::Vector3d centre_m() const;
};

// Returns the least distance (m, >= 0) of the points of two segments: 0 if they cross.
double calc_segment_distance_m(const Capsule& a, const Capsule& b);
// Returns the signed distance (m) of two capsules, and of a capsule and an obstacle.
double calc_distance_m(const Capsule& a, const Capsule& b);
double calc_distance_m(const Capsule& capsule, const Obstacle& obstacle);

}  // namespace armwright
