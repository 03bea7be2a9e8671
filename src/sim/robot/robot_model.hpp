// A robot arm as the rest of the program sees it: a serial chain of revolute and prismatic joints
// on a fixed base. It is read from URDF with a strict validation of everything that is used:
// numbers that are not numbers, negative masses and inertia tensors that no body can have are
// refused.
//
// Frames: a link's frame is its joint's frame (URDF's convention); that of a prismatic joint moves
// with the link. Links joined by fixed joints are lumped into the link that carries them. SI units,
// angles in rad.
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.hpp"

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

// A revolute joint turns about its axis by an angle in rad (a continuous one is revolute with
// infinite limits); a prismatic joint moves along it by a distance in m.
enum class JointKind { revolute, prismatic };

struct Joint {
  std::string name;
  JointKind kind = JointKind::revolute;
  Eigen::Isometry3d origin =
      Eigen::Isometry3d::Identity();                // in the parent link's frame, at position 0
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  // unit vector in the joint's frame
  double lower = 0;         // rad or m; -inf and +inf for a continuous joint
  double upper = 0;         // rad or m
  double speed_limit = 0;   // rad/s or m/s; both +inf for a continuous joint without <limit>
  double effort_limit = 0;  // N m or N
};

// A mesh that a link's mass was taken from.
struct MassFile {
  std::string name;  // as written in the URDF
  std::filesystem::path path;
};

struct RobotModel {
  std::string name;
  Link base;                  // fixed to the world, its frame is the world's
  std::vector<Joint> joints;  // from the base to the tip
  std::vector<Link> links;    // links[i] is moved by joints[i]
  Eigen::Isometry3d tip_pose =
      Eigen::Isometry3d::Identity();  // tool centre point in the last link's frame
  // Points of the tool, in the last link's frame, whose distance from their targets is measured;
  // none: the tool centre point's. At most four (sim/tool_task.hpp makes them).
  std::vector<Eigen::Vector3d> tool_points_m;
  // What the file says and no simulation does, and what was done on the user's behalf: a whole line
  // each, fit for a terminal.
  std::vector<std::string> notes;
  // The meshes that masses were taken from.
  std::vector<MassFile> mass_files;

  std::size_t joint_count() const { return joints.size(); }
};

// What of a URDF is simulated, and how.
struct RobotOptions {
  std::string base = {};         // the link that the chain begins at; empty: the root
  std::string tip = {};          // the link that it ends at; empty: the only leaf below the base
  double density_kg_per_m3 = 0;  // of moving links without <inertial>; 0: they have no mass
};

// An option does not fit the file. The message begins with the file's name.
class RobotOptionError final : public Error {
 public:
  RobotOptionError(std::string option, const std::string& message,
                   std::vector<std::string> leaves = {})
      : Error(ErrorKind::usage, message), option_(std::move(option)), leaves_(std::move(leaves)) {}
  // The member's name; "tip" also where it must be given and is not. Then leaves() has the ends of
  // the branches, in the file's order.
  const std::string& option() const { return option_; }
  const std::vector<std::string>& leaves() const { return leaves_; }

 private:
  std::string option_;
  std::vector<std::string> leaves_;
};

// Reads and validates a URDF. Its links are a tree; the chain runs from the link `options.base`
// down to the link `options.tip`, and its joints move. All others are held at position 0, or at the
// end of their range that is nearest to it, and their links lumped into those that carry them: what
// hangs beside the chain or beyond the tip into a moving link, what is above or beside `base` into
// the fixed base. The world's frame is the root link's, the tip's frame the tool centre point.
//
// Of a URDF are used: inertial, visual, joint origins, axes and limits. A limit of effort or
// velocity of 0, a placeholder, is none. At a density the moving links without <inertial> get mass,
// centre of mass and inertia of their visual shapes (shape_mass.hpp). `notes` says what was done
// and what is left out (docs/robots.md).
//
// Throws RobotOptionError for a base or tip that is no link, a base that is not above the tip, no
// moving joint between them, several leaves and no tip named, a density that is not finite and >=
// 0. Throws Error{bad_data} "FILE:LINE: what is wrong, what is allowed" for: a file over 8 MiB or
// nested deeper than 64; document types; anything that is not a finite number where one belongs;
// misspelt elements and attributes; xacro; names used twice; links that are no tree; a moving link
// without mass; mass <= 0; an inertia that is not symmetric positive definite or violates the
// triangle inequality of principal moments (all zero, with mass 0: no mass); a zero axis; on the
// chain a revolute or prismatic joint without limits, lower > upper, speed or effort limits < 0,
// mimic, and any type but revolute, continuous, prismatic and fixed; a mesh that gives no mass; a
// version other than 1.0. load_urdf(): Error{io} if the file cannot be read.
RobotModel load_urdf(const std::filesystem::path& file, const RobotOptions& options = {});
RobotModel parse_urdf(std::string_view xml, const std::string& name,
                      const RobotOptions& options = {});

// A steel block on the flange: `mass_kg` as a box of 0.16825 x 0.16825 x 0.09 m (the thesis's load,
// section 6.4) whose short side points along the last link, its centre 45 mm beyond the tip. Other
// masses keep the shape and scale the density. Error{usage} unless the mass is finite and >= 0;
// Error{bad_data} if the tip lies in the last joint, which leaves no direction.
RobotModel add_load(RobotModel model, double mass_kg);

// Every moving link's mass and inertia times `factor`, as if of another density. Error{usage}
// unless it is finite and > 0.
RobotModel scale_masses(RobotModel model, double factor);

}  // namespace armwright
