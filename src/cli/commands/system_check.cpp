#include "cli/commands/system_check.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <map>
#include <span>

#include "base/build_info.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "optimizers/interface/optimizer.hpp"
#include "optimizers/table/optimizer_table.hpp"
#include "problems/config/config_files.hpp"
#include "problems/config/problem_loader.hpp"
#include "report/page/page_file.hpp"
#include "sim/engines/engine_table.hpp"
#include "sim/robot/mesh_file.hpp"

namespace armwright {
namespace {

using Checks = std::vector<SystemCheck>;

std::string advise_build(std::string_view packages, std::string_view option) {
  return fmt::format("apt install {}, then build with -D{}=ON", packages, option);
}

void check_build(Checks& checks) {
  for (const auto& [what, value] : describe_build()) {
    // The machine and the optional libraries have checks of their own.
    if (what != "cpu" && what != "host" && value != kNotInBuild) {
      checks.push_back({"program", what, CheckState::good, value});
    }
  }
}

void check_engines(Checks& checks) {
  for (const EngineRow& row : engine_table()) {
    const std::string simd =
        row.simd ? fmt::format("; SIMD levels here: {}; default {}",
                               join(supported_simd_names(), ", "), to_string(find_best_simd()))
                 : "";
    checks.push_back({"engines", row.name, CheckState::good, row.summary + simd});
  }
  for (const MissingEngine& missing : missing_engine_table()) {
    checks.push_back({"engines", missing.name, CheckState::lacking, "not in this build",
                      advise_build("libmujoco-dev", "ARMWRIGHT_WITH_MUJOCO")});
  }
}

// A build has all optimizers of a library or none of them, apart from those that no build offers.
void check_optimizers(Checks& checks) {
  struct Library {
    const char* name;  // the beginning of a row's backend
    const char* key;   // in list_libraries()
    const char* package;
    const char* option;
  };
  constexpr Library kLibraries[] = {
      {"NLopt", "nlopt", "libnlopt-cxx-dev", "ARMWRIGHT_WITH_NLOPT"},
      {"pagmo", "pagmo", "libpagmo-dev", "ARMWRIGHT_WITH_PAGMO"},
      {"Ceres", "ceres", "libceres-dev", "ARMWRIGHT_WITH_CERES"},
  };
  const auto list_rows = [](std::string_view library) {
    std::vector<const OptimizerRow*> rows;
    for (const OptimizerRow& row : optimizer_table()) {
      if (row.unfit.empty() &&
          (library.empty() ? row.backend.empty() : row.backend.starts_with(library))) {
        rows.push_back(&row);
      }
    }
    return rows;
  };
  checks.push_back({"optimizers", "armwright's own", CheckState::good,
                    fmt::format("{} optimizers", list_rows("").size())});
  for (const Library& library : kLibraries) {
    const std::vector<const OptimizerRow*> rows = list_rows(library.name);
    if (list_libraries().at(library.key).empty()) {
      checks.push_back({"optimizers", library.name, CheckState::lacking,
                        fmt::format("not in this build: {} optimizers are missing", rows.size()),
                        advise_build(library.package, library.option)});
      continue;
    }
    try {  // a library may be loaded only now
      const OptimizerRow row = load_optimizer(rows.front()->name);
      row.make(Options::parse(row.name, row.options, {}));
      checks.push_back({"optimizers", library.name, CheckState::good,
                        fmt::format("{} optimizers", rows.size())});
    } catch (const Error& error) {
      checks.push_back({"optimizers", library.name, CheckState::bad, error.what()});
    }
  }
}

void check_page(Checks& checks) {
  try {
    get_page_assets();
    checks.push_back({"reports", "page and figures", CheckState::good, "built in"});
  } catch (const Error&) {
    checks.push_back({"reports", "page and figures", CheckState::lacking,
                      "not in this build: report, plot and watch do not work",
                      advise_build("nodejs npm duktape-dev", "ARMWRIGHT_WITH_PAGE")});
  }
  if (can_read_meshes()) {
    checks.push_back({"reports", "meshes of robots", CheckState::good, "Assimp is built in"});
  } else {
    checks.push_back({"reports", "meshes of robots", CheckState::lacking,
                      "not in this build: replays show simple shapes, and meshes give no masses",
                      advise_build("libassimp-dev", "ARMWRIGHT_WITH_ASSIMP")});
  }
}

// Loads all shipped problems.
void check_configuration(Checks& checks) {
  constexpr const char* kGroup = "configuration";
  constexpr const char* kRemedy =
      "install armwright again, or set ARMWRIGHT_CONFIGS to the folder that holds problems/";
  try {
    const auto folder = find_config_folder();
    std::vector<std::string> counts;
    for (const char* kind : {"problems", "robots", "designs", "studies"}) {
      counts.push_back(fmt::format("{} {}", list_configs(kind).size(), kind));
    }
    checks.push_back({kGroup, "folder", CheckState::good,
                      fmt::format("{}: {}", sanitize(folder.string()), join(counts, ", "))});
  } catch (const std::exception& error) {
    checks.push_back({kGroup, "folder", CheckState::bad, error.what(), kRemedy});
    return;
  }
  std::string unreadable;
  std::size_t readable = 0;
  for (const std::string& name : list_configs("problems")) {
    try {
      load_problem(name, {});
      ++readable;
    } catch (const std::exception& error) {
      unreadable += (unreadable.empty() ? "" : "; ") + sanitize(error.what());
    }
  }
  if (readable > 0 && unreadable.empty()) {
    checks.push_back(
        {kGroup, "problems", CheckState::good, fmt::format("all {} can be loaded", readable)});
  } else {
    checks.push_back({kGroup, "problems", CheckState::bad,
                      unreadable.empty() ? "there are none" : unreadable, kRemedy});
  }
}

// Returns the path at which the shell finds the program, or an empty text.
std::string find_program(const std::string& name) {
  const char* path = std::getenv("PATH");
  for (const std::string& folder : split(path != nullptr ? path : "", ':')) {
    const auto file = std::filesystem::path(folder.empty() ? "." : folder) / name;
    std::error_code ignored;
    if (std::filesystem::is_regular_file(file, ignored) && ::access(file.c_str(), X_OK) == 0) {
      return file.string();
    }
  }
  return "";
}

void check_programs(Checks& checks) {
  struct Need {
    const char* name;
    std::vector<std::string> programs;  // any one of them is enough
    const char* what_for;
    const char* remedy;
  };
  const Need needs[] = {
      {"browser",
       {"chromium", "google-chrome", "chrome", "firefox", "xdg-open"},
       "opens the pages of report and watch",
       "apt install chromium, or open the pages on another machine"},
      {"python3", {"python3"}, "runs plugins in Python", "apt install python3"},
      {"C++ compiler", {"c++", "g++", "clang++"}, "builds plugins", "apt install g++"},
      {"cmake", {"cmake"}, "builds plugins", "apt install cmake"},
      {"git", {"git"}, "names the commit when armwright is built", "apt install git"},
  };
  for (const Need& need : needs) {
    std::string found;
    for (const std::string& program : need.programs) {
      found = found.empty() ? find_program(program) : found;
    }
    if (found.empty()) {
      checks.push_back({"programs", need.name, CheckState::lacking,
                        fmt::format("not found; it {}", need.what_for), need.remedy});
    } else {
      checks.push_back({"programs", need.name, CheckState::good,
                        fmt::format("{}; {}", sanitize(found), need.what_for)});
    }
  }
}

}  // namespace

const char* to_string(CheckState state) {
  switch (state) {
    case CheckState::good:
      return "good";
    case CheckState::lacking:
      return "lacking";
    case CheckState::bad:
      return "bad";
  }
  return "?";
}

void check_program(Checks& checks) {
  check_build(checks);
  check_engines(checks);
  check_optimizers(checks);
  check_page(checks);
  check_configuration(checks);
  check_programs(checks);
}

std::vector<SystemCheck> check_system() {
  Checks checks;
  check_program(checks);
  check_results_folder(checks);
  check_machine(checks);
  return checks;
}

}  // namespace armwright
