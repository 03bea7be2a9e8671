// Checks JSON from files before a parser reads it. The parser itself accepts any depth. But code
// that copies, compares, flattens or writes the result recurses once per level, and a few hundred
// kilobytes of text can nest deep enough to overflow the stack.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace armwright {

inline constexpr std::size_t kJsonDepthLimit = 64;

// Throws Error{bad_data} "NAME:LINE: ..." if arrays and objects nest deeper than kJsonDepthLimit.
void check_json_depth(std::string_view text, const std::string& name);

// Returns the text of a file after checking its size (as read_file() does) and its depth.
std::string read_json_file(const std::filesystem::path& file, std::size_t limit_bytes);

// Returns the message of an error of the JSON library, safe to print in one line, without the
// library's own number in front: "[json.exception.parse_error.101] ". Other messages stay as they
// are.
std::string describe_json_error(std::string_view message);

// Returns one line per difference: "run.seed: recorded 1, now 2". Empty if both texts have the same
// values. Both must be valid JSON. Texts within them that are JSON objects are compared likewise.
std::vector<std::string> describe_differences(const std::string& recorded_json,
                                              const std::string& now_json);

}  // namespace armwright
