// Pages of documentation that the program writes about itself (scripts/docs). They say nothing
// about this build, so that every build writes the same.
#pragma once

#include <string>
#include <string_view>

namespace armwright {

// The first line of each.
inline constexpr const char* kGeneratedPage =
    "<!-- Written by scripts/docs from the table in the program: change the row there, not this "
    "file. -->\n";

// Plain text that Markdown shows as it is, also in a cell of a table.
std::string escape_markdown(std::string_view text);

// As code, in a cell of a table as well; "(empty)" for no text.
std::string format_code(const std::string& text);

}  // namespace armwright
