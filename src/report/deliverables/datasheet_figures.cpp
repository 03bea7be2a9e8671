// Draws the figures of the data sheet.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/folder_checksums.hpp"
#include "base/text.hpp"
#include "process/csv_reader.hpp"
#include "report/deliverables/datasheet_parts.hpp"

namespace armwright {
namespace {

// Returns the share of the cases below each error: one step per case. Cases without a number have
// no step, so the line ends below 100 %.
LineFigure make_spread(const FinishedArm& arm) {
  LineFigure figure{"of the test cases have an error below", "error in mm", "%", {}};
  std::vector<double> errors_m;
  std::ranges::copy_if(arm.result().test.case_errors, std::back_inserter(errors_m),
                       [](double error) { return std::isfinite(error); });
  std::ranges::sort(errors_m);
  const auto all = static_cast<double>(arm.result().test.case_errors.size());
  for (std::size_t i = 0; i < errors_m.size(); ++i) {
    const double error_mm = kMillimetresPerMetre * errors_m[i];
    figure.points.emplace_back(error_mm, 100 * static_cast<double>(i) / all);
    figure.points.emplace_back(error_mm, 100 * static_cast<double>(i + 1) / all);
  }
  // On a linear axis, a few cases with a lost target would press all others against the left edge.
  constexpr double kWide = 20;
  figure.logarithmic_x =
      !errors_m.empty() && errors_m.front() > 0 && errors_m.back() > kWide * errors_m.front();
  return figure;
}

std::size_t find_column(const std::vector<std::string>& heads, std::string_view name,
                        const std::filesystem::path& file) {
  const auto found = std::ranges::find(heads, name);
  if (found == heads.end()) {
    throw Error(ErrorKind::bad_data,
                fmt::format("{}: has no column {}; remove the file and start the run again with "
                            "the same command to have it rebuilt",
                            sanitize(file.string()), name));
  }
  return static_cast<std::size_t>(found - heads.begin());
}

// Returns at most kPoints points, which the eye can still tell apart: the largest error of each
// stretch of time.
std::vector<Eigen::Vector2d> keep_peaks(const std::vector<Eigen::Vector2d>& points) {
  constexpr std::size_t kPoints = 400;
  const std::size_t stretch = (points.size() + kPoints - 1) / kPoints;
  std::vector<Eigen::Vector2d> thinned;
  for (std::size_t i = 0; i < points.size(); i += std::max<std::size_t>(stretch, 1)) {
    const auto first = points.begin() + static_cast<std::ptrdiff_t>(i);
    const auto last =
        points.begin() + static_cast<std::ptrdiff_t>(std::min(i + stretch, points.size()));
    thinned.push_back(*std::max_element(
        first, last,
        [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.y() < b.y(); }));
  }
  return thinned;
}

LineFigure make_first_case(const FinishedArm& arm) {
  constexpr std::size_t kTrajectoryLimit_bytes = std::size_t{1} << 28;
  LineFigure figure{"tip error in the first test case", "time in s", "mm", {}};
  const auto file = arm.run.folder / "winner-trajectory.csv";
  if (!path_exists(file)) {
    return figure;
  }
  const std::string text = read_checked_file(file, kTrajectoryLimit_bytes);
  CsvReader reader(text);
  std::vector<std::string> fields;
  reader.read_row(fields);
  const std::size_t time = find_column(fields, "time_s", file);
  const std::size_t error = find_column(fields, "error_m", file);
  const std::size_t columns = fields.size();
  while (reader.read_row(fields)) {
    const auto time_s = fields.size() == columns ? parse_finite(fields[time]) : std::nullopt;
    const auto error_m = fields.size() == columns ? parse_finite(fields[error]) : std::nullopt;
    if (!time_s || !error_m) {
      throw Error(ErrorKind::bad_data,
                  fmt::format("{}:{}: is not a row of a motion that armwright wrote; remove the "
                              "file and start the run again with the same command to have it "
                              "rebuilt",
                              sanitize(file.string()), reader.row()));
    }
    figure.points.emplace_back(*time_s, kMillimetresPerMetre * *error_m);
  }
  figure.points = keep_peaks(figure.points);
  return figure;
}

}  // namespace

std::string make_datasheet_figures(const FinishedArm& arm) {
  std::string html;
  for (const LineFigure& figure : {make_spread(arm), make_first_case(arm)}) {
    if (figure.points.size() > 1) {
      html += make_svg(figure);
    }
  }
  return html.empty() ? "" : "<div class=\"figures\">\n" + html + "</div>\n";
}

}  // namespace armwright
