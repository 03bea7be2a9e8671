// Paths in CSV files, which [path] of a problem names (path_reader.hpp has the columns).
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "sim/tracking/task.hpp"
#include "sim/tracking/test_case.hpp"

namespace armwright {

inline constexpr double kFarthestPlace_m = 100;  // as in files of test cases
inline constexpr std::size_t kMostPathPoints = 1'000'000;

// The rows of a path's file; `name` is the file's in messages. With times a continuous path that
// has a point each control period of the task, else the points that it moves between.
// Error{bad_data} names file and line.
TestCase parse_path(std::string_view text, const std::string& name, const TrackingTask& task);

// The target stays at the end of a continuous path for the task's rest_s.
void add_rest(const TrackingTask& task, TestCase& path);

}  // namespace armwright
