// Reads recorded motions of a robot, for the identification of its plant: CSV files and bags of ROS 2
// (MCAP and sqlite3) with sensor_msgs/JointState or control_msgs/JointTrajectoryControllerState.
//
// A log is refused if its numbers cannot be what they are taken for: gaps in time, degrees in place
// of radians, swapped columns, clipped torques (log_check.hpp). docs/identification.md describes the
// formats and the checks for users.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "sim/robot/robot_model.hpp"

namespace armwright {

// One recorded motion of a robot, at the joints' side of the gears, as it was recorded: not filtered
// and not resampled. Matrices have one row per sample and one column per joint.
struct MotionLog {
  std::string name;             // of the file
  std::string sha256;           // of the file as it lies; read_log() sets it
  std::vector<double> times_s;  // strictly increasing
  Eigen::MatrixXd positions;    // rad or m; of the motors, if the log also has link positions
  Eigen::MatrixXd efforts;      // N m or N
  // Per joint, its efforts divided by the numbers in the file: gear ratio, unit and sign.
  Eigen::VectorXd effort_factors;
  // Empty if no joint has them. A column is NaN if only that joint lacks it.
  Eigen::MatrixXd velocities;      // rad/s or m/s
  Eigen::MatrixXd link_positions;  // rad or m
  Eigen::MatrixXd references;      // setpoints of the positions, rad or m
  // Notes for the user, one line each: the columns that the reader took and what it changed.
  std::vector<std::string> notes;

  std::size_t sample_count() const { return times_s.size(); }
};

// Says how the columns or messages of a file become joints. Joints are given by their number from 1
// or by their name.
struct LogOptions {
  // The columns by armwright's names: time, and position_N, velocity_N, effort_N, motor_torque_N,
  // link_position_N and reference_N for the joint N. For a bag: position, velocity, effort,
  // motor_torque or reference, and the field of the message: "effort", "output.effort".
  std::map<std::string, std::string> columns = {};
  // Units by armwright's names, with or without the joint: {"position", "deg"}, {"time", "ms"}. The
  // unit of positions also counts for link positions and references.
  std::map<std::string, std::string> units = {};
  // Motor angle per joint position, rad/rad or rad/m. They make efforts of motor torques.
  std::map<std::string, double> gear_ratios = {};
  // 1 or -1 for each joint whose efforts have the opposite sign in the file.
  std::map<std::string, double> signs = {};
  // The names that the file has for the robot's joints, in the robot's order. Empty: the robot's.
  std::vector<std::string> joints = {};
  std::string topic = {};  // of a bag; empty: the only one that fits
};

// Sets one value of the options from the words of the command line: `option` is "column", "unit",
// "gear-ratio" or "sign". A gear ratio may be a fraction: "1798/7". Throws Error{usage}, which names
// the option, if the value is not possible.
void set_log_option(LogOptions& options, std::string_view option, const std::string& key,
                    const std::string& value);

// Reads a log. The content of the file decides about its format; a file that zstd has compressed is
// read, too. A folder of rosbag2 stands for its bag file. Throws Error{bad_data} if the file cannot
// be read to its end or fails a check, Error{usage} if an option does not fit the file or the
// robot, and Error{io}.
MotionLog read_log(const std::filesystem::path& file, const RobotModel& robot,
                   const LogOptions& options = {});
// Does the same with the content of a file. `name` is its name for messages.
MotionLog parse_log(std::string content, const std::string& name, const RobotModel& robot,
                    const LogOptions& options = {});

}  // namespace armwright
