// Limits and measures child processes: their memory, their end, and the time since their last
// message. The classes ChildProcess and LineProcess wait for the messages and kill a silent child.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace armwright {

inline constexpr double kMib = 1024.0 * 1024.0;  // bytes per MiB

// Limits of a child process. A process that exceeds one is killed.
struct ProcessLimits {
  double silence_s = 60;  // longest time from an answer to the child's next message
  // Growth of ProcessMemory::data_bytes since the start of the child, in MiB. A LineProcess limits
  // resident_bytes instead.
  double memory_mib = 4096;
  bool are_options = false;  // both values are options of the user, and messages name them
};

struct ProcessMemory {
  std::int64_t resident_bytes = 0;
  std::int64_t data_bytes = 0;  // writable private memory with stacks, also if it was never touched
};

// Returns the memory of a process, given as a number or "self". Returns nothing if the process has
// ended.
std::optional<ProcessMemory> measure_memory(const std::string& process);

// Returns the memory in MiB that a process and its descendants hold resident together; 0 if the
// process has ended. A descendant whose parent has ended is not found. The processes count shared
// pages once each; where the sum is above `exact_above_mib`, each counts its share of such pages
// instead, which takes longer.
double measure_tree_mib(pid_t process, double exact_above_mib);

// Returns whether a child has ended. Does not reap it, so that its process number stays reserved.
bool has_ended(pid_t child);

// Kills a child and all processes of the group that it leads. The child must not have been reaped,
// so that its number cannot belong to another process.
void kill_group(pid_t child);

// Waits for the end of a child and returns the status of waitpid().
int reap(pid_t child);

// Returns "was killed by signal 11 (Segmentation fault)".
std::string describe_signal(int signal);

// Measures the time that passes while this process runs: the sum of the times between two calls of
// look(), where each counts at most as long as one wait. So a suspended machine or a stopped
// program does not make a child late.
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
