// What an arm's maker takes home from one run: the winner as controllers of ROS 2, as the robot's
// description with the new effort limits, and on a sheet of paper.
#pragma once

#include <filesystem>

namespace armwright {

struct FinishedArm;

// controllers-DISTRIBUTION.yaml, one each (ros2_control.hpp, whose errors it throws).
void write_ros2_control(const FinishedArm& arm, const std::filesystem::path& folder);

// The robot's own file under its own name, with the larger of each joint's effort limits
// (sim/robot/urdf_effort_writer.hpp). Error{usage} if the winner stretches links, which a file of
// links and meshes as they are cannot say; Error{bad_data} if the file is not what the run used.
void write_urdf(const FinishedArm& arm, const std::filesystem::path& folder);

// datasheet.html (datasheet.hpp).
void write_datasheet(const FinishedArm& arm, const std::filesystem::path& folder);

}  // namespace armwright
