#include "problems/logs/log_units.hpp"

#include <algorithm>
#include <numbers>
#include <vector>

#include "base/text.hpp"

namespace armwright {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180;

// Longer spellings stand before those that they end with.
constexpr LogUnit kKnownUnits[] = {
    {"rad_per_s", UnitKind::angle_rate, 1, "rad/s"},
    {"deg_per_s", UnitKind::angle_rate, kRadPerDeg, "deg/s"},
    {"mm_per_s", UnitKind::length_rate, 1e-3, "mm/s"},
    {"m_per_s", UnitKind::length_rate, 1, "m/s"},
    {"rad", UnitKind::angle, 1, "rad"},
    {"deg", UnitKind::angle, kRadPerDeg, "deg"},
    {"n_m", UnitKind::torque, 1, "N m"},
    {"nm", UnitKind::torque, 1, "N m"},
    {"mm", UnitKind::length, 1e-3, "mm"},
    {"m", UnitKind::length, 1, "m"},
    {"n", UnitKind::force, 1, "N"},
    {"ns", UnitKind::time, 1e-9, "ns"},
    {"us", UnitKind::time, 1e-6, "us"},
    {"ms", UnitKind::time, 1e-3, "ms"},
    {"s", UnitKind::time, 1, "s"},
};

}  // namespace

std::string normalize_name(std::string_view name) {
  std::string normal;
  for (const char c : name) {
    const bool is_mark = std::string_view(" \t./:-_").find(c) != std::string_view::npos;
    if (!is_mark) {
      normal += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    } else if (!normal.empty() && normal.back() != '_') {
      normal += '_';
    }
  }
  while (normal.ends_with('_')) {
    normal.pop_back();
  }
  return normal;
}

std::span<const LogUnit> list_log_units() {
  return kKnownUnits;
}

const LogUnit* find_log_unit(std::string_view text) {
  std::string spelling = normalize_name(text);
  const std::size_t slash = text.find('/');
  if (slash != std::string_view::npos) {
    spelling =
        normalize_name(text.substr(0, slash)) + "_per_" + normalize_name(text.substr(slash + 1));
  }
  const auto* found = std::ranges::find(kKnownUnits, spelling, &LogUnit::spelling);
  return found == std::end(kKnownUnits) ? nullptr : found;
}

UnitKind get_unit_kind(LogQuantity quantity, JointKind joint, bool is_motor) {
  const bool turns = joint == JointKind::revolute;
  if (quantity == LogQuantity::velocity) {
    return turns ? UnitKind::angle_rate : UnitKind::length_rate;
  }
  if (quantity == LogQuantity::effort) {
    return turns || is_motor ? UnitKind::torque : UnitKind::force;
  }
  return turns ? UnitKind::angle : UnitKind::length;
}

std::string list_unit_names(UnitKind kind) {
  std::vector<std::string> names;
  for (const LogUnit& unit : kKnownUnits) {
    if (unit.kind == kind && (names.empty() || names.back() != unit.name)) {
      names.emplace_back(unit.name);
    }
  }
  return join(names, ", ");
}

}  // namespace armwright
