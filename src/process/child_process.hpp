// A forked child of this process (no exec) that exchanges messages with it and can be abandoned at
// any time. The child keeps only the standard descriptors: its input is empty, and its output goes
// into a log or to the standard error. It has no signal handlers, leads a process group of its own
// so that the terminal does not reach it, runs no exit handlers of this process, and dies when this
// process dies.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "base/file_descriptor.hpp"
#include "process/output_log.hpp"
#include "process/parent_link.hpp"
#include "process/process_watch.hpp"

namespace armwright {

class ChildProcess {
 public:
  // Runs `body` in the child. The child's output goes into `log`, which must live longer than this
  // object, or to our standard error without a log. Throws Error{io} if no process can be started.
  ChildProcess(const std::function<void(ParentLink&)>& body, const ProcessLimits& limits,
               OutputLog* log = nullptr);
  ~ChildProcess();  // kills and reaps the child, and kills its process group
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  enum class Event { message, finished, given_up };
  // Waits for the next message. Returns `finished` if the body has returned, and `given_up` if
  // `must_give_up` returned true; it is called at least every 50 ms. Throws ChildFailure if the
  // body threw, or the child died, sent nothing for too long, or exceeded its memory limit.
  Event receive(const std::function<bool()>& must_give_up, std::string& message);
  // Sends a message. Returns nothing when all is sent, or `given_up` as receive() does. Throws as
  // receive() does.
  std::optional<Event> send(std::string_view message, const std::function<bool()>& must_give_up);

  // Asks the child to end (SIGTERM) and waits at most for `patience`. Returns whether it has ended.
  bool end_gently(std::chrono::milliseconds patience) const;

 private:
  using Clock = std::chrono::steady_clock;

  std::optional<Event> take_message(std::string& message);
  bool wait_for(short events);  // true if an event has happened
  bool read_available();        // false at the end of the stream
  void take_output();
  void check_silence() const;
  void check_memory();
  [[noreturn]] void explain_death();

  ProcessLimits limits_;
  FileDescriptor socket_;  // our end of the connection to the child
  std::optional<OutputPipe> output_;
  pid_t pid_ = -1;
  std::string received_;
  WakingTime silence_;
  std::optional<ProcessMemory> memory_at_start_;
};

}  // namespace armwright
