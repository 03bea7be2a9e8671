// A log as its file has it, between the readers of the formats and the checks.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "problems/logs/motion_log.hpp"

namespace armwright {

enum class LogQuantity { position, velocity, effort, link_position, reference };
inline constexpr std::array<const char*, 5> kQuantityNames = {"position", "velocity", "effort",
                                                              "link_position", "reference"};

// One quantity of one joint in SI units, at the joint's side of the gear.
struct RecordedColumn {
  std::string name;  // in the file, for messages
  LogQuantity quantity = LogQuantity::position;
  Eigen::Index joint = 0;
  double factor = 1;           // from the file's unit and side of the gear to `values`
  std::vector<double> values;  // NaN where the file has no finite number
};

struct Recording {
  std::string file;
  std::string topic;          // of a bag; empty for a table
  std::size_t first_row = 1;  // the line of a table, or the message of a topic, of the first sample
  std::string time_name;
  std::vector<double> times_s;
  std::vector<RecordedColumn> columns;  // the time's not among them
  std::vector<std::string> notes;

  // Returns the place of a sample for the beginning of a message: "log.csv:17" or "bag.mcap, message
  // 17 of /joint_states".
  std::string locate(std::size_t sample) const;
  // Returns "line 17" or "message 17".
  std::string name_row(std::size_t sample) const;
};

// Return a name from a file or a value for a message: printable, short and quoted.
std::string quote_name(std::string_view name);
// Returns the names for a message, at most 40 of them.
std::string list_quoted(const std::vector<std::string>& names);

}  // namespace armwright
