// A robot with two turning joints and a sliding one, and a motion of it whose derivatives are known.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "base/expect_error.hpp"
#include "problems/logs/motion_log.hpp"

namespace armwright {

inline RobotModel make_log_robot() {
  std::string links = "<link name='base'/>", joints;
  const auto add = [&](const char* link, const char* joint) {
    links += fmt::format(
        "<link name='{}'><inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' "
        "ixz='0' iyz='0'/></inertial></link>",
        link);
    joints += joint;
  };
  add("upper",
      "<joint name='shoulder' type='revolute'><parent link='base'/><child link='upper'/>"
      "<limit lower='-2.5' upper='2.5' velocity='9' effort='900'/></joint>");
  add("fore",
      "<joint name='elbow' type='revolute'><parent link='upper'/><child link='fore'/>"
      "<limit lower='-1' upper='2' velocity='9' effort='900'/></joint>");
  add("tool",
      "<joint name='lift' type='prismatic'><parent link='fore'/><child link='tool'/>"
      "<limit lower='0' upper='0.5' velocity='2' effort='900'/></joint>");
  return parse_urdf("<robot name='log'>" + links + joints + "</robot>", "log.urdf");
}

// offset + amplitude sin(2 pi f t + phase), and its derivatives.
struct Swing {
  double offset, amplitude, frequency_hz, phase;
  double position(double t_s) const { return offset + amplitude * std::sin(angle(t_s)); }
  double rate(double t_s) const { return amplitude * omega() * std::cos(angle(t_s)); }
  double acceleration(double t_s) const {
    return -amplitude * omega() * omega() * std::sin(angle(t_s));
  }
  double omega() const { return 2 * std::numbers::pi * frequency_hz; }
  double angle(double t_s) const { return omega() * t_s + phase; }
};

inline constexpr Swing kSwings[] = {
    {0.1, 0.9, 0.5, 0.2}, {0.4, 0.7, 0.7, 1.1}, {0.25, 0.2, 0.4, 2.0}};
inline constexpr double kLogPeriod_s = 0.004;

// A table with a column per quantity.
struct LogTable {
  std::vector<std::string> names;
  std::vector<std::vector<double>> columns;

  std::vector<double>& at(const std::string& name) {
    return columns.at(static_cast<std::size_t>(std::ranges::find(names, name) - names.begin()));
  }
  void rename(const std::string& from, const std::string& to) {
    *std::ranges::find(names, from) = to;
  }
  void remove(const std::string& name) {
    const auto place = std::ranges::find(names, name) - names.begin();
    names.erase(names.begin() + place);
    columns.erase(columns.begin() + place);
  }
  void scale(const std::string& name, double factor) {
    for (double& value : at(name)) {
      value *= factor;
    }
  }
  std::string to_csv(char separator = ',') const {
    std::string text;
    for (std::size_t i = 0; i < names.size(); ++i) {
      text += (i == 0 ? "" : std::string(1, separator)) + names[i];
    }
    text += '\n';
    for (std::size_t row = 0; row < columns.front().size(); ++row) {
      for (std::size_t i = 0; i < names.size(); ++i) {
        text += (i == 0 ? "" : std::string(1, separator)) + fmt::format("{:.12g}", columns[i][row]);
      }
      text += '\n';
    }
    return text;
  }
};

// Columns time_s, position_N_U, velocity_N_U, effort_N_U of `count` samples.
inline LogTable make_log_table(std::size_t count = 1001) {
  LogTable table;
  const auto add = [&](const std::string& name, const auto& calc) {
    table.names.push_back(name);
    table.columns.emplace_back();
    for (std::size_t i = 0; i < count; ++i) {
      table.columns.back().push_back(calc(static_cast<double>(i) * kLogPeriod_s));
    }
  };
  add("time_s", [](double t_s) { return t_s; });
  const char* const units[] = {"rad", "rad", "m"};
  for (std::size_t j = 0; j < 3; ++j) {
    add(fmt::format("position_{}_{}", j + 1, units[j]),
        [&](double t_s) { return kSwings[j].position(t_s); });
  }
  for (std::size_t j = 0; j < 3; ++j) {
    add(fmt::format("velocity_{}_{}_per_s", j + 1, units[j]),
        [&](double t_s) { return kSwings[j].rate(t_s); });
  }
  for (std::size_t j = 0; j < 3; ++j) {
    add(fmt::format("effort_{}_{}", j + 1, j == 2 ? "n" : "n_m"), [&](double t_s) {
      return 30 * kSwings[j].acceleration(t_s) + 20 * kSwings[j].position(t_s);
    });
  }
  return table;
}

inline MotionLog parse_table(const LogTable& table, const LogOptions& options = {}) {
  return parse_log(table.to_csv(), "log.csv", make_log_robot(), options);
}

inline std::string refuse_table(const LogTable& table, const LogOptions& options = {}) {
  return error_of(ErrorKind::bad_data, [&] { parse_table(table, options); });
}

}  // namespace armwright
