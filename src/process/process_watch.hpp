// What is watched in child processes: memory, end, and the time since the last sign of life.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace armwright {

inline constexpr double kMib = 1024.0 * 1024.0;  // bytes per MiB

struct ProcessLimits {
  double silence_s = 60;     // longest time between two questions; the scores' own time not counted
  double memory_mib = 4096;  // that the child may allocate beyond what it began with
  bool are_options = false;  // the two above: messages then name them, for the user to change
};

struct ProcessMemory {
  std::int64_t resident_bytes = 0;
  std::int64_t data_bytes = 0;  // writable private memory, stacks included, whether touched or not
};

// `process` is a number or "self". Nothing for a process that is gone.
std::optional<ProcessMemory> measure_memory(const std::string& process);

// Whether a child has ended. It is not reaped: its number stays its own.
bool has_ended(pid_t child);

// Kills a child that has not been reaped, so that no number can be anybody else's, and everything
// in the process group that it leads.
void kill_group(pid_t child);

// Waits for its end and returns waitpid's status.
int reap(pid_t child);

// "was killed by signal 11 (Segmentation fault)"
std::string describe_signal(int signal);

// Time that passes while this process is awake: the sum of the times between looks, each of which
// counts for no more than a wait may last. So a suspended machine or a stopped program does not
// make a child late.
class WakingTime {
 public:
  void restart();
  void look();
  double get_s() const { return passed_s_; }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point last_ = Clock::now();
  double passed_s_ = 0;
};

}  // namespace armwright
