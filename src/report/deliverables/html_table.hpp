// The parts of a printed sheet: sections, tables, lists of facts. All text is given as it is and
// escaped here.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace armwright {

struct HtmlCell {
  std::string text;
  std::string style = {};  // a class of the sheet's style, "number" or of a section's own; or none
};

// The first cell of each row is its heading. Every row has as many cells as `heads`; cells that are
// too long for their column end in dots and show the whole when pointed at.
std::string make_table(std::span<const std::string> heads,
                       std::span<const std::vector<HtmlCell>> rows);

struct HtmlFact {
  std::string label;
  std::string text;  // left out if empty
};
std::string make_fact_list(std::span<const HtmlFact> facts);

// `content` is HTML.
std::string make_section(std::string_view title, std::string_view content);

}  // namespace armwright
