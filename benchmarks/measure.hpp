// Measurements for benchmarks: wall-clock time or CPU time of the thread, and medians.
#pragma once

#include <time.h>

#include <algorithm>
#include <vector>

namespace armwright {

inline double read_clock_s(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

// Returns the seconds that the work takes.
double measure_s(const auto& work, clockid_t clock = CLOCK_MONOTONIC) {
  const double start = read_clock_s(clock);
  work();
  return read_clock_s(clock) - start;
}
double measure_cpu_s(const auto& work) {
  return measure_s(work, CLOCK_THREAD_CPUTIME_ID);
}

inline double calc_median(std::vector<double> values) {
  const auto middle = values.begin() + std::ssize(values) / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace armwright
