// JSON from files, looked at before a parser sees it: the parser itself copes with any depth, but
// whatever copies, compares, flattens or writes what it has read calls itself once a level, and
// text of a few hundred kilobytes nests deep enough to end the program.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace armwright {

inline constexpr std::size_t kJsonDepthLimit = 64;

// Error{bad_data} "NAME:LINE: ..." if arrays and objects nest deeper than kJsonDepthLimit.
void check_json_depth(std::string_view text, const std::string& name);

// The file's text, with both checks; the size as in read_file().
std::string read_json_file(const std::filesystem::path& file, std::size_t limit_bytes);

// One line a difference: "run.seed: recorded 1, now 2". Empty if the texts say the same.
std::vector<std::string> describe_differences(const std::string& recorded_json,
                                              const std::string& now_json);

}  // namespace armwright
