// Files of planned motions: CSV, and the trajectory_msgs/JointTrajectory of ROS 2 as YAML.
//
// CSV: a line of names, then one line per sample. Columns: time_s; of joint i from 1 position_i_rad,
// velocity_i_rad_per_s and acceleration_i_rad_per_s2 (position_i_m and so on if it slides). The
// velocities and the accelerations may be missing, each for all joints; any other columns are left out.
// YAML: joint_names, and points with positions, time_from_start {sec, nanosec} and, likewise,
// velocities and accelerations. Joints may stand in any order there.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "sim/robot/robot_model.hpp"

namespace armwright {

// Matrices have one row per sample and one column per joint of the robot (rad or m).
struct MotionSamples {
  std::vector<double> times_s;                                // from 0, rising
  Eigen::MatrixXd positions, rates = {}, accelerations = {};  // the last two may be empty
};

// Returns the motion as CSV with 9 digits. `efforts` (N m or N), if there are any, get the columns
// expected_effort_i_n_m.
std::string write_motion_csv(const RobotModel& robot, const MotionSamples& motion,
                             const Eigen::MatrixXd& efforts = {});
// Returns the motion as YAML, with nine decimals.
std::string write_joint_trajectory(const RobotModel& robot, const MotionSamples& motion);

// Reads one of the two; a name that ends in .yaml or .yml is YAML. Rates and accelerations that are
// missing stay empty. Throws Error{io}, and Error{bad_data} with
// file and line for joints that are not the robot's, times that do not rise, numbers that are not
// finite, and fewer than two samples. Unless it is `timed`, a CSV may lack time_s; its samples are then
// one second apart.
MotionSamples read_motion_file(const std::filesystem::path& file, const RobotModel& robot,
                               bool timed = true);
MotionSamples parse_motion(std::string_view text, const std::string& name, const RobotModel& robot,
                           bool timed = true);

}  // namespace armwright
