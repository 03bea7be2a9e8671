// The units that columns of a log can have.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "problems/logs/recording.hpp"

namespace armwright {

enum class UnitKind { angle, length, angle_rate, length_rate, torque, force, time };

struct LogUnit {
  std::string_view spelling;  // as normalize_name() makes it
  UnitKind kind;
  double factor;  // to SI
  const char* name;
};

// Returns the name in small letters, with one underscore in place of any blanks and marks.
std::string normalize_name(std::string_view name);

// Returns all units; longer spellings stand before those that they end with.
std::span<const LogUnit> list_log_units();
// Returns the unit in any spelling: "deg", "rad/s", "N m"; nullptr if it is unknown.
const LogUnit* find_log_unit(std::string_view text);

// Returns the kind of unit that the quantity of a joint has.
UnitKind get_unit_kind(LogQuantity quantity, JointKind joint, bool is_motor);
// Returns the names of the units of this kind for a message.
std::string list_unit_names(UnitKind kind);

}  // namespace armwright
