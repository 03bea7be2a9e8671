// times.json in the folder of a run or of a cell: how long it took, over all lives of its process.
// A life begins when a command starts or resumes the run, and ends in order; a life that was killed
// leaves no time. Times differ between two runs of the same configuration, so no comparison of
// results and no checksum covers this file, and nothing is computed from it.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>

#include "base/folder.hpp"

namespace armwright {

inline constexpr const char* kTimesFile = "times.json";

struct RunTimes {
  double wall_s = 0;            // time on the clock
  std::optional<double> cpu_s;  // processor time, if the process simulated all cases itself
  std::uint64_t lives = 0;
};

// Returns the recorded times, or nothing if there are none, as in runs of version 1.0. Throws
// Error{bad_data} if the file is damaged, and Error{io}.
std::optional<RunTimes> load_times(const std::filesystem::path& folder);
// Does the same for readers that can do without the times: returns nothing for a damaged file, which
// the survey of the run names.
std::optional<RunTimes> find_times(const std::filesystem::path& folder);

// Measures one life of a run. The processor time is that of this process and of its children that
// have ended.
class RunClock {
 public:
  RunClock();
  // Adds the time since the construction to times.json. Replaces a damaged file. `simulates` says
  // whether this process simulates the cases itself. Throws Error{io}.
  void add_to(const Folder& folder, bool simulates) const;

 private:
  std::chrono::steady_clock::time_point begun_ = std::chrono::steady_clock::now();
  double begun_cpu_s_ = 0;
};

}  // namespace armwright
