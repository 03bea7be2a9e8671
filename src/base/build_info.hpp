// What this program was built from and runs on, for manifests and --version.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace armwright {

std::string get_version();       // "1.0.0"
std::string get_release_date();  // of that version: "2026-11-23"

// A library and its version, as they were when the build was configured; empty where the build was
// made without it.
struct LibraryVersion {
  std::string name;
  std::string version;
};
std::vector<LibraryVersion> list_libraries();  // by name

// version, git, compiler, build_type, cpu, host, and the version of every library, or kNotInBuild.
std::map<std::string, std::string> describe_build();
inline constexpr const char* kNotInBuild = "not in this build";

// One sentence for each thing that `recorded`, describe_build() of another time, has and that is
// another one now. `what` began then: "run". What that version did not record is not compared.
std::vector<std::string> describe_build_changes(const std::map<std::string, std::string>& recorded,
                                                std::string_view what);

}  // namespace armwright
