#include "report/deliverables/html_table.hpp"

#include <fmt/format.h>

#include "report/formats/html_text.hpp"

namespace armwright {
namespace {

std::string make_table_cell(const char* element, const HtmlCell& cell) {
  const std::string text = escape_html(cell.text);
  return fmt::format("<{0}{1} title=\"{2}\">{2}</{0}>", element,
                     cell.style.empty() ? "" : fmt::format(" class=\"{}\"", cell.style), text);
}

}  // namespace

std::string make_table(std::span<const std::string> heads,
                       std::span<const std::vector<HtmlCell>> rows) {
  std::string html = "<table>\n<tr>";
  for (const std::string& head : heads) {
    html += make_table_cell("th", {head, ""});
  }
  html += "</tr>\n";
  for (const std::vector<HtmlCell>& row : rows) {
    html += "<tr>";
    for (std::size_t i = 0; i < row.size(); ++i) {
      html += make_table_cell(i == 0 ? "th" : "td", row[i]);
    }
    html += "</tr>\n";
  }
  return html + "</table>\n";
}

std::string make_fact_list(std::span<const HtmlFact> facts) {
  std::string html = "<dl>\n";
  for (const HtmlFact& fact : facts) {
    if (!fact.text.empty()) {
      html +=
          fmt::format("<dt>{}</dt><dd>{}</dd>\n", escape_html(fact.label), escape_html(fact.text));
    }
  }
  return html + "</dl>\n";
}

std::string make_section(std::string_view title, std::string_view content) {
  return fmt::format("<section>\n<h2>{}</h2>\n{}</section>\n", escape_html(title), content);
}

}  // namespace armwright
