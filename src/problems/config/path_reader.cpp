#include "problems/config/path_reader.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/text.hpp"
#include "problems/config/path_file.hpp"
#include "problems/config/task_reader.hpp"
#include "sim/tracking/reference_signal.hpp"
#include "sim/tracking/test_case.hpp"

namespace armwright {
namespace {

constexpr std::size_t kPathLimit_bytes = std::size_t{64} << 20;
constexpr Range kAnyPlace{.lower = -kFarthestPlace_m, .upper = kFarthestPlace_m};

TestCase make_points(const ConfigTable& table) {
  TestCase path;
  const auto points = table.get_tables_or_empty("point");
  if (points.size() < 2) {
    table.refuse("point", "a path needs two [[path.point]] tables or more, the start first");
  }
  for (const ConfigTable& point : points) {
    path.points_m.push_back(read_vector(point, "position_m", kAnyPlace, "x, y and z in metres"));
    if (point.has("rpy_rad")) {
      path.turns.emplace_back(make_turn(
          read_vector(point, "rpy_rad", {.lower = -7, .upper = 7}, "roll, pitch and yaw in rad")));
    }
  }
  if (!path.turns.empty() && path.turns.size() != path.points_m.size()) {
    table.refuse("point", "rpy_rad must be given for all points or for none");
  }
  return path;
}

int read_repeats(const ConfigTable& table) {
  return static_cast<int>(table.get_integer_or("repeats", 1, 1, 1000));
}

TestCase make_line(const ConfigTable& table) {
  const Eigen::Vector3d from_m = read_vector(table, "from_m", kAnyPlace, "x, y and z in metres");
  const Eigen::Vector3d to_m = read_vector(table, "to_m", kAnyPlace, "x, y and z in metres");
  TestCase path;
  path.points_m.push_back(from_m);
  for (int i = 0; i < read_repeats(table); ++i) {
    path.points_m.push_back(to_m);
    path.points_m.push_back(from_m);
  }
  return path;
}

TestCase make_circle(const ConfigTable& table, const TrackingTask& task) {
  const Eigen::Vector3d centre_m =
      read_vector(table, "centre_m", kAnyPlace, "x, y and z in metres");
  const Eigen::Vector3d normal = read_direction(table, "normal");
  const double radius_m = table.get_number("radius_m", {.lower = 1e-4, .upper = 100});
  const int repeats = read_repeats(table);
  Eigen::Vector3d first;
  if (table.has("start")) {
    first = read_direction(table, "start");
  } else {
    first = std::abs(normal.x()) < 0.9 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY();
  }
  first -= first.dot(normal) * normal;
  if (!(first.norm() > 1e-6)) {
    table.refuse("start", "it must not be parallel to path.normal");
  }
  first.normalize();
  const Eigen::Vector3d second = normal.cross(first);
  if (task.signal == SignalShape::step) {
    table.refuse("kind", "a circle needs a reference signal that moves; task.signal is \"step\"");
  }
  const double length_m = 2 * std::numbers::pi * radius_m * repeats;
  const ReferenceSignal signal(task.signal, length_m, task.speed_m_per_s,
                               task.trapezoid_acceleration_m_per_s2);
  const double steps = std::ceil(signal.duration_s() / task.control_period_s - 1e-9);
  if (steps > kMostPathPoints) {
    table.refuse("radius_m", fmt::format("the circle would take {:.3g} control periods, possible "
                                         "are {}; raise task.speed_m_per_s",
                                         steps, kMostPathPoints));
  }
  TestCase path;
  path.continuous = true;
  for (int step = 0; step <= static_cast<int>(steps); ++step) {
    const double angle_rad = signal.calc_distance(step * task.control_period_s) / radius_m;
    path.points_m.push_back(
        centre_m + radius_m * (std::cos(angle_rad) * first + std::sin(angle_rad) * second));
  }
  add_rest(task, path);
  return path;
}

}  // namespace

std::optional<ReadPath> read_path(const ConfigTable& table, const TrackingTask& task) {
  static const std::vector<std::string> kinds = {"points", "line", "circle", "file"};
  if (!table.has("kind")) {
    return std::nullopt;  // other keys without it are refused as unknown
  }
  const std::string kind = table.get_choice("kind", kinds);
  ReadPath path;
  if (kind == "points") {
    path.the_case = make_points(table);
  } else if (kind == "line") {
    path.the_case = make_line(table);
  } else if (kind == "circle") {
    path.the_case = make_circle(table, task);
  } else {
    const std::filesystem::path named = table.get_string("file");
    const std::filesystem::path beside = table.file().parent_path() / named;
    std::error_code ignored;
    path.file = std::filesystem::is_regular_file(beside, ignored) ? beside : named;
    if (!std::filesystem::is_regular_file(*path.file, ignored)) {
      table.refuse("file", fmt::format("there is no such file, in {} or in the current folder",
                                       sanitize(table.file().parent_path().string())));
    }
    path.the_case =
        parse_path(read_file(*path.file, kPathLimit_bytes), sanitize(path.file->string()), task);
  }
  if (!path.the_case.continuous) {
    if (const auto fault = find_fault(path.the_case)) {
      table.refuse("kind", fmt::format("point {} {}", fault->point, fault->what));
    }
  }
  if (!path.the_case.turns.empty() && task.tool.orientation == ToolOrientation::free) {
    table.refuse("kind",
                 "the path says how the tool is turned, which does not count where "
                 "task.orientation is \"free\"; set it to \"pose\" or \"pointing\"");
  }
  return path;
}

}  // namespace armwright
