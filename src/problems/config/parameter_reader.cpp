#include "problems/config/parameter_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>

#include "base/text.hpp"

namespace armwright {

std::vector<DesignParameter> read_parameters(const ConfigTable& table,
                                             const TrackingConfig& config) {
  const ControllerRow& controller = find_controller(config.start.controller);
  std::vector<std::string> valid;
  for (const controllers::Gain& gain : controller.gains) {
    valid.push_back(gain.name);
  }
  const std::vector<std::string> gains = valid;
  valid.insert(valid.end(), {"effort_min", "effort_max"});
  const std::vector<std::string> drives = valid;
  valid.insert(valid.end(), {"length_scale", "section_scale"});
  const auto read_names = [&](const ConfigTable& where) {
    std::vector<std::string> names;
    for (const std::string& name : where.get_strings("optimize")) {
      if (name == "gains") {  // all of them, whatever the controller
        names.insert(names.end(), gains.begin(), gains.end());
      } else {
        names.push_back(name);
      }
    }
    for (auto name = names.begin(); name != names.end(); ++name) {
      if (std::find(valid.begin(), valid.end(), *name) == valid.end()) {
        where.refuse("optimize", describe_unknown("design parameter", *name, valid));
      }
      if (std::find(names.begin(), name, *name) != name) {
        where.refuse("optimize", fmt::format("'{}' stands there twice; name it once", *name));
      }
    }
    return names;
  };
  const std::size_t joints = config.robot.joint_count();
  std::vector<std::vector<std::string>> chosen(joints,
                                               table.has("optimize") ? read_names(table) : drives);
  std::vector<std::string> joint_names;
  for (const Joint& joint : config.robot.joints) {
    joint_names.push_back(joint.name);
  }
  std::vector<std::string> named;
  for (const ConfigTable& joint : table.get_tables_or_empty("joint")) {
    const std::string name = joint.get_choice("name", joint_names);
    if (std::find(named.begin(), named.end(), name) != named.end()) {
      joint.refuse("name", "another [[variables.joint]] has that name; put them together");
    }
    named.push_back(name);
    const auto found = std::find(joint_names.begin(), joint_names.end(), name);
    chosen[static_cast<std::size_t>(found - joint_names.begin())] = read_names(joint);
  }
  std::vector<DesignParameter> parameters;
  for (std::size_t joint = 0; joint < joints; ++joint) {
    for (std::size_t i = 0; i < valid.size(); ++i) {
      if (std::find(chosen[joint].begin(), chosen[joint].end(), valid[i]) == chosen[joint].end()) {
        continue;
      }
      DesignParameter parameter;
      parameter.joint = joint;
      constexpr std::array kOthers = {
          DesignParameter::Kind::effort_min, DesignParameter::Kind::effort_max,
          DesignParameter::Kind::length_scale, DesignParameter::Kind::section_scale};
      parameter.kind = i < gains.size() ? DesignParameter::Kind::gain : kOthers[i - gains.size()];
      parameter.gain = i;
      parameters.push_back(parameter);
    }
  }
  if (table.has("task")) {
    const auto names = table.get_strings("task");
    if (names != std::vector<std::string>{"speed"}) {
      table.refuse("task", "the task has one variable; write [\"speed\"] or leave it out");
    }
    DesignParameter speed;
    speed.kind = DesignParameter::Kind::speed;
    parameters.push_back(speed);
  }
  if (parameters.empty()) {
    table.refuse("optimize", "at least one design parameter of one joint must be optimized");
  }
  return parameters;
}

}  // namespace armwright
