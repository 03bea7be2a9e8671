// A small figure of one line, as SVG to stand within HTML: no script, nothing from outside.
#pragma once

#include <string>
#include <vector>

namespace armwright {

struct FigurePoint {
  double x = 0, y = 0;
};

struct LineFigure {
  std::string title;
  std::string x_label, y_label;
  std::vector<FigurePoint> points = {};  // finite, by x; at least two
  bool logarithmic_x = false;            // all x > 0
};

std::string make_svg(const LineFigure& figure);

// 0 and beyond, up to `largest`, at steps of 1, 2 or 5 times a power of ten, four to nine of them.
std::vector<double> make_ticks(double largest);

}  // namespace armwright
