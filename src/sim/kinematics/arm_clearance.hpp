// The clearance of an arm: the least distance of its links from obstacles and, on request, from each
// other. Every link is a capsule around its shapes.
//
// The capsule of a link is the one of least volume among these: its axis is the line from the link's
// joint to the next one (or to the tip), or one of the three principal axes of the shapes' corners;
// it lies in the middle of the corners across its axis, and is as thick and as long as it must be to
// hold them all. A cylinder counts with the corners of 16-sided prisms around it, a mesh with its
// vertices. A link without shapes gets the line between the joints, with 5 % of the arm's length as
// its radius, as in floor_clearance.hpp; its tip may be nearer, since links taper.
//
// Two links that are joined, or overlap in each of 200 random postures, touch by design and are never
// compared.
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/kinematics/obstacle.hpp"
#include "sim/robot/mesh_finder.hpp"
#include "sim/robot/robot_model.hpp"

namespace armwright {

// Returns a capsule that holds all points (m). `axes` are the directions to try.
Capsule fit_capsule(std::span<const Eigen::Vector3d> points_m,
                    std::span<const Eigen::Vector3d> axes);
// Returns the obstacle that a shape in the world is. `mesh` is the file of a mesh, whose vertices the
// fitted capsule holds. Throws what read_mesh() throws.
Obstacle make_obstacle(const VisualShape& shape, std::string name,
                       const std::filesystem::path& mesh = {});
// Returns one capsule per body, the base first, in the frame of its link; nothing for a base without
// shapes. Meshes that cannot be found or read do not count; if a link then has no shapes left,
// `notes` gets a sentence.
std::vector<std::optional<Capsule>> fit_link_capsules(const RobotModel& robot, MeshFinder meshes,
                                                      std::vector<std::string>& notes);

class ArmClearance {
 public:
  // With `self`, links are compared with each other too, and with the base.
  ArmClearance(const RobotModel& robot, std::vector<std::optional<Capsule>> capsules,
               std::vector<Obstacle> obstacles, bool self);

  // Returns the clearance of the same arm with other capsules, one per body.
  ArmClearance with_capsules(std::vector<std::optional<Capsule>> capsules) const;

  struct Nearest {
    double distance_m = 0;    // signed
    std::size_t body = 0;     // 0: the base; 1: the first link
    std::size_t other = 0;    // the index of an obstacle, or another body
    bool is_obstacle = true;  // what `other` is
  };
  // Returns the nearest pair in a posture; its distance is infinite if there is nothing to compare.
  // `poses` are those of calc_link_poses(). Thread-safe.
  Nearest find_nearest(std::span<const Eigen::Isometry3d> poses) const;
  // Returns the names of the pair: "link_3 and the obstacle 'post'".
  std::string describe(const Nearest& nearest) const;
  // Returns a sentence about a distance below `least_m`, without a full stop.
  std::string describe_gap(const Nearest& nearest, double least_m) const;
  const std::vector<Obstacle>& obstacles() const { return obstacles_; }
  const std::vector<std::optional<Capsule>>& capsules() const { return capsules_; }

 private:
  void find_pairs(const RobotModel& robot);
  // Returns the capsules in the world; those of bodies without one have no size.
  std::vector<Capsule> place(std::span<const Eigen::Isometry3d> poses) const;

  std::vector<std::optional<Capsule>> capsules_;
  std::vector<Obstacle> obstacles_;
  std::vector<std::pair<std::size_t, std::size_t>> pairs_;  // of bodies that are compared
  std::vector<std::string> names_;                          // of the bodies
};

}  // namespace armwright
