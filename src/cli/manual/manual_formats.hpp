// Sets manual pages: for a terminal, for man, and as one page of Markdown. The last says nothing
// about this build, so that every build writes the same.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "cli/manual/manual_page.hpp"
#include "cli/terminal/terminal.hpp"

namespace armwright {

std::vector<std::string> manual_format_names();  // text, man, markdown

// As man shows it.
std::string to_text(const ManualPage& page, const Style& style, int width);

// For man: roff with the macros of man(7). `version` and `date` ("2026-11-23") go into the page's
// last line.
std::string to_roff(const ManualPage& page, const std::string& version, const std::string& date);

// One command as a section of Markdown.
std::string to_markdown(const ManualPage& page);
// All of them, under a title and a table of contents: docs/reference/commands.md.
std::string to_markdown_reference(std::span<const ManualPage> pages);

}  // namespace armwright
