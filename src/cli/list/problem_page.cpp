#include "cli/list/problem_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/text.hpp"
#include "cli/terminal/markdown.hpp"
#include "problems/config/problem_loader.hpp"

namespace armwright {
namespace {

std::string list_quantities(const std::vector<Quantity>& quantities) {
  std::vector<std::string> texts;
  for (const Quantity& quantity : quantities) {
    texts.push_back(quantity.unit.empty() || quantity.unit == "1"
                        ? quantity.name
                        : fmt::format("{} ({})", quantity.name, quantity.unit));
  }
  return join(texts, ", ");
}

// "joint_1.p, joint_1.i, ..." of four joints as "p, i, ... of joint_1, ..., joint_4".
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
  if (!description.constraints.empty()) {
    text += fmt::format("- Constraints: {}\n", escape_markdown(describe_limits(description)));
  }
  text += fmt::format(
      "- Unless told otherwise: `{}`, a budget of {} {}s, schedule `{}`; {} validation and {} test "
      "cases\n",
      loaded.optimizer, loaded.budget, description.cost_unit, to_text(loaded.schedule),
      loaded.sets.validation_cases, loaded.sets.test_cases);
  if (!loaded.published.where.empty()) {
    text += fmt::format("- Published: {}\n", escape_markdown(loaded.published.where));
  }
  return text;
}

}  // namespace

std::string format_problem_page() {
  std::string text = fmt::format(
      "{}# Problems\n\n"
      "What `armwright list problems` lists: the problems that are shipped. `armwright list "
      "problems NAME` shows one with every variable and setting; what the settings mean is in "
      "[configuration.md](configuration.md).\n\n| problem | |\n|---|---|\n",
      kGeneratedPage);
  std::string sections;
  for (const ProblemTitle& problem : list_problems()) {
    text += fmt::format("| [`{0}`](#{0}) | {1} |\n", problem.name, escape_markdown(problem.title));
    sections += format_problem(problem.name, load_problem(problem.name));
  }
  return text + sections;
}

}  // namespace armwright
