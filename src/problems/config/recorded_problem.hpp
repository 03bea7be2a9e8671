// A problem made again from what a run recorded of it.
#pragma once

#include <filesystem>
#include <string>

#include "problems/config/problem_loader.hpp"

namespace armwright {

// From LoadedProblem::resolved_json, that of a replicate (make_replicate) too, whatever has become
// of the problem's file. Files that it names by a relative path are looked for in `beside` first;
// whether they are still the same the caller compares (input_hashes). Error as of load_problem(),
// and Error{bad_data} for another text.
LoadedProblem load_recorded_problem(const std::string& resolved_json, const std::string& name,
                                    const std::filesystem::path& beside);

}  // namespace armwright
