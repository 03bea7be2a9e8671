// Facts about the build of this program and the machine that it runs on, for manifests and
// --version.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace armwright {

std::string get_version();       // "1.0.0"
std::string get_release_date();  // of that version: "2026-11-23"

// Returns each library's version when the build was configured, by the library's name. The version
// is empty if the build does not use the library.
std::map<std::string, std::string> list_libraries();

// Returns version, git, compiler, build_type, cpu, host, and the version of every library or
// kNotInBuild.
std::map<std::string, std::string> describe_build();
inline constexpr const char* kNotInBuild = "not in this build";

// Returns one sentence for each value of `recorded`, an earlier describe_build(), that is different
// now. `what` names the recorded thing, for example "run". Values that only one of them has are not
// compared.
std::vector<std::string> describe_build_changes(const std::map<std::string, std::string>& recorded,
                                                std::string_view what);

}  // namespace armwright
