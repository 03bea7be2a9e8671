// Reads a path of the tool from a CSV file.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "base/error.hpp"
#include "base/read_limit.hpp"
#include "base/text.hpp"
#include "problems/config/problem_readers.hpp"

namespace armwright {
namespace {

constexpr double kShortestQuaternion = 0.5;  // rounding does not shorten a unit quaternion so far

constexpr int kLinesBetweenLooks = 256;  // at the limit of reading

struct Row {
  double time_s = 0;
  Eigen::Vector3d place_m;
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
};

// Returns the row at `time_s` between two rows.
Row interpolate(const Row& from, const Row& to, double time_s) {
  const double share = (time_s - from.time_s) / (to.time_s - from.time_s);
  return {time_s, from.place_m + share * (to.place_m - from.place_m),
          from.turn.slerp(share, to.turn)};
}

// The places of the columns in each row.
struct Columns {
  std::size_t count = 0;
  std::optional<std::size_t> time;
  std::array<std::size_t, 3> place{};
  std::vector<std::size_t> turn;  // three angles, four coefficients, or none
};

constexpr const char* kPathColumns =
    "time_s (optional), x_m, y_m, z_m and, optional, roll_rad, pitch_rad, yaw_rad or qw, qx, qy, "
    "qz";

Columns read_columns(const std::vector<std::string>& names, const std::string& where) {
  const auto fail = [&](const std::string& what) {
    throw Error(ErrorKind::bad_data,
                fmt::format("{}:1: {}; the columns of a path are {}", where, what, kPathColumns));
  };
  Columns columns;
  columns.count = names.size();
  std::vector<bool> used(names.size());
  const auto find = [&](std::string_view name) -> std::optional<std::size_t> {
    const auto found = std::ranges::find(names, name);
    if (found == names.end()) {
      return std::nullopt;
    }
    const auto at = static_cast<std::size_t>(found - names.begin());
    if (std::find(found + 1, names.end(), name) != names.end()) {
      fail(fmt::format("column '{}' stands there twice", name));
    }
    used[at] = true;
    return at;
  };
  columns.time = find("time_s");
  constexpr std::array<std::string_view, 3> kPlace = {"x_m", "y_m", "z_m"};
  for (std::size_t i = 0; i < kPlace.size(); ++i) {
    const auto at = find(kPlace[i]);
    if (!at) {
      fail(fmt::format("there is no column '{}'", kPlace[i]));
    }
    columns.place[i] = *at;
  }
  const auto find_turn = [&](std::vector<std::string_view> parts) {
    std::vector<std::size_t> found;
    for (const std::string_view part : parts) {
      if (const auto at = find(part)) {
        found.push_back(*at);
      }
    }
    if (!found.empty() && found.size() < parts.size()) {
      fail("an orientation needs all its columns");
    }
    if (!found.empty() && !columns.turn.empty()) {
      fail("the orientation is given twice");
    }
    if (!found.empty()) {
      columns.turn = found;
    }
  };
  find_turn({"roll_rad", "pitch_rad", "yaw_rad"});
  find_turn({"qw", "qx", "qy", "qz"});
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (!used[i]) {
      fail(fmt::format("there is an unknown column '{}'",
                       sanitize(std::string_view(names[i]).substr(0, 40))));
    }
  }
  return columns;
}

std::vector<std::string> split_line(std::string_view line) {
  std::vector<std::string> fields;
  while (true) {
    const std::size_t comma = line.find(',');
    std::string_view field = line.substr(0, comma);
    const std::size_t first = field.find_first_not_of(" \t");
    field = first == std::string_view::npos
                ? std::string_view()
                : field.substr(first, field.find_last_not_of(" \t\r") - first + 1);
    fields.emplace_back(field);
    if (comma == std::string_view::npos) {
      return fields;
    }
    line.remove_prefix(comma + 1);
  }
}

Row read_row(const std::vector<double>& numbers, const Columns& columns, const std::string& where) {
  Row row;
  row.time_s = columns.time ? numbers[*columns.time] : 0;
  for (std::size_t i = 0; i < columns.place.size(); ++i) {
    row.place_m[static_cast<Eigen::Index>(i)] = numbers[columns.place[i]];
  }
  if (row.place_m.cwiseAbs().maxCoeff() > kFarthestPlace_m) {
    throw Error(
        ErrorKind::bad_data,
        fmt::format("{}: the place ({:g}, {:g}, {:g}) m is too far away; positions are in "
                    "metres, at most {:g}",
                    where, row.place_m.x(), row.place_m.y(), row.place_m.z(), kFarthestPlace_m));
  }
  if (columns.turn.size() == 3) {
    row.turn = Eigen::Quaterniond(
        make_turn({numbers[columns.turn[0]], numbers[columns.turn[1]], numbers[columns.turn[2]]}));
  } else if (columns.turn.size() == 4) {
    row.turn = Eigen::Quaterniond(numbers[columns.turn[0]], numbers[columns.turn[1]],
                                  numbers[columns.turn[2]], numbers[columns.turn[3]]);
    if (!(row.turn.norm() > kShortestQuaternion && row.turn.norm() < 2)) {
      throw Error(ErrorKind::bad_data,
                  fmt::format("{}: the quaternion has the length {:g}; it must be a unit "
                              "quaternion",
                              where, row.turn.norm()));
    }
    row.turn.normalize();
  }
  return row;
}

std::vector<Row> read_rows(std::string_view text, const std::string& name, Columns& columns) {
  std::vector<Row> rows;
  int line_number = 0;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (++line_number % kLinesBetweenLooks == 0) {
      check_reading();
    }
    if (line.find_first_not_of(" \t\r") == std::string_view::npos) {
      continue;
    }
    const std::vector<std::string> fields = split_line(line);
    const std::string where = fmt::format("{}:{}", name, line_number);
    if (columns.count == 0) {
      columns = read_columns(fields, name);
      continue;
    }
    if (fields.size() != columns.count) {
      throw Error(ErrorKind::bad_data, fmt::format("{}: there are {} fields for {} columns", where,
                                                   fields.size(), columns.count));
    }
    std::vector<double> numbers;
    for (const std::string& field : fields) {
      const auto number = parse_finite(field);
      if (!number) {
        throw Error(ErrorKind::bad_data,
                    fmt::format("{}: '{}' is not a finite number", where,
                                sanitize(std::string_view(field).substr(0, 40))));
      }
      numbers.push_back(*number);
    }
    Row row = read_row(numbers, columns, where);
    if (columns.time && !rows.empty() && !(row.time_s > rows.back().time_s)) {
      throw Error(ErrorKind::bad_data,
                  fmt::format("{}: time_s is {:g} after {:g}; it must rise from row to row", where,
                              row.time_s, rows.back().time_s));
    }
    if (!columns.time && !rows.empty() && row.place_m == rows.back().place_m) {
      throw Error(ErrorKind::bad_data,
                  fmt::format("{}: the same place as the row before; points where the tool rests "
                              "must differ (or give a column time_s)",
                              where));
    }
    rows.push_back(row);
    if (rows.size() > kMostPathPoints) {
      throw Error(ErrorKind::bad_data,
                  fmt::format("{}: more than {} rows", where, kMostPathPoints));
    }
  }
  if (rows.size() < 2) {
    throw Error(ErrorKind::bad_data,
                fmt::format("{}: has {} rows; a path needs two or more under a line of column "
                            "names: {}",
                            name, rows.size(), kPathColumns));
  }
  return rows;
}

}  // namespace

void add_rest(const TrackingTask& task, TestCase& path) {
  const auto steps = static_cast<int>(std::ceil(task.rest_s / task.control_period_s - 1e-9));
  for (int i = 0; i < steps; ++i) {
    path.points_m.push_back(path.points_m.back());
    if (!path.turns.empty()) {
      path.turns.push_back(path.turns.back());
    }
  }
}

TestCase parse_path(std::string_view text, const std::string& name, const TrackingTask& task) {
  Columns columns;
  const std::vector<Row> rows = read_rows(text, name, columns);
  TestCase path;
  const auto add = [&](const Row& row) {
    path.points_m.push_back(row.place_m);
    if (!columns.turn.empty()) {
      path.turns.push_back(row.turn);
    }
  };
  if (!columns.time) {
    std::ranges::for_each(rows, add);
    return path;
  }
  path.continuous = true;
  const double whole_s = rows.back().time_s - rows.front().time_s;
  const double steps = std::ceil(whole_s / task.control_period_s - 1e-9);
  if (steps > kMostPathPoints) {
    throw Error(ErrorKind::bad_data,
                fmt::format("{}: the path takes {:g} s, {:.3g} control periods; possible are {}",
                            name, whole_s, steps, kMostPathPoints));
  }
  std::size_t next = 1;
  for (int step = 0; step <= static_cast<int>(steps); ++step) {
    const double time_s =
        std::min(rows.front().time_s + step * task.control_period_s, rows.back().time_s);
    while (next + 1 < rows.size() && rows[next].time_s < time_s) {
      ++next;
    }
    add(interpolate(rows[next - 1], rows[next], time_s));
  }
  add_rest(task, path);
  return path;
}

}  // namespace armwright
