#include "problems/logs/motion_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/text.hpp"
#include "problems/logs/recording.hpp"
#include "problems/logs/yaml_scalars.hpp"

namespace armwright {
namespace {

using Eigen::Index;

constexpr std::size_t kMotionLimit_bytes = std::size_t{64} << 20;
constexpr std::size_t kMostMotionValues = 5'000'000;
constexpr double kNanosecond_s = 1e-9;

const char* const kOrders[] = {"position", "velocity", "acceleration"};
const char* const kAngles[] = {"rad", "rad_per_s", "rad_per_s2"};
const char* const kLengths[] = {"m", "m_per_s", "m_per_s2"};
const char* const kLists[] = {"positions", "velocities", "accelerations"};

std::string name_column(const RobotModel& robot, std::size_t joint, int order) {
  const bool turns = robot.joints[joint].kind == JointKind::revolute;
  return fmt::format("{}_{}_{}", kOrders[order], joint + 1, (turns ? kAngles : kLengths)[order]);
}

std::string write_row(const Eigen::MatrixXd& rows, Index row, const char* format,
                      const char* separator) {
  std::string text;
  for (Index i = 0; i < rows.cols(); ++i) {
    text += (i == 0 ? "" : separator) + fmt::format(fmt::runtime(format), rows(row, i));
  }
  return text;
}

[[noreturn]] void refuse_at(const std::string& file, std::size_t line, const std::string& what) {
  throw Error(ErrorKind::bad_data, line == 0 ? fmt::format("{}: {}", file, what)
                                             : fmt::format("{}:{}: {}", file, line, what));
}

double parse_number(const std::string& file, std::size_t line, const std::string& what,
                    std::string_view text) {
  const auto value = parse_finite(text);
  if (!value) {
    refuse_at(file, line,
              fmt::format("{} is {}; it must be a finite number", what, quote_name(text)));
  }
  return *value;
}

void check_time(const std::string& file, std::size_t line, const std::vector<double>& times_s,
                double time_s) {
  if (times_s.empty() ? time_s < 0 : time_s <= times_s.back()) {
    refuse_at(file, line,
              times_s.empty() ? fmt::format("the time is {:g} s; it must be 0 or more", time_s)
                              : fmt::format("the time is {:.9g} s after {:.9g} s; times must rise",
                                            time_s, times_s.back()));
  }
}

// Makes the samples of three lists of rows, of which the last two may be empty.
MotionSamples make_samples(const std::string& file, std::size_t joints, std::vector<double> times_s,
                           const std::vector<double> (&values)[3]) {
  if (times_s.size() < 2) {
    refuse_at(file, 0,
              fmt::format("it has {} samples; a motion needs two or more", times_s.size()));
  }
  const double first_s = times_s.front();
  for (double& time_s : times_s) {
    time_s -= first_s;
  }
  MotionSamples motion{.times_s = std::move(times_s), .positions = {}};
  Eigen::MatrixXd* const parts[] = {&motion.positions, &motion.rates, &motion.accelerations};
  const auto rows = static_cast<Index>(motion.times_s.size());
  for (int order = 0; order < 3; ++order) {
    if (!values[order].empty()) {
      *parts[order] =
          Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
              values[order].data(), rows, static_cast<Index>(joints));
    }
  }
  return motion;
}

MotionSamples parse_csv(std::string_view text, const std::string& file, const RobotModel& robot,
                        bool timed) {
  const std::size_t joints = robot.joint_count();
  std::vector<double> times_s, values[3];
  std::map<std::string, std::size_t, std::less<>> columns;
  std::size_t count = 0, line_number = 0;
  bool has_order[3] = {true, true, true};
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    ++line_number;
    line = line.ends_with('\r') ? line.substr(0, line.size() - 1) : line;
    if (line.empty() || line.front() == '#') {
      continue;
    }
    const std::vector<std::string> fields = split(line, ',');
    if (columns.empty()) {
      count = fields.size();
      for (std::size_t i = 0; i < count; ++i) {
        if (!columns.emplace(fields[i], i).second) {
          refuse_at(file, line_number,
                    fmt::format("column {} stands there twice", quote_name(fields[i])));
        }
      }
      for (int order = 0; order < 3; ++order) {
        for (std::size_t joint = 0; joint < joints; ++joint) {
          has_order[order] = has_order[order] && columns.contains(name_column(robot, joint, order));
        }
      }
      if ((timed && !columns.contains("time_s")) || !has_order[0]) {
        refuse_at(file, line_number,
                  fmt::format("a motion of this robot needs the columns {}{} to {}",
                              timed ? "time_s and " : "", name_column(robot, 0, 0),
                              name_column(robot, joints - 1, 0)));
      }
      continue;
    }
    if (fields.size() != count) {
      refuse_at(file, line_number,
                fmt::format("it has {} fields, the first line has {}", fields.size(), count));
    }
    const auto time = columns.find("time_s");
    const double time_s = time == columns.end()
                              ? static_cast<double>(times_s.size())
                              : parse_number(file, line_number, "time_s", fields[time->second]);
    check_time(file, line_number, times_s, time_s);
    times_s.push_back(time_s);
    for (int order = 0; order < 3; ++order) {
      for (std::size_t joint = 0; has_order[order] && joint < joints; ++joint) {
        const std::string name = name_column(robot, joint, order);
        values[order].push_back(parse_number(file, line_number, name, fields[columns.at(name)]));
      }
    }
  }
  if (columns.empty()) {
    refuse_at(file, 0, "it is empty; a motion needs a line with the names of its columns");
  }
  return make_samples(file, joints, std::move(times_s), values);
}

MotionSamples parse_yaml(std::string_view text, const std::string& file, const RobotModel& robot) {
  const YamlScalars scalars = read_yaml_scalars(text, file, kMostMotionValues, "leave out points");
  const auto find = [&](const std::string& key) -> const YamlScalar* {
    const auto found = scalars.find(key);
    return found == scalars.end() ? nullptr : &found->second;
  };
  const std::size_t joints = robot.joint_count();
  std::vector<std::size_t> places(joints, joints);  // of the robot's joints in the file
  std::size_t named = 0;
  for (; const YamlScalar* name = find(fmt::format("joint_names.{}", named)); ++named) {
    const auto joint = std::ranges::find(robot.joints, name->text, &Joint::name);
    if (joint == robot.joints.end()) {
      refuse_at(file, name->line,
                fmt::format("joint_names has {}, which is no moving joint of the robot '{}'",
                            quote_name(name->text), sanitize(robot.name)));
    }
    places[static_cast<std::size_t>(joint - robot.joints.begin())] = named;
  }
  for (std::size_t joint = 0; joint < joints; ++joint) {
    if (places[joint] == joints || named != joints) {
      refuse_at(file, 0,
                fmt::format("joint_names must have each of the robot's {} joints once; '{}' is "
                            "missing or one is there twice",
                            joints, sanitize(robot.joints[joint].name)));
    }
  }
  std::vector<double> times_s, values[3];
  for (std::size_t point = 0;; ++point) {
    const std::string at = fmt::format("points.{}.", point);
    const YamlScalar* const sec = find(at + "time_from_start.sec");
    const YamlScalar* const nanosec = find(at + "time_from_start.nanosec");
    if (sec == nullptr) {
      if (const YamlScalar* position = find(at + "positions.0")) {
        refuse_at(file, position->line,
                  fmt::format("point {} has no time_from_start with sec and nanosec", point + 1));
      }
      break;
    }
    const double time_s =
        parse_number(file, sec->line, "sec", sec->text) +
        (nanosec == nullptr
             ? 0
             : kNanosecond_s * parse_number(file, nanosec->line, "nanosec", nanosec->text));
    check_time(file, sec->line, times_s, time_s);
    times_s.push_back(time_s);
    for (int order = 0; order < 3; ++order) {
      const bool is_there = find(fmt::format("{}{}.0", at, kLists[order])) != nullptr;
      if (order > 0 && !is_there && (point == 0 || values[order].empty())) {
        continue;
      }
      for (std::size_t joint = 0; joint < joints; ++joint) {
        const YamlScalar* const value =
            find(fmt::format("{}{}.{}", at, kLists[order], places[joint]));
        if (value == nullptr ||
            find(fmt::format("{}{}.{}", at, kLists[order], joints)) != nullptr) {
          refuse_at(file, sec->line,
                    fmt::format("point {}: {} must have {} numbers, one per joint", point + 1,
                                kLists[order], joints));
        }
        if (values[order].size() < point * joints) {
          refuse_at(file, value->line,
                    fmt::format("point {} has {}, and the points before have none", point + 1,
                                kLists[order]));
        }
        values[order].push_back(parse_number(file, value->line, kLists[order], value->text));
      }
    }
  }
  return make_samples(file, joints, std::move(times_s), values);
}

}  // namespace

std::string write_motion_csv(const RobotModel& robot, const MotionSamples& motion,
                             const Eigen::MatrixXd& efforts) {
  const Eigen::MatrixXd* const parts[] = {&motion.positions, &motion.rates, &motion.accelerations};
  std::string text = "time_s";
  for (int order = 0; order < 3; ++order) {
    for (Index joint = 0; joint < parts[order]->cols(); ++joint) {
      text += "," + name_column(robot, static_cast<std::size_t>(joint), order);
    }
  }
  for (Index joint = 0; joint < efforts.cols(); ++joint) {
    const bool turns = robot.joints[static_cast<std::size_t>(joint)].kind == JointKind::revolute;
    text += fmt::format(",expected_effort_{}_{}", joint + 1, turns ? "n_m" : "n");
  }
  text += "\n";
  for (std::size_t k = 0; k < motion.times_s.size(); ++k) {
    text += fmt::format("{:.9g}", motion.times_s[k]);
    for (const Eigen::MatrixXd* part : {parts[0], parts[1], parts[2], &efforts}) {
      if (part->cols() > 0) {
        text += "," + write_row(*part, static_cast<Index>(k), "{:.9g}", ",");
      }
    }
    text += "\n";
  }
  return text;
}

std::string write_joint_trajectory(const RobotModel& robot, const MotionSamples& motion) {
  std::string text =
      "# A trajectory_msgs/msg/JointTrajectory. The robot must stand at the first point before.\n"
      "joint_names:\n";
  for (const Joint& joint : robot.joints) {
    text += "  - " + nlohmann::json(joint.name).dump() + "\n";
  }
  text += "points:\n";
  const Eigen::MatrixXd* const parts[] = {&motion.positions, &motion.rates, &motion.accelerations};
  for (std::size_t k = 0; k < motion.times_s.size(); ++k) {
    for (int order = 0; order < 3; ++order) {
      if (parts[order]->cols() >
          0) {  // decimals, as YAML takes numbers without a point for integers
        text += fmt::format("  {} {}: [{}]\n", order == 0 ? "-" : " ", kLists[order],
                            write_row(*parts[order], static_cast<Index>(k), "{:.9f}", ", "));
      }
    }
    const auto time_ns = static_cast<std::int64_t>(std::llround(motion.times_s[k] / kNanosecond_s));
    text += fmt::format("    time_from_start: {{sec: {}, nanosec: {}}}\n", time_ns / 1'000'000'000,
                        time_ns % 1'000'000'000);
  }
  return text;
}

MotionSamples parse_motion(std::string_view text, const std::string& name, const RobotModel& robot,
                           bool timed) {
  const std::string file = sanitize(name);
  return name.ends_with(".yaml") || name.ends_with(".yml") ? parse_yaml(text, file, robot)
                                                           : parse_csv(text, file, robot, timed);
}

MotionSamples read_motion_file(const std::filesystem::path& file, const RobotModel& robot,
                               bool timed) {
  return parse_motion(read_file(file, kMotionLimit_bytes), file.string(), robot, timed);
}

}  // namespace armwright
