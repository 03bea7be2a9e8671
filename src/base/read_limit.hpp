// Limits the processor time and the memory that reading an input may take. A file of a few lines
// can keep a reader busy for minutes, for example a robot for which no speed can be proposed.
//
// A reader has a ReadStep while it reads, and its long loops call check_reading(). The limit counts
// for each outermost step of a thread: for a problem with its robot, path and proposals, for a
// study with its problems, for a design, for a file of test cases.
//
// The limit belongs to the process: a reader is called from many places, and a caller that forgets
// to pass a limit would have none. Nothing is limited before set_read_limit().
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "base/stop_signal.hpp"

namespace armwright {

struct ReadLimit {
  // Processor time of the thread that reads, so that a busy machine refuses nothing.
  double time_s = 10;
  // Growth of the resident memory of the process.
  std::uint64_t memory_bytes = std::uint64_t{1} << 30;
};

// Returns the limit in the form of --read-limit: "10s,1GiB".
std::string to_string(const ReadLimit& limit);

// Limits every later ReadStep of this process. `report` gets a line of progress after 1, 2, 4, ...
// seconds. `stop` ends a step during which it is requested. Call this before threads start; both
// must live until the process ends.
void set_read_limit(const ReadLimit& limit, StopSignal& stop,
                    std::function<void(const std::string&)> report);

// The time in which the calling thread reads something, with its name for messages, as in "the
// problem 'q1-complex'". Steps nest; the names of the outermost and the innermost are shown.
class ReadStep {
 public:
  explicit ReadStep(std::string what);
  ~ReadStep();
  ReadStep(const ReadStep&) = delete;
  ReadStep& operator=(const ReadStep&) = delete;
};

// Throws Error{bad_data} if the present step of the calling thread has taken more than the limit,
// and WorkStopped if a stop was requested during the step. Returns without effect outside of steps.
// Takes about a microsecond.
void check_reading();

}  // namespace armwright
