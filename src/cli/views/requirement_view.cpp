#include "cli/views/requirement_view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/text.hpp"
#include "cli/terminal/format.hpp"
#include "cli/terminal/table.hpp"

namespace armwright {
namespace {

using nlohmann::json;

// Returns a share in percent, and any other value with its unit.
std::string format_required_value(double value, const std::string& unit) {
  return unit == "1" ? format_significant(100 * value) + " %" : format_quantity(value, unit);
}

std::string format_grade(const JudgedRequirement& judged, const Style& style) {
  std::string word;
  switch (judged.grade) {
    case RequirementGrade::met:
      word = style.green("met");
      break;
    case RequirementGrade::tight:
      word = style.yellow("met, within 10 % of the limit");
      break;
    case RequirementGrade::missed:
      word = style.red("MISSED");
      break;
    case RequirementGrade::unknown:
      word = judged.value ? "not shown: a case has no number" : "not measured";
      break;
  }
  return word + (judged.binds ? "; this limit binds" : "");
}

// "case 12, point 3" or "case 7, joint_2"
std::string format_place(const ShownRequirement& one) {
  std::vector<std::string> parts;
  if (one.worst_case) {
    parts.push_back(fmt::format("case {}", *one.worst_case));
  }
  if (one.worst_point) {
    parts.push_back(fmt::format("point {}", *one.worst_point));
  }
  if (one.worst_joint) {
    parts.push_back(sanitize(*one.worst_joint));
  }
  return join(parts, ", ");
}

}  // namespace

std::vector<ShownRequirement> judge_evaluation(const TrackingProblem& problem,
                                               const DesignEvaluation& evaluation) {
  const auto& requirements = problem.description().requirements;
  std::vector<std::optional<double>> values(requirements.size());
  std::vector<ShownRequirement> shown(requirements.size());
  for (std::uint64_t number = 0; number < evaluation.results.size(); ++number) {
    if (!get_error(evaluation.results[number])) {
      continue;
    }
    for (std::size_t i = 0; i < requirements.size(); ++i) {
      const RequiredValue& required = evaluation.required[number][i];
      if (!required.value || (values[i] && *required.value <= *values[i])) {
        continue;
      }
      values[i] = required.value;
      shown[i].worst_case = number;
      shown[i].worst_point = required.point;
      shown[i].worst_joint.reset();
      if (required.joint) {
        shown[i].worst_joint = problem.config().robot.joints[*required.joint].name;
      }
    }
  }
  const auto judged =
      judge_requirements(requirements, values, evaluation.summary.without_number == 0);
  for (std::size_t i = 0; i < judged.size(); ++i) {
    shown[i].judged = judged[i];
  }
  return shown;
}

std::string format_requirements(std::span<const ShownRequirement> requirements,
                                const Style& style) {
  const bool has_places = std::ranges::any_of(
      requirements, [](const ShownRequirement& one) { return one.worst_case.has_value(); });
  std::vector<Column> columns = {
      {"", false}, {"use", false}, {"at most"}, {"is"}, {"of the limit"}};
  if (has_places) {
    columns.push_back({"worst in", false});
  }
  columns.push_back({"", false});  // last, as the table would count escape codes as characters
  Table table(std::move(columns));
  for (const ShownRequirement& one : requirements) {
    const JudgedRequirement& judged = one.judged;
    const Limit& limit = judged.requirement.limit;
    std::vector<std::string> cells = {
        sanitize(limit.quantity.name), judged.requirement.is_constraint ? "constraint" : "report",
        format_required_value(limit.value, limit.quantity.unit),
        judged.value ? format_required_value(*judged.value, limit.quantity.unit) : "-",
        judged.ratio ? format_significant(100 * *judged.ratio, 3) + " %" : "-"};
    if (has_places) {
      cells.push_back(format_place(one));
    }
    cells.push_back(format_grade(judged, style));
    table.add_row(std::move(cells));
  }
  return style.bold("Requirements, on the worst case") + "\n" + table.format(style, 2);
}

std::string describe_limit(const Limit& limit) {
  return format_required_value(limit.value, limit.quantity.unit);
}

json requirements_to_json(std::span<const ShownRequirement> requirements) {
  json list = json::array();
  for (const ShownRequirement& shown : requirements) {
    const JudgedRequirement& judged = shown.judged;
    const RequiredMetric& requirement = judged.requirement;
    json one = {{"name", sanitize(requirement.limit.quantity.name)},
                {"unit", requirement.limit.quantity.unit},
                {"limit", requirement.limit.value},
                {"use", requirement.is_constraint ? "constraint" : "report"},
                {"value", to_json_value(judged.value)},
                {"ratio", to_json_value(judged.ratio)},
                {"grade", to_string(judged.grade)},
                {"light", get_light(judged.grade)},
                {"binds", judged.binds},
                {"worst_case", nullptr},
                {"worst_point", nullptr},
                {"worst_joint", nullptr}};
    if (shown.worst_case) {
      one["worst_case"] = *shown.worst_case;
    }
    if (shown.worst_point) {
      one["worst_point"] = *shown.worst_point;
    }
    if (shown.worst_joint) {
      one["worst_joint"] = sanitize(*shown.worst_joint);
    }
    list.push_back(std::move(one));
  }
  return list;
}

bool is_constraint_missed(std::span<const ShownRequirement> requirements) {
  return std::ranges::any_of(requirements, [](const ShownRequirement& one) {
    return one.judged.requirement.is_constraint && one.judged.grade == RequirementGrade::missed;
  });
}

}  // namespace armwright
