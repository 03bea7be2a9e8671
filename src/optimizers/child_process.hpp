// A child of this process (fork, no exec) that exchanges messages with it and can be abandoned at
// any time. The child holds no descriptor of this process but the standard ones (its input is
// empty, its output goes to the error stream), has no signal handlers, is out of the terminal's
// reach (own process group), runs none of this process's exit handlers and dies with it.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "base/file_descriptor.hpp"
#include "optimizers/isolation.hpp"

namespace armwright {

// What became of a child, as the end of a sentence that begins with its name: "was killed by signal
// 11 (Segmentation fault)". A body may throw it too, and it comes out with the same words.
class ChildFailure : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

// The child's end. If the parent is gone, the child ends: no function returns then.
class ParentLink {
 public:
  explicit ParentLink(int socket) : socket_(socket) {}
  void send(std::string_view message);
  std::string receive();
  // Sends a question and waits for its answer.
  std::string ask(std::string_view question);

 private:
  friend class ChildProcess;
  enum class Kind : std::uint8_t { message, finished, failure, exception, out_of_memory };
  void send(Kind kind, std::string_view message);

  int socket_;
};

class ChildProcess {
 public:
  // Runs `body` in the child. Error{io} if there is no process to be had.
  ChildProcess(const std::function<void(ParentLink&)>& body, const IsolationLimits& limits);
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

 private:
  using Clock = std::chrono::steady_clock;
  struct SocketPair {
    FileDescriptor parent;
    FileDescriptor child;
  };

  static SocketPair open_sockets();
  [[noreturn]] void run_child(pid_t parent, const std::function<void(ParentLink&)>& body);
  std::optional<Event> take_message(std::string& message);
  bool wait_for(short events);  // whether there is something to be done
  bool read_available();        // false at the end
  void check_memory();
  [[noreturn]] void explain_death();

  IsolationLimits limits_;
  SocketPair sockets_;
  pid_t pid_ = -1;
  std::string received_;
  double silence_s_ = 0;
  Clock::time_point last_check_;
  std::optional<std::int64_t> memory_at_start_;  // bytes
};

}  // namespace armwright
