// Reads a path of the tool from a problem file: points, a line, a circle or the name of a CSV file.

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/text.hpp"
#include "problems/config/problem_readers.hpp"
#include "sim/tracking/reference_signal.hpp"
#include "sim/tracking/test_case.hpp"

namespace armwright {
namespace {

constexpr std::size_t kPathLimit_bytes = std::size_t{64} << 20;
constexpr Range kAnyPlace{.lower = -kFarthestPlace_m, .upper = kFarthestPlace_m};

const Setting<std::string> kPathKind{"kind", one_of({"points", "line", "circle", "file"}),
                                     kNoDefault, "a path of your own in place of generated cases"};
const Setting<std::vector<double>> kPathFrom{"from_m", kAnyPlace, kNoDefault,
                                             "for the kind line: one end, three numbers"};
const Setting<std::vector<double>> kPathTo{"to_m", kAnyPlace, kNoDefault,
                                           "for the kind line: the other end, three numbers"};
const Setting<std::vector<double>> kPathCentre{"centre_m", kAnyPlace, kNoDefault,
                                               "for the kind circle: its centre, three numbers"};
const Setting<std::vector<double>> kPathNormal{
    "normal", kDirectionRange, kNoDefault,
    "for the kind circle: the target moves counterclockwise about this direction, three numbers"};
const Setting<double> kPathRadius{
    "radius_m", {.lower = 1e-4, .upper = 100}, kNoDefault, "for the kind circle: its radius"};
const Setting<std::vector<double>> kPathStart{
    "start", kDirectionRange, kNoDefault,
    "for the kind circle: direction from the centre to the point where the path begins, three "
    "numbers"};
const Setting<int> kPathRepeats{
    "repeats",
    {.lower = 1, .upper = 1000},
    1,
    "how often the target moves along a line and back, or round a circle"};
const Setting<std::string> kPathFile{
    "file", kNoDefault, "for the kind file: CSV file, looked for beside this file (docs/tasks.md)"};

const Setting<std::vector<double>> kPointPosition{
    "position_m", kAnyPlace, kNoDefault,
    "for the kind points: position of the point, three numbers; the first point is the start"};
const Setting<std::vector<double>> kPointRpy{
    "rpy_rad", kAngleRange, kNoDefault,
    "the tool's orientation at the point: roll, pitch and yaw; either all points have it or none"};

const SettingTable kPointSettings{
    .key = "point", .is_array = true, .settings = {&kPointPosition, &kPointRpy}};

TestCase make_points(const ConfigTable& table) {
  TestCase path;
  const auto points = table.get_tables_or_empty(kPointSettings);
  if (points.size() < 2) {
    table.refuse(kPointSettings.key,
                 "a path needs two [[path.point]] tables or more, the start first");
  }
  for (const ConfigTable& point : points) {
    path.points_m.push_back(read_vector(point, kPointPosition, "x, y and z in metres"));
    if (point.has(kPointRpy)) {
      path.turns.emplace_back(
          make_turn(read_vector(point, kPointRpy, "roll, pitch and yaw in rad")));
    }
  }
  if (!path.turns.empty() && path.turns.size() != path.points_m.size()) {
    table.refuse(kPointSettings.key, "rpy_rad must be given for all points or for none");
  }
  return path;
}

TestCase make_line(const ConfigTable& table) {
  const Eigen::Vector3d from_m = read_vector(table, kPathFrom, "x, y and z in metres");
  const Eigen::Vector3d to_m = read_vector(table, kPathTo, "x, y and z in metres");
  TestCase path;
  path.points_m.push_back(from_m);
  const int repeats = table.get(kPathRepeats);
  for (int i = 0; i < repeats; ++i) {
    path.points_m.push_back(to_m);
    path.points_m.push_back(from_m);
  }
  return path;
}

TestCase make_circle(const ConfigTable& table, const TrackingTask& task) {
  const Eigen::Vector3d centre_m = read_vector(table, kPathCentre, "x, y and z in metres");
  const Eigen::Vector3d normal = read_direction(table, kPathNormal);
  const double radius_m = table.get(kPathRadius);
  const int repeats = table.get(kPathRepeats);
  Eigen::Vector3d first;
  if (table.has(kPathStart)) {
    first = read_direction(table, kPathStart);
  } else {
    first = std::abs(normal.x()) < 0.9 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY();
  }
  first -= first.dot(normal) * normal;
  if (!(first.norm() > 1e-6)) {
    table.refuse(kPathStart, "it must not be parallel to path.normal");
  }
  first.normalize();
  const Eigen::Vector3d second = normal.cross(first);
  if (task.signal == SignalShape::step) {
    table.refuse(kPathKind,
                 "a circle needs a reference signal that moves; task.signal is \"step\"");
  }
  const double length_m = 2 * std::numbers::pi * radius_m * repeats;
  const targets::SignalCurve signal = make_signal_curve(task.signal, length_m, task.speed_m_per_s,
                                                        task.trapezoid_acceleration_m_per_s2);
  const double steps = std::ceil(signal.duration_s / task.control_period_s - 1e-9);
  if (steps > kMostPathPoints) {
    table.refuse(kPathRadius, fmt::format("the circle would take {:.3g} control periods, possible "
                                          "are {}; raise task.speed_m_per_s",
                                          steps, kMostPathPoints));
  }
  TestCase path;
  path.continuous = true;
  for (int step = 0; step <= static_cast<int>(steps); ++step) {
    const double angle_rad =
        targets::calc_distance(signal, step * task.control_period_s) / radius_m;
    path.points_m.push_back(
        centre_m + radius_m * (std::cos(angle_rad) * first + std::sin(angle_rad) * second));
  }
  add_rest(task, path);
  return path;
}

}  // namespace

const SettingTable kPathSettings{
    .key = "path",
    .settings = {&kPathKind, &kPathFrom, &kPathTo, &kPathCentre, &kPathNormal, &kPathRadius,
                 &kPathStart, &kPathRepeats, &kPathFile},
    .tables = {&kPointSettings}};

std::optional<TestCase> read_path(const ConfigTable& table, const TrackingTask& task,
                                  LoadedProblem& loaded) {
  if (!table.has(kPathKind)) {
    return std::nullopt;  // other keys without it are refused as unknown
  }
  const std::string kind = table.get(kPathKind);
  TestCase path;
  if (kind == "points") {
    path = make_points(table);
  } else if (kind == "line") {
    path = make_line(table);
  } else if (kind == "circle") {
    path = make_circle(table, task);
  } else {
    const std::filesystem::path file = find_beside(table, kPathFile);
    path = parse_path(read_file(file, kPathLimit_bytes), sanitize(file.string()), task);
    add_input(loaded, file);
  }
  if (!path.continuous) {
    if (const auto fault = find_fault(path)) {
      table.refuse(kPathKind, fmt::format("point {} {}", fault->point, fault->what));
    }
  }
  return path;
}

}  // namespace armwright
