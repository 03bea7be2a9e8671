#include "cli/list/optimizer_page.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/text.hpp"
#include "cli/terminal/format.hpp"
#include "cli/terminal/markdown.hpp"
#include "optimizers/interface/capability_table.hpp"
#include "optimizers/table/auto.hpp"
#include "optimizers/table/auto_rules.hpp"

namespace armwright {
namespace {

// Returns 1e+12 instead of a number with many zeros.
std::string format_bound(double value) {
  const std::string brief = fmt::format("{:g}", value);
  return parse_finite(brief) == value ? brief : format_exact(value);
}

std::string format_sentence(const std::string& text) {
  return escape_markdown(text) + (text.ends_with('.') ? "" : ".");
}

std::string format_allowed(const OptionSpec& option) {
  if (option.choices.empty()) {
    const std::string range = describe_range(option);
    const bool is_text = std::holds_alternative<std::string>(option.fallback);
    const std::string type = is_text ? "any text" : get_option_type(option.fallback);
    return range.empty() ? type : type + ", " + range;
  }
  std::vector<std::string> choices;
  std::ranges::transform(option.choices, std::back_inserter(choices), format_code);
  return join(choices, ", ");
}

// "NLopt (CMake option X)" -> "NLopt"
std::string get_backend_name(const OptimizerRow& row) {
  return row.backend.substr(0, row.backend.find(" ("));
}

std::string format_index_row(const OptimizerRow& row) {
  std::vector<std::string> needs = list_requirements(row);
  if (!row.backend.empty()) {
    needs.insert(needs.begin(), get_backend_name(row));
  }
  return fmt::format("| [`{}`]({}) | {}{} | {} | {} |\n", row.name, get_page_name(row.name),
                     escape_markdown(row.summary), row.unfit.empty() ? "" : " (not offered)",
                     escape_markdown(join(list_capabilities(row.capabilities), ", ")),
                     escape_markdown(join(needs, ", ")));
}

std::string format_facts(const OptimizerRow& row) {
  std::string text;
  if (!row.unfit.empty()) {
    text += fmt::format("- **Not offered:** {}\n", format_sentence(row.unfit));
  }
  text += row.backend.empty()
              ? "- **Build:** part of every build.\n"
              : fmt::format("- **Build:** needs {}, which a build has by default.\n",
                            escape_markdown(row.backend));
  const std::vector<std::string> required = list_requirements(row);
  text += required.empty() ? "- **Problem:** any.\n"
                           : fmt::format("- **Problem:** one with {}.\n",
                                         escape_markdown(join(required, " and ")));
  if (row.limits.evaluations > 0) {
    text += fmt::format("- **Budget:** at most {} evaluations; for more use `{}`.\n",
                        row.limits.evaluations, row.limits.alternative);
  }
  text += fmt::format("- **Runs:** {}\n", format_sentence(describe_isolation(row)));
  if (!row.tuned_on.empty()) {
    std::vector<std::string> problems;
    std::ranges::transform(row.tuned_on, std::back_inserter(problems), format_code);
    text += fmt::format(
        "- **Defaults:** some were chosen on {}: {} The verdict of a study with such a problem "
        "says so. [More](../defaults.md).\n",
        join(problems, ", "), format_sentence(row.tuning));
  }
  return text;
}

std::string format_calls(const OptimizerRow& row) {
  if (!row.unfit.empty()) {
    return "";
  }
  const std::string problem = row.requirements.objectives > 1 ? "q2-pareto" : "q1-complex";
  const auto format_call = [&](const std::string& name, const std::vector<std::string>& flags) {
    std::vector<std::string> words = {"armwright", "optimize", problem, "--optimizer", name};
    words.insert(words.end(), flags.begin(), flags.end());
    return "    " + quote_command(words) + "\n";
  };
  std::string text = "## How to call it\n\n" + format_call(row.name, {});
  if (row.capabilities.stochastic) {
    text += format_call(row.name, {"--seed", "2"});
  }
  if (!row.options.empty()) {
    const OptionSpec& first = row.options.front();
    text += format_call(row.name, {"--opt", first.name + "=" + to_text(first.fallback)});
  }
  // Designs of a front must have met the same cases.
  if (row.capabilities.generations && row.requirements.objectives < 2) {
    text += format_call(row.name, {"--schedule", "fresh:1"});
  }
  if (row.capabilities.local) {
    text += format_call("multistart:" + row.name, {});
  }
  return text + "\n";
}

std::string format_capabilities(const OptimizerRow& row) {
  std::string text = "## Capabilities\n\n| capability | | what that means |\n|---|---|---|\n";
  for (const CapabilityRow& capability : kCapabilityTable) {
    text += fmt::format("| {} | {} | {} |\n", capability.name,
                        row.capabilities.*capability.member ? "yes" : "no",
                        escape_markdown(describe_capability(row, capability)));
  }
  return text + "\n";
}

std::string format_options(const OptimizerRow& row) {
  if (row.options.empty()) {
    return "## Options\n\nIt has no options.\n\n";
  }
  std::string text = "## Options\n\n| option | default | allowed | meaning |\n|---|---|---|---|\n";
  for (const OptionSpec& option : row.options) {
    text += fmt::format("| {} | {} | {} | {} |\n", format_code(option.name),
                        format_code(to_text(option.fallback)), format_allowed(option),
                        escape_markdown(option.description));
  }
  return text + "\n";
}

// Of auto: what it chooses by, in the order in which the rules are tried.
std::string format_rules_page() {
  std::string text =
      "## Rules\n\nThe first rule holds whose conditions are met and whose optimizer can work on "
      "the problem. [auto.md](../auto.md) explains them.\n\n"
      "| rule | conditions | optimizer | why |\n|---|---|---|---|\n";
  int number = 0;
  for (const AutoRule& rule : load_auto_rules(find_auto_rules(""))) {
    text +=
        fmt::format("| {} | {} | {} | {} |\n", ++number, escape_markdown(describe_conditions(rule)),
                    format_code(describe_used(rule)), escape_markdown(rule.why));
  }
  return text + "\n";
}

// A row's source lists its papers, separated by "; ".
std::string format_source(const OptimizerRow& row) {
  std::string text = "## Source\n\n";
  std::string rest = row.source;
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find("; "), rest.size());
    text += fmt::format("- {}\n", format_sentence(rest.substr(0, end)));
    rest.erase(0, end + 2);
  }
  return text;
}

}  // namespace

std::vector<std::string> list_capabilities(const Capabilities& capabilities) {
  std::vector<std::string> names;
  for (const CapabilityRow& capability : kCapabilityTable) {
    if (capabilities.*capability.member) {
      names.emplace_back(capability.name);
    }
  }
  return names;
}

std::string describe_capability(const OptimizerRow& row, const CapabilityRow& capability) {
  const bool has = row.capabilities.*capability.member;
  if (capability.member == &Capabilities::constraints && !has) {
    const bool weighs = std::ranges::count(row.options, "constraint_weight", &OptionSpec::name) > 0;
    return weighs ? "does not know the constraints: their violation, times constraint_weight, is "
                    "added to the objective"
                  : "does not know the constraints and ignores them";
  }
  return has ? capability.with : capability.without;
}

std::vector<std::string> list_requirements(const OptimizerRow& row) {
  const Requirements& requirements = row.requirements;
  std::vector<std::string> list;
  if (requirements.objectives > 1) {
    list.push_back(fmt::format("at least {} objectives", requirements.objectives));
  }
  if (requirements.variables > 1) {
    list.push_back(fmt::format("at least {} decision variables", requirements.variables));
  }
  if (row.limits.variables > 0) {
    list.push_back(fmt::format("at most {} decision variables", row.limits.variables));
  }
  if (requirements.residuals) {
    list.emplace_back("residuals (all robot problems have them)");
  }
  return list;
}

std::string describe_isolation(const OptimizerRow& row) {
  if (row.isolated.empty()) {
    return "in armwright's own process";
  }
  constexpr const char* kElsewhere =
      "in a process of its own, where a hang or a crash costs this run and nothing else";
  return row.isolated == "always"
             ? kElsewhere
             : fmt::format("{} {}, otherwise in armwright's own", row.isolated, kElsewhere);
}

const char* get_option_type(const OptionValue& value) {
  constexpr const char* kNames[] = {"true or false", "integer", "number", "text"};
  return kNames[value.index()];
}

std::string describe_range(const OptionSpec& option) {
  if (std::holds_alternative<std::int64_t>(option.fallback)) {
    return fmt::format("{:.0f} to {:.0f}", option.lower, option.upper);
  }
  if (std::holds_alternative<double>(option.fallback)) {
    return fmt::format("{} to {}", format_bound(option.lower), format_bound(option.upper));
  }
  return "";
}

std::string get_page_name(const std::string& optimizer) {
  std::string name = optimizer + ".md";
  std::ranges::replace(name, ':', '-');
  return name;
}

std::string format_optimizer_index(std::span<const OptimizerRow> rows) {
  std::string text = fmt::format(
      "{}# Optimizers\n\n"
      "The values of `--optimizer`, in the order of `armwright list optimizers`. There are two "
      "more "
      "ways to name an optimizer:\n\n"
      "- `multistart:NAME` runs a *local* optimizer from the start and then from random points, "
      "until the budget ends.\n"
      "- `./libmine.so` and `exec:COMMAND` are [optimizers of your own](../plugins.md).\n\n"
      "All optimizers get the same budget and the same training cases, and their winners are "
      "judged "
      "in the same way. The same seed gives the same run. If an option is a share of the box, it "
      "is "
      "a share of the distance between a variable's bounds. For a logarithmic variable, it is a "
      "share of the distance between the logarithms of the bounds.\n\n"
      "| optimizer | what it is | capabilities | needs |\n|---|---|---|---|\n",
      kGeneratedPage);
  for (const OptimizerRow& row : rows) {
    text += format_index_row(row);
  }
  text +=
      "\nIf *needs* names a library, a build without this library does not have the optimizer. If "
      "*needs* names a demand on the problem, it is checked before a run begins.\n\n"
      "## How to read the capabilities\n\n"
      "| capability | an optimizer with it | an optimizer without it |\n|---|---|---|\n";
  for (const CapabilityRow& capability : kCapabilityTable) {
    text += fmt::format("| {} | {} | {} |\n", capability.name, escape_markdown(capability.with),
                        escape_markdown(capability.without));
  }
  return text;
}

std::string format_optimizer_page(const OptimizerRow& row) {
  return fmt::format("{}# {}\n\n{}\n\n", kGeneratedPage, format_code(row.name),
                     format_sentence(row.summary)) +
         format_facts(row) + "\n" + format_calls(row) + format_capabilities(row) +
         format_options(row) + (row.name == kAutoName ? format_rules_page() : "") +
         format_source(row) + "\n[All optimizers](README.md)\n";
}

}  // namespace armwright
