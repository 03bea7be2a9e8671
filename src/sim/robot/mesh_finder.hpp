// Finds the mesh files that a robot's description names.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace armwright {

// Returns the name and the folder in the text NAME=DIR, or nothing if one of them is empty.
std::optional<std::pair<std::string, std::filesystem::path>> parse_package(std::string_view text);

// Finds meshes for one description. Remembers the folders of packages, so use one object for all
// meshes of a robot. The environment is read when a package is looked for.
class MeshFinder {
 public:
  // `folder` is that of the description. `packages` has the folders of packages by their names.
  explicit MeshFinder(const std::filesystem::path& folder,
                      std::map<std::string, std::filesystem::path> packages = {});

  // Returns the path of the mesh file `name`, or nothing if the file does not exist. The forms of
  // `name`:
  //   package://NAME/REST     REST in the first of these folders that has it:
  //                           - that of NAME in `packages`
  //                           - NAME in the description's folder or in a folder above it, or the one
  //                             of these folders that is called NAME
  //                           - a folder whose package.xml has the name NAME: one of the above, or
  //                             at most two levels below one of the five nearest
  //                           - PREFIX/share/NAME for each PREFIX of AMENT_PREFIX_PATH
  //                           - a package NAME in the folders of ROS_PACKAGE_PATH
  //   file://PATH, /PATH      the path itself
  //   any other               that path in the folder, then in each folder above it
  std::optional<std::filesystem::path> find(const std::string& name);

 private:
  std::optional<std::filesystem::path> find_in_package(const std::filesystem::path& wanted);
  // Returns the folders of a package that only a search finds. Searches once per package.
  const std::vector<std::filesystem::path>& search_package(const std::string& package);

  std::vector<std::filesystem::path> folders_;  // the description's and those above it
  std::map<std::string, std::filesystem::path> packages_;
  std::map<std::string, std::vector<std::filesystem::path>> found_;  // by the package's name
};

// Returns one sentence about meshes that were not found, without a full stop. `example` is one of
// their names.
std::string describe_missing_meshes(std::size_t count, std::string_view example);

}  // namespace armwright
