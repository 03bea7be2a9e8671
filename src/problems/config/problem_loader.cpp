#include "problems/config/problem_loader.hpp"

#include <fmt/format.h>

#include <utility>

#include "base/config.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "base/toml_text.hpp"
#include "problems/analytic/analytic.hpp"
#include "problems/config/config_files.hpp"
#include "problems/config/design_file.hpp"
#include "problems/config/problem_tables.hpp"
#include "problems/config/tracking_loader.hpp"

namespace armwright {
namespace {

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
  loaded.schedule = read_schedule_table(table);
  loaded.fixed_cases =
      static_cast<int>(table.get_integer_or("fixed_cases", loaded.fixed_cases, 1, kMostCases));
}

// The same for whoever reads the file later: a shipped name stays a name.
std::string read_design_name(const ConfigTable& table, std::string_view key) {
  const std::string name = table.get_string(key);
  const auto path = resolve_named(table, key, "designs");
  return path.stem() == name ? name : path.string();
}

PublishedWinner read_published_winner(const ConfigTable& table) {
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

constexpr std::string_view kRobotInName = "{robot}";

// The file's own, unless it gives another. "{robot}" in that stands for the name of the URDF's
// file; files that extend such a one are named after themselves.
std::string read_name(const ConfigTable& table, const std::filesystem::path& path) {
  std::string name = table.get_string("name", path.stem().string());
  if (const std::size_t at = name.find(kRobotInName); at != std::string::npos) {
    if (table.files().size() > 1) {
      name = path.stem().string();
    } else {
      const std::filesystem::path urdf = table.get_table("robot").get_string("urdf");
      name.replace(at, kRobotInName.size(), urdf.stem().string());
    }
  }
  if (sanitize(name) != name) {
    throw Error(ErrorKind::usage,
                fmt::format("{}: a problem is named after its file, and this name is not printable "
                            "UTF-8; rename the file",
                            sanitize(path.string())));
  }
  if (name.empty() || name.find('/') != std::string::npos || name.front() == '.') {
    table.refuse("name", "it names folders: it must not be empty, begin with '.' or hold '/'");
  }
  return name;
}

// A path is always the same, and so are its simulations unless plants are perturbed: one of each is
// enough, whatever the file says of generated cases.
void settle_path(LoadedProblem& loaded, std::vector<std::string>& settled) {
  const TrackingConfig& config = loaded.tracking()->config();
  if (!config.path || config.perturbation.changes_anything()) {
    return;
  }
  loaded.sets.validation_cases = 1;
  loaded.sets.test_cases = 1;
  loaded.schedule = {Schedule::Kind::fixed, 1};
  loaded.fixed_cases = 1;
  settled.insert(settled.end(),
                 {"sets.validation_cases=1", "sets.test_cases=1", "schedule.kind=fixed",
                  "schedule.cases=1", "schedule.fixed_cases=1"});
}

void load_analytic(const ConfigTable& table, LoadedProblem& loaded) {
  const ConfigTable function = table.get_table("function");
  const std::string name = function.get_choice("name", analytic_names());
  const AnalyticFunction& row = find_analytic(name);
  const auto dimension = static_cast<int>(function.get_integer_or(
      "dimension", row.default_dimension, row.smallest_dimension, row.largest_dimension));
  loaded.problem = make_analytic(name, dimension);
}

}  // namespace

LoadedProblem load_problem_tables(const std::filesystem::path& path, const ReadTable& read_table,
                                  std::span<const std::string> overrides,
                                  std::span<const EngineRow> engines) {
  const ConfigTable table = read_table(overrides);
  LoadedProblem loaded;
  loaded.name = read_name(table, path);
  loaded.title = table.get_string("title", loaded.name);
  table.get_string("description", "");
  static const std::vector<std::string> kinds = {"tracking", "analytic"};
  const bool analytic = table.get_choice("kind", kinds) == "analytic";
  read_schedule(table.get_table_or_empty("schedule"), loaded);
  loaded.racing = read_racing_table(table.get_table_or_empty("racing"));
  CaseSets usual;
  if (analytic) {  // a function has no cases to tell apart
    usual.validation_cases = 1;
    usual.test_cases = 1;
  }
  loaded.sets = read_sets(table.get_table_or_empty("sets"), usual);
  const ConfigTable run = table.get_table_or_empty("run");
  loaded.optimizer = run.get_string("optimizer", "ga");
  loaded.budget = run.get_integer_or("budget", 10000, 0, 1'000'000'000'000);
  loaded.published = read_published_winner(table.get_table_or_empty("published"));
  std::vector<std::string> settled;
  if (analytic) {
    load_analytic(table, loaded);
  } else {
    settled = load_tracking(table, engines, loaded);
    if (table.get_string("name", "").find(kRobotInName) != std::string::npos) {
      settled.push_back("name=" + quote_toml(loaded.name));
    }
    settle_path(loaded, settled);
    if (table.has("sweep")) {
      loaded.sweep = read_sweep(table.get_table("sweep"), *loaded.tracking());
    }
  }
  table.refuse_unknown();
  if (settled.empty()) {
    loaded.resolved_json = table.to_json();
  } else {
    settled.insert(settled.begin(), overrides.begin(), overrides.end());
    loaded.resolved_json = read_table(settled).to_json();
  }
  return loaded;
}

LoadedProblem load_problem(std::string_view name_or_path, std::span<const std::string> overrides,
                           std::span<const EngineRow> engines) {
  const auto path = resolve_config("problems", name_or_path);
  return load_problem_tables(
      path,
      [&](std::span<const std::string> all) {
        return ConfigTable::load(path, all, find_config_folder() / "problems");
      },
      overrides, engines);
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
