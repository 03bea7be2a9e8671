// Messages of joints in CDR (OMG DDS-XTypes 1.3, 7.4), in either byte order:
// sensor_msgs/JointState and control_msgs/JointTrajectoryControllerState.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace armwright {

constexpr std::size_t kMostStatePoints = 6;

struct StatePoint {
  std::array<std::vector<double>, 4> fields;  // positions, velocities, accelerations, effort
};

// A state has one point, a controller's state three to six.
struct JointMessage {
  std::int64_t stamp_ns = 0;
  std::vector<std::string_view> names;  // in the bytes of the message
  std::array<StatePoint, kMostStatePoints> points;
  std::size_t point_count = 0;
};

// Decodes a JointState, or a controller's state whose points have the names `point_names`. Without
// names, the length decides whether an output follows the reference, the feedback and the error.
// Returns what is wrong with the bytes; empty: nothing.
std::string decode_joint_state(std::string_view bytes, JointMessage& message);
std::string decode_controller_state(std::string_view bytes,
                                    const std::vector<std::string>& point_names,
                                    JointMessage& message);

}  // namespace armwright
