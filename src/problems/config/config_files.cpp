#include "problems/config/config_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "base/error.hpp"
#include "base/folder.hpp"
#include "base/text.hpp"
#include "process/command_words.hpp"
#include "process/own_file.hpp"

namespace armwright {
namespace {

std::string get_extension(std::string_view kind) {
  return kind == "robots" ? ".urdf" : kind == "gains" ? ".yaml" : ".toml";
}

// Robots and their plants stand in one folder.
std::filesystem::path find_folder(std::string_view kind) {
  return find_config_folder() / (kind == "plants" ? "robots" : kind);
}

std::string get_singular(std::string_view kind) {
  if (kind == "studies") {
    return "study";
  }
  return std::string(kind.substr(0, kind.size() - 1));  // "problems" -> "problem"
}

bool is_file(const std::filesystem::path& path) {
  std::error_code ignored;  // a file whose type cannot be read counts as missing
  return std::filesystem::is_regular_file(path, ignored);
}

std::string describe_missing(std::string_view kind, const std::filesystem::path& path,
                             const std::filesystem::path& beside) {
  const std::string name = sanitize(path.string());
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) {
    return fmt::format("'{}' is a folder; name a {} file in it", name, get_extension(kind));
  }
  std::string text = fmt::format("there is no file '{}'", name);
  if (path.is_relative()) {
    text += beside.empty()
                ? " in the current folder"
                : fmt::format(" in {} or in the current folder", sanitize(beside.string()));
  }
  if (kind == "problems" && name.find(' ') != std::string::npos) {
    return fmt::format("{}; the name of a program begins with exec:, as in 'exec:{}'", text, name);
  }
  if (!path.has_parent_path()) {
    text += fmt::format(", and no shipped {} has that name", get_singular(kind));
    const auto nearest = find_nearest(path.stem().string(), list_configs(kind));
    return nearest ? fmt::format("{}; did you mean '{}'?", text, *nearest) : text;
  }
  const std::string completed = path.string() + get_extension(kind);
  return is_file(completed) ? fmt::format("{}; did you mean '{}'?", text, sanitize(completed))
                            : text;
}

// Returns the configuration's folder for a shared object. PREFIX of
// PREFIX/lib/python3/dist-packages/armwright/*.so is four folders above the object's own. If no
// folder has the configuration, it returns the expected place in the highest of them.
std::filesystem::path find_beside(const std::filesystem::path& library) {
  constexpr int kMostLevels = 4;
  std::filesystem::path folder = library.parent_path();
  for (int level = 1;; ++level) {
    folder = folder.parent_path();
    const auto configs = folder / "share" / "armwright" / "configs";
    if (level == kMostLevels || folder_exists(configs / "problems")) {
      return configs;
    }
  }
}

}  // namespace

std::filesystem::path find_config_folder() {
  if (const char* folder = std::getenv("ARMWRIGHT_CONFIGS"); folder != nullptr && *folder != '\0') {
    if (folder_exists(std::filesystem::path(folder) / "problems")) {
      return folder;
    }
    throw Error(ErrorKind::usage,
                fmt::format("ARMWRIGHT_CONFIGS is '{}'; it must be a folder that holds problems/, "
                            "designs/ and robots/",
                            sanitize(folder)));
  }
  const OwnFile own = find_own_file();
  const auto folder = own.is_program
                          ? own.path.parent_path().parent_path() / "share" / "armwright" / "configs"
                          : find_beside(own.path);
  if (!folder_exists(folder / "problems")) {
    throw Error(ErrorKind::usage,
                fmt::format("the shipped configuration was not found in {}; reinstall armwright or "
                            "set ARMWRIGHT_CONFIGS to the folder that holds problems/",
                            folder.string()));
  }
  return folder;
}

std::filesystem::path resolve_config(std::string_view kind, std::string_view name_or_path,
                                     const std::filesystem::path& beside) {
  if (kind == "problems" && !suggest_exec(name_or_path).empty()) {
    throw Error(ErrorKind::usage, describe_missing_exec("problem", name_or_path, ""));
  }
  const std::string extension = get_extension(kind);
  const std::filesystem::path path(name_or_path);
  if (kind == "problems" && (path.extension() == ".urdf" || path.extension() == ".xml")) {
    throw Error(ErrorKind::usage,
                fmt::format("'{0}' is the file of a robot, not of a problem; name it as the robot: "
                            "--robot {0}",
                            sanitize(name_or_path)));
  }
  const bool has_folder = name_or_path.find('/') != std::string_view::npos;
  // Shipped robots are URDF files; load_urdf() also reads MJCF, and refuses xacro.
  const bool is_other_robot =
      kind == "robots" && (path.extension() == ".xml" || path.extension() == ".xacro");
  const bool is_yml = kind == "gains" && path.extension() == ".yml";
  if (has_folder || path.extension() == extension || is_other_robot || is_yml) {
    for (const auto& candidate : {beside / path, path}) {
      if (is_file(candidate)) {
        return candidate;
      }
    }
    const auto shipped = has_folder ? path : find_folder(kind) / path;
    if (!has_folder && is_file(shipped)) {  // "irb.urdf" may name a shipped file
      return shipped;
    }
    throw Error(ErrorKind::usage, describe_missing(kind, path, beside));
  }
  const auto names = list_configs(kind);
  if (std::find(names.begin(), names.end(), name_or_path) == names.end()) {
    const bool is_listed =
        kind == "problems" || kind == "designs" || kind == "robots" || kind == "studies";
    throw Error(ErrorKind::usage,
                describe_unknown(get_singular(kind), name_or_path, names,
                                 is_listed ? fmt::format("armwright list {}", kind) : "") +
                    fmt::format(" (or the path of a {} file)",
                                kind == "robots" ? ".urdf or .xml" : extension));
  }
  return find_folder(kind) / (std::string(name_or_path) + extension);
}

std::vector<std::string> list_configs(std::string_view kind) {
  std::vector<std::string> names;
  const auto folder = find_folder(kind);
  if (!folder_exists(folder)) {
    return names;
  }
  for (const auto& path : list_folder(folder)) {
    if (path.extension() == get_extension(kind) && path.stem().string().front() != '_') {
      names.push_back(path.stem().string());
    }
  }
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace armwright
