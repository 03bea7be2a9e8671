#include "study/build_info.hpp"

#include <fmt/format.h>
#include <sqlite3.h>
#include <unistd.h>

#include <Eigen/Core>
#include <fstream>

#include "base/text.hpp"
#include "git_state.hpp"

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

std::map<std::string, std::string> describe_build() {
  return {
      {"version", get_version()},
      {"git", ARMWRIGHT_GIT},
      {"compiler", ARMWRIGHT_COMPILER},
      {"build_type", ARMWRIGHT_BUILD_TYPE},
      {"cpu", read_cpu_name()},
      {"host", read_host_name()},
      {"ode", ARMWRIGHT_ODE_VERSION},
      {"urdfdom", ARMWRIGHT_URDFDOM_VERSION},
      {"eigen",
       fmt::format("{}.{}.{}", EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION)},
      {"sqlite", sqlite3_libversion()},
  };
}

}  // namespace armwright
