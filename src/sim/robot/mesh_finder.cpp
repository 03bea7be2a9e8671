#include "sim/robot/mesh_finder.hpp"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <cstdlib>
#include <system_error>

#include "base/text.hpp"

namespace armwright {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPackageScheme = "package://";
constexpr std::string_view kFileScheme = "file://";
constexpr std::size_t kLevelsAbove = 5;  // whose neighbours are searched
constexpr int kDepthBeside = 2;
constexpr int kDepthOfPath = 6;             // below a folder of ROS_PACKAGE_PATH
constexpr std::size_t kMostFolders = 5000;  // of one search, so that it takes less than a second
constexpr std::uintmax_t kMostManifest_bytes = 1 << 20;

bool is_file(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

// Returns the name in a folder's package.xml, or an empty text.
std::string read_package_name(const fs::path& folder) {
  const fs::path file = folder / "package.xml";
  std::error_code error;
  if (!is_file(file) || fs::file_size(file, error) > kMostManifest_bytes || error) {
    return "";
  }
  tinyxml2::XMLDocument document;
  if (document.LoadFile(file.c_str()) != tinyxml2::XML_SUCCESS) {
    return "";
  }
  const tinyxml2::XMLElement* const root = document.RootElement();
  const tinyxml2::XMLElement* const name =
      root == nullptr ? nullptr : root->FirstChildElement("name");
  const char* const text = name == nullptr ? nullptr : name->GetText();
  std::string found = text == nullptr ? "" : text;
  found.erase(0, std::min(found.size(), found.find_first_not_of(" \t\r\n")));
  found.erase(found.find_last_not_of(" \t\r\n") + 1);
  return found;
}

std::vector<fs::path> list_folders(const fs::path& folder) {
  std::vector<fs::path> folders;
  std::error_code error;
  for (fs::directory_iterator at(folder, error); !error && at != fs::directory_iterator();
       at.increment(error)) {
    std::error_code unreadable;
    if (at->is_directory(unreadable) && at->path().filename().string().front() != '.') {
      folders.push_back(at->path());
    }
  }
  std::ranges::sort(folders);  // the order of the file system must not decide
  return folders;
}

// Adds the packages of that name in a folder and below it. Looks at no folder inside a package, as
// ROS does. `left` is the number of folders that may still be looked at.
void search(const fs::path& folder, const std::string& package, int depth, std::size_t& left,
            std::vector<fs::path>& found) {
  if (left == 0) {
    return;
  }
  --left;
  const std::string name = read_package_name(folder);
  if (name == package) {
    found.push_back(folder);
  }
  if (depth > 0 && name.empty()) {
    for (const fs::path& inside : list_folders(folder)) {
      search(inside, package, depth - 1, left, found);
    }
  }
}

std::vector<std::string> list_paths(const char* variable) {
  const char* const value = std::getenv(variable);
  std::vector<std::string> paths = split(value == nullptr ? "" : value, ':');
  std::erase(paths, "");
  return paths;
}

}  // namespace

std::optional<std::pair<std::string, fs::path>> parse_package(std::string_view text) {
  const std::size_t at = text.find('=');
  if (at == 0 || at == std::string_view::npos || at + 1 == text.size()) {
    return std::nullopt;
  }
  return std::pair(std::string(text.substr(0, at)), fs::path(text.substr(at + 1)));
}

MeshFinder::MeshFinder(const fs::path& folder, std::map<std::string, fs::path> packages)
    : packages_(std::move(packages)) {
  std::error_code error;
  fs::path here = fs::absolute(folder, error).lexically_normal();
  if (here.filename().empty()) {
    here = here.parent_path();  // "a/b/" has an empty file name
  }
  folders_.push_back(here);
  for (; here != here.parent_path(); here = here.parent_path()) {
    folders_.push_back(here.parent_path());
  }
}

std::optional<fs::path> MeshFinder::find(const std::string& name) {
  const bool in_package = name.starts_with(kPackageScheme);
  const fs::path wanted = name.substr(in_package                      ? kPackageScheme.size()
                                      : name.starts_with(kFileScheme) ? kFileScheme.size()
                                                                      : 0);
  if (wanted.empty()) {
    return std::nullopt;
  }
  if (wanted.is_absolute()) {
    return is_file(wanted) ? std::optional(wanted) : std::nullopt;
  }
  if (in_package) {
    return find_in_package(wanted);
  }
  for (const fs::path& folder : folders_) {
    if (is_file(folder / wanted)) {
      return folder / wanted;
    }
  }
  return std::nullopt;
}

std::optional<fs::path> MeshFinder::find_in_package(const fs::path& wanted) {
  const std::string package = wanted.begin()->string();
  const fs::path rest = wanted.lexically_relative(package);
  std::vector<fs::path> near;  // folders that need no search
  if (const auto given = packages_.find(package); given != packages_.end()) {
    near.push_back(given->second);
  }
  for (const fs::path& folder : folders_) {
    near.push_back(folder / package);
    if (folder.filename() == package) {
      near.push_back(folder);
    }
  }
  const auto find_in = [&](const std::vector<fs::path>& places) -> std::optional<fs::path> {
    const auto found = std::ranges::find_if(
        places, [&](const fs::path& folder) { return is_file(folder / rest); });
    return found == places.end() ? std::nullopt : std::optional(*found / rest);
  };
  const auto found = find_in(near);
  return found ? found : find_in(search_package(package));
}

const std::vector<fs::path>& MeshFinder::search_package(const std::string& package) {
  const auto known = found_.find(package);
  if (known != found_.end()) {
    return known->second;
  }
  std::vector<fs::path> found;
  std::size_t left = kMostFolders;
  for (std::size_t level = 0; level < folders_.size(); ++level) {
    search(folders_[level], package, 0, left, found);
    if (level < kLevelsAbove) {
      for (const fs::path& beside : list_folders(folders_[level])) {
        search(beside, package, kDepthBeside - 1, left, found);
      }
    }
  }
  for (const std::string& prefix : list_paths("AMENT_PREFIX_PATH")) {
    found.push_back(fs::path(prefix) / "share" / package);
  }
  left = kMostFolders;
  for (const std::string& path : list_paths("ROS_PACKAGE_PATH")) {
    search(path, package, kDepthOfPath, left, found);
  }
  return found_[package] = std::move(found);
}

std::string describe_missing_meshes(std::size_t count, std::string_view example) {
  return fmt::format(
      "{} found, e.g. {}; --package NAME=DIR (robot.packages) says where a package is",
      count == 1 ? "1 mesh was not" : fmt::format("{} meshes were not", count), sanitize(example));
}

}  // namespace armwright
