// The steps of reading a URDF; internal to the sim room (its door is robot_model.hpp). Each library
// that parses XML is confined to one of the .cpp files. All throw Error{bad_data} "NAME:LINE: what
// is wrong, what is allowed".
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "sim/robot_model.hpp"

namespace armwright {

inline constexpr std::size_t kUrdfLimit_bytes = std::size_t{8} << 20;
inline constexpr std::size_t kUrdfDepthLimit = 64;
inline constexpr std::size_t kUrdfElementLimit = 50'000;
inline constexpr std::size_t kUrdfAttributeLimit = 64;     // of one element
inline constexpr std::size_t kUrdfTextLimit_bytes = 4096;  // of a name or the path of a mesh
inline constexpr std::size_t kUrdfLinkLimit =
    1'000;  // urdfdom frees a chain recursively, link by link

[[noreturn]] void fail_urdf(const std::string& name, int line, const std::string& what);

// Looks at the text alone, before any XML parser sees it: sizes, nesting, NUL bytes, document
// types, entities, truncation.
void scan_urdf(std::string_view xml, const std::string& name);

// Calls scan_urdf(), then validates all that is used of the file. Returns the same robot as plain
// XML: only elements and attributes that were checked, every number in its shortest exact form, so
// that a second parser cannot read it differently.
std::string check_urdf(std::string_view xml, const std::string& name);

// What of the links and joints makes the chain.
struct UrdfLink {
  std::string name;
  int line = 0;
  bool has_mass = false;
};
struct UrdfJoint {
  std::string name, parent, child;
  int line = 0;
  bool moving = false;
};
// One root, one leaf, no cycle, at least one moving joint, none of which moves nothing but massless
// links.
void check_urdf_chain(const std::vector<UrdfLink>& links, const std::vector<UrdfJoint>& joints,
                      const std::string& name);

// Builds the model from what check_urdf() returned, with urdfdom; lumps links joined by fixed
// joints.
RobotModel build_model(const std::string& checked_xml, const std::string& name);

}  // namespace armwright
