// Splits a command into words as a shell does.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace armwright {

// Splits at blanks and handles both kinds of quotes and backslashes as a shell does. Expands
// nothing. Throws Error{usage} if a quote is not closed or there is no word.
std::vector<std::string> split_command(std::string_view command);

}  // namespace armwright
