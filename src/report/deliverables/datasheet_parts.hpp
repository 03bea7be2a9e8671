// The parts of the data sheet: its style, tables, lists and figures, as HTML. Only .cpp files
// include this. Callers give plain text, and these functions escape it.
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "report/deliverables/deliverables.hpp"

namespace armwright {

// A cell of a table.
struct HtmlCell {
  std::string text;
  std::string style = {};  // a class of kDatasheetStyle, such as "green"; empty: none
};

// Returns a table. The first cell of each row is the row's heading. Every row has as many cells as
// `heads`. A text that is too long for its column ends in dots, and the browser shows all of it as
// a tooltip.
std::string make_table(std::span<const std::string> heads,
                       std::span<const std::vector<HtmlCell>> rows);

// Returns a list of pairs of label and text. Leaves out pairs without text.
std::string make_fact_list(std::span<const std::pair<std::string, std::string>> facts);

// Returns a section. `content` is HTML and is not escaped.
std::string make_section(std::string_view title, std::string_view content);

// A small figure of one line.
struct LineFigure {
  std::string title;
  std::string x_label, y_label;
  std::vector<Eigen::Vector2d> points = {};  // at least two, finite, sorted by x
  bool logarithmic_x = false;                // requires x > 0 for all points
};

// Returns the figure as SVG that can stand within HTML. It has no script and loads nothing.
std::string make_svg(const LineFigure& figure);

// Returns four to nine ticks from 0 up to `largest`. Their distance is 1, 2 or 5 times a power of
// ten.
std::vector<double> make_ticks(double largest);

// Returns the data sheet's figures: the distribution of the errors of the test cases, and the tip's
// error over time in the first of them, if the run's folder has that motion. Returns an empty text
// if neither can be drawn. Throws Error{bad_data} if the file with the motion is damaged.
std::string make_datasheet_figures(const FinishedArm& arm);

// The style sheet: A4 portrait, black on white, readable without colours too.
inline constexpr const char* kDatasheetStyle = R"(
@page { size: A4; margin: 11mm 12mm; }
* { box-sizing: border-box; }
body { margin: 0 auto; width: 186mm; font: 8.2pt/1.2 "DejaVu Sans", Arial, sans-serif; color: #111; background: #fff; }
h1 { font-size: 14pt; margin: 0; overflow: hidden; text-overflow: ellipsis; white-space: nowrap; }
h2 { font-size: 9pt; margin: 1.7mm 0 .5mm; border-bottom: .3mm solid #111; }
p { margin: .5mm 0; }
.lead, .clamped { display: -webkit-box; -webkit-box-orient: vertical; -webkit-line-clamp: 2; overflow: hidden; }
.fault { border: .4mm solid #a00; padding: .3mm 1.5mm; font-size: 7.6pt; font-weight: bold; color: #a00; }
.columns { display: grid; grid-template-columns: repeat(3, minmax(0, 1fr)); gap: 0 5mm; }
.figures { display: grid; grid-template-columns: repeat(2, minmax(0, 1fr)); gap: 0 5mm; }
dl { display: grid; grid-template-columns: max-content minmax(0, 1fr); gap: 0 2mm; margin: 0; }
dt { color: #444; }
dd { margin: 0; overflow-wrap: anywhere; }
table { width: 100%; border-collapse: collapse; table-layout: fixed; font-size: 7.6pt; }
th, td { padding: .1mm .8mm; border-bottom: .1mm solid #bbb; overflow: hidden; text-overflow: ellipsis; white-space: nowrap; }
th { font-weight: normal; color: #444; text-align: left; }
tr:first-child th { font-size: 7pt; font-weight: bold; color: #111; border-bottom: .2mm solid #111; text-align: right; vertical-align: bottom; white-space: normal; overflow-wrap: anywhere; }
tr:first-child th:first-child { text-align: left; }
th:first-child { width: 34mm; white-space: normal; }
td { text-align: right; font-variant-numeric: tabular-nums; }
td.green { background: #d3ecd3; }
td.yellow { background: #fbedb4; }
td.red { background: #f6c9c4; }
td.grey { background: #e6e6e6; }
svg { width: 100%; display: block; font-size: 9px; }
svg .grid { stroke: #ddd; stroke-width: .5; }
svg polyline { fill: none; stroke: #14508c; stroke-width: 1.2; }
.small { font-size: 6.4pt; overflow-wrap: anywhere; }
@media screen {
body { width: min(186mm, 100% - 24px); }
}
@media screen and (width < 700px) {
.columns, .figures { grid-template-columns: minmax(0, 1fr); }
h1 { white-space: normal; overflow-wrap: anywhere; }
tr { display: grid; grid-template-columns: repeat(auto-fill, minmax(84px, 1fr)); }
th, td { white-space: normal; overflow-wrap: anywhere; }
tr > :first-child, tr:first-child > :first-child { grid-column: 1 / -1; width: auto; font-weight: bold; }
}
)";

}  // namespace armwright
