#include "problems/config_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "base/error.hpp"
#include "base/text.hpp"

namespace armwright {
namespace {

std::string get_extension(std::string_view kind) {
  return kind == "robots" ? ".urdf" : ".toml";
}

}  // namespace

std::filesystem::path find_config_folder() {
  if (const char* folder = std::getenv("ARMWRIGHT_CONFIGS"); folder != nullptr && *folder != '\0') {
    if (std::filesystem::is_directory(std::filesystem::path(folder) / "problems")) {
      return folder;
    }
    throw Error(ErrorKind::usage,
                fmt::format("ARMWRIGHT_CONFIGS is '{}'; it must be a folder that holds problems/, "
                            "designs/ and robots/",
                            sanitize(folder)));
  }
  std::error_code ignored;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", ignored);
  const auto folder = program.parent_path().parent_path() / "share" / "armwright" / "configs";
  if (!std::filesystem::is_directory(folder / "problems")) {
    throw Error(ErrorKind::usage,
                fmt::format("the shipped configuration was not found in {}; reinstall armwright or "
                            "set ARMWRIGHT_CONFIGS to the folder that holds problems/",
                            folder.string()));
  }
  return folder;
}

std::filesystem::path resolve_config(std::string_view kind, std::string_view name_or_path) {
  const std::string extension = get_extension(kind);
  const std::filesystem::path path(name_or_path);
  if (name_or_path.find('/') != std::string_view::npos || path.extension() == extension) {
    if (std::filesystem::is_regular_file(path)) {
      return path;
    }
    const auto shipped = find_config_folder() / kind / path;  // "irb.urdf" may name a shipped file
    if (name_or_path.find('/') == std::string_view::npos &&
        std::filesystem::is_regular_file(shipped)) {
      return shipped;
    }
    throw Error(ErrorKind::usage, fmt::format("{}: there is no such file", sanitize(name_or_path)));
  }
  const auto shipped = find_config_folder() / kind / (std::string(name_or_path) + extension);
  const auto names = list_configs(kind);
  if (std::find(names.begin(), names.end(), name_or_path) == names.end()) {
    const std::string what(kind.substr(0, kind.size() - 1));  // "problems" -> "problem"
    throw Error(ErrorKind::usage, describe_unknown(what, name_or_path, names) +
                                      fmt::format(" (or the path of a {} file)", extension));
  }
  return shipped;
}

std::vector<std::string> list_configs(std::string_view kind) {
  std::vector<std::string> names;
  const auto folder = find_config_folder() / kind;
  if (!std::filesystem::is_directory(folder)) {
    return names;
  }
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const auto& path = entry.path();
    if (path.extension() == get_extension(kind) && path.stem().string().front() != '_') {
      names.push_back(path.stem().string());
    }
  }
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace armwright
