// Designs as TOML files: the controllers' gains and the effort limits of every joint, where the
// design changes them the links (length_scale, section_scale; without them 1) and the speed
// (speed_m_per_s; without it the task's), and, for published ones, what was reported of them under
// which conditions.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/config.hpp"
#include "sim/tracking/design.hpp"

namespace armwright {

// One published evaluation of a design.
struct PublishedResult {
  std::string label;                   // "A.10 with the 20 kg load"
  std::string problem;                 // shipped problem that it was evaluated on
  std::vector<std::string> overrides;  // KEY=VALUE, on top of the problem
  std::optional<double> error_m;       // nothing: the source gives no number
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

// Reads a shipped design by name or a file by path. Error{usage} names file, line, field, value and
// what is allowed.
DesignFile load_design(std::string_view name_or_path);

// Of a table that was read already; `name` is what the design is called unless it says so itself.
DesignFile read_design(const ConfigTable& table, const std::string& name);

// The design as a file that load_design reads back bit for bit; without what was published of it.
std::string to_toml(const DesignFile& file);

}  // namespace armwright
