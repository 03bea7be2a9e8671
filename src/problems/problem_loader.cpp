#include "problems/problem_loader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <iterator>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/config.hpp"
#include "base/error.hpp"
#include "base/file.hpp"
#include "base/hash.hpp"
#include "base/text.hpp"
#include "problems/analytic.hpp"
#include "problems/config_files.hpp"
#include "problems/design_file.hpp"
#include "problems/recorded_problem.hpp"
#include "problems/replicate.hpp"
#include "problems/tracking_description.hpp"

namespace armwright {
namespace {

constexpr std::size_t kInputLimit_bytes = std::size_t{8} << 20;
constexpr std::int64_t kMostCases = 1'000'000;
constexpr double kMostPeriods = 1e7;  // of a test case: 320 MB of target angles; published: 3925

TrackingTask read_task(const ConfigTable& table, const ConfigTable& physics) {
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
  task.control_period_s =
      table.get_number_or("control_period_s", task.control_period_s, {.lower = 1e-5, .upper = 0.1});
  task.count_first_point = table.get_bool_or("count_first_point", task.count_first_point);
  task.ik_bug = table.get_bool_or("ik_bug", task.ik_bug);
  task.load_kg = table.get_number_or("load_kg", task.load_kg, {.lower = 0, .upper = 1000});

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
void check_length(const ConfigTable& table, const TrackingTask& task,
                  const WorkspaceSphere& sphere) {
  double periods = 0;
  for (int k = 1; k <= sphere.points; ++k) {
    const double duration_s =
        std::max(sphere.calc_move_m(k), task.distance_limit_m) / task.speed_m_per_s;
    periods += (duration_s + task.rest_s) / task.control_period_s;
  }
  if (periods > kMostPeriods) {
    table.refuse(table.has("control_period_s") ? "control_period_s" : "speed_m_per_s",
                 fmt::format("a test case would take {:.3g} control periods, possible are {:.3g}; "
                             "raise control_period_s or speed_m_per_s, or lower distance_limit_m, "
                             "rest_s or workspace.points",
                             periods, kMostPeriods));
  }
}

TrackingObjective read_objective(const ConfigTable& table) {
  using Kind = TrackingObjective::Kind;
  static const std::vector<std::pair<std::string, Kind>> rows = {
      {"error", Kind::error},
      {"error_and_torque", Kind::error_and_torque},
      {"error_vs_torque", Kind::error_vs_torque},
      {"torque_with_error_limit", Kind::torque_with_error_limit},
      {"error_with_torque_limit", Kind::error_with_torque_limit}};
  std::vector<std::string> kinds;
  std::ranges::transform(rows, std::back_inserter(kinds),
                         [](const auto& row) { return row.first; });
  TrackingObjective objective;
  const std::string kind = table.get_choice("kind", kinds, "error");
  objective.kind = std::ranges::find(rows, kind, [](const auto& row) { return row.first; })->second;
  objective.logarithm = table.get_bool_or("logarithm", false);
  if (objective.logarithm && objective.kind == Kind::error_vs_torque) {
    table.refuse("logarithm", "two objectives are compared as they are; leave it out");
  }
  const Range positive{.lower = 0, .upper = 1e12, .lower_open = true};
  objective.torque_weight = table.get_number_or("torque_weight", 1, {.lower = 0, .upper = 1e6});
  objective.error_scale_m = table.get_number_or("error_scale_m", objective.error_scale_m, positive);
  objective.torque_scale_n_m =
      table.get_number_or("torque_scale_n_m", objective.torque_scale_n_m, positive);
  // Read where they count only: elsewhere a limit is refused, as it would hold nobody back.
  if (objective.kind == Kind::torque_with_error_limit) {
    objective.error_limit_m = table.get_number("error_limit_m", positive);
  }
  if (objective.kind == Kind::error_with_torque_limit) {
    objective.total_torque_limit_n_m = table.get_number("total_torque_limit_n_m", positive);
  }
  return objective;
}

// Objectives with a limit of which nothing can come, whatever the design.
void check_limits(const ConfigTable& table, const TrackingConfig& config) {
  using Kind = TrackingObjective::Kind;
  ArmDesign weakest = config.start;
  bool changes_torque = false;
  for (const DesignParameter& parameter : config.parameters) {
    if (parameter.kind != DesignParameter::Kind::gain) {
      get_parameter(weakest, parameter) /= config.bounds_factor;
      changes_torque = true;
    }
  }
  const double least_n_m = calc_total_torque_n_m(weakest);
  if (config.objective.kind == Kind::torque_with_error_limit && !changes_torque) {
    table.refuse(
        "kind", fmt::format("no effort limit is optimized, so that the total torque is always {:g} "
                            "N m; add effort_min and effort_max to variables.optimize",
                            least_n_m));
  }
  if (config.objective.kind == Kind::error_with_torque_limit &&
      least_n_m > config.objective.total_torque_limit_n_m) {
    table.refuse("total_torque_limit_n_m",
                 fmt::format("no design within the bounds has less than {:g} N m; raise it or "
                             "variables.bounds_factor",
                             least_n_m));
  }
}

// "p", "i", "d", "effort_min", "effort_max", for every joint or for those with a
// [[variables.joint]] of their own.
std::vector<DesignParameter> read_parameters(const ConfigTable& table,
                                             const TrackingConfig& config) {
  const ControllerRow& controller = find_controller(config.start.controller);
  std::vector<std::string> valid;
  for (const GainSpec& gain : controller.gains) {
    valid.push_back(gain.name);
  }
  valid.insert(valid.end(), {"effort_min", "effort_max"});
  const auto read_names = [&](const ConfigTable& where) {
    const auto names = where.get_strings("optimize");
    for (auto name = names.begin(); name != names.end(); ++name) {
      if (std::find(valid.begin(), valid.end(), *name) == valid.end()) {
        where.refuse("optimize", describe_unknown("design parameter", *name, valid));
      }
      if (std::find(names.begin(), name, *name) != name) {
        where.refuse("optimize", fmt::format("'{}' stands there twice; name it once", *name));
      }
    }
    return names;
  };
  const std::size_t joints = config.robot.joint_count();
  std::vector<std::vector<std::string>> chosen(joints,
                                               table.has("optimize") ? read_names(table) : valid);
  std::vector<std::string> joint_names;
  for (const Joint& joint : config.robot.joints) {
    joint_names.push_back(joint.name);
  }
  std::vector<std::string> named;
  for (const ConfigTable& joint : table.get_tables_or_empty("joint")) {
    const std::string name = joint.get_choice("name", joint_names);
    if (std::find(named.begin(), named.end(), name) != named.end()) {
      joint.refuse("name", "another [[variables.joint]] has that name; put them together");
    }
    named.push_back(name);
    const auto found = std::find(joint_names.begin(), joint_names.end(), name);
    chosen[static_cast<std::size_t>(found - joint_names.begin())] = read_names(joint);
  }
  std::vector<DesignParameter> parameters;
  for (std::size_t joint = 0; joint < joints; ++joint) {
    for (std::size_t i = 0; i < valid.size(); ++i) {
      if (std::find(chosen[joint].begin(), chosen[joint].end(), valid[i]) == chosen[joint].end()) {
        continue;
      }
      DesignParameter parameter;
      parameter.joint = joint;
      parameter.kind = i < controller.gains.size()    ? DesignParameter::Kind::gain
                       : i == controller.gains.size() ? DesignParameter::Kind::effort_min
                                                      : DesignParameter::Kind::effort_max;
      parameter.gain = i;
      parameters.push_back(parameter);
    }
  }
  if (parameters.empty()) {
    table.refuse("optimize", "at least one design parameter of one joint must be optimized");
  }
  return parameters;
}

CaseSets read_sets(const ConfigTable& table, CaseSets sets) {
  const auto read_name = [&](std::string_view key, std::string_view prefix, std::string& name) {
    name = table.get_string(key, name);
    if (name.rfind(prefix, 0) != 0 || name.size() == prefix.size()) {
      table.refuse(key, fmt::format("a {} set must be named {}ID, as in {}1", key, prefix, prefix));
    }
  };
  read_name("training", "train/", sets.training);
  read_name("validation", "validation/", sets.validation);
  read_name("test", "test/", sets.test);
  sets.validation_cases = static_cast<int>(
      table.get_integer_or("validation_cases", sets.validation_cases, 1, kMostCases));
  sets.test_cases =
      static_cast<int>(table.get_integer_or("test_cases", sets.test_cases, 1, kMostCases));
  return sets;
}

void read_schedule(const ConfigTable& table, LoadedProblem& loaded) {
  static const std::vector<std::string> kinds = {"fixed", "fresh"};
  loaded.schedule.fresh = table.get_choice("kind", kinds, "fixed") == "fresh";
  loaded.schedule.cases = static_cast<int>(table.get_integer_or("cases", 1, 1, kMostCases));
  loaded.fixed_cases =
      static_cast<int>(table.get_integer_or("fixed_cases", loaded.fixed_cases, 1, kMostCases));
}

// The file that a key names, looked for beside the configuration first.
std::filesystem::path resolve_named(const ConfigTable& table, std::string_view key,
                                    std::string_view kind) {
  const std::string name = table.get_string(key);
  try {
    return resolve_config(kind, name, table.file().parent_path());
  } catch (const Error& error) {
    table.refuse(key, error.what());
  }
}

// The same for whoever reads the file later: a shipped name stays a name.
std::string read_design_name(const ConfigTable& table, std::string_view key) {
  const std::string name = table.get_string(key);
  const auto path = resolve_named(table, key, "designs");
  return path.stem() == name ? name : path.string();
}

PublishedWinner read_published(const ConfigTable& table) {
  PublishedWinner published;
  if (table.has("error_m")) {
    published.error_m = table.get_number("error_m", {.lower = 0, .lower_open = true});
  }
  if (table.has("total_torque_n_m")) {
    published.total_torque_n_m =
        table.get_number("total_torque_n_m", {.lower = 0, .lower_open = true});
  }
  if (table.has("design")) {
    published.design = read_design_name(table, "design");
  }
  published.where = table.get_string("where", "");
  return published;
}

SweepPlan read_sweep(const ConfigTable& table, const TrackingProblem& problem) {
  SweepPlan sweep;
  sweep.parameter = table.get_string("parameter");
  sweep.values = table.get_numbers("values");
  if (sweep.values.empty()) {
    table.refuse("values", "it must hold at least one number");
  }
  sweep.design = read_design_name(table, "design");
  try {
    problem.check_design(load_design(sweep.design).design);
  } catch (const Error& error) {
    table.refuse("design", error.what());
  }
  return sweep;
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

// Returns the SIMD level that the engines use, if any.
std::optional<SimdLevel> load_tracking(const ConfigTable& table, std::span<const EngineRow> engines,
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
  config.task = read_task(task, physics);
  config.workspace = read_workspace(table.get_table_or_empty("workspace"));
  check_length(task, config.task, config.workspace);
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
  config.parameters = read_parameters(variables, config);
  check_limits(table.get_table_or_empty("objective"), config);
  loaded.tracking = make_tracking(std::move(config), variables, urdf);
  loaded.problem = loaded.tracking;
  if (table.has("sweep")) {
    loaded.sweep = read_sweep(table.get_table("sweep"), *loaded.tracking);
  }
  return chosen.simd;
}

void load_analytic(const ConfigTable& table, LoadedProblem& loaded) {
  const ConfigTable function = table.get_table("function");
  const std::string name = function.get_choice("name", analytic_names());
  const AnalyticRow& row = find_analytic(name);
  const auto dimension = static_cast<int>(function.get_integer_or(
      "dimension", row.default_dimension, row.smallest_dimension, row.largest_dimension));
  loaded.problem = make_analytic(name, dimension);
}

// The configuration with these overrides.
using ReadTable = std::function<ConfigTable(std::span<const std::string> overrides)>;

LoadedProblem load(const std::filesystem::path& path, const ReadTable& read_table,
                   std::span<const std::string> overrides, std::span<const EngineRow> engines) {
  const ConfigTable table = read_table(overrides);
  LoadedProblem loaded;
  loaded.name = path.stem().string();
  if (sanitize(loaded.name) != loaded.name) {
    throw Error(ErrorKind::usage,
                fmt::format("{}: a problem is named after its file, and this name is not printable "
                            "UTF-8; rename the file",
                            sanitize(path.string())));
  }
  loaded.title = table.get_string("title", loaded.name);
  table.get_string("description", "");
  static const std::vector<std::string> kinds = {"tracking", "analytic"};
  const bool analytic = table.get_choice("kind", kinds) == "analytic";
  read_schedule(table.get_table_or_empty("schedule"), loaded);
  CaseSets usual;
  if (analytic) {  // a function has no cases to tell apart
    usual.validation_cases = 1;
    usual.test_cases = 1;
  }
  loaded.sets = read_sets(table.get_table_or_empty("sets"), usual);
  const ConfigTable run = table.get_table_or_empty("run");
  loaded.optimizer = run.get_string("optimizer", "ga");
  loaded.budget = run.get_integer_or("budget", 10000, 0, 1'000'000'000'000);
  loaded.published = read_published(table.get_table_or_empty("published"));
  std::optional<SimdLevel> simd;
  if (analytic) {
    load_analytic(table, loaded);
  } else {
    simd = load_tracking(table, engines, loaded);
  }
  table.refuse_unknown();
  if (simd) {  // what "auto" has come to decides the last bits of every result
    std::vector<std::string> settled(overrides.begin(), overrides.end());
    settled.push_back(fmt::format("physics.simd={}", to_string(*simd)));
    loaded.resolved_json = read_table(settled).to_json();
  } else {
    loaded.resolved_json = table.to_json();
  }
  return loaded;
}

// JSON as TOML: a line for each key at the top, everything below it inline.
std::string write_toml(const nlohmann::json& value) {
  // A JSON string is a TOML string, but for one character that TOML wants escaped.
  const auto write_scalar = [](const nlohmann::json& scalar) {
    std::string text = scalar.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    for (std::size_t at = text.find('\x7f'); at != std::string::npos; at = text.find('\x7f', at)) {
      text.replace(at, 1, "\\u007f");
    }
    return text;
  };
  std::vector<std::string> parts;
  if (value.is_array()) {
    for (const nlohmann::json& element : value) {
      parts.push_back(write_toml(element));
    }
    return "[" + join(parts, ", ") + "]";
  }
  if (value.is_object()) {
    for (const auto& [key, element] : value.items()) {
      parts.push_back(write_scalar(key) + " = " + write_toml(element));
    }
    return "{" + join(parts, ", ") + "}";
  }
  return write_scalar(value);
}

}  // namespace

LoadedProblem load_problem(std::string_view name_or_path, std::span<const std::string> overrides,
                           std::span<const EngineRow> engines) {
  const auto path = resolve_config("problems", name_or_path);
  return load(
      path, [&](std::span<const std::string> all) { return ConfigTable::load(path, all); },
      overrides, engines);
}

LoadedProblem load_recorded_problem(const std::string& resolved_json, const std::string& name,
                                    const std::filesystem::path& beside) {
  nlohmann::json resolved;
  std::string toml;
  std::vector<double> start;
  try {
    resolved = nlohmann::json::parse(resolved_json);
    if (resolved.contains("replicate")) {
      start = resolved.at("replicate").at("start").get<std::vector<double>>();
      resolved.erase("replicate");
    }
    for (const auto& [key, value] : resolved.items()) {
      toml += write_toml(key) + " = " + write_toml(value) + "\n";
    }
  } catch (const nlohmann::json::exception& error) {
    throw Error(ErrorKind::bad_data,
                fmt::format("the recorded configuration of {} is not what armwright wrote ({})",
                            sanitize(name), error.what()));
  }
  const auto path = beside / (name + ".toml");
  LoadedProblem loaded = load(
      path,
      [&](std::span<const std::string> all) {
        return ConfigTable::parse(toml, path.string(), all);
      },
      {}, engine_table());
  if (!start.empty()) {
    if (start.size() != loaded.problem->description().variables.size()) {
      throw Error(ErrorKind::bad_data,
                  fmt::format("the recorded configuration of {} has {} start values for {} "
                              "variables",
                              sanitize(name), start.size(),
                              loaded.problem->description().variables.size()));
    }
    loaded = make_replicate(loaded, loaded.sets.training, start);
  }
  return loaded;
}

std::vector<ProblemTitle> list_problems() {
  std::vector<ProblemTitle> titles;
  for (const std::string& name : list_configs("problems")) {
    const ConfigTable table = ConfigTable::load(resolve_config("problems", name));
    titles.push_back({name, table.get_string("title", "")});
  }
  return titles;
}

}  // namespace armwright
