// What an identification found, as text. identify prints it at the end, and show at any time.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "cli/terminal/terminal.hpp"

namespace armwright {

// Returns doubts first, then the parameters with their intervals, what is not determined, the errors
// of each joint on the logs that were fitted and on those held back, and the files in the folder.
// `identification` is that of identification.json (study/identification/fit_report.hpp). Throws
// nlohmann::json::exception if it is not.
std::string describe_identification(const nlohmann::json& identification,
                                    const std::filesystem::path& folder, const Style& style);

}  // namespace armwright
