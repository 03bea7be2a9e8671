// The steps of reading MJCF, the format of MuJoCo. Only the .cpp files of this folder include this
// header; other modules use robot_model.hpp.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "sim/robot/robot_model.hpp"

namespace armwright {

// Line `line` of the file `file`, as messages name it.
struct MjcfPlace {
  std::string file;
  int line = 1;
};

struct MjcfMesh {
  std::string name;  // in <asset>
  std::string file;  // as written, with the folder that <compiler> gives
};

// The text of an MJCF file, prepared for the library: included files are inserted, every tag has a
// line of its own, and no element makes the library open a file. What armwright does not use is
// left out, also attributes that the library's version may not know (mjcf_text.cpp lists both).
struct MjcfText {
  std::string xml;
  std::vector<MjcfPlace> places;                    // of each line of `xml`
  std::map<std::string, MjcfPlace> bodies, joints;  // by name
  std::vector<MjcfPlace> equalities, tendons;       // in the file's order
  std::vector<MjcfMesh> meshes;  // those with a file; `xml` names it make_mesh_name(i)
  std::map<std::string, std::filesystem::path> included;  // by name as written
  std::vector<std::string> notes;
};

// Returns the name that stands for the file of a mesh in MjcfText::xml, with another ending there.
std::string make_mesh_name(std::size_t mesh, std::string_view ending = ".obj");

// Returns the prepared text. `name` is the file's name in messages; included files are looked for
// in its folder. Throws Error{bad_data} "FILE:LINE: what is wrong, what to do" for text that is not
// well-formed and beyond the limits of a URDF, which hold for all files together.
MjcfText prepare_mjcf(std::string_view xml, const std::string& name);

// Reads an MJCF file as parse_urdf() does.
RobotModel parse_mjcf(std::string_view xml, const std::string& name, const RobotOptions& options);

}  // namespace armwright
