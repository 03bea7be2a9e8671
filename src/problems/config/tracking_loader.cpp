#include "problems/config/tracking_loader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <utility>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/hash.hpp"
#include "base/text.hpp"
#include "problems/config/config_files.hpp"
#include "problems/config/design_file.hpp"
#include "problems/config/objective_reader.hpp"
#include "problems/config/parameter_reader.hpp"
#include "problems/config/path_reader.hpp"
#include "problems/config/perturbation_reader.hpp"
#include "problems/config/requirement_reader.hpp"
#include "problems/config/robot_proposal.hpp"
#include "problems/config/task_reader.hpp"
#include "problems/tracking/tracking_config.hpp"
#include "sim/robot/mesh_file.hpp"
#include "sim/tracking/design_conversion.hpp"
#include "sim/tracking/designed_arm.hpp"

namespace armwright {
namespace {

constexpr std::size_t kInputLimit_bytes = std::size_t{8} << 20;
// The speed is a variable: its start, and that a case fits at the slowest.
void set_start_speed(const ConfigTable& variables, TrackingConfig& config) {
  TrackingTask slowest = make_task(config.task, config.start);
  config.start.speed_m_per_s = slowest.speed_m_per_s;
  slowest.speed_m_per_s /= config.speed_bounds_factor;
  const double periods = calc_case_duration_s(config, slowest) / slowest.control_period_s;
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

// What is wrong with a robot is wrong with its file.
template <class Call>
auto name_file(const std::filesystem::path& urdf, const Call& call) {
  try {
    return call();
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::bad_data) {
      throw;
    }
    throw Error(ErrorKind::bad_data, fmt::format("{}: {}", sanitize(urdf.string()), error.what()));
  }
}

std::shared_ptr<const TrackingProblem> make_tracking(TrackingConfig config,
                                                     const ConfigTable& variables,
                                                     const std::filesystem::path& urdf) {
  try {
    return name_file(urdf, [&] { return std::make_shared<TrackingProblem>(std::move(config)); });
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::usage) {
      throw;
    }
    variables.refuse("start", error.what());
  }
}

void add_input(LoadedProblem& loaded, const std::filesystem::path& file) {
  loaded.input_hashes[file.filename().string()] =
      calc_sha256_hex(read_file(file, kInputLimit_bytes));
}

// The path, if there is one, and what is left to be proposed; what of it is settled.
std::vector<std::string> read_path_and_proposal(const ConfigTable& table, TrackingConfig& config,
                                                LoadedProblem& loaded) {
  if (const auto path = read_path(table.get_table_or_empty("path"), config.task)) {
    config.path = path->the_case;
    // Every move was asked for, the first included, unless the file says otherwise.
    config.task.count_first_point =
        table.get_table_or_empty("task").get_bool_or("count_first_point", true);
    if (path->file) {
      add_input(loaded, *path->file);
    }
  }
  if (!table.get_table("robot").get_bool_or("propose", false)) {
    return {};
  }
  return apply_proposal(table, config);
}

// The arm that [robot] describes, as it is in the file.
RobotModel load_robot(const ConfigTable& table, const std::filesystem::path& urdf,
                      LoadedProblem& loaded) {
  RobotOptions options;
  options.base = table.get_string("base", "");
  options.tip = table.get_string("tip", "");
  options.density_kg_per_m3 =
      table.get_number_or("density_kg_per_m3", 0, {.lower = 1, .upper = 30'000});
  try {
    RobotModel robot = load_urdf(urdf, options);
    add_input(loaded, urdf);
    for (const MassFile& mesh : robot.mass_files) {
      loaded.input_hashes[mesh.name] = calc_sha256_hex(read_file(mesh.path, kMeshFileLimit_bytes));
    }
    return robot;
  } catch (const RobotOptionError& error) {
    table.refuse(table.has(error.option()) ? error.option() : "urdf", error.what());
  }
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
  config.robot = scale_masses(load_robot(robot, urdf, loaded), config.mass_scale);

  const ConfigTable physics = table.get_table_or_empty("physics");
  config.engines = choose_engines(physics, engines);
  const std::optional<SimdLevel> simd = config.engines.simd;
  const ConfigTable task = table.get_table_or_empty("task");
  const ConfigTable control = table.get_table_or_empty("control");
  config.task = read_task(task, physics, control);
  if (!config.task.home.empty() && config.task.home.size() != config.robot.joint_count()) {
    task.refuse("home", fmt::format("it must hold {} numbers, one a joint of the robot",
                                    config.robot.joint_count()));
  }
  config.workspace = read_workspace(table.get_table_or_empty("workspace"));
  std::vector<std::string> proposed =
      name_file(urdf, [&] { return read_path_and_proposal(table, config, loaded); });
  check_length(task, control, config);
  config.objective = read_objective(table.get_table_or_empty("objective"));
  config.cutoff_error_m = table.get_table_or_empty("training")
                              .get_number_or("cutoff_error_m", config.cutoff_error_m,
                                             {.lower = kFailureError_m, .upper = 1e6});

  const ConfigTable variables = table.get_table("variables");
  if (variables.get_string("start") == kProposedStart) {
    config.start = name_file(urdf, [&] { return propose_start(config); });
  } else {
    const auto start = resolve_named(variables, "start", "designs");
    config.start = load_design(start.string()).design;
    add_input(loaded, start);
  }
  config.within_effort_limits = variables.get_bool_or("within_effort_limits", false);
  config.bounds_factor = variables.get_number_or("bounds_factor", config.bounds_factor,
                                                 {.lower = 1, .upper = 1e9, .lower_open = true});
  if (config.start.joints.size() != config.robot.joint_count()) {
    variables.refuse("start",
                     fmt::format("that design has {} joints and robot '{}' has {}; designs are "
                                 "made for one robot: take another robot.urdf, or start from a "
                                 "design made for this one (variables.start=proposed makes one)",
                                 config.start.joints.size(), sanitize(config.robot.name),
                                 config.robot.joint_count()));
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
  loaded.problem = make_tracking(std::move(config), variables, urdf);
  std::vector<std::string> settled = std::move(perturbation.settled);
  std::ranges::move(proposed, std::back_inserter(settled));
  if (simd) {  // what "auto" has come to decides the last bits of every result
    settled.push_back(fmt::format("physics.simd={}", to_string(*simd)));
  }
  return settled;
}

}  // namespace armwright
