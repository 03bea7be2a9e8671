// `armwright list optimizers`.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/text.hpp"
#include "cli/list/list_views.hpp"
#include "cli/list/optimizer_page.hpp"
#include "cli/terminal/table.hpp"
#include "optimizers/table/auto.hpp"
#include "optimizers/table/auto_rules.hpp"
#include "optimizers/table/optimizer_table.hpp"

namespace armwright {
namespace {

using nlohmann::json;

std::vector<ListItem> list_known_optimizers() {
  std::vector<ListItem> items;
  for (const OptimizerRow& row : optimizer_table()) {
    items.push_back({row.name, row.summary, row.unavailable});
  }
  return items;
}

// Returns a row of the table, also of an unavailable optimizer, or the row of a plugin.
OptimizerRow get_row(const std::string& name) {
  const bool listed = std::ranges::count(optimizer_table(), name, &OptimizerRow::name) > 0;
  return listed ? find_optimizer(name) : load_optimizer(name);
}

std::string format_heading(const OptimizerRow& row, const Style& style, int width) {
  const std::string name = sanitize(row.name);
  const int indent = static_cast<int>(name.size()) + 2;
  const auto lines = wrap_words(sanitize(row.summary), std::max(width - indent, indent));
  return style.bold(name) + ": " + join(lines, "\n" + std::string(name.size() + 2, ' ')) + "\n";
}

std::string format_facts(const OptimizerRow& row, const Style& style, int width) {
  Table facts({{"", false}, {"", false, true}});
  if (!row.unavailable.empty()) {
    facts.add_row({"Not available", sanitize(row.unavailable)});
  }
  const std::vector<std::string> required = list_requirements(row);
  facts.add_row({"Problem", required.empty() ? "any" : "one with " + join(required, " and ")});
  if (row.limits.evaluations > 0) {
    facts.add_row({"Budget", fmt::format("at most {} evaluations; for more use {}",
                                         row.limits.evaluations, row.limits.alternative)});
  }
  facts.add_row(
      {"Schedules",
       row.capabilities.generations
           ? "fresh:K (new training cases every generation), growing:K:FACTOR, coevolution:K "
             "and fixed:K"
           : "fixed:K only"});
  facts.add_row({"Runs", describe_isolation(row)});
  if (!row.backend.empty()) {
    facts.add_row({"Library", row.backend});
  }
  if (!row.tuned_on.empty()) {
    facts.add_row(
        {"Defaults", "some were chosen on " + join(row.tuned_on, ", ") + ": " + row.tuning});
  }
  facts.add_row({"Source", sanitize(row.source)});
  return facts.format(style, 2, width);
}

std::string format_capabilities(const OptimizerRow& row, const Style& style, int width) {
  Table table({{"capability", false}, {"", false}, {"what that means", false, true}});
  for (const CapabilityRow& capability : kCapabilityTable) {
    table.add_row({capability.name, row.capabilities.*capability.member ? "yes" : "no",
                   describe_capability(row, capability)});
  }
  return table.format(style, 0, width);
}

std::string format_options(const OptimizerRow& row, const Style& style, int width) {
  if (row.options.empty()) {
    return "It has no options.\n";
  }
  Table table({{"option (for --opt)", false},
               {"default", false},
               {"allowed", false, true},
               {"meaning", false, true}});
  for (const OptionSpec& option : row.options) {
    const std::string range = describe_range(option);
    const std::string type = get_option_type(option.fallback);
    table.add_row({sanitize(option.name), sanitize(to_text(option.fallback)),
                   !option.choices.empty() ? sanitize(join(option.choices, ", "))
                   : range.empty()         ? type
                                           : type + ", " + range,
                   sanitize(option.description)});
  }
  return table.format(style, 0, width);
}

std::string format_rules(const Style& style, int width) {
  const std::filesystem::path file = find_auto_rules("");
  Table table(
      {{"rule"}, {"conditions", false, true}, {"optimizer", false, true}, {"why", false, true}});
  int number = 0;
  for (const AutoRule& rule : load_auto_rules(file)) {
    table.add_row(
        {fmt::format("{}", ++number), describe_conditions(rule), describe_used(rule), rule.why});
  }
  return table.format(style, 0, width) +
         "\nThe first rule holds whose conditions are met and whose " +
         "optimizer can work on the problem.\nThe file: " + file.string() + "\n";
}

std::string explain_optimizer(const std::string& name, const Style& style) {
  const OptimizerRow row = get_row(name);
  const int width = get_text_width(Stream::out);
  return format_heading(row, style, width) + format_facts(row, style, width) + "\n" +
         format_capabilities(row, style, width) + "\n" + format_options(row, style, width) +
         (row.name == kAutoName ? "\n" + format_rules(style, width) : "");
}

json rules_to_json() {
  json rules = json::array();
  for (const AutoRule& rule : load_auto_rules(find_auto_rules(""))) {
    json conditions = json::object();
    for (const AutoCondition& condition : rule.conditions) {
      const AutoFeature& feature = kAutoFeatures[condition.feature];
      conditions[feature.name] =
          feature.is_flag
              ? json(condition.lower != 0)
              : json{{"at_least", std::isfinite(condition.lower) ? json(condition.lower) : json()},
                     {"at_most", std::isfinite(condition.upper) ? json(condition.upper) : json()}};
    }
    rules.push_back({{"conditions", conditions},
                     {"optimizer", rule.row.name},
                     {"options", rule.options},
                     {"why", rule.why}});
  }
  return rules;
}

json to_json(const OptimizerRow& row) {
  json options = json::array();
  for (const OptionSpec& option : row.options) {
    json one = {{"name", option.name},
                {"type", get_option_type(option.fallback)},
                {"default", std::visit([](const auto& v) { return json(v); }, option.fallback)},
                {"meaning", option.description}};
    if (!option.choices.empty()) {
      one["choices"] = option.choices;
    } else if (!describe_range(option).empty()) {
      one["lower"] = option.lower;
      one["upper"] = option.upper;
    }
    options.push_back(std::move(one));
  }
  json capabilities = json::object();
  for (const CapabilityRow& capability : kCapabilityTable) {
    capabilities[capability.name] = row.capabilities.*capability.member;
  }
  json all = {
      {"name", row.name},
      {"summary", row.summary},
      {"source", row.source},
      {"unavailable", row.unavailable},
      {"library", row.backend},
      {"isolated", row.isolated},
      {"capabilities", capabilities},
      {"tuned_on", row.tuned_on},
      {"tuning", row.tuning},
      {"requirements",
       {{"objectives", row.requirements.objectives},
        {"variables", row.requirements.variables},
        {"residuals", row.requirements.residuals}}},
      {"limits", {{"variables", row.limits.variables}, {"evaluations", row.limits.evaluations}}},
      {"options", options}};
  if (row.name == kAutoName) {
    all["rules"] = rules_to_json();
  }
  return all;
}

json list_optimizers_as_json() {
  json list = json::array();
  for (const OptimizerRow& row : optimizer_table()) {
    list.push_back(to_json(row));
  }
  return list;
}

}  // namespace

ListKind make_optimizer_kind() {
  return {.name = "optimizers",
          .list = list_known_optimizers,
          .explain = explain_optimizer,
          .explain_as_json = [](const std::string& name) { return to_json(get_row(name)); },
          .list_as_json = list_optimizers_as_json,
          .explain_as_markdown =
              [](const std::string& name) {
                return name.empty() ? format_optimizer_index(optimizer_table())
                                    : format_optimizer_page(get_row(name));
              }};
}

}  // namespace armwright
