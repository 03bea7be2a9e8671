// `armwright list controllers`.

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "cli/list/list_views.hpp"
#include "cli/terminal/table.hpp"
#include "sim/controllers/controller.hpp"

namespace armwright {
namespace {

using nlohmann::json;

const char* describe(FeedForward feed_forward) {
  switch (feed_forward) {
    case FeedForward::none:
      return "none";
    case FeedForward::gravity:
      return "gravity";
    case FeedForward::inverse_dynamics:
      return "inverse dynamics";
  }
  return "?";
}

// Returns the bounds of a gain as a decision variable.
std::string describe_bounds(const controllers::Gain& gain) {
  return gain.range == 0
             ? "start / bounds_factor to start x bounds_factor"
             : fmt::format("start +- {}{}", gain.range, gain.any_sign ? "" : ", not below 0");
}

std::string explain(const std::string& name, const Style& style) {
  const ControllerRow& row = find_controller(name);
  Table table({{"gain", false}, {"in design files", false}, {"unit", false}, {"spans", false}});
  for (const controllers::Gain& gain : row.gains) {
    table.add_row({gain.name, gain.key, gain.unit, describe_bounds(gain)});
  }
  std::string text = format_title(style, row.name, row.summary);
  text += "\n";
  for (const std::string& line : wrap_words(row.formula, get_text_width(Stream::out) - 2)) {
    text += "  " + line + "\n";
  }
  text += row.feed_forward == FeedForward::none
              ? ""
              : fmt::format("  Feed-forward: {}, computed for the problem's arm.\n",
                            describe(row.feed_forward));
  return text + "\n" + table.format(style);
}

json to_json(const ControllerRow& row) {
  json gains = json::array();
  for (const controllers::Gain& gain : row.gains) {
    gains.push_back({{"name", gain.name},
                     {"key", gain.key},
                     {"unit", gain.unit},
                     {"range", gain.range == 0 ? json(nullptr) : json(gain.range)},
                     {"any_sign", gain.any_sign}});
  }
  return {{"name", row.name},
          {"summary", row.summary},
          {"formula", row.formula},
          {"feed_forward", describe(row.feed_forward)},
          {"gains", gains}};
}

}  // namespace

ListKind make_controller_kind() {
  const auto list = [] {
    std::vector<ListItem> items;
    for (const ControllerRow& row : controller_table()) {
      items.push_back({row.name, row.summary});
    }
    return items;
  };
  const auto list_as_json = [] {
    json all = json::array();
    for (const ControllerRow& row : controller_table()) {
      all.push_back(to_json(row));
    }
    return all;
  };
  return {.name = "controllers",
          .list = list,
          .explain = explain,
          .explain_as_json = [](const std::string& name) { return to_json(find_controller(name)); },
          .list_as_json = list_as_json};
}

}  // namespace armwright
