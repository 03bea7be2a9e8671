// The [path] table of a tracking problem: a path of the user's own in place of cases generated in
// the workspace. It is the one case that designs are trained, validated and tested on; where plants
// are perturbed there are as many of it as the sets say, each with a plant of its own.
//
//   kind = "points"  [[path.point]] tables with position_m and, in all or none, rpy_rad; the tool
//                    moves from each to the next by the task's reference signal, and rests
//   kind = "line"    from_m, to_m, repeats: there and back again, likewise
//   kind = "circle"  centre_m, normal, radius_m, start (a direction; default: as near to x as it
//                    gets), repeats: without a stop, the way along it by the reference signal at
//                    task.speed_m_per_s; the error counts all along
//   kind = "file"    file = "path.csv": columns x_m, y_m, z_m, to which roll_rad, pitch_rad and
//                    yaw_rad or qw, qx, qy and qz can be added, and time_s: with it the path is
//                    gone through without a stop, straight between its rows, and the error counts
//                    all along; without it the rows are points
// Orientations turn along the shortest way (slerp).
#pragma once

#include <filesystem>
#include <optional>

#include "base/config.hpp"
#include "problems/tracking/tracking_config.hpp"

namespace armwright {

// Whether it is gone through without a stop, and the file that it comes from, if any.
struct ReadPath {
  TestCase the_case;
  std::optional<std::filesystem::path> file;
};

// Nothing where the table is empty. Error{usage} names file, line and key; Error{bad_data} the file
// of a path and its line.
std::optional<ReadPath> read_path(const ConfigTable& table, const TrackingTask& task);

}  // namespace armwright
