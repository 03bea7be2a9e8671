#include "report/deliverables/datasheet_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report/formats/export_text.hpp"

namespace armwright {
namespace {

std::string make_table_cell(const char* element, const HtmlCell& cell) {
  const std::string text = escape_html(cell.text);
  return fmt::format("<{0}{1} title=\"{2}\">{2}</{0}>", element,
                     cell.style.empty() ? "" : fmt::format(" class=\"{}\"", cell.style), text);
}

// In the units of the SVG. The style sheet decides the printed size.
constexpr double kWidth = 360, kHeight = 170;
constexpr double kLeft = 42, kRight = 10, kTop = 20, kBottom = 34;

// Maps values to places along an axis, in the units of the SVG.
struct Axis {
  double low = 0, high = 1;
  bool logarithmic = false;
  double from = 0, to = 1;

  double place(double value) const {
    const double share =
        logarithmic ? std::log(value / low) / std::log(high / low) : (value - low) / (high - low);
    return from + share * (to - from);
  }
};

std::vector<double> make_decade_ticks(double low, double high) {
  std::vector<double> ticks;
  for (double decade = std::pow(10, std::floor(std::log10(low))); decade <= high; decade *= 10) {
    for (const double step : {1.0, 2.0, 5.0}) {
      if (decade * step >= low && decade * step <= high) {
        ticks.push_back(decade * step);
      }
    }
  }
  // Over many decades only the decades have ticks.
  constexpr std::size_t kMost = 9;
  if (ticks.size() > kMost) {
    std::erase_if(ticks, [](double tick) {
      return std::abs(std::log10(tick) - std::round(std::log10(tick))) > 1e-9;
    });
  }
  return ticks;
}

std::string make_text(double x, double y, const char* anchor, std::string_view text) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n", x, y, anchor,
                     escape_html(text));
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

std::string make_fact_list(std::span<const std::pair<std::string, std::string>> facts) {
  std::string html = "<dl>\n";
  for (const auto& [label, text] : facts) {
    if (!text.empty()) {
      html += fmt::format("<dt>{}</dt><dd>{}</dd>\n", escape_html(label), escape_html(text));
    }
  }
  return html + "</dl>\n";
}

std::string make_section(std::string_view title, std::string_view content) {
  return fmt::format("<section>\n<h2>{}</h2>\n{}</section>\n", escape_html(title), content);
}

std::vector<double> make_ticks(double largest) {
  constexpr double kIntervals = 5;  // the wanted number, approximately
  const double rough = largest / kIntervals;
  const double decade = std::pow(10, std::floor(std::log10(rough)));
  const double step = decade * (rough / decade < 1.5   ? 1
                                : rough / decade < 3.5 ? 2
                                : rough / decade < 7.5 ? 5
                                                       : 10);
  std::vector<double> ticks;
  for (int i = 0; i * step <= largest * (1 + 1e-9); ++i) {
    ticks.push_back(i * step);
  }
  return ticks;
}

std::string make_svg(const LineFigure& figure) {
  const double largest_x = figure.points.back().x();
  double largest_y = 0;
  for (const Eigen::Vector2d& point : figure.points) {
    largest_y = std::max(largest_y, point.y());
  }
  largest_y = largest_y > 0 ? largest_y : 1;
  Axis x{0, largest_x > 0 ? largest_x : 1, false, kLeft, kWidth - kRight};
  if (figure.logarithmic_x) {
    x.low = figure.points.front().x();
    x.logarithmic = true;
  }
  const Axis y{0, largest_y, false, kHeight - kBottom, kTop};
  std::string svg = fmt::format("<svg viewBox=\"0 0 {} {}\" role=\"img\">\n<title>{}</title>\n",
                                kWidth, kHeight, escape_html(figure.title));
  svg += make_text(kLeft, kTop - 8, "start", figure.title);
  for (const double tick : x.logarithmic ? make_decade_ticks(x.low, x.high) : make_ticks(x.high)) {
    const double at = x.place(tick);
    svg +=
        fmt::format("<path class=\"grid\" d=\"M{0:.1f} {1}V{2}\"/>\n", at, kTop, kHeight - kBottom);
    svg += make_text(at, kHeight - kBottom + 12, "middle", fmt::format("{:.6g}", tick));
  }
  for (const double tick : make_ticks(largest_y)) {
    const double at = y.place(tick);
    svg += fmt::format("<path class=\"grid\" d=\"M{} {:.1f}H{}\"/>\n", kLeft, at, kWidth - kRight);
    svg += make_text(kLeft - 4, at + 3, "end", fmt::format("{:.6g}", tick));
  }
  svg += make_text((kLeft + kWidth - kRight) / 2, kHeight - 6, "middle", figure.x_label);
  svg += make_text(4, kTop - 8, "start", figure.y_label);
  svg += "<polyline points=\"";
  for (const Eigen::Vector2d& point : figure.points) {
    svg += fmt::format("{:.1f},{:.1f} ", x.place(point.x()), y.place(point.y()));
  }
  return svg + "\"/>\n</svg>\n";
}

}  // namespace armwright
