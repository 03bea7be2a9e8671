// From the tables of a tracking problem's configuration to the problem: robot, engines, task,
// objective and decision variables.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/config.hpp"
#include "problems/config/problem_loader.hpp"

namespace armwright {

// The file that a key names, looked for beside the configuration first.
std::filesystem::path resolve_named(const ConfigTable& table, std::string_view key,
                                    std::string_view kind);

// Sets the problem and the hashes of its inputs. Returns what the configuration leaves open and has
// been settled by now, as overrides.
std::vector<std::string> load_tracking(const ConfigTable& table, std::span<const EngineRow> engines,
                                       LoadedProblem& loaded);

}  // namespace armwright
