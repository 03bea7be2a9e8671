// All kinds of things, and those whose items are only a name and a sentence.

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/text.hpp"
#include "cli/list/list_views.hpp"
#include "sim/tracking/reference_signal.hpp"

namespace armwright {
namespace {

using nlohmann::json;

// Makes a kind whose items have only a name and a summary.
ListKind make_plain_kind(const std::string& name, std::vector<ListItem> (*list)()) {
  const std::string what = name.substr(0, name.size() - 1);  // "engines" -> "engine"
  const auto find = [what, name, list](const std::string& wanted) {
    std::vector<std::string> names;
    for (const ListItem& item : list()) {
      if (item.name == wanted) {
        return item;
      }
      names.push_back(item.name);
    }
    throw Error(ErrorKind::usage, describe_unknown(what, wanted, names, "armwright list " + name));
  };
  const auto explain = [find](const std::string& wanted, const Style& style) {
    const ListItem item = find(wanted);
    return format_title(style, item.name, item.summary);
  };
  const auto explain_as_json = [find](const std::string& wanted) {
    const ListItem item = find(wanted);
    return json{{"name", item.name}, {"summary", item.summary}};
  };
  return {name, list, explain, explain_as_json};
}

std::vector<ListItem> list_signals() {
  // In the order of signal_names(). The formulas are with the signals in sim/tracking.
  constexpr const char* kMeanings[] = {
      "the target jumps to the next point at once, and counts as reached after distance / speed",
      "constant speed",
      "constant acceleration, constant speed, constant deceleration",
      "acceleration during half of the time, deceleration during the other half",
      "the speed rises linearly to 2.5 times the average in 0.4 of the time, then decays "
      "quadratically",
  };
  std::vector<ListItem> items;
  for (std::size_t i = 0; i < signal_names().size(); ++i) {
    items.push_back({signal_names()[i], i < std::size(kMeanings) ? kMeanings[i] : ""});
  }
  return items;
}

}  // namespace

std::vector<ListKind> list_kinds(const std::string& program, const RobotRequest& robot) {
  return {make_problem_kind(),
          make_optimizer_kind(),
          make_robot_kind(robot),
          make_engine_kind(),
          make_design_kind(),
          make_study_kind(program),
          make_plain_kind("signals", list_signals),
          make_controller_kind(),
          make_setting_kind()};
}

std::vector<std::string> list_kind_names() {
  std::vector<std::string> names;
  for (const ListKind& kind : list_kinds()) {
    names.push_back(kind.name);
  }
  return names;
}

std::string format_title(const Style& style, const std::string& name, const std::string& summary) {
  return style.bold(sanitize(name)) + (summary.empty() ? "" : ": " + sanitize(summary)) + "\n";
}

}  // namespace armwright
