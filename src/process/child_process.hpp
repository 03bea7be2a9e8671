// A child of this process (fork, no exec) that exchanges messages with it and can be abandoned at
// any time. The child holds no descriptor of this process but the standard ones (its input is
// empty, what it prints goes into a log or to the error stream), has no signal handlers, is out of
// the terminal's reach (own process group), runs none of this process's exit handlers and dies with
// it.
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
  // Runs `body` in the child. What it prints goes into `log`, which must outlive this; without one
  // to our standard error. Error{io} if there is no process to be had.
  ChildProcess(const std::function<void(ParentLink&)>& body, const ProcessLimits& limits,
               OutputLog* log = nullptr);
  ~ChildProcess();  // kills the child and whatever it started in its process group, and reaps it
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  enum class Event { message, finished, given_up };
  // Waits for the next message. `finished`: the body has returned; `given_up`: `must_give_up`
  // (asked at least every 50 ms) said so. Throws ChildFailure when the body threw, the child died,
  // sent nothing for too long or took too much memory.
  Event receive(const std::function<bool()>& must_give_up, std::string& message);
  // The same for sending; never `message` nor `finished`, but nothing if all is sent.
  std::optional<Event> send(std::string_view message, const std::function<bool()>& must_give_up);

  // Asks it to end (SIGTERM), which it may take as long for as `patience`; whether it has ended.
  bool end_gently(std::chrono::milliseconds patience) const;

 private:
  using Clock = std::chrono::steady_clock;
  struct SocketPair {
    FileDescriptor parent;
    FileDescriptor child;
  };

  static SocketPair open_sockets();
  std::optional<Event> take_message(std::string& message);
  bool wait_for(short events);  // whether there is something to be done
  bool read_available();        // false at the end
  void take_output();
  void check_silence() const;
  void check_memory();
  [[noreturn]] void explain_death();

  ProcessLimits limits_;
  SocketPair sockets_;
  std::optional<OutputPipe> output_;
  pid_t pid_ = -1;
  std::string received_;
  WakingTime silence_;
  std::optional<ProcessMemory> memory_at_start_;
};

}  // namespace armwright
