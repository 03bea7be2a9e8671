// The model of a robot arm: a serial chain of revolute and prismatic joints on a fixed base. It is
// read from a URDF file or an MJCF file. The reader validates everything that it uses; for example, it refuses
// values that are not finite numbers, negative masses, and inertia tensors that no body can have.
//
// Frames: a link's frame is its joint's frame, as in URDF. The frame of a prismatic joint moves
// with its link. A link on a fixed joint becomes part of the link that carries it. Units are SI;
// angles are in rad.
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.hpp"
#include "sim/robot/joint_plant.hpp"

namespace armwright {

// The mass properties of a rigid body.
struct Inertial {
  double mass_kg = 0;
  Eigen::Vector3d com_m = Eigen::Vector3d::Zero();  // in the link's frame
  Eigen::Matrix3d inertia_kg_m2 =
      Eigen::Matrix3d::Zero();  // about the centre of mass, in the link's axes
};

// Returns the mass properties of two rigidly joined bodies, both given in the same frame
// (parallel-axis theorem).
Inertial combine(const Inertial& a, const Inertial& b);
// Returns the same body expressed in another frame; `pose` is the pose of its old frame in that
// frame.
Inertial transform(const Inertial& body, const Eigen::Isometry3d& pose);

enum class ShapeKind { box, cylinder, sphere, mesh };

// One visual shape of a link. Simulations do not use it; it can give a link its mass
// (RobotOptions).
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

// A revolute joint turns about its axis; its position is an angle in rad. A continuous joint of
// URDF is revolute with infinite limits. A prismatic joint moves along its axis; its position is a
// distance in m.
enum class JointKind { revolute, prismatic };
inline const char* get_effort_unit(JointKind kind) {
  return kind == JointKind::revolute ? "N m" : "N";
}

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
  JointPlant plant;         // the ideal joint unless it is set
};

// A change of a URDF's text. Elements are numbered in the order of their opening tags; <robot> is 0.
struct UrdfEdit {
  enum class Kind { remove, replace, append };
  std::size_t element = 0;
  Kind kind = Kind::remove;
  std::string xml = {};  // takes the element's place, or is added at the end of its content
};

// A blemish of a URDF with which the reader coped, as one line for the user, and the changes after
// which the file needs no repair. Safe to print on a terminal.
struct UrdfRepair {
  std::string what;
  std::vector<UrdfEdit> edits;
};

// How a robot's file was read.
struct RobotReading {
  std::string base, tip;          // the links at which the chain begins and ends
  std::vector<std::string> ends;  // the links at the ends of the branches below the base
  bool is_tip_proposed = false;   // the reader chose the tip among several ends
  std::vector<UrdfRepair> repairs;
  // The moving links whose masses are guesses, because the file states none (assumed_mass.hpp).
  std::vector<std::string> assumed_links;
  double density_kg_per_m3 = 0;  // that gave links their masses; 0: none did
  std::map<std::string, std::filesystem::path> packages;  // as RobotOptions::packages
};

struct RobotModel {
  std::string name;
  Link base;                  // fixed to the world; its frame is the world's
  std::vector<Joint> joints;  // from the base to the tip
  std::vector<Link> links;    // links[i] is moved by joints[i]
  Eigen::Isometry3d tip_pose =
      Eigen::Isometry3d::Identity();  // tool centre point in the last link's frame
  // The points of the tool whose distances from their targets are measured, in the last link's
  // frame. At most four (make_tool_points() of sim/kinematics/tool_task.hpp). Empty: the tool
  // centre point is measured.
  std::vector<Eigen::Vector3d> tool_points_m;
  // The names of the joints that could move and are held, because they are not on the chain.
  std::vector<std::string> held_joints;
  // A body at the tip that the last link's inertial includes, in the tip's frame: that of the file of
  // the plant. Nothing: there is none.
  std::optional<Inertial> payload;
  // Notes for the user, one line each, safe to print on a terminal. They name the parts of the file
  // that simulations ignore and the assumptions that the reader made.
  std::vector<std::string> notes;
  // The mesh files from which masses were computed, and files that an MJCF file includes, by their
  // names as written in the robot's file.
  std::map<std::string, std::filesystem::path> mass_files;
  RobotReading reading;

  std::size_t joint_count() const { return joints.size(); }
  // Returns whether a joint is not ideal.
  bool has_plant() const;
  bool has_unactuated() const;
};

// The density of links without <inertial> if RobotOptions::repair asks for one: that of water, as
// arms are castings with motors and air inside.
inline constexpr double kRepairDensity_kg_per_m3 = 1000;

// Options that select the simulated chain of a URDF and give links a mass.
struct RobotOptions {
  std::string base = {};         // the chain's first link; empty: the root
  std::string tip = {};          // the chain's last link; empty: the leaf that is clearly the tool
  double density_kg_per_m3 = 0;  // density of moving links without <inertial>; 0: no mass
  // Whether the chain's joints have the viscous and Coulomb friction of their <dynamics>. If not,
  // they have none, as in version 1.0, and a note says so.
  bool dynamics = false;
  // Whether the reader repairs what changes the arm's physics: it corrects inertias of moving links
  // and assumes the masses of moving links that have none. If not, it refuses them, as version 1.0.
  bool repair = false;
  // With `repair` and without a density: whether kRepairDensity_kg_per_m3 gives links without mass
  // that of their shapes, if all of these can be read. If not, it follows from the arm's lengths.
  bool mass_from_shapes = true;
  std::map<std::string, std::filesystem::path> packages = {};  // folders of packages by their names
};

// An Error{usage}: a member of RobotOptions does not fit the file. The message begins with the
// file's name.
class RobotOptionError final : public Error {
 public:
  RobotOptionError(std::string option, const std::string& message,
                   std::vector<std::string> leaves = {})
      : Error(ErrorKind::usage, message), option_(std::move(option)), leaves_(std::move(leaves)) {}
  // Returns the name of the member of RobotOptions. It is "tip" also if the tip is missing but
  // needed; then leaves() returns the links at the ends of the branches, in the file's order.
  const std::string& option() const { return option_; }
  const std::vector<std::string>& leaves() const { return leaves_; }

 private:
  std::string option_;
  std::vector<std::string> leaves_;
};

// Reads and validates a URDF. load_urdf() reads the file `file`; parse_urdf() reads the text `xml`
// and uses `name` as the file's name in messages and to find meshes.
//
// The links of a URDF form a tree. The chain runs from the link `options.base` down to the link
// `options.tip`; only the joints between them move. Without a tip it runs to the only leaf, or to
// the leaf that is clearly the tool: the only one behind a moving joint that is no collision helper,
// or the only one with a tool's name (tool0, tcp, ee, flange, ...). Every other joint is held at position 0, or at
// the end of its range that is nearest to 0. Its links become part of the link that carries them.
// Links beside the chain or beyond the tip become part of a moving link; links above or beside
// `base` become part of the fixed base. The world's frame is the root link's frame. The tip's frame
// is the tool centre point.
//
// The reader uses the inertial and visual elements, the joints' origins, axes and limits, and with
// `options.dynamics` their friction (damping is d, friction is c). A limit of 0 on effort or speed
// is a placeholder and means no limit. With `options.density_kg_per_m3` > 0, each moving link
// without <inertial> gets the mass properties of its visual shapes (shape_mass.hpp).
// RobotModel::notes names these assumptions and all parts that are ignored (docs/robots.md).
//
// A file whose root element is <mujoco> is MJCF. Its bodies are the links, hinge joints are
// revolute, slide joints prismatic, and base and tip may also be sites. Other joints are held at
// their reference position (ref). With `options.dynamics`, a joint has its armature, damping,
// frictionloss and spring. Limits of effort are those of the actuators.
//
// What does not touch the arm's motion is repaired: a <visual> that cannot be shown is left out, and
// so is a bad <inertial> of a link that does not move. `options.repair` also repairs moving links.
// RobotReading::repairs has a line for each kind of repair.
//
// Throws RobotOptionError if
// - the base or tip is not a link, or the base is not above the tip,
// - no joint between them moves,
// - there are several leaves, no tip is given and none of them is clearly the tool,
// - the density is not finite or is negative.
//
// Throws Error{bad_data} "FILE:LINE: what is wrong, what is allowed" for the faults below. If links
// and joints have several, the message is "FILE: N things to mend" with a line for each.
// - a file over 8 MiB, nesting deeper than 64, document types, a version other than 1.0, xacro,
// - misspelt elements and attributes, and values that are not finite numbers,
// - names used twice, and links that do not form a tree,
// - a moving link without mass, or a mass <= 0 (mass 0 with an all-zero inertia means no mass),
// - a moving link's inertia that is not symmetric positive definite or violates the triangle
//   inequality of the principal moments,
// - a mesh that is needed for a mass and cannot give one,
// - a zero axis,
// - on the chain: a revolute or prismatic joint without limits, lower > upper, speed or effort
//   limits < 0, mimic, and any type except revolute, continuous, prismatic and fixed.
//
// and for MJCF: what MuJoCo 2.2 does not take, ball and free joints on the chain, two joints in one
// body of it, equality constraints and tendons that act on it, and builds without MuJoCo.
//
// load_urdf() throws Error{io} if the file cannot be read.
RobotModel load_urdf(const std::filesystem::path& file, const RobotOptions& options = {});
RobotModel parse_urdf(std::string_view xml, const std::string& name,
                      const RobotOptions& options = {});
// One collision shape of a URDF. Its pose is in the root link's frame, with every joint at 0.
struct CollisionShape {
  std::string link;
  int line = 0;
  VisualShape shape;
};
// Return all collision shapes of a URDF, links in the file's order. The file may be a scene without
// any moving joint. Throw Error{bad_data} "FILE:LINE: what is wrong, what is allowed" for what
// parse_urdf() refuses of links, joints and visual shapes, and for shapes without size.
// load_collisions() throws Error{io} if the file cannot be read.
std::vector<CollisionShape> load_collisions(const std::filesystem::path& file);
std::vector<CollisionShape> parse_collisions(std::string_view xml, const std::string& name);
// Returns whether the root element of the text is <mujoco>.
bool is_mjcf(std::string_view xml);

// A load of the user's own, in the frame of the tip and for each kg of its mass.
struct LoadBody {
  Eigen::Vector3d com_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d inertia_m2 =
      Eigen::Matrix3d::Zero();  // inertia / mass, about the centre of mass, in the tip's axes

  bool operator==(const LoadBody&) const = default;
};

// Returns the robot with a load on its last link: `body`, or else a steel block on the flange. The
// block is a box of 0.16825 x 0.16825 x 0.09 m (the thesis's load, section 6.4). Its short side
// points along the last link, and its centre lies 45 mm beyond the tip. If the tip is the origin of
// the last link, the block points along the last joint's axis. `mass_kg` changes the density, not
// the shape. Throws Error{usage} if the mass is not finite or is negative.
RobotModel add_load(RobotModel model, double mass_kg, const std::optional<LoadBody>& body = {});

// Returns the robot with the mass and inertia of each moving link multiplied by `factor`, as if its
// density were changed. Throws Error{usage} if the factor is not finite and positive.
RobotModel scale_masses(RobotModel model, double factor);

// Changes of all joints' plants. The default changes nothing. Factors act after the additions.
struct PlantScales {
  double friction = 1;   // factor on all friction, also on the offset
  double armature = 1;   // factor on armatures, also on those of armature_share
  double stiffness = 1;  // factor on stiffness and damping, also on those of elastic_hz
  // A joint without armature gets this share of the inertia that it moves while the others are held
  // at the middles of their ranges (at 0 if they have none).
  double armature_share = 0;
  // A rigid joint with armature A becomes elastic: on a held link, its motor swings at this
  // frequency f, k = (2 pi f)^2 A, with a twentieth of the critical damping. 0: it stays rigid.
  double elastic_hz = 0;

  bool operator==(const PlantScales&) const = default;
};
RobotModel scale_plants(RobotModel model, const PlantScales& scales);

}  // namespace armwright
