// The words of a command, as a shell would split it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace armwright {

// Words between blanks; quotes of both kinds and backslashes as in a shell. Nothing is expanded.
// Error{usage} if a quote stays open or there is no word.
std::vector<std::string> split_command(std::string_view command);

}  // namespace armwright
