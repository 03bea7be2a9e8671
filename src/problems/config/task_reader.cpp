#include "problems/config/task_reader.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.hpp"
#include "problems/tracking/tracking_config.hpp"

namespace armwright {
namespace {

template <class Enum>
Enum read_enum(const ConfigTable& table, std::string_view key,
               const std::vector<std::string>& names, Enum fallback) {
  const std::string name = table.get_choice(key, names, names[static_cast<std::size_t>(fallback)]);
  return static_cast<Enum>(std::ranges::find(names, name) - names.begin());
}

ToolTask read_tool(const ConfigTable& table) {
  ToolTask tool;
  tool.orientation = read_enum(table, "orientation", tool_orientation_names(), tool.orientation);
  if (table.has("tool_rpy_rad")) {
    tool.turn = make_turn(read_vector(table, "tool_rpy_rad", {.lower = -7, .upper = 7},
                                      "roll, pitch and yaw in rad"));
  }
  if (table.has("tool_axis")) {
    tool.axis = read_direction(table, "tool_axis");
  }
  tool.arm_m = table.get_number_or("orientation_arm_m", tool.arm_m, {.lower = 1e-3, .upper = 100});
  return tool;
}

}  // namespace

Eigen::Vector3d read_vector(const ConfigTable& table, std::string_view key, Range range,
                            std::string_view what) {
  const auto numbers = table.get_numbers(key, range);
  if (numbers.size() != 3) {
    table.refuse(key, fmt::format("it must be three numbers: {}", what));
  }
  return {numbers[0], numbers[1], numbers[2]};
}

Eigen::Vector3d read_direction(const ConfigTable& table, std::string_view key) {
  const Eigen::Vector3d vector =
      read_vector(table, key, {.lower = -1e6, .upper = 1e6}, "a direction's x, y and z");
  if (!(vector.norm() > 1e-9)) {
    table.refuse(key, "it must point somewhere: one of the three numbers must not be 0");
  }
  return vector.normalized();
}

TrackingTask read_task(const ConfigTable& table, const ConfigTable& physics,
                       const ConfigTable& control) {
  TrackingTask task;
  task.signal = find_signal(table.get_choice("signal", signal_names(), "complex"));
  task.speed_m_per_s =
      table.get_number_or("speed_m_per_s", task.speed_m_per_s, {.lower = 0.01, .upper = 100});
  task.distance_limit_m =
      table.get_number_or("distance_limit_m", task.distance_limit_m, {.lower = 0, .upper = 100});
  task.trapezoid_acceleration_m_per_s2 =
      table.get_number_or("trapezoid_acceleration_m_per_s2", task.trapezoid_acceleration_m_per_s2,
                          {.lower = 0, .upper = 1e6, .lower_open = true});
  task.rest_s = table.get_number_or("rest_s", task.rest_s, {.lower = 0, .upper = 60});
  task.count_first_point = table.get_bool_or("count_first_point", task.count_first_point);
  task.ik_bug = table.get_bool_or("ik_bug", task.ik_bug);
  task.load_kg = table.get_number_or("load_kg", task.load_kg, {.lower = 0, .upper = 1000});
  task.kinematics = read_enum(table, "kinematics", kinematics_names(), task.kinematics);
  task.limits = read_enum(table, "limits", limit_policy_names(), task.limits);
  task.tool = read_tool(table);
  if (table.has("home")) {
    task.home = table.get_numbers("home", {.lower = -1000, .upper = 1000});
  }
  if (task.kinematics == KinematicsChoice::palletiser &&
      task.tool.orientation != ToolOrientation::free) {
    table.refuse("kinematics",
                 "the closed form of a palletiser says nothing of the tool's orientation; set "
                 "task.orientation to \"free\" or kinematics to \"numeric\"");
  }
  task.control_period_s =
      control.get_number_or("period_s", task.control_period_s, {.lower = 1e-5, .upper = 0.1});

  PhysicsSettings& p = task.physics;
  p.gravity_m_per_s2 =
      physics.get_number_or("gravity_m_per_s2", p.gravity_m_per_s2, {.lower = 0, .upper = 1000});
  p.substeps = static_cast<int>(physics.get_integer_or("substeps", p.substeps, 1, 1000));
  p.erp = physics.get_number_or("erp", p.erp, {.lower = 0, .upper = 1});
  p.cfm = physics.get_number_or("cfm", p.cfm, {.lower = 0, .upper = 1});
  return task;
}

WorkspaceSphere read_workspace(const ConfigTable& table) {
  WorkspaceSphere sphere;
  if (table.has("centre_m")) {
    sphere.centre_m =
        read_vector(table, "centre_m", {.lower = -1000, .upper = 1000}, "x, y and z in metres");
  }
  if (table.has("normal")) {
    sphere.normal = read_direction(table, "normal");
  }
  sphere.radius_m = table.get_number_or("radius_m", sphere.radius_m, {.lower = 1e-3, .upper = 100});
  sphere.shortest_move_m = table.get_number_or("shortest_move_m", sphere.shortest_move_m,
                                               {.lower = 1e-6, .upper = 2 * sphere.radius_m});
  sphere.points = static_cast<int>(table.get_integer_or("points", sphere.points, 3, 1000));
  try {
    TestSet::make_generated("test/1", sphere);
  } catch (const Error& error) {
    table.refuse(table.has("shortest_move_m") ? "shortest_move_m" : "radius_m", error.what());
  }
  return sphere;
}

void check_length(const ConfigTable& table, const ConfigTable& control,
                  const TrackingConfig& config) {
  const double periods = calc_case_duration_s(config, config.task) / config.task.control_period_s;
  if (periods > kMostPeriods) {
    const std::string must = fmt::format(
        "a test case would take {:.3g} control periods, possible are {:.3g}; raise "
        "control.period_s or task.speed_m_per_s, or lower task.distance_limit_m, "
        "task.rest_s or workspace.points",
        periods, kMostPeriods);
    if (control.has("period_s")) {
      control.refuse("period_s", must);
    }
    table.refuse("speed_m_per_s", must);
  }
}

}  // namespace armwright
