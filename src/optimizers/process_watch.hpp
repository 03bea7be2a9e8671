// What is watched in the processes that optimizers run in, and the options by which the user says
// how closely: the same for shared libraries and for programs.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "optimizers/optimizer.hpp"

namespace armwright {

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

// silence_s, memory_mib and log. They change no result: a run may be resumed with other values.
std::vector<OptionSpec> make_watch_options();

}  // namespace armwright
