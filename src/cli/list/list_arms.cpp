// `armwright list robots` and `list designs`.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "base/error.hpp"
#include "base/folder.hpp"
#include "base/text.hpp"
#include "cli/list/list_views.hpp"
#include "cli/terminal/format.hpp"
#include "cli/terminal/table.hpp"
#include "cli/views/result_view.hpp"
#include "problems/config/config_files.hpp"
#include "problems/config/design_file.hpp"
#include "problems/config/plant_file.hpp"
#include "sim/robot/robot_model.hpp"

namespace armwright {
namespace {

using nlohmann::json;

// A robot as --robot loads it, with its friction and the plant of the file beside it. If the user
// must name a tip, the model ends at the tip with the fewest joints.
struct ListedRobot {
  RobotModel model;
  std::vector<std::string> tips;  // the possible tips if the user must name one; otherwise empty
  std::string tip;                // the tip at which the model ends
  std::string plant_file;         // empty: there is none
};

ListedRobot load_listed(const std::filesystem::path& file) {
  ListedRobot robot;
  try {
    robot.model = load_urdf(file, {.dynamics = true});
  } catch (const RobotOptionError& error) {
    for (const std::string& leaf : error.leaves()) {
      try {
        RobotModel model = load_urdf(file, {.tip = leaf, .dynamics = true});
        if (robot.tips.empty() || model.joint_count() < robot.model.joint_count()) {
          robot.model = std::move(model);
          robot.tip = leaf;
        }
        robot.tips.push_back(leaf);
      } catch (const Error&) {  // this leaf cannot be a tip, for example if a joint mimics another
      }
    }
    if (robot.tips.empty()) {
      throw;
    }
  }
  if (const auto plant = name_plant_file(file); path_exists(plant)) {
    load_plant(plant, robot.model);
    robot.plant_file = plant.string();
  }
  return robot;
}

std::string describe_tips(const ListedRobot& robot) {
  return robot.tips.empty() ? ""
                            : fmt::format(" up to '{}'; name a tip: {}", sanitize(robot.tip),
                                          sanitize(join(robot.tips, ", ")));
}

std::vector<ListItem> list_robots() {
  std::vector<ListItem> items;
  for (const std::string& name : list_configs("robots")) {
    const ListedRobot robot = load_listed(resolve_config("robots", name));
    items.push_back(
        {name, fmt::format("{} joints{}", robot.model.joint_count(), describe_tips(robot))});
  }
  return items;
}

std::string format_limit(double value, std::string_view unit) {
  return std::isinf(value) ? "none" : fmt::format("{} {}", format_significant(value), unit);
}

std::string format_position_limit(JointKind kind, double value) {
  if (kind == JointKind::prismatic || std::isinf(value)) {
    return format_limit(value, "m");
  }
  return fmt::format("{:.1f} deg", value * 180 / std::numbers::pi);
}

std::string explain_robot(const std::string& name, const Style& style) {
  const auto file = resolve_config("robots", name);
  const ListedRobot listed = load_listed(file);
  const RobotModel& robot = listed.model;
  Table table({{"joint", false},
               {"moves", false},
               {"mass kg"},
               {"lower"},
               {"upper"},
               {"speed"},
               {"effort"}});
  for (std::size_t i = 0; i < robot.joint_count(); ++i) {
    const Joint& joint = robot.joints[i];
    const bool slides = joint.kind == JointKind::prismatic;
    table.add_row({sanitize(joint.name), sanitize(robot.links[i].name),
                   format_significant(robot.links[i].inertial.mass_kg),
                   format_position_limit(joint.kind, joint.lower),
                   format_position_limit(joint.kind, joint.upper),
                   format_limit(joint.speed_limit, slides ? "m/s" : "rad/s"),
                   format_limit(joint.effort_limit, slides ? "N" : "N m")});
  }
  std::string text = format_title(style, robot.name, file.string()) + "\n" + table.format(style);
  if (!listed.tips.empty()) {
    text += fmt::format("\n  The joints{}.\n", describe_tips(listed));
  }
  if (robot.has_plant()) {
    text += fmt::format("\n  Between motors and links, as {}:\n",
                        listed.plant_file.empty() ? "<dynamics> states it"
                                                  : fmt::format("<dynamics> and {} state it",
                                                                sanitize(listed.plant_file)));
    for (const Joint& joint : robot.joints) {
      if (!joint.plant.is_ideal()) {
        text += fmt::format("    {}: {}\n", sanitize(joint.name), describe_plant(joint));
      }
    }
  }
  for (const std::string& note : robot.notes) {
    text += fmt::format("  note: {}\n", note);
  }
  return text;
}

json explain_robot_as_json(const std::string& name) {
  const ListedRobot listed = load_listed(resolve_config("robots", name));
  const RobotModel& robot = listed.model;
  const auto finite = [](double value) {
    return std::isfinite(value) ? json(value) : json(nullptr);
  };
  json joints = json::array();
  for (std::size_t i = 0; i < robot.joint_count(); ++i) {
    const Joint& joint = robot.joints[i];
    const bool slides = joint.kind == JointKind::prismatic;
    json described = {
        {"name", sanitize(joint.name)},
        {"kind", slides ? "prismatic" : "revolute"},
        {"link", sanitize(robot.links[i].name)},
        {"mass_kg", robot.links[i].inertial.mass_kg},
        {slides ? "lower_m" : "lower_rad", finite(joint.lower)},
        {slides ? "upper_m" : "upper_rad", finite(joint.upper)},
        {slides ? "speed_limit_m_per_s" : "speed_limit_rad_per_s", finite(joint.speed_limit)},
        {slides ? "effort_limit_n" : "effort_limit_n_m", finite(joint.effort_limit)}};
    if (!joint.plant.is_ideal()) {
      json plant = list_plant_numbers(joint);
      if (joint.plant.is_elastic()) {
        plant["measured"] = joint.plant.measured == MeasuredSide::motor ? "motor" : "link";
      }
      if (const auto& efforts = joint.plant.counterbalance.efforts; !efforts.empty()) {
        const auto [least, most] = std::ranges::minmax(efforts);
        const char* const unit = slides ? "n" : "n_m";
        plant[fmt::format("counterbalance_least_{}", unit)] = least;
        plant[fmt::format("counterbalance_most_{}", unit)] = most;
      }
      described["plant"] = std::move(plant);
    }
    joints.push_back(std::move(described));
  }
  json tips = json::array();
  for (const std::string& tip : listed.tips) {
    tips.push_back(sanitize(tip));
  }
  return {{"name", sanitize(robot.name)},
          {"joints", joints},
          {"tip", listed.tips.empty() ? json(nullptr) : json(sanitize(listed.tip))},
          {"tips", tips},
          {"notes", robot.notes}};
}

std::vector<ListItem> list_designs() {
  std::vector<ListItem> items;
  for (const std::string& name : list_configs("designs")) {
    items.push_back({name, load_design(name).title});
  }
  return items;
}

std::string explain_design(const std::string& name, const Style& style) {
  const DesignFile file = load_design(name);
  std::string text = format_title(style, file.name, file.title);
  text += file.source.empty() ? "" : fmt::format("  Source: {}\n", sanitize(file.source));
  text += fmt::format("\n{}", format_design(file, style));
  if (!file.published.empty()) {
    Table table({{"published as", false},
                 {"problem", false},
                 {"with", false},
                 {"error mm"},
                 {"where", false}});
    for (const PublishedResult& published : file.published) {
      table.add_row({sanitize(published.label), sanitize(published.problem),
                     sanitize(join(published.overrides, " ")), format_mm(published.error_m),
                     sanitize(published.where)});
    }
    text += fmt::format("\n{}", table.format(style));
  }
  return text;
}

json explain_design_as_json(const std::string& name) {
  const DesignFile file = load_design(name);
  const ControllerRow& controller = find_controller(file.design.controller);
  json joints = json::array();
  for (std::size_t i = 0; i < file.design.joints.size(); ++i) {
    const JointDrive& drive = file.design.joints[i];
    json joint = {{"name", sanitize(file.joint_names.at(i))},
                  {"effort_min_n_m", drive.limits.min},
                  {"effort_max_n_m", drive.limits.max}};
    for (std::size_t g = 0; g < drive.gains.size(); ++g) {
      joint[controller.gains[g].key] = drive.gains[g];
    }
    joints.push_back(std::move(joint));
  }
  json published = json::array();
  for (const PublishedResult& result : file.published) {
    published.push_back({{"label", sanitize(result.label)},
                         {"problem", sanitize(result.problem)},
                         {"error_m", result.error_m ? json(*result.error_m) : json(nullptr)},
                         {"where", sanitize(result.where)}});
  }
  return {{"name", sanitize(file.name)},
          {"title", sanitize(file.title)},
          {"source", sanitize(file.source)},
          {"controller", file.design.controller},
          {"total_torque_n_m", calc_total_effort(file.design)},
          {"joints", joints},
          {"published", published}};
}

}  // namespace

ListKind make_robot_kind() {
  return {"robots", list_robots, explain_robot, explain_robot_as_json};
}

ListKind make_design_kind() {
  return {"designs", list_designs, explain_design, explain_design_as_json};
}

}  // namespace armwright
