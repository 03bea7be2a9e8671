#include "optimizers/table/optimizer_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "base/error.hpp"
#include "base/text.hpp"
#include "optimizers/builtin/ga.hpp"
#include "optimizers/builtin/latin_hypercube.hpp"
#include "optimizers/builtin/random_search.hpp"
#include "optimizers/ceres/ceres_backend.hpp"
#include "optimizers/cma/cma_search.hpp"
#include "optimizers/dfls/dfls_search.hpp"
#include "optimizers/fronts/front_generation.hpp"
#include "optimizers/nlopt/nlopt_algorithms.hpp"
#include "optimizers/pagmo/pagmo_backend.hpp"
#include "optimizers/plugins/plugin_library.hpp"
#include "optimizers/plugins/plugin_process.hpp"
#include "optimizers/plugins/recorded_optimizer.hpp"
#include "optimizers/table/auto.hpp"
#include "optimizers/table/multistart.hpp"
#include "optimizers/turbo/turbo.hpp"
#include "process/command_words.hpp"

namespace armwright {
namespace {

constexpr std::string_view kMultistart = "multistart:";
constexpr std::string_view kProcess = "exec:";

std::string_view remove_multistart(std::string_view name) {
  while (name.starts_with(kMultistart)) {
    name.remove_prefix(kMultistart.size());
  }
  return name;
}

// Throws Error{usage} for a name that cannot appear in results and reports, which are UTF-8.
void check_printable(std::string_view name) {
  if (sanitize(name) != name) {
    throw Error(ErrorKind::usage,
                fmt::format("optimizer '{}': this name is not printable UTF-8; rename the file",
                            sanitize(name)));
  }
}

// Returns the name behind "multistart:". Throws Error{usage} if that is a multistart again.
std::string_view get_restarted(std::string_view name) {
  const std::string_view inner = name.substr(kMultistart.size());
  if (inner.starts_with(kMultistart)) {
    constexpr std::size_t kShown = 80;
    throw Error(ErrorKind::usage,
                fmt::format("optimizer '{}': 'multistart:' is given twice; give it once",
                            sanitize(name.substr(0, kShown))));
  }
  return inner;
}

bool is_in_table(std::string_view name) {
  return std::ranges::count(optimizer_table(), name, &OptimizerRow::name) > 0;
}

}  // namespace

const std::vector<OptimizerRow>& optimizer_table() {
  static const std::vector<OptimizerRow> table = [] {
    std::vector<OptimizerRow> rows;
    for (const auto make_rows :
         {make_auto_rows, make_ga_rows, make_cmaes_rows, make_dfls_rows, make_turbo_rows,
          make_front_rows, make_ceres_rows, make_nlopt_rows, make_pagmo_rows,
          make_random_search_rows, make_latin_hypercube_rows}) {
      std::ranges::move(make_rows(), std::back_inserter(rows));
    }
    return rows;
  }();
  return table;
}

std::vector<std::string> optimizer_names() {
  std::vector<std::string> names;
  std::ranges::transform(optimizer_table(), std::back_inserter(names), &OptimizerRow::name);
  return names;
}

const OptimizerRow& find_optimizer(std::string_view name) {
  const auto row = std::ranges::find(optimizer_table(), name, &OptimizerRow::name);
  if (row == optimizer_table().end()) {
    throw Error(ErrorKind::usage, describe_unknown("optimizer", name, optimizer_names(),
                                                   "armwright list optimizers"));
  }
  return *row;
}

OptimizerRow load_optimizer(std::string_view name) {
  check_printable(name);
  if (name.starts_with(kMultistart)) {
    return make_multistart_row(load_optimizer(get_restarted(name)));
  }
  if (name.starts_with(kProcess)) {
    OptimizerRow row = load_process_plugin(name.substr(kProcess.size()));
    if (is_in_table(row.name)) {
      throw Error(
          ErrorKind::bad_data,
          fmt::format("optimizer '{}': it calls itself '{}', which is the name of an optimizer "
                      "of armwright's own; results could be mistaken for one another",
                      sanitize(name), row.name));
    }
    return row;
  }
  if (is_host_name(name)) {
    throw Error(ErrorKind::usage, explain_host_optimizer(name));
  }
  if (!suggest_exec(name).empty()) {
    throw Error(ErrorKind::usage, describe_missing_exec("optimizer", name, "--optimizer "));
  }
  if (is_library_name(name)) {
    return load_library_plugin(name);
  }
  if (!is_in_table(name)) {
    if (const auto file = find_library_plugin(name)) {
      return load_library_plugin(*file, std::string(name));
    }
  }
  OptimizerRow row = find_optimizer(name);
  // A command that only reads a recorded run or study needs no more than the row.
  if (!row.unavailable.empty()) {
    row.make = [what = fmt::format("optimizer '{}' is not available: {}", row.name,
                                   row.unavailable)](const Options&) -> std::unique_ptr<Optimizer> {
      throw Error(ErrorKind::usage, what);
    };
  }
  return row;
}

bool is_plugin(std::string_view name) {
  name = remove_multistart(name);
  return name.starts_with(kProcess) || (!is_host_name(name) && !is_in_table(name) &&
                                        (is_library_name(name) || find_library_plugin(name)));
}

std::vector<std::string> list_plugin_files(std::string_view name) {
  name = remove_multistart(name);
  if (name.starts_with(kProcess)) {
    return list_program_files(name.substr(kProcess.size()));
  }
  const std::filesystem::path file =
      is_library_name(name) ? std::filesystem::path(name)
                            : find_library_plugin(name).value_or(std::filesystem::path(name));
  return {std::filesystem::absolute(file).string()};
}

OptimizerRow read_recorded_plugin(const std::string& name, const std::string& description,
                                  std::span<const std::string> options) {
  check_printable(name);
  if (description.empty()) {
    return make_undescribed_row(name, options);
  }
  if (name.starts_with(kMultistart)) {
    return make_multistart_row(
        read_recorded_plugin(std::string(get_restarted(name)), description, options));
  }
  return read_plugin_row(name, description);
}

std::string explain_unsuitable(const OptimizerRow& row, const ProblemDescription& problem) {
  const Requirements& required = row.requirements;
  if (std::ssize(problem.objectives) < required.objectives) {
    return fmt::format("it needs a problem of at least {} objectives, and this one has {}",
                       required.objectives, problem.objectives.size());
  }
  if (std::ssize(problem.variables) < required.variables) {
    return fmt::format("it needs a problem of at least {} decision variables, and this one has {}",
                       required.variables, problem.variables.size());
  }
  if (row.limits.variables > 0 && std::ssize(problem.variables) > row.limits.variables) {
    return fmt::format("it is made for at most {} decision variables, and this one has {}; use {}",
                       row.limits.variables, problem.variables.size(), row.limits.alternative);
  }
  if (required.residuals && !problem.has_residuals && !problem.constraints.empty()) {
    std::vector<std::string> able;
    for (const OptimizerRow& one : optimizer_table()) {
      if (one.capabilities.constraints && one.unavailable.empty()) {
        able.push_back(one.name);
      }
    }
    return fmt::format(
        "it works on residuals, which know no constraints, and this problem has {}; "
        "these see constraints: {}; and all that have an option constraint_weight, as cmaes, "
        "take them for a penalty",
        problem.constraints.size(), join(able, ", "));
  }
  if (required.residuals && !problem.has_residuals) {
    return "it works on residuals, of whose squares the objective is the sum, and this problem "
           "offers none" +
           (problem.residuals_advice.empty() ? "; use one that needs none, as cmaes"
                                             : "; " + problem.residuals_advice);
  }
  return "";
}

}  // namespace armwright
