#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/text.hpp"
#include "cli/list_views.hpp"
#include "cli/table.hpp"
#include "optimizers/optimizer.hpp"

namespace armwright {
namespace {

using nlohmann::json;

std::vector<ListItem> list_items() {
  std::vector<ListItem> items;
  for (const OptimizerRow& row : optimizer_table()) {
    items.push_back(
        {row.name, row.unavailable.empty() ? row.summary : row.summary + " (not available)"});
  }
  return items;
}

// A row of the table, available or not, or a plugin.
OptimizerRow get_row(const std::string& name) {
  const bool listed = std::ranges::count(optimizer_table(), name, &OptimizerRow::name) > 0;
  return listed ? find_optimizer(name) : load_optimizer(name);
}

const char* get_type(const OptionValue& value) {
  constexpr const char* kNames[] = {"true or false", "integer", "number", "text"};
  return kNames[value.index()];
}

std::string describe_range(const OptionSpec& option) {
  if (!option.choices.empty()) {
    return join(option.choices, ", ");
  }
  const bool number = std::holds_alternative<double>(option.fallback) ||
                      std::holds_alternative<std::int64_t>(option.fallback);
  return number ? fmt::format("{} to {}", option.lower, option.upper) : "";
}

std::vector<std::pair<std::string, bool>> list_capabilities(const Capabilities& c) {
  return {{"bounds", c.bounds},
          {"constraints", c.constraints},
          {"multi_objective", c.multi_objective},
          {"batch", c.batch},
          {"noisy", c.noisy},
          {"residuals", c.residuals},
          {"stochastic", c.stochastic},
          {"generations", c.generations},
          {"local", c.local},
          {"sampling", c.sampling},
          {"paced", c.paced}};
}

std::string explain_optimizer(const std::string& name, const Style& style) {
  const OptimizerRow row = get_row(name);
  std::string text = format_title(style, row.name, row.summary);
  text += fmt::format("  Source: {}\n", row.source);
  if (!row.unavailable.empty()) {
    text += fmt::format("  Not available: {}\n", row.unavailable);
  }
  std::vector<std::string> able;
  std::vector<std::string> unable;
  for (const auto& [capability, has] : list_capabilities(row.capabilities)) {
    (has ? able : unable).push_back(capability);
  }
  text += fmt::format("  Capabilities: {} (not: {})\n", join(able, ", "), join(unable, ", "));
  text += row.capabilities.generations
              ? "  Schedules: fresh:K (new training cases every generation) and fixed:K\n\n"
              : "  Schedules: fixed:K only\n\n";
  if (row.options.empty()) {
    return text + "It has no options.\n";
  }
  Table table({{"option (for --opt)", false},
               {"type", false},
               {"default", false},
               {"allowed", false},
               {"meaning", false}});
  for (const OptionSpec& option : row.options) {
    table.add_row({option.name, get_type(option.fallback), to_text(option.fallback),
                   describe_range(option), option.description});
  }
  return text + table.format(style);
}

json explain_optimizer_as_json(const std::string& name) {
  const OptimizerRow row = get_row(name);
  json options = json::array();
  for (const OptionSpec& option : row.options) {
    json one = {{"name", option.name},
                {"type", get_type(option.fallback)},
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
  for (const auto& [capability, has] : list_capabilities(row.capabilities)) {
    capabilities[capability] = has;
  }
  return {{"name", row.name},
          {"summary", row.summary},
          {"source", row.source},
          {"unavailable", row.unavailable},
          {"capabilities", capabilities},
          {"options", options}};
}

}  // namespace

ListKind make_optimizer_kind() {
  return {"optimizers", list_items, explain_optimizer, explain_optimizer_as_json};
}

}  // namespace armwright
