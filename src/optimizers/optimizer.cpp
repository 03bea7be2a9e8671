#include "optimizers/optimizer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "base/error.hpp"
#include "base/text.hpp"
#include "optimizers/ceres.hpp"
#include "optimizers/cmaes.hpp"
#include "optimizers/foreign_optimizer.hpp"
#include "optimizers/ga.hpp"
#include "optimizers/latin_hypercube.hpp"
#include "optimizers/multistart.hpp"
#include "optimizers/nlopt.hpp"
#include "optimizers/pagmo.hpp"
#include "optimizers/plugin_library.hpp"
#include "optimizers/plugin_process.hpp"
#include "optimizers/random_search.hpp"

namespace armwright {
namespace {

// What is allowed, as it stands in messages.
std::string describe_allowed(const OptionSpec& spec) {
  if (std::holds_alternative<bool>(spec.fallback)) {
    return "true or false";
  }
  if (std::holds_alternative<std::int64_t>(spec.fallback)) {
    return fmt::format("an integer between {:.0f} and {:.0f}", spec.lower, spec.upper);
  }
  if (std::holds_alternative<double>(spec.fallback)) {
    return fmt::format("a number between {} and {}", format_exact(spec.lower),
                       format_exact(spec.upper));
  }
  return "one of: " + join(spec.choices, ", ");
}

std::optional<OptionValue> parse_value(const OptionSpec& spec, const std::string& text) {
  if (std::holds_alternative<bool>(spec.fallback)) {
    if (text == "true" || text == "false") {
      return text == "true";
    }
    return std::nullopt;
  }
  if (std::holds_alternative<std::int64_t>(spec.fallback)) {
    const auto value = parse_integer(text);
    const bool allowed = value && static_cast<double>(*value) >= spec.lower &&
                         static_cast<double>(*value) <= spec.upper;
    return allowed ? std::optional<OptionValue>(std::int64_t{*value}) : std::nullopt;
  }
  if (std::holds_alternative<double>(spec.fallback)) {
    const auto value = parse_finite(text);
    const bool allowed = value && *value >= spec.lower && *value <= spec.upper;
    return allowed ? std::optional<OptionValue>(*value) : std::nullopt;
  }
  const bool allowed = spec.choices.empty() || std::ranges::count(spec.choices, text) > 0;
  return allowed ? std::optional<OptionValue>(text) : std::nullopt;
}

}  // namespace

Options Options::parse(std::string_view optimizer, std::span<const OptionSpec> specs,
                       std::span<const std::string> assignments) {
  const auto refuse = [&](const std::string& what) {
    throw Error(ErrorKind::usage, fmt::format("optimizer '{}': {}", sanitize(optimizer), what));
  };
  std::map<std::string, std::string> given;
  for (const std::string& assignment : assignments) {
    const std::size_t equals = assignment.find('=');
    if (equals == std::string::npos) {
      refuse(fmt::format("option '{}' has no value; write NAME=VALUE", sanitize(assignment)));
    }
    const std::string name = assignment.substr(0, equals);
    const std::string text = assignment.substr(equals + 1);
    const auto spec = std::ranges::find(specs, name, &OptionSpec::name);
    if (spec == specs.end()) {
      std::vector<std::string> names;
      std::ranges::transform(specs, std::back_inserter(names), &OptionSpec::name);
      refuse(describe_unknown("option", name, names));
    }
    if (const auto [earlier, is_new] = given.emplace(name, text); !is_new) {
      refuse(fmt::format("option '{}' is given twice, as '{}' and as '{}'; give it once", name,
                         sanitize(earlier->second), sanitize(text)));
    }
  }
  Options options;
  for (const OptionSpec& spec : specs) {
    const auto found = given.find(spec.name);
    if (found == given.end()) {
      options.values_[spec.name] = spec.fallback;
      continue;
    }
    const auto value = parse_value(spec, found->second);
    if (!value) {
      refuse(fmt::format("option '{}' is '{}'; it must be {}", spec.name, sanitize(found->second),
                         describe_allowed(spec)));
    }
    options.values_[spec.name] = *value;
  }
  return options;
}

// Asking for an option that was not declared, or as another type, is a bug of ours: at() and get()
// throw what nobody catches.
bool Options::get_bool(const std::string& name) const {
  return std::get<bool>(values_.at(name));
}

std::int64_t Options::get_integer(const std::string& name) const {
  return std::get<std::int64_t>(values_.at(name));
}

double Options::get_number(const std::string& name) const {
  return std::get<double>(values_.at(name));
}

const std::string& Options::get_text(const std::string& name) const {
  return std::get<std::string>(values_.at(name));
}

std::string to_text(const OptionValue& value) {
  if (const auto* flag = std::get_if<bool>(&value)) {
    return *flag ? "true" : "false";
  }
  if (const auto* integer = std::get_if<std::int64_t>(&value)) {
    return fmt::format("{}", *integer);
  }
  if (const auto* number = std::get_if<double>(&value)) {
    return format_exact(*number);
  }
  return std::get<std::string>(value);
}

const std::vector<OptimizerRow>& optimizer_table() {
  static const std::vector<OptimizerRow> table = [] {
    std::vector<OptimizerRow> rows;
    for (const auto make_rows :
         {make_ga_rows, make_cmaes_rows, make_ceres_rows, make_nlopt_rows, make_pagmo_rows,
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
    throw Error(ErrorKind::usage, describe_unknown("optimizer", name, optimizer_names()));
  }
  return *row;
}

OptimizerRow load_optimizer(std::string_view name) {
  // It stands in results and reports, which are UTF-8.
  if (sanitize(name) != name) {
    throw Error(ErrorKind::usage,
                fmt::format("optimizer '{}': this name is not printable UTF-8; rename the file",
                            sanitize(name)));
  }
  constexpr std::string_view kMultistart = "multistart:";
  if (name.starts_with(kMultistart)) {
    return make_multistart_row(load_optimizer(name.substr(kMultistart.size())));
  }
  constexpr std::string_view kProcess = "exec:";
  if (name.starts_with(kProcess)) {
    return load_process_plugin(name.substr(kProcess.size()));
  }
  if (is_foreign_name(name)) {
    throw Error(ErrorKind::usage, explain_foreign(name));
  }
  if (is_library_name(name)) {
    return load_library_plugin(name);
  }
  if (std::ranges::count(optimizer_table(), name, &OptimizerRow::name) == 0) {
    if (const auto file = find_library_plugin(name)) {
      return load_library_plugin(*file, std::string(name));
    }
  }
  OptimizerRow row = find_optimizer(name);
  if (!row.unavailable.empty()) {
    throw Error(ErrorKind::usage,
                fmt::format("optimizer '{}' is not available: {}", row.name, row.unavailable));
  }
  return row;
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
           (problem.residuals_advice.empty() ? "" : "; " + problem.residuals_advice);
  }
  return "";
}

}  // namespace armwright
