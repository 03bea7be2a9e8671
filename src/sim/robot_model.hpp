// A robot arm as the rest of the program sees it: a serial chain of revolute joints on a fixed
// base, read from URDF behind our own strict validation (urdfdom 3.0.1 takes mass "nan", "1.5kg"
// and the like as 0, accepts negative masses and inertia tensors that no body can have, and crashes
// on deep nesting).
//
// Frames: a link's frame is its joint's frame (URDF's convention). Links joined by fixed joints are
// lumped into the link that carries them. SI units, angles in rad.
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace armwright {

struct Inertial {
  double mass_kg = 0;
  Eigen::Vector3d com_m = Eigen::Vector3d::Zero();  // in the link's frame
  Eigen::Matrix3d inertia_kg_m2 =
      Eigen::Matrix3d::Zero();  // about the centre of mass, along the link's axes
};

// Rigidly joins two bodies given in the same frame (parallel-axis theorem).
Inertial combine(const Inertial& a, const Inertial& b);
// The same body seen from a frame in which its old frame has the pose `pose`.
Inertial transform(const Inertial& body, const Eigen::Isometry3d& pose);

enum class ShapeKind { box, cylinder, sphere, mesh };

// What a link looks like; never used in a simulation.
struct VisualShape {
  ShapeKind kind = ShapeKind::box;
  Eigen::Vector3d size_m = Eigen::Vector3d::Zero();  // box: edges; cylinder: radius, length, 0;
                                                     // sphere: radius, 0, 0; mesh: scale
  std::string mesh_file;                             // mesh only, as written in the URDF
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  // in the link's frame
  Eigen::Vector4d rgba = Eigen::Vector4d(0.7, 0.7, 0.7, 1.0);
};

struct Link {
  std::string name;
  Inertial inertial;
  std::vector<VisualShape> visuals;
};

struct Joint {
  std::string name;
  Eigen::Isometry3d origin =
      Eigen::Isometry3d::Identity();                // in the parent link's frame, at angle 0
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  // unit vector in the joint's frame
  double lower_rad = 0;                             // -inf and +inf for a continuous joint
  double upper_rad = 0;
  double speed_limit_rad_per_s = 0;
  double effort_limit_n_m = 0;
};

struct RobotModel {
  std::string name;
  Link base;                  // fixed to the world, its frame is the world's
  std::vector<Joint> joints;  // from the base to the tip
  std::vector<Link> links;    // links[i] is moved by joints[i]
  Eigen::Isometry3d tip_pose =
      Eigen::Isometry3d::Identity();  // tool centre point in the last link's frame

  std::size_t joint_count() const { return joints.size(); }
};

// Reads and validates a URDF. The chain runs from the root link to the only leaf; a leaf without
// mass reached by a fixed joint is the tool centre point. Throws Error{bad_data} "FILE:LINE: what
// is wrong, what is allowed" for: a file over 8 MiB or nested deeper than 64; anything that is not
// a finite number where one belongs; a moving link without mass; mass <= 0; an inertia that is not
// symmetric positive definite or violates the triangle inequality of principal moments; a zero
// axis; lower > upper; speed or effort limits < 0; a branching chain; any joint type but revolute,
// continuous and fixed; all that urdfdom itself refuses.
RobotModel load_urdf(const std::filesystem::path& file);
RobotModel parse_urdf(std::string_view xml, const std::string& name);

// A steel block on the flange: `mass_kg` as a box of 0.16825 x 0.16825 x 0.09 m (the thesis's load,
// section 6.4) whose short side points along the last link, its centre 45 mm beyond the tip. Other
// masses keep the shape and scale the density.
RobotModel add_load(RobotModel model, double mass_kg);

}  // namespace armwright
