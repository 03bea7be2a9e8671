#include "base/build_info.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <fstream>

#include "base/text.hpp"
#include "git_state.hpp"
#include "library_versions.hpp"

namespace armwright {
namespace {

std::string read_cpu_name() {
  std::ifstream cpuinfo("/proc/cpuinfo");
  for (std::string line; std::getline(cpuinfo, line);) {
    if (line.rfind("model name", 0) == 0) {
      const std::size_t colon = line.find(": ");
      return colon == std::string::npos ? "unknown" : sanitize(line.substr(colon + 2));
    }
  }
  return "unknown";
}

std::string read_host_name() {
  char name[256] = {};
  return gethostname(name, sizeof name - 1) == 0 ? sanitize(name) : "unknown";
}

}  // namespace

std::string get_version() {
  return ARMWRIGHT_VERSION;
}

std::string get_release_date() {
  return ARMWRIGHT_RELEASE_DATE;
}

std::map<std::string, std::string> list_libraries() {
  std::map<std::string, std::string> libraries;
  for (const auto& row : kLibraryVersions) {
    libraries[row.name] = row.version;
  }
  return libraries;
}

std::map<std::string, std::string> describe_build() {
  std::map<std::string, std::string> build = {
      {"version", get_version()},       {"git", ARMWRIGHT_GIT},
      {"compiler", ARMWRIGHT_COMPILER}, {"build_type", ARMWRIGHT_BUILD_TYPE},
      {"cpu", read_cpu_name()},         {"host", read_host_name()},
  };
  for (const auto& [library, version] : list_libraries()) {
    build[library] = version.empty() ? kNotInBuild : version;
  }
  return build;
}

std::vector<std::string> describe_build_changes(const std::map<std::string, std::string>& recorded,
                                                std::string_view what) {
  std::vector<std::string> changes;
  for (const auto& [key, now] : describe_build()) {
    const auto then = recorded.find(key);
    if (then != recorded.end() && then->second != now) {
      changes.push_back(fmt::format("{} was '{}' when the {} began and is '{}' now", key,
                                    sanitize(then->second), what, now));
    }
  }
  return changes;
}

}  // namespace armwright
