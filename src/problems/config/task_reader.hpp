// The [task], [control], [physics] and [workspace] tables of a tracking problem: what the arm has
// to do.
#pragma once

#include "base/config.hpp"
#include "problems/tracking/tracking_config.hpp"

namespace armwright {

// Of a test case: 320 MB of target angles of four joints; published: 3925.
inline constexpr double kMostPeriods = 1e7;

TrackingTask read_task(const ConfigTable& table, const ConfigTable& physics,
                       const ConfigTable& control);
WorkspaceSphere read_workspace(const ConfigTable& table);
// Three numbers. Refused where they are not.
Eigen::Vector3d read_vector(const ConfigTable& table, std::string_view key, Range range,
                            std::string_view what);
// Three numbers as a unit vector; refused where they have no direction.
Eigen::Vector3d read_direction(const ConfigTable& table, std::string_view key);

// Numbers that are each allowed, but together make a case that no memory holds.
void check_length(const ConfigTable& table, const ConfigTable& control,
                  const TrackingConfig& config);

}  // namespace armwright
