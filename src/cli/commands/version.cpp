#include "cli/commands/version.hpp"

#include <fmt/format.h>

#include "base/build_info.hpp"
#include "base/text.hpp"
#include "sim/simd/simd_level.hpp"

namespace armwright {

std::string describe_version() {
  const auto build = describe_build();
  std::string text = fmt::format("armwright {}\n", get_version());
  const auto add = [&text](const std::string& what, const std::string& value) {
    text += fmt::format("  {:<13} {}\n", what, value);
  };
  add("git", build.at("git"));
  add("compiler", build.at("compiler"));
  add("build type", build.at("build_type"));
  add("processor", build.at("cpu"));
  add("SIMD levels", fmt::format("{}; the best of them, {}, unless told otherwise",
                                 join(supported_simd_names(), ", "), to_string(find_best_simd())));
  add("host", build.at("host"));
  text += "Libraries it was built with:\n";
  std::vector<std::string> missing;
  for (const LibraryVersion& library : list_libraries()) {
    if (library.version.empty()) {
      missing.push_back(library.name);
    } else {
      add(library.name, library.version);
    }
  }
  if (!missing.empty()) {
    text += fmt::format("Not in this build: {}\n", join(missing, ", "));
  }
  return text;
}

}  // namespace armwright
