#include "process/child_process.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <system_error>
#include <thread>

#include "base/error.hpp"
#include "base/text.hpp"
#include "process/fork_support.hpp"

namespace armwright {
namespace {

constexpr int kPollMs = 50;
constexpr int kClosedPollMs = 1;  // after the connection has closed, the child ends soon
constexpr std::uint64_t kMaxFrameBytes = std::uint64_t{1} << 32;

[[noreturn]] void fail(const char* doing, int error) {
  throw Error(ErrorKind::io,
              fmt::format("cannot {}: {}", doing, std::generic_category().message(error)));
}

}  // namespace

ChildProcess::ChildProcess(const std::function<void(ParentLink&)>& body,
                           const ProcessLimits& limits, OutputLog* log)
    : limits_(limits), memory_at_start_(measure_memory("self")) {
  std::array<int, 2> ends{};
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    fail("open a socket for a child process", errno);
  }
  socket_.reset(ends[0]);
  FileDescriptor child_end(ends[1]);
  if (log != nullptr) {
    output_.emplace(*log);
  }
  ChildSettings settings{.parent = getpid(),
                         .socket = child_end.get(),
                         .output = output_ ? output_->child_end() : -1,
                         .memory_mib = limits_.memory_mib};
  if (memory_at_start_) {
    settings.data_bytes_at_start = memory_at_start_->data_bytes;
  }
  {
    const AllSignalsBlocked blocked;
    pid_ = fork();
    if (pid_ == 0) {
      run_child(settings, body);
    }
  }
  if (pid_ < 0) {
    fail("start a child process", errno);
  }
  child_end.close();
  if (output_) {
    output_->close_child_end();
  }
  setpgid(pid_, pid_);  // the child does the same; either call may be first
}

ChildProcess::~ChildProcess() {
  kill_group(pid_);
  reap(pid_);
  try {
    take_output();
  } catch (const std::exception&) {
    // The child's last output is lost. A destructor cannot report the error.
  }
}

bool ChildProcess::end_gently(std::chrono::milliseconds patience) const {
  constexpr std::chrono::milliseconds kPause{5};
  ::kill(pid_, SIGTERM);  // the child is not reaped yet, so the id is still its own
  for (const auto end = Clock::now() + patience; Clock::now() < end && !has_ended(pid_);) {
    std::this_thread::sleep_for(kPause);
  }
  return has_ended(pid_);
}

ChildProcess::Event ChildProcess::receive(const std::function<bool()>& must_give_up,
                                          std::string& message) {
  silence_.restart();
  while (true) {
    if (must_give_up()) {
      return Event::given_up;
    }
    if (const auto event = take_message(message)) {
      return *event;
    }
    check_silence();  // a part of a message does not count as a sign of life
    // Checks for the child's end before reading: everything that it sent before its end is then
    // readable.
    const bool is_dead = has_ended(pid_);
    if (!is_dead && !wait_for(POLLIN)) {
      continue;
    }
    const std::size_t before = received_.size();
    const bool is_open = read_available();
    if (received_.size() > before) {
      continue;
    }
    if (is_dead) {
      explain_death();
    }
    if (!is_open) {
      wait_for(0);  // the child closed its end: it ends soon, or the silence limit ends the wait
    }
  }
}

std::optional<ChildProcess::Event> ChildProcess::send(std::string_view message,
                                                      const std::function<bool()>& must_give_up) {
  const std::string frame = make_frame(FrameKind::message, message);
  silence_.restart();
  for (std::size_t sent = 0; sent < frame.size();) {
    const ssize_t count = ::send(socket_.get(), frame.data() + sent, frame.size() - sent,
                                 MSG_NOSIGNAL | MSG_DONTWAIT);
    if (count >= 0) {
      sent += static_cast<std::size_t>(count);
    } else if (errno == EAGAIN) {
      wait_for(POLLOUT);
      check_silence();
      if (must_give_up()) {
        return Event::given_up;
      }
    } else if (errno != EINTR) {
      return std::nullopt;  // the child has ended; receive() reports why
    }
  }
  return std::nullopt;
}

std::optional<ChildProcess::Event> ChildProcess::take_message(std::string& message) {
  FrameHeader header;
  if (received_.size() < sizeof header) {
    return std::nullopt;
  }
  std::memcpy(&header, received_.data(), sizeof header);
  if (header.mark != FrameHeader{}.mark || header.size > kMaxFrameBytes ||
      header.kind > FrameKind::out_of_memory) {
    throw ChildFailure("has written into the connection to its parent");
  }
  if (received_.size() - sizeof header < header.size) {
    return std::nullopt;
  }
  message = received_.substr(sizeof header, header.size);
  received_.erase(0, sizeof header + header.size);
  if (header.kind != FrameKind::message) {
    take_output();  // the child sends this after its last output
  }
  switch (header.kind) {
    case FrameKind::message:
      return Event::message;
    case FrameKind::finished:
      return Event::finished;
    case FrameKind::failure:
      throw ChildFailure(sanitize(message));
    case FrameKind::exception:
      throw ChildFailure(fmt::format("threw an exception ({})", sanitize(message)));
    case FrameKind::out_of_memory:
      break;
  }
  throw ChildFailure(fmt::format("ran out of memory: it may take {} MiB beyond what it began with",
                                 limits_.memory_mib),
                     "memory_mib");
}

bool ChildProcess::wait_for(short events) {
  std::array<pollfd, 2> waiting{
      pollfd{.fd = events == 0 ? -1 : socket_.get(), .events = events, .revents = 0},
      pollfd{.fd = output_ ? output_->get() : -1, .events = POLLIN, .revents = 0}};
  poll(waiting.data(), waiting.size(), events == 0 ? kClosedPollMs : kPollMs);
  silence_.look();
  take_output();
  if (waiting[0].revents != 0) {
    return true;
  }
  check_memory();
  return false;
}

void ChildProcess::check_silence() const {
  if (silence_.get_s() > limits_.silence_s) {
    throw ChildFailure(
        fmt::format("was silent for more than {} s and had to be killed", limits_.silence_s),
        "silence_s");
  }
}

bool ChildProcess::read_available() {
  std::array<char, 65536> buffer;
  const ssize_t count = recv(socket_.get(), buffer.data(), buffer.size(), MSG_DONTWAIT);
  if (count > 0) {
    received_.append(buffer.data(), static_cast<std::size_t>(count));
  }
  return count > 0 || (count < 0 && (errno == EAGAIN || errno == EINTR));
}

void ChildProcess::take_output() {
  if (output_) {
    output_->take_available();
  }
}

void ChildProcess::check_memory() {
  const auto now = measure_memory(std::to_string(pid_));
  if (!memory_at_start_ || !now) {
    return;
  }
  const auto grown = static_cast<double>(now->data_bytes - memory_at_start_->data_bytes);
  if (grown > limits_.memory_mib * kMib) {
    throw ChildFailure(fmt::format("took more memory than the {} MiB it may and had to be killed",
                                   limits_.memory_mib),
                       "memory_mib");
  }
}

void ChildProcess::explain_death() {
  take_output();
  siginfo_t info{};
  waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOHANG | WNOWAIT);
  if (info.si_code == CLD_EXITED) {
    throw ChildFailure(
        fmt::format("ended its process with exit code {} before it had finished", info.si_status));
  }
  throw ChildFailure(describe_signal(info.si_status));
}

}  // namespace armwright
