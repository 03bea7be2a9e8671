// The steps of reading a URDF. Only the .cpp files of this folder include this header; other
// modules use robot_model.hpp. All functions throw Error{bad_data} "NAME:LINE: what is wrong, what
// is allowed". `name` is the file's name in messages.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/robot/robot_model.hpp"

namespace armwright {

inline constexpr std::size_t kUrdfLimit_bytes = std::size_t{8} << 20;
inline constexpr std::size_t kUrdfDepthLimit = 64;
inline constexpr std::size_t kUrdfElementLimit = 50'000;
inline constexpr std::size_t kUrdfAttributeLimit = 64;     // per element
inline constexpr std::size_t kUrdfTextLimit_bytes = 4096;  // of a name or a mesh's path
inline constexpr std::size_t kUrdfLinkLimit =
    1'000;  // build_model() recurses once per link of a branch

// The advice in messages about a file that still contains xacro.
inline constexpr std::string_view kXacroAdvice =
    "xacro is not read: run xacro my.urdf.xacro > my.urdf (ROS), or python3 -m xacro my.urdf.xacro "
    "> my.urdf, and give armwright the result";

// Throws Error{bad_data} "NAME:LINE: WHAT".
[[noreturn]] void fail_urdf(const std::string& name, int line, const std::string& what);

// Checks the text before the XML parser reads it: sizes, nesting, NUL bytes, document types,
// entities, truncation.
void scan_urdf(std::string_view xml, const std::string& name);

// The name of a link and its line in the file.
struct UrdfLink {
  std::string name;
  int line = 0;
};
// A joint's name, parent link, child link and type, and its line in the file.
struct UrdfJoint {
  std::string name, parent, child, type;
  int line = 0;
};

// The part of the tree of links that is simulated as the chain.
struct UrdfChain {
  std::string base, tip;              // names of links
  std::map<std::string, int> joints;  // lines of the chain's moving joints, by name
};
// Returns the chain that `options` selects. Checks that the links form a tree with one root. Throws
// RobotOptionError as load_urdf() does, also if no joint between base and tip can move.
UrdfChain choose_chain(const std::vector<UrdfLink>& links, const std::vector<UrdfJoint>& joints,
                       const RobotOptions& options, const std::string& name);

// The checked mass and shapes of a link.
struct UrdfBody {
  std::optional<Inertial> inertial;  // in the link's frame
  std::vector<VisualShape> shapes;   // poses in the link's frame
};

// A joint's origin, and its motion if it is part of the chain.
struct UrdfPlacement {
  Eigen::Isometry3d origin = Eigen::Isometry3d::Identity();  // in the parent link's frame
  // For a joint of the chain: its kind, axis and limits, as in RobotModel. `motion.origin` is
  // unused.
  Joint motion;
  // For a movable joint outside the chain: the pose at which it is held, relative to its origin,
  // and the held position as text ("0 m").
  Eigen::Isometry3d held_pose = Eigen::Isometry3d::Identity();
  std::string held_at;  // empty: the joint is fixed or part of the chain
};

// A validated URDF, with links and joints in the file's order.
struct CheckedUrdf {
  std::string name;  // of the robot
  UrdfChain chain;
  std::vector<UrdfLink> links;
  std::vector<UrdfBody> bodies;  // one per link
  std::vector<UrdfJoint> joints;
  std::vector<UrdfPlacement> placements;  // one per joint
  std::vector<std::string> notes;
};

// Calls scan_urdf(), then reads and validates every part of the file that armwright uses.
CheckedUrdf check_urdf(std::string_view xml, const std::string& name, const RobotOptions& options);

// Builds the model: joins links that do not move relative to each other, and computes missing
// masses from the density. Throws for a moving link without mass. Searches meshes from the folder
// of the file `name`.
RobotModel build_model(const CheckedUrdf& checked, const std::string& name,
                       const RobotOptions& options);

}  // namespace armwright
