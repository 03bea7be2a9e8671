// `armwright list robots`.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <set>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/folder.hpp"
#include "base/text.hpp"
#include "cli/list/arm_picture.hpp"
#include "cli/list/list_views.hpp"
#include "cli/terminal/format.hpp"
#include "cli/terminal/table.hpp"
#include "problems/config/config_files.hpp"
#include "problems/config/plant_file.hpp"
#include "sim/proposal/workspace_proposal.hpp"
#include "sim/robot/mesh_finder.hpp"
#include "sim/robot/urdf_writer.hpp"

namespace armwright {
namespace {

using nlohmann::json;

constexpr std::size_t kUrdfLimit_bytes = std::size_t{8} << 20;  // as load_urdf()

// A robot as --robot loads it, with its friction and the plant of the file beside it. If the user
// must name a tip, the model ends at the tip with the fewest joints.
struct ListedRobot {
  std::filesystem::path file;
  RobotModel model;
  std::vector<std::string> tips;  // the possible tips if the user must name one; otherwise empty
  std::string plant_file;         // empty: there is none
};

ListedRobot load_listed(const std::string& name, const RobotRequest& request) {
  ListedRobot robot;
  robot.file = resolve_config("robots", name);
  RobotOptions options{.base = request.base, .tip = request.tip, .dynamics = true, .repair = true};
  for (const std::string& text : request.packages) {
    if (const auto package = parse_package(text)) {
      options.packages.insert(*package);
    }
  }
  try {
    robot.model = load_urdf(robot.file, options);
  } catch (const RobotOptionError& error) {
    for (const std::string& leaf : error.leaves()) {
      try {
        options.tip = leaf;
        RobotModel model = load_urdf(robot.file, options);
        if (robot.tips.empty() || model.joint_count() < robot.model.joint_count()) {
          robot.model = std::move(model);
        }
        robot.tips.push_back(leaf);
      } catch (const Error&) {  // this leaf cannot be a tip, for example if a joint mimics another
      }
    }
    if (robot.tips.empty()) {
      throw;
    }
  }
  if (const auto plant = name_plant_file(robot.file); path_exists(plant)) {
    load_plant(plant, robot.model);
    robot.plant_file = plant.string();
  }
  return robot;
}

// Returns "" if the tip is known.
std::string describe_tips(const ListedRobot& robot) {
  return robot.tips.empty()
             ? ""
             : fmt::format(" up to '{}'; name a tip: {}", sanitize(robot.model.reading.tip),
                           sanitize(join(robot.tips, ", ")));
}

std::vector<ListItem> list_robots() {
  std::vector<ListItem> items;
  for (const std::string& name : list_configs("robots")) {
    const ListedRobot robot = load_listed(name, {});
    items.push_back(
        {name, fmt::format("{} joints{}", robot.model.joint_count(), describe_tips(robot))});
  }
  return items;
}

// A posture in which the arm is drawn.
struct Posture {
  std::vector<double> q;
  bool is_home = false;  // the home that a problem gets without one of its own
};

Posture find_posture(const RobotModel& robot) {
  try {
    TrackingTask task;
    task.tool.axis = propose_tool_axis(robot);
    if (const auto place = propose_workspace(robot, task, {}, std::nullopt)) {
      return {place->home, true};
    }
  } catch (const Error&) {  // the problem says with its reason why the arm has no workspace
  }
  Posture posture;
  for (const Joint& joint : robot.joints) {
    posture.q.push_back(std::clamp(0.0, joint.lower, joint.upper));
  }
  return posture;
}

// Returns the names of the meshes that are missing, each once.
std::vector<std::string> list_missing_meshes(const ListedRobot& listed) {
  MeshFinder finder(listed.file.parent_path(), listed.model.reading.packages);
  std::set<std::string> missing;
  const auto look = [&](const Link& link) {
    for (const VisualShape& shape : link.visuals) {
      if (shape.kind == ShapeKind::mesh && !finder.find(shape.mesh_file)) {
        missing.insert(shape.mesh_file);
      }
    }
  };
  look(listed.model.base);
  std::ranges::for_each(listed.model.links, look);
  return {missing.begin(), missing.end()};
}

// Writes the file without its blemishes, if the user asked for it, and returns a line about it.
std::string write_repaired(const ListedRobot& listed, const std::string& target) {
  if (target.empty()) {
    return "";
  }
  std::error_code ignored;
  if (std::filesystem::equivalent(listed.file, target, ignored)) {
    throw Error(ErrorKind::usage,
                fmt::format("--write {}: this is the file that is read; name another one",
                            sanitize(target)));
  }
  const std::string text = read_file(listed.file, kUrdfLimit_bytes);
  if (is_mjcf(text)) {
    throw Error(ErrorKind::usage,
                fmt::format("--write {}: {} is MJCF, which is never repaired; leave --write out",
                            sanitize(target), sanitize(listed.file.string())));
  }
  std::string comment =
      listed.model.reading.repairs.empty() ? "Checked by armwright." : "Repaired by armwright:";
  for (const UrdfRepair& repair : listed.model.reading.repairs) {
    comment += "\n  " + repair.what;
  }
  write_output(target,
               apply_repairs(text, listed.file.string(), listed.model.reading.repairs, comment));
  return fmt::format(
      "  {} is the same robot without the need of repairs; its meshes are looked for "
      "from its own folder\n",
      sanitize(target));
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

bool is_assumed(const RobotModel& robot, const std::string& link) {
  return std::ranges::count(robot.reading.assumed_links, link) > 0;
}

std::string format_joints(const RobotModel& robot, const Style& style) {
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
    const Link& link = robot.links[i];
    table.add_row({sanitize(joint.name), sanitize(link.name),
                   (is_assumed(robot, link.name) ? "assumed " : "") +
                       format_significant(link.inertial.mass_kg),
                   format_position_limit(joint.kind, joint.lower),
                   format_position_limit(joint.kind, joint.upper),
                   format_limit(joint.speed_limit, slides ? "m/s" : "rad/s"),
                   format_limit(joint.effort_limit, slides ? "N" : "N m")});
  }
  return table.format(style);
}

std::string format_plant(const ListedRobot& listed) {
  if (!listed.model.has_plant()) {
    return "";
  }
  std::string text =
      fmt::format("\n  Between motors and links, as {}:\n",
                  listed.plant_file.empty()
                      ? "<dynamics> states it"
                      : fmt::format("<dynamics> and {} state it", sanitize(listed.plant_file)));
  for (const Joint& joint : listed.model.joints) {
    if (!joint.plant.is_ideal()) {
      text += fmt::format("    {}: {}\n", sanitize(joint.name), describe_plant(joint));
    }
  }
  return text;
}

std::string format_picture(const RobotModel& robot) {
  const Posture posture = find_posture(robot);
  std::string text =
      fmt::format("\n  Side view {}: # base, 1 to {} joints, * tip\n\n",
                  posture.is_home ? "at home" : "at position 0", robot.joint_count());
  for (const std::string& line : split(draw_arm(robot, posture.q), '\n')) {
    text += line.empty() ? "\n" : fmt::format("    {}\n", line);
  }
  return text;
}

std::string explain_robot(const std::string& name, const RobotRequest& request,
                          const Style& style) {
  const ListedRobot listed = load_listed(name, request);
  const RobotModel& robot = listed.model;
  double moving_kg = 0;
  for (const Link& link : robot.links) {
    moving_kg += link.inertial.mass_kg;
  }
  std::string text =
      format_title(style, robot.name, listed.file.string()) + "\n" + format_joints(robot, style);
  text +=
      fmt::format("\n  From '{}' to '{}': {} joints, {} kg move\n", sanitize(robot.reading.base),
                  sanitize(robot.reading.tip), robot.joint_count(), format_significant(moving_kg));
  if (!listed.tips.empty()) {
    text += fmt::format("  The joints{}.\n", describe_tips(listed));
  }
  text += format_plant(listed) + format_picture(robot);
  for (const UrdfRepair& repair : robot.reading.repairs) {
    text += fmt::format("  repaired: {}\n", repair.what);
  }
  for (const std::string& note : robot.notes) {
    text += fmt::format("  note: {}\n", note);
  }
  if (const auto missing = list_missing_meshes(listed); !missing.empty()) {
    text += fmt::format("  note: {}\n", describe_missing_meshes(missing.size(), missing.front()));
  }
  return text + write_repaired(listed, request.write);
}

json describe_joint(const RobotModel& robot, std::size_t number) {
  const auto finite = [](double value) {
    return std::isfinite(value) ? json(value) : json(nullptr);
  };
  const Joint& joint = robot.joints[number];
  const Link& link = robot.links[number];
  const bool slides = joint.kind == JointKind::prismatic;
  json described = {
      {"name", sanitize(joint.name)},
      {"kind", slides ? "prismatic" : "revolute"},
      {"link", sanitize(link.name)},
      {"mass_kg", link.inertial.mass_kg},
      {"mass_assumed", is_assumed(robot, link.name)},
      {slides ? "lower_m" : "lower_rad", finite(joint.lower)},
      {slides ? "upper_m" : "upper_rad", finite(joint.upper)},
      {slides ? "speed_limit_m_per_s" : "speed_limit_rad_per_s", finite(joint.speed_limit)},
      {slides ? "effort_limit_n" : "effort_limit_n_m", finite(joint.effort_limit)}};
  if (!joint.plant.is_ideal()) {
    json plant = list_plant_numbers(joint);
    if (joint.plant.is_elastic()) {
      plant["measured"] = joint.plant.measured == MeasuredSide::motor ? "motor" : "link";
    }
    if (joint.plant.unactuated) {
      plant["unactuated"] = true;
    } else if (const auto& efforts = joint.plant.counterbalance.efforts; !efforts.empty()) {
      const auto [least, most] = std::ranges::minmax(efforts);
      const char* const unit = slides ? "n" : "n_m";
      plant[fmt::format("counterbalance_least_{}", unit)] = least;
      plant[fmt::format("counterbalance_most_{}", unit)] = most;
    }
    described["plant"] = std::move(plant);
  }
  return described;
}

json list_sanitized(const std::vector<std::string>& texts) {
  json list = json::array();
  for (const std::string& text : texts) {
    list.push_back(sanitize(text));
  }
  return list;
}

json explain_robot_as_json(const std::string& name, const RobotRequest& request) {
  const ListedRobot listed = load_listed(name, request);
  const RobotModel& robot = listed.model;
  json joints = json::array();
  for (std::size_t i = 0; i < robot.joint_count(); ++i) {
    joints.push_back(describe_joint(robot, i));
  }
  json repairs = json::array();
  for (const UrdfRepair& repair : robot.reading.repairs) {
    repairs.push_back(repair.what);
  }
  const Posture posture = find_posture(robot);
  json described = {{"name", sanitize(robot.name)},
                    {"base", sanitize(robot.reading.base)},
                    {"tip", sanitize(robot.reading.tip)},
                    {"tips", list_sanitized(listed.tips)},
                    {"ends", list_sanitized(robot.reading.ends)},
                    {"joints", joints},
                    {posture.is_home ? "home" : "posture", posture.q},
                    {"repairs", repairs},
                    {"notes", robot.notes},
                    {"missing_meshes", list_sanitized(list_missing_meshes(listed))}};
  write_repaired(listed, request.write);
  return described;
}

}  // namespace

ListKind make_robot_kind(const RobotRequest& request) {
  return {"robots", list_robots,
          [request](const std::string& name, const Style& style) {
            return explain_robot(name, request, style);
          },
          [request](const std::string& name) { return explain_robot_as_json(name, request); }};
}

}  // namespace armwright
