// The steps of reading a URDF; internal to the sim room (its door is robot_model.hpp). Each library
// that parses XML is confined to a few .cpp files. All throw Error{bad_data} "NAME:LINE: what is
// wrong, what is allowed".
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
inline constexpr std::size_t kUrdfAttributeLimit = 64;     // of one element
inline constexpr std::size_t kUrdfTextLimit_bytes = 4096;  // of a name or the path of a mesh
inline constexpr std::size_t kUrdfLinkLimit =
    1'000;  // build_model() recurses once per link of a branch

// What to do about a file that xacro has yet to work on.
inline constexpr std::string_view kXacroAdvice =
    "xacro is not read: run xacro my.urdf.xacro > my.urdf (ROS), or python3 -m xacro my.urdf.xacro "
    "> my.urdf, and give armwright the result";

[[noreturn]] void fail_urdf(const std::string& name, int line, const std::string& what);

// Looks at the text alone, before any XML parser sees it: sizes, nesting, NUL bytes, document
// types, entities, truncation.
void scan_urdf(std::string_view xml, const std::string& name);

struct UrdfLink {
  std::string name;
  int line = 0;
};
struct UrdfJoint {
  std::string name, parent, child, type;
  int line = 0;
};

// Which of a tree of links and joints is the chain.
struct UrdfChain {
  std::string base, tip;              // links
  std::map<std::string, int> joints;  // those that move between them; where they stand
};
// One root and no cycle; the base, the tip and at least one joint between them that is not fixed.
// RobotOptionError as load_urdf() says.
UrdfChain choose_chain(const std::vector<UrdfLink>& links, const std::vector<UrdfJoint>& joints,
                       const RobotOptions& options, const std::string& name);

// A link as the file describes it, checked.
struct UrdfBody {
  std::optional<Inertial> inertial;  // in the link's frame
  std::vector<VisualShape> shapes;   // likewise
};

// How a joint is placed, and how it moves if it is part of the chain.
struct UrdfPlacement {
  Eigen::Isometry3d origin = Eigen::Isometry3d::Identity();  // in the parent link's frame
  // Of a joint of the chain: its kind, axis and limits, as in RobotModel. Its origin stays empty.
  Joint motion;
  // Of a joint beside the chain that could move: the pose in which it is held, from its origin on,
  // and that position in words ("0 m").
  Eigen::Isometry3d held_pose = Eigen::Isometry3d::Identity();
  std::string held_at;  // empty: it is fixed, or part of the chain
};

// A URDF that has been validated: links and joints in the file's order.
struct CheckedUrdf {
  std::string name;  // the robot's
  UrdfChain chain;
  std::vector<UrdfLink> links;
  std::vector<UrdfBody> bodies;  // one per link
  std::vector<UrdfJoint> joints;
  std::vector<UrdfPlacement> placements;  // one per joint
  std::vector<std::string> notes;
};

// Calls scan_urdf(), then reads and validates all that is used of the file.
CheckedUrdf check_urdf(std::string_view xml, const std::string& name, const RobotOptions& options);

// Builds the model: joins links that do not move against each other, and gives links mass at a
// density. Refuses a moving link without mass. Searches meshes from the folder of the file `name`.
RobotModel build_model(const CheckedUrdf& checked, const std::string& name,
                       const RobotOptions& options);

}  // namespace armwright
