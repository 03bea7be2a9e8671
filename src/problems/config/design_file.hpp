// Designs as TOML files. A design has the controllers' gains and the effort limits of every joint.
// If it changes the robot it has the scales of links (length_scale, section_scale; default 1), and
// if it changes the task the speed (speed_m_per_s; default: the task's). Files of published designs
// also have the results that were reported for them, each with its conditions.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/setting.hpp"
#include "sim/robot/robot_model.hpp"
#include "sim/tracking/design.hpp"

namespace armwright {

// One published evaluation of a design.
struct PublishedResult {
  std::string label;                   // "A.10 with the 20 kg load"
  std::string problem;                 // the shipped problem of the evaluation
  std::vector<std::string> overrides;  // KEY=VALUE texts, applied to the problem
  std::optional<double> error_m;       // empty: the source gives no number
  std::optional<double> total_torque_n_m;
  std::string where;  // "thesis, Fig. 6.13"
};

struct DesignFile {
  std::string name;
  std::string title;
  std::string source;
  std::vector<std::string> joint_names;
  ArmDesign design;
  std::vector<PublishedResult> published;
};

// Returns the file of a design for a robot, without name, title and source.
DesignFile make_design_file(const RobotModel& robot, ArmDesign design);
// Reads a shipped design by name, or a file by path. Throws Error{bad_data} that names file, line,
// field, value and what is allowed, Error{usage} for an unknown name, Error{io} for a file that
// cannot be read.
DesignFile load_design(std::string_view name_or_path);

// Returns the design as a file that load_design() reads back bit for bit, without what was
// published about it.
std::string to_toml(const DesignFile& file);

// Returns the declarations of every setting of a design's file, with the gains of all controllers.
const SettingTable& design_settings();

}  // namespace armwright
