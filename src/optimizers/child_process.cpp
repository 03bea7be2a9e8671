#include "optimizers/child_process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <pthread.h>
#include <stdio_ext.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <new>
#include <system_error>
#include <typeinfo>

#include "base/error.hpp"
#include "base/text.hpp"

namespace armwright {
namespace {

constexpr int kPollMs = 50;
constexpr int kClosedPollMs = 1;  // once the connection is closed, death is a matter of moments
constexpr double kMib = 1024.0 * 1024.0;
constexpr int kChildSocket = 3;
constexpr std::size_t kMaxTextBytes = 4000;  // of an exception; what is longer is cut
constexpr std::uint64_t kMaxFrameBytes = std::uint64_t{1} << 32;

// A frame: this, then `size` bytes. The mark tells apart what a child wrote into a descriptor that
// is not its own.
struct FrameHeader {
  std::uint64_t mark = 0x41524d5752494748;
  std::uint64_t size = 0;
  std::uint64_t kind = 0;
};

// Writable private memory of a process, its stacks included: what allocations make grow.
std::optional<std::int64_t> measure_data_bytes(const std::string& process) {
  std::ifstream file("/proc/" + process + "/statm");
  std::int64_t size = 0, resident = 0, shared = 0, text = 0, library = 0, data = 0;
  if (!(file >> size >> resident >> shared >> text >> library >> data)) {
    return std::nullopt;
  }
  return data * sysconf(_SC_PAGESIZE);
}

[[noreturn]] void fail(const char* doing, int error) {
  throw Error(ErrorKind::io,
              fmt::format("cannot {}: {}", doing, std::generic_category().message(error)));
}

class AllSignalsBlocked {
 public:
  AllSignalsBlocked() {
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before_);
  }
  ~AllSignalsBlocked() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  AllSignalsBlocked(const AllSignalsBlocked&) = delete;
  AllSignalsBlocked& operator=(const AllSignalsBlocked&) = delete;

 private:
  sigset_t before_;
};

void reset_signals() {
  for (int signal = 1; signal < NSIG; ++signal) {
    std::signal(signal, SIG_DFL);  // refused for those that have no handler, and rightly
  }
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
}

void leave_descriptors_behind(int socket) {
  if (socket != kChildSocket) {
    dup3(socket, kChildSocket, O_CLOEXEC);
  }
  closefrom(kChildSocket + 1);
  const int nothing = open("/dev/null", O_RDWR | O_CLOEXEC);
  dup2(nothing, STDIN_FILENO);
  if (nothing > kChildSocket) {
    close(nothing);
  }
  dup2(STDERR_FILENO, STDOUT_FILENO);  // the program's results alone go to its output
}

// The parent kills a child that is over the limit; between two of its looks this stops the rest.
void limit_memory(std::optional<std::int64_t> at_start, double memory_mib) {
  rlimit limit{};
  if (!at_start || getrlimit(RLIMIT_DATA, &limit) != 0) {
    return;
  }
  const double wanted = static_cast<double>(*at_start) + (memory_mib * 1.25 + 64) * kMib;
  if (wanted < static_cast<double>(limit.rlim_cur)) {
    limit.rlim_cur = static_cast<rlim_t>(wanted);
    setrlimit(RLIMIT_DATA, &limit);
  }
}

}  // namespace

void ParentLink::send(Kind kind, std::string_view message) {
  const FrameHeader header{.size = message.size(), .kind = static_cast<std::uint64_t>(kind)};
  std::string frame(reinterpret_cast<const char*>(&header), sizeof header);
  frame += message;
  for (std::size_t sent = 0; sent < frame.size();) {
    const ssize_t count = ::send(socket_, frame.data() + sent, frame.size() - sent, MSG_NOSIGNAL);
    if (count < 0 && errno != EINTR) {
      _exit(EXIT_FAILURE);
    }
    sent += count > 0 ? static_cast<std::size_t>(count) : 0;
  }
}

void ParentLink::send(std::string_view message) {
  send(Kind::message, message);
}

std::string ParentLink::receive() {
  const auto read_exactly = [this](char* to, std::size_t size) {
    while (size > 0) {
      const ssize_t count = recv(socket_, to, size, 0);
      if (count == 0 || (count < 0 && errno != EINTR)) {
        _exit(EXIT_FAILURE);
      }
      if (count > 0) {
        to += count;
        size -= static_cast<std::size_t>(count);
      }
    }
  };
  FrameHeader header;
  read_exactly(reinterpret_cast<char*>(&header), sizeof header);
  std::string message(header.size, '\0');
  read_exactly(message.data(), message.size());
  return message;
}

std::string ParentLink::ask(std::string_view question) {
  send(question);
  return receive();
}

ChildProcess::SocketPair ChildProcess::open_sockets() {
  std::array<int, 2> ends{};
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    fail("open a socket for a child process", errno);
  }
  return {FileDescriptor(ends[0]), FileDescriptor(ends[1])};
}

ChildProcess::ChildProcess(const std::function<void(ParentLink&)>& body,
                           const IsolationLimits& limits)
    : limits_(limits),
      sockets_(open_sockets()),
      last_check_(Clock::now()),
      memory_at_start_(measure_data_bytes("self")) {
  const pid_t parent = getpid();
  {
    // Until the child has its own, no signal may run this process's handlers in it.
    const AllSignalsBlocked blocked;
    pid_ = fork();
    if (pid_ == 0) {
      run_child(parent, body);
    }
  }
  if (pid_ < 0) {
    fail("start a child process", errno);
  }
  sockets_.child.close();
  setpgid(pid_, pid_);  // as the child does: whoever comes first
}

ChildProcess::~ChildProcess() {
  kill(-pid_, SIGKILL);
  kill(pid_, SIGKILL);
  while (waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

void ChildProcess::run_child(pid_t parent, const std::function<void(ParentLink&)>& body) {
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) {
    _exit(EXIT_FAILURE);
  }
  leave_descriptors_behind(sockets_.child.get());
  // What this process had not yet written is not the child's to write; and exit() in the body ends
  // here, before the handlers registered earlier.
  __fpurge(stdout);
  on_exit([](int status, void*) { _exit(status); }, nullptr);
  limit_memory(memory_at_start_, limits_.memory_mib);
  reset_signals();
  ParentLink link(kChildSocket);
  try {
    body(link);
    std::fflush(stdout);
    link.send(ParentLink::Kind::finished, "");
  } catch (const std::bad_alloc&) {
    link.send(ParentLink::Kind::out_of_memory, "");
  } catch (const ChildFailure& failure) {
    std::fflush(stdout);
    link.send(ParentLink::Kind::failure, std::string_view(failure.what()).substr(0, kMaxTextBytes));
  } catch (const std::exception& error) {
    std::fflush(stdout);
    link.send(ParentLink::Kind::exception, std::string_view(error.what()).substr(0, kMaxTextBytes));
  } catch (...) {
    link.send(ParentLink::Kind::exception, "something that is no std::exception");
  }
  _exit(EXIT_SUCCESS);
}

ChildProcess::Event ChildProcess::receive(const std::function<bool()>& must_give_up,
                                          std::string& message) {
  silence_s_ = 0;
  last_check_ = Clock::now();
  while (true) {
    if (must_give_up()) {
      return Event::given_up;
    }
    if (const auto event = take_message(message)) {
      return *event;
    }
    // Death is looked at before reading: what was sent before it is then all there.
    siginfo_t info{};
    const bool is_dead =
        waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOHANG | WNOWAIT) == 0 &&
        info.si_pid == pid_;
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
      wait_for(0);  // its end is closed: it is about to die, or will fall silent
    }
  }
}

std::optional<ChildProcess::Event> ChildProcess::send(std::string_view message,
                                                      const std::function<bool()>& must_give_up) {
  const FrameHeader header{.size = message.size()};
  std::string frame(reinterpret_cast<const char*>(&header), sizeof header);
  frame += message;
  silence_s_ = 0;
  last_check_ = Clock::now();
  for (std::size_t sent = 0; sent < frame.size();) {
    const ssize_t count = ::send(sockets_.parent.get(), frame.data() + sent, frame.size() - sent,
                                 MSG_NOSIGNAL | MSG_DONTWAIT);
    if (count >= 0) {
      sent += static_cast<std::size_t>(count);
    } else if (errno == EAGAIN) {
      wait_for(POLLOUT);
      if (must_give_up()) {
        return Event::given_up;
      }
    } else if (errno != EINTR) {
      return std::nullopt;  // it is dead; receive() says of what
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
      header.kind > static_cast<std::uint64_t>(ParentLink::Kind::out_of_memory)) {
    throw ChildFailure("has written into the connection to its parent");
  }
  if (received_.size() - sizeof header < header.size) {
    return std::nullopt;
  }
  message = received_.substr(sizeof header, header.size);
  received_.erase(0, sizeof header + header.size);
  switch (static_cast<ParentLink::Kind>(header.kind)) {
    case ParentLink::Kind::message:
      return Event::message;
    case ParentLink::Kind::finished:
      return Event::finished;
    case ParentLink::Kind::failure:
      throw ChildFailure(sanitize(message));
    case ParentLink::Kind::exception:
      throw ChildFailure(fmt::format("threw an exception ({})", sanitize(message)));
    case ParentLink::Kind::out_of_memory:
      break;
  }
  throw ChildFailure(
      fmt::format("ran out of memory (memory_mib allows {} MiB beyond what it began with)",
                  limits_.memory_mib));
}

// Silence is the sum of short waits rather than a difference of times, so that a suspended machine
// or a stopped program does not count.
bool ChildProcess::wait_for(short events) {
  pollfd waiting{.fd = events == 0 ? -1 : sockets_.parent.get(), .events = events, .revents = 0};
  const int count = poll(&waiting, 1, events == 0 ? kClosedPollMs : kPollMs);
  const Clock::time_point now = Clock::now();
  const double waited_s = std::chrono::duration<double>(now - last_check_).count();
  last_check_ = now;
  silence_s_ += std::min(waited_s, 4e-3 * kPollMs);
  if (count > 0) {
    return true;
  }
  check_memory();
  if (silence_s_ > limits_.silence_s) {
    throw ChildFailure(
        fmt::format("was silent for more than {} s (option silence_s) and had to be killed",
                    limits_.silence_s));
  }
  return false;
}

bool ChildProcess::read_available() {
  std::array<char, 65536> buffer;
  const ssize_t count = recv(sockets_.parent.get(), buffer.data(), buffer.size(), MSG_DONTWAIT);
  if (count > 0) {
    received_.append(buffer.data(), static_cast<std::size_t>(count));
  }
  return count > 0 || (count < 0 && (errno == EAGAIN || errno == EINTR));
}

void ChildProcess::check_memory() {
  const auto now = measure_data_bytes(std::to_string(pid_));
  if (!memory_at_start_ || !now) {
    return;
  }
  if (static_cast<double>(*now - *memory_at_start_) > limits_.memory_mib * kMib) {
    throw ChildFailure(fmt::format(
        "took more memory than the {} MiB it may (option memory_mib) and had to be killed",
        limits_.memory_mib));
  }
}

void ChildProcess::explain_death() {
  siginfo_t info{};
  waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOHANG | WNOWAIT);
  if (info.si_code == CLD_EXITED) {
    throw ChildFailure(
        fmt::format("ended its process with exit code {} before it had finished", info.si_status));
  }
  throw ChildFailure(
      fmt::format("was killed by signal {} ({})", info.si_status, strsignal(info.si_status)));
}

}  // namespace armwright
