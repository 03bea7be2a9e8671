// The steps of reading a URDF; internal to the sim room (its door is robot_model.hpp). Each library
// that parses XML is confined to a few .cpp files. All throw Error{bad_data} "NAME:LINE: what is
// wrong, what is allowed".
#pragma once

#include <cstddef>
#include <map>
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
    1'000;  // urdfdom frees a chain recursively, link by link

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

// A joint that is not part of the chain and stays where it is.
struct HeldJoint {
  int line = 0;
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();  // of its child, from its origin
  std::string place;                                         // "0 m", for a note
};

// A URDF that has been validated.
struct CheckedUrdf {
  std::string xml;  // the same robot as plain XML: only elements and attributes that were checked,
                    // every number in its shortest exact form, so that a second parser cannot read
                    // it differently; joints that are held are fixed ones
  UrdfChain chain;
  std::map<std::string, HeldJoint> held;  // by joint
  std::vector<std::string> notes;
};

// Calls scan_urdf(), then validates all that is used of the file.
CheckedUrdf check_urdf(std::string_view xml, const std::string& name, const RobotOptions& options);

// Builds the model with urdfdom: lumps links that do not move against each other, gives mass at a
// density. Refuses a moving link without mass. Meshes are looked for from the folder of the file
// `name`.
RobotModel build_model(const CheckedUrdf& checked, const std::string& name,
                       const RobotOptions& options);

}  // namespace armwright
