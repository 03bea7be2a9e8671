// `armwright list problems`.

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/text.hpp"
#include "cli/list/list_views.hpp"
#include "cli/terminal/format.hpp"
#include "cli/terminal/markdown.hpp"
#include "cli/terminal/table.hpp"
#include "cli/views/requirement_view.hpp"
#include "problems/config/problem_loader.hpp"

namespace armwright {
namespace {

using nlohmann::json;

std::vector<ListItem> list_known_problems() {
  std::vector<ListItem> items;
  for (const ProblemTitle& problem : list_problems()) {
    items.push_back({problem.name, problem.title});
  }
  return items;
}

// "/task/speed_m_per_s" -> "task.speed_m_per_s", as --set takes it
std::string get_key(std::string pointer) {
  pointer.erase(0, 1);
  std::replace(pointer.begin(), pointer.end(), '/', '.');
  return pointer;
}

// Adds one row per setting. A list is one row.
void collect_settings(const json& value, const std::string& pointer, Table& table) {
  if (value.is_object()) {
    for (const auto& [key, inner] : value.items()) {
      collect_settings(inner, pointer + "/" + key, table);
    }
    return;
  }
  const std::string key = get_key(pointer);
  if (key != "title" && key != "description") {
    table.add_row({sanitize(key), sanitize(value.dump())});
  }
}

// Returns a table of the requirements, or an empty text if the problem has none.
std::string format_required(const ProblemDescription& description, const Style& style) {
  if (description.requirements.empty()) {
    return "";
  }
  Table table({{"requirement", false}, {"at most"}, {"use", false}});
  for (const RequiredMetric& requirement : description.requirements) {
    table.add_row({sanitize(requirement.limit.quantity.name), describe_limit(requirement.limit),
                   requirement.is_constraint ? "constraint" : "report"});
  }
  return table.format(style) + "\n";
}

std::string format_allowed(const DecisionVariable& variable, double value) {
  return variable.type == VariableType::real ? format_significant(value)
                                             : sanitize(format_value(variable, value));
}

std::string explain_problem(const std::string& name, const Style& style) {
  const LoadedProblem loaded = load_problem(name);
  const ProblemDescription& description = loaded.problem->description();
  const json settings = json::parse(loaded.resolved_json);
  std::string text = format_title(style, loaded.name, loaded.title);
  if (settings.contains("description")) {
    for (const std::string& line : split(settings["description"].get<std::string>(), '\n')) {
      text += fmt::format("  {}\n", sanitize(line));
    }
  }
  text += "\n";
  for (const Quantity& objective : description.objectives) {
    text += fmt::format("Minimises {} [{}]", objective.name, objective.unit);
  }
  text += fmt::format(", {} decision variables, {} constraints; a case is a {}\n\n",
                      description.variables.size(), description.constraints.size(),
                      description.cost_unit);
  const bool discrete = has_discrete(description.variables);
  std::vector<Column> columns = {{"variable", false}, {"unit", false}, {"start"},
                                 {"lower"},           {"upper"},       {"scale", false}};
  if (discrete) {
    columns.push_back({"type", false, true});
  }
  Table variables(columns);
  for (const DecisionVariable& variable : description.variables) {
    std::vector<std::string> row = {
        variable.name,
        variable.unit,
        format_allowed(variable, variable.start),
        format_allowed(variable, variable.lower),
        format_allowed(variable, variable.upper),
        variable.scale == Scale::logarithmic ? "logarithmic" : "linear"};
    if (discrete) {
      row.push_back(variable.type == VariableType::category
                        ? "category: " + sanitize(join(variable.choices, ", "))
                        : to_string(variable.type));
    }
    variables.add_row(row);
  }
  Table table({{"setting (for --set)", false}, {"value", false}});
  collect_settings(settings, "", table);
  return text + variables.format(style) + "\n" + format_required(description, style) +
         table.format(style);
}

json explain_problem_as_json(const std::string& name) {
  const LoadedProblem loaded = load_problem(name);
  const ProblemDescription& description = loaded.problem->description();
  json variables = json::array();
  for (const DecisionVariable& variable : description.variables) {
    variables.push_back(
        {{"name", variable.name},
         {"unit", variable.unit},
         {"start", variable.start},
         {"lower", variable.lower},
         {"upper", variable.upper},
         {"scale", variable.scale == Scale::logarithmic ? "logarithmic" : "linear"}});
    if (variable.type != VariableType::real) {
      variables.back()["type"] = to_string(variable.type);
    }
    if (variable.type == VariableType::category) {
      variables.back()["choices"] = variable.choices;
    }
  }
  json objectives = json::array();
  for (const Quantity& objective : description.objectives) {
    objectives.push_back({{"name", objective.name}, {"unit", objective.unit}});
  }
  json requirements = json::array();
  for (const RequiredMetric& requirement : description.requirements) {
    requirements.push_back({{"name", sanitize(requirement.limit.quantity.name)},
                            {"unit", requirement.limit.quantity.unit},
                            {"limit", requirement.limit.value},
                            {"use", requirement.is_constraint ? "constraint" : "report"}});
  }
  return {{"name", sanitize(loaded.name)}, {"title", sanitize(loaded.title)},
          {"objectives", objectives},      {"variables", variables},
          {"requirements", requirements},  {"settings", json::parse(loaded.resolved_json)}};
}

std::string list_quantities(const std::vector<Quantity>& quantities) {
  std::vector<std::string> texts;
  for (const Quantity& quantity : quantities) {
    texts.push_back(quantity.unit.empty() || quantity.unit == "1"
                        ? quantity.name
                        : fmt::format("{} ({})", quantity.name, quantity.unit));
  }
  return join(texts, ", ");
}

// Returns the names of the variables. "joint_1.p, joint_1.i, ..." of four joints becomes "p, i, ...
// of joint_1, ..., joint_4".
std::string describe_variables(const std::vector<DecisionVariable>& variables) {
  std::vector<std::string> owners, kinds;
  const auto add = [](std::vector<std::string>& names, const std::string& name) {
    if (std::ranges::count(names, name) == 0) {
      names.push_back(name);
    }
  };
  for (const DecisionVariable& variable : variables) {
    const std::size_t dot = variable.name.find('.');
    if (dot == std::string::npos) {
      return fmt::format("{} to {}", variables.front().name, variables.back().name);
    }
    add(owners, variable.name.substr(0, dot));
    add(kinds, variable.name.substr(dot + 1));
  }
  return fmt::format("{} of {}", join(kinds, ", "), join(owners, ", "));
}

// Returns the number of variables of each type: "2 real, 3 integer".
std::string describe_types(const std::vector<DecisionVariable>& variables) {
  std::vector<std::string> texts;
  for (const VariableType type :
       {VariableType::real, VariableType::integer, VariableType::category}) {
    const auto count = std::ranges::count(variables, type, &DecisionVariable::type);
    if (count > 0) {
      texts.push_back(fmt::format("{} {}", count, to_string(type)));
    }
  }
  return join(texts, ", ");
}

std::string describe_limits(const ProblemDescription& description) {
  std::vector<std::string> texts;
  for (const Limit& limit : description.limits) {
    texts.push_back(
        fmt::format("{} at most {:g} {}", limit.quantity.name, limit.value, limit.quantity.unit));
  }
  if (texts.empty() && !description.constraints.empty()) {
    return fmt::format("{} <= 0", list_quantities(description.constraints));
  }
  return join(texts, "; ");
}

std::string format_problem(const std::string& name, const LoadedProblem& loaded) {
  const ProblemDescription& description = loaded.problem->description();
  const auto settings = nlohmann::json::parse(loaded.resolved_json);
  std::string text = fmt::format("\n## `{}`\n\n{}.\n", name, escape_markdown(loaded.title));
  if (settings.contains("description")) {
    text += "\n";
    for (const std::string& line : split(settings["description"].get<std::string>(), '\n')) {
      text += line.empty() ? "" : escape_markdown(line) + "\n";
    }
  }
  text += fmt::format("\n- Minimised: {}\n- Variables: {}, {}\n",
                      escape_markdown(list_quantities(description.objectives)),
                      description.variables.size(),
                      escape_markdown(describe_variables(description.variables)));
  if (has_discrete(description.variables)) {
    text += fmt::format("- Types: {}\n", escape_markdown(describe_types(description.variables)));
  }
  if (!description.constraints.empty()) {
    text += fmt::format("- Constraints: {}\n", escape_markdown(describe_limits(description)));
  }
  text += fmt::format(
      "- Defaults: `{}`, a budget of {} {}s, schedule `{}`; {} validation and {} test "
      "cases\n",
      loaded.optimizer, loaded.budget, description.cost_unit, to_text(loaded.schedule),
      loaded.sets.validation_cases, loaded.sets.test_cases);
  if (!loaded.published.where.empty()) {
    text += fmt::format("- Published: {}\n", escape_markdown(loaded.published.where));
  }
  return text;
}

std::string format_problem_page() {
  std::string text = fmt::format(
      "{}# Problems\n\n"
      "The shipped problems, which `armwright list problems` lists. `armwright list problems NAME` "
      "shows one of them with all variables and settings. [configuration.md](configuration.md) "
      "explains the settings.\n\n| problem | |\n|---|---|\n",
      kGeneratedPage);
  std::string sections;
  for (const ProblemTitle& problem : list_problems()) {
    text += fmt::format("| [`{0}`](#{0}) | {1} |\n", problem.name, escape_markdown(problem.title));
    sections += format_problem(problem.name, load_problem(problem.name));
  }
  return text + sections;
}

}  // namespace

ListKind make_problem_kind() {
  return {.name = "problems",
          .list = list_known_problems,
          .explain = explain_problem,
          .explain_as_json = explain_problem_as_json,
          .explain_as_markdown = [](const std::string& name) {
            if (!name.empty()) {
              throw Error(ErrorKind::usage,
                          "the page of problems contains all problems; leave out the name");
            }
            return format_problem_page();
          }};
}

}  // namespace armwright
