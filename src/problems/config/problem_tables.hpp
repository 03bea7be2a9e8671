// The loading of a problem whose tables come from anywhere: a file, or the record of a run.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>

#include "base/config.hpp"
#include "problems/config/problem_loader.hpp"

namespace armwright {

// The configuration with these overrides.
using ReadTable = std::function<ConfigTable(std::span<const std::string> overrides)>;

// The problem is named after `path`, beside which files are looked for.
LoadedProblem load_problem_tables(const std::filesystem::path& path, const ReadTable& read_table,
                                  std::span<const std::string> overrides,
                                  std::span<const EngineRow> engines);

}  // namespace armwright
