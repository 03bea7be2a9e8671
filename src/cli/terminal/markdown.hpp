// Text as Markdown, for the documentation pages that the program writes about itself
// (scripts/docs). These pages say nothing about the build, so that every build writes the same.
#pragma once

#include <string>
#include <string_view>

namespace armwright {

// The first line of each generated page.
inline constexpr const char* kGeneratedPage =
    "<!-- Written by scripts/docs from the table in the program: change the row there, not this "
    "file. -->\n";

// Escapes plain text so that Markdown shows it unchanged, also in the cell of a table.
std::string escape_markdown(std::string_view text);

// Returns the text as code, also for the cell of a table. Returns "(empty)" for an empty text.
std::string format_code(const std::string& text);

}  // namespace armwright
