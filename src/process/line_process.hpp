// A program in a process of its own, spoken to in lines: its standard input and output are ours.
// It is watched while it is waited for, and never outlives the object: what it started in its
// process group is killed with it.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "base/file_descriptor.hpp"
#include "process/output_log.hpp"

namespace armwright {

// The child broke off, fell silent or took too much. The message completes a sentence that begins
// with the child's name: "ended with exit code 3".
class LineProcessFailure : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

// It kept us waiting for longer than it might.
class LineProcessSilence : public LineProcessFailure {
  using LineProcessFailure::LineProcessFailure;
};

class LineProcess {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::size_t kLongestLine = std::size_t{64} << 20;

  // Looks words[0] up on the PATH. Standard error goes to `log`, which must outlive this.
  // Error{usage} if there is no such program; Error{io} from here and all that waits if the log
  // cannot be written.
  LineProcess(const std::vector<std::string>& words, OutputLog& log);
  ~LineProcess();  // kills
  LineProcess(const LineProcess&) = delete;
  LineProcess& operator=(const LineProcess&) = delete;

  // From now on it may hold `mib` more of resident memory than it does now.
  void limit_memory(double mib);

  // Both throw LineProcessFailure. `silence_s` is how long it may keep us waiting.
  void send(const std::string& line, double silence_s);
  // The next line, or nothing as soon as `is_given_up` holds, which is asked ten times a second.
  std::optional<std::string> receive(double silence_s, const std::function<bool()>& is_given_up);

  // No more is said to it; it has `patience_s` to end by itself and is killed after that. Its exit
  // as text if it was not exit code 0: empty if it was, or if it had to be killed.
  std::string finish(double patience_s);

 private:
  std::string kill();  // and reap; how it ended
  void check_memory();
  void read_available();
  std::optional<std::string> take_line();

  pid_t pid_ = -1;
  FileDescriptor input_;   // we write here
  FileDescriptor output_;  // we read here
  OutputPipe log_;         // and here
  bool at_end_ = false;
  std::string received_;
  std::size_t taken_ = 0;        // of received_
  std::size_t searched_ = 0;     // of received_, without finding the end of a line
  double memory_limit_mib_ = 0;  // 0: none
  double memory_mib_at_start_ = 0;
  Clock::time_point next_memory_check_;
};

}  // namespace armwright
