// A program in a process of its own that exchanges lines with this process over its standard input
// and output. It is watched while this process waits for it. The destructor kills it and its
// process group.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "base/file_descriptor.hpp"
#include "process/output_log.hpp"

namespace armwright {

// The child ended, sent nothing for too long or used too much memory. The message completes a
// sentence that begins with the child's name: "ended with exit code 3".
class LineProcessFailure : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

// The child took more memory than it may.
class LineProcessMemory : public LineProcessFailure {
  using LineProcessFailure::LineProcessFailure;
};

// The child did not answer in time.
class LineProcessSilence : public LineProcessFailure {
  using LineProcessFailure::LineProcessFailure;
};

class LineProcess {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::size_t kLongestLine = std::size_t{64} << 20;

  // Starts words[0], which is searched on the PATH. Its standard error goes to `log`, which must
  // live longer than this object. Throws Error{usage} if there is no such program. This and every
  // function that waits throw Error{io} if the log cannot be written. The program begins in
  // `folder`; an empty path stands for the folder of this process.
  LineProcess(const std::vector<std::string>& words, OutputLog& log,
              const std::filesystem::path& folder = {});
  ~LineProcess();  // kills
  LineProcess(const LineProcess&) = delete;
  LineProcess& operator=(const LineProcess&) = delete;

  // Limits the resident memory of the program and its descendants to its present value plus `mib`
  // MiB. (A ChildProcess limits private writable memory of one process instead.)
  void limit_memory(double mib);

  // These functions, and complete(), throw LineProcessFailure, and WorkStopped as
  // check_work_stop() does. `silence_s` is the longest time to wait for the child.
  void send(const std::string& line, double silence_s);
  // Returns the next line, or nothing as soon as `is_given_up` returns true; it is called ten times
  // per second.
  std::optional<std::string> receive(double silence_s, const std::function<bool()>& is_given_up);

  // Closes its input, waits at most `patience_s` for its end, and then kills it. Returns how it
  // ended as text; empty for exit code 0 or if it had to be killed.
  std::string finish(double patience_s);

  // How a program ended that ran to its end by itself.
  struct Ending {
    std::optional<int> exit_code;  // nothing if a signal killed it
    std::string how;               // "ended with exit code 3"
    std::string output;            // the beginning of its standard output
    bool is_cut = false;           // true: it printed more
  };
  // For a program that gets no lines: closes its input, reads at most `most_bytes` of its output
  // and lets it print the rest into the void, and waits for its end. Kills what it has started and
  // left running. Throws LineProcessSilence if that takes longer than `limit_s`, and
  // LineProcessFailure if it takes too much memory.
  Ending complete(double limit_s, std::size_t most_bytes);

 private:
  std::string kill();  // kills and reaps it; returns how it ended
  void check_memory();
  void read_available(std::size_t most = kLongestLine);
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
