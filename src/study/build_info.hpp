// What this program was built from and runs on, for manifests and --version.
#pragma once

#include <map>
#include <string>

namespace armwright {

std::string get_version();  // "0.1.0"
// version, git, compiler, build_type, cpu, host, and the versions of ODE, urdfdom, Eigen and
// SQLite.
std::map<std::string, std::string> describe_build();

}  // namespace armwright
