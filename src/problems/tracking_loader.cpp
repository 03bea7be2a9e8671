#include "problems/tracking_loader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/hash.hpp"
#include "problems/config_files.hpp"
#include "problems/design_file.hpp"
#include "problems/objective_reader.hpp"
#include "problems/parameter_reader.hpp"
#include "problems/perturbation_reader.hpp"
#include "problems/requirement_reader.hpp"
#include "problems/tracking_description.hpp"
#include "sim/design_conversion.hpp"
#include "sim/designed_arm.hpp"

namespace armwright {
namespace {

constexpr std::size_t kInputLimit_bytes = std::size_t{8} << 20;
constexpr double kMostPeriods = 1e7;  // of a test case: 320 MB of target angles; published: 3925

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
    const auto centre = table.get_numbers("centre_m", {.lower = -1000, .upper = 1000});
    if (centre.size() != 3) {
      table.refuse("centre_m", "it must be three numbers: x, y and z in metres");
    }
    sphere.centre_m = {centre[0], centre[1], centre[2]};
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

// Numbers that are each allowed, but together make a case that no memory holds.
void check_length(const ConfigTable& table, const ConfigTable& control, const TrackingTask& task,
                  const WorkspaceSphere& sphere) {
  const double periods = calc_case_duration_s(task, sphere) / task.control_period_s;
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

// The speed is a variable: its start, and that a case fits at the slowest.
void set_start_speed(const ConfigTable& variables, TrackingConfig& config) {
  TrackingTask slowest = make_task(config.task, config.start);
  config.start.speed_m_per_s = slowest.speed_m_per_s;
  slowest.speed_m_per_s /= config.speed_bounds_factor;
  const double periods = calc_case_duration_s(slowest, config.workspace) / slowest.control_period_s;
  if (periods > kMostPeriods) {
    variables.refuse(
        variables.has("speed_bounds_factor") ? "speed_bounds_factor" : "task",
        fmt::format("a test case at the slowest speed would take {:.3g} control periods, possible "
                    "are {:.3g}; lower speed_bounds_factor",
                    periods, kMostPeriods));
  }
}

// The start under the controller that the problem names, and the tables that it wants.
void apply_controller(const ConfigTable& control, TrackingConfig& config) {
  if (control.has("controller")) {
    const std::string name = control.get_choice("controller", controller_names());
    try {
      config.start = convert_design(config.start, name, config.task.control_period_s);
    } catch (const Error& error) {
      control.refuse("controller", error.what());
    }
  }
  config.task.feed_forward = find_controller(config.start.controller).feed_forward;
}

std::shared_ptr<const TrackingProblem> make_tracking(TrackingConfig config,
                                                     const ConfigTable& variables,
                                                     const std::filesystem::path& urdf) {
  try {
    return std::make_shared<TrackingProblem>(std::move(config));
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::usage) {
      throw Error(error.kind(), fmt::format("{}: {}", urdf.string(), error.what()));
    }
    variables.refuse("start", error.what());
  }
}

void add_input(LoadedProblem& loaded, const std::filesystem::path& file) {
  loaded.input_hashes[file.filename().string()] =
      calc_sha256_hex(read_file(file, kInputLimit_bytes));
}

}  // namespace

std::filesystem::path resolve_named(const ConfigTable& table, std::string_view key,
                                    std::string_view kind) {
  const std::string name = table.get_string(key);
  try {
    return resolve_config(kind, name, table.file().parent_path());
  } catch (const Error& error) {
    table.refuse(key, error.what());
  }
}

std::vector<std::string> load_tracking(const ConfigTable& table, std::span<const EngineRow> engines,
                                       LoadedProblem& loaded) {
  TrackingConfig config;
  config.name = loaded.name;
  config.summary = loaded.title;
  const ConfigTable robot = table.get_table("robot");
  const auto urdf = resolve_named(robot, "urdf", "robots");
  config.mass_scale = robot.get_number_or("mass_scale", 1, {.lower = 0.01, .upper = 100});
  config.robot = scale_masses(load_urdf(urdf), config.mass_scale);
  add_input(loaded, urdf);

  const ConfigTable physics = table.get_table_or_empty("physics");
  ChosenEngines chosen = choose_engines(physics, engines);
  config.engines = std::move(chosen.engines);
  const ConfigTable task = table.get_table_or_empty("task");
  const ConfigTable control = table.get_table_or_empty("control");
  config.task = read_task(task, physics, control);
  config.workspace = read_workspace(table.get_table_or_empty("workspace"));
  check_length(task, control, config.task, config.workspace);
  config.objective = read_objective(table.get_table_or_empty("objective"));
  config.cutoff_error_m = table.get_table_or_empty("training")
                              .get_number_or("cutoff_error_m", config.cutoff_error_m,
                                             {.lower = kFailureError_m, .upper = 1e6});

  const ConfigTable variables = table.get_table("variables");
  const auto start = resolve_named(variables, "start", "designs");
  config.start = load_design(start.string()).design;
  add_input(loaded, start);
  config.bounds_factor = variables.get_number_or("bounds_factor", config.bounds_factor,
                                                 {.lower = 1, .upper = 1e9, .lower_open = true});
  if (config.start.joints.size() != config.robot.joint_count()) {
    variables.refuse("start",
                     fmt::format("the design has {} joints and the robot {}; name a design "
                                 "made for this robot",
                                 config.start.joints.size(), config.robot.joint_count()));
  }
  apply_controller(control, config);
  config.parameters = read_parameters(variables, config);
  const Range factor{.lower = 1, .upper = 100, .lower_open = true};
  config.length_bounds_factor =
      variables.get_number_or("length_bounds_factor", config.length_bounds_factor, factor);
  config.section_bounds_factor =
      variables.get_number_or("section_bounds_factor", config.section_bounds_factor, factor);
  config.speed_bounds_factor =
      variables.get_number_or("speed_bounds_factor", config.speed_bounds_factor, factor);
  if (changes_speed(config)) {
    set_start_speed(variables, config);
  }
  config.torque_per_mass_n_m_per_kg = table.get_table_or_empty("motors").get_number_or(
      "torque_per_mass_n_m_per_kg", 0, {.lower = 0, .upper = 1e9});
  ReadPerturbation perturbation =
      read_perturbation(table.get_table_or_empty("perturbation"), config.robot.joint_count());
  config.perturbation = std::move(perturbation.perturbation);
  if (perturbation.preset) {
    add_input(loaded, *perturbation.preset);
  }
  check_limits(table.get_table_or_empty("objective"), config);
  config.requirements = read_requirements(table.get_tables_or_empty("requirement"), config);
  loaded.tracking = make_tracking(std::move(config), variables, urdf);
  loaded.problem = loaded.tracking;
  std::vector<std::string> settled = std::move(perturbation.settled);
  if (chosen.simd) {  // what "auto" has come to decides the last bits of every result
    settled.push_back(fmt::format("physics.simd={}", to_string(*chosen.simd)));
  }
  return settled;
}

}  // namespace armwright
