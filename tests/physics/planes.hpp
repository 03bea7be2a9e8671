// Planar mechanisms in plane coordinates, for equations of motion written by hand.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "base/decompositions.hpp"
#include "chain_oracle.hpp"

namespace armwright::physics_test {

using Eigen::Matrix2d;
using Eigen::Vector2d;

struct Plane {
  const char* name;
  Vector3d u, v;  // u x v: the hinges' axis
};

inline const std::vector<Plane> kPlanes{
    {"vertical", {0, 0, 1}, {1, 0, 0}},
    {"horizontal", {1, 0, 0}, {0, 1, 0}},
    {"inclined", Vector3d(1, 2, 2) / 3, Vector3d(2, 1, -2) / 3}};

inline Vector2d turn(double angle_rad, const Vector2d& v) {
  return Eigen::Rotation2Dd(angle_rad) * v;
}
inline Vector2d turn_left(const Vector2d& v) {
  return {-v.y(), v.x()};
}

}  // namespace armwright::physics_test
