// Formats manual pages: as text for a terminal, as roff for man, and as Markdown. The Markdown says
// nothing about the build, so that every build writes the same.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "cli/manual/manual_page.hpp"
#include "cli/terminal/terminal.hpp"

namespace armwright {

std::vector<std::string> manual_format_names();  // text, man, markdown

// Returns the page as man shows it, in lines of at most `width` characters.
std::string to_text(const ManualPage& page, const Style& style, int width);

// Returns the page as roff with the macros of man(7). `version` and `date` ("2026-11-23") stand in
// the page's last line.
std::string to_roff(const ManualPage& page, const std::string& version, const std::string& date);

// Returns the page as a section of Markdown.
std::string to_markdown(const ManualPage& page);
// Returns all pages with a title and a table of contents: docs/reference/commands.md.
std::string to_markdown_reference(std::span<const ManualPage> pages);

}  // namespace armwright
