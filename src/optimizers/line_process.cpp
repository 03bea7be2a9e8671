#include "optimizers/line_process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <system_error>
#include <utility>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/text.hpp"
#include "optimizers/process_watch.hpp"

namespace armwright {
namespace {

constexpr auto kSlice = std::chrono::milliseconds(100);  // between two looks at what is watched

using Clock = LineProcess::Clock;

Clock::time_point after(double seconds) {
  return Clock::now() +
         std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
}

// Resident memory in MiB; 0 for a process that is gone.
double read_memory_mib(pid_t pid) {
  const auto memory = measure_memory(std::to_string(pid));
  return memory ? static_cast<double>(memory->resident_bytes) / 1048576 : 0;
}

void set_nonblocking(int fd) {
  fcntl(fd, F_SETFL, fcntl(fd, F_GETFL) | O_NONBLOCK);
}

std::string describe_exit(int status) {
  if (WIFSIGNALED(status)) {
    return describe_signal(WTERMSIG(status));
  }
  return fmt::format("ended with exit code {}", WEXITSTATUS(status));
}

// posix_spawn's two descriptions of the child, freed at the end of their scope.
struct SpawnSettings {
  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;

  SpawnSettings() {
    posix_spawn_file_actions_init(&actions);
    posix_spawnattr_init(&attributes);
    sigset_t none;
    sigset_t all;
    sigemptyset(&none);
    sigfillset(&all);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setsigdefault(&attributes, &all);
    posix_spawnattr_setpgroup(&attributes, 0);  // Ctrl-C is ours to answer, and kill() takes all
    posix_spawnattr_setflags(
        &attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
  }
  ~SpawnSettings() {
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
  }
  SpawnSettings(const SpawnSettings&) = delete;
  SpawnSettings& operator=(const SpawnSettings&) = delete;
};

}  // namespace

LineProcess::LineProcess(const std::vector<std::string>& words, OutputLog& log)
    : log_(log), next_memory_check_(Clock::now()) {
  // The child's input is a socket, not a pipe: send() can be told not to raise SIGPIPE.
  std::array<int, 2> to_child{};
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, to_child.data()) != 0) {
    fail_io(words.front(), "connect to the process", errno);
  }
  input_.reset(to_child[0]);
  const FileDescriptor child_input(to_child[1]);
  std::array<int, 2> from_child{};
  if (pipe2(from_child.data(), O_CLOEXEC) != 0) {
    fail_io(words.front(), "connect to the process", errno);
  }
  output_.reset(from_child[0]);
  const FileDescriptor child_output(from_child[1]);
  set_nonblocking(input_.get());
  set_nonblocking(output_.get());

  SpawnSettings settings;
  posix_spawn_file_actions_adddup2(&settings.actions, child_input.get(), STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&settings.actions, child_output.get(), STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&settings.actions, log_.child_end(), STDERR_FILENO);
  posix_spawn_file_actions_addclosefrom_np(&settings.actions, STDERR_FILENO + 1);
  std::vector<char*> arguments;
  std::ranges::transform(words, std::back_inserter(arguments),
                         [](const std::string& word) { return const_cast<char*>(word.c_str()); });
  arguments.push_back(nullptr);
  const int error = posix_spawnp(&pid_, words.front().c_str(), &settings.actions,
                                 &settings.attributes, arguments.data(), environ);
  log_.close_child_end();
  if (error != 0) {
    pid_ = -1;
    throw Error(ErrorKind::usage,
                fmt::format("cannot start '{}': {}; it must be a program on the PATH or the path "
                            "of one",
                            sanitize(words.front()), std::generic_category().message(error)));
  }
}

LineProcess::~LineProcess() {
  try {
    kill();
  } catch (const std::exception&) {
    // Dead it is; only its last words are lost.
  }
}

void LineProcess::limit_memory(double mib) {
  memory_limit_mib_ = mib;
  memory_mib_at_start_ = read_memory_mib(pid_);
}

std::string LineProcess::kill() {
  if (pid_ < 0) {
    return "ended";
  }
  kill_group(pid_);
  const int status = reap(std::exchange(pid_, -1));
  log_.take_available();
  return describe_exit(status);
}

void LineProcess::check_memory() {
  const auto now = Clock::now();
  if (memory_limit_mib_ <= 0 || now < next_memory_check_) {
    return;
  }
  next_memory_check_ = now + kSlice;
  const double grown_mib = read_memory_mib(pid_) - memory_mib_at_start_;
  if (grown_mib > memory_limit_mib_) {
    throw LineProcessFailure(
        fmt::format("took {:.0f} MiB of memory beyond what it began with; {:.0f} MiB are allowed "
                    "(option memory_mib)",
                    grown_mib, memory_limit_mib_));
  }
}

void LineProcess::read_available() {
  std::array<char, 65536> buffer;
  while (!at_end_ && received_.size() <= kLongestLine) {
    const ssize_t count = read(output_.get(), buffer.data(), buffer.size());
    if (count > 0) {
      received_.append(buffer.data(), static_cast<std::size_t>(count));
    } else if (count == 0) {
      at_end_ = true;
    } else if (errno != EINTR) {
      return;  // nothing more for now
    }
  }
}

std::optional<std::string> LineProcess::take_line() {
  const std::size_t end = received_.find('\n', searched_);
  const std::size_t length = std::min(end, received_.size()) - taken_;
  if (length > kLongestLine) {
    throw LineProcessFailure(
        fmt::format("sent a line of more than {} MiB", kLongestLine / (1024 * 1024)));
  }
  if (end == std::string::npos) {
    received_.erase(0, taken_);
    taken_ = 0;
    searched_ = received_.size();
    return std::nullopt;
  }
  std::string line = received_.substr(taken_, length);
  taken_ = end + 1;
  searched_ = taken_;
  return line;
}

void LineProcess::send(const std::string& line, double silence_s) {
  const std::string text = line + '\n';
  const auto deadline = after(silence_s);
  std::size_t sent = 0;
  while (sent < text.size()) {
    const ssize_t count =
        ::send(input_.get(), text.data() + sent, text.size() - sent, MSG_NOSIGNAL);
    if (count >= 0) {
      sent += static_cast<std::size_t>(count);
      continue;
    }
    if (errno == EPIPE || errno == ECONNRESET) {
      return;  // it does not listen: receive() finds out why
    }
    if (has_ended(pid_)) {
      return;
    }
    if (Clock::now() > deadline) {
      throw LineProcessSilence(fmt::format("has not read its input for {:g} s", silence_s));
    }
    check_memory();
    log_.take_available();
    // It may have to get rid of something before it listens.
    const bool has_room = !at_end_ && received_.size() <= kLongestLine;
    std::array<pollfd, 3> waiting{pollfd{input_.get(), POLLOUT, 0}, pollfd{log_.get(), POLLIN, 0},
                                  pollfd{has_room ? output_.get() : -1, POLLIN, 0}};
    poll(waiting.data(), waiting.size(), static_cast<int>(kSlice.count()));
    read_available();
  }
}

std::optional<std::string> LineProcess::receive(double silence_s,
                                                const std::function<bool()>& is_given_up) {
  const auto deadline = after(silence_s);
  while (true) {
    if (auto line = take_line()) {
      return line;
    }
    check_memory();
    log_.take_available();
    if (is_given_up()) {
      return std::nullopt;
    }
    // What it wrote before it ended is read first, whoever else holds its output open.
    const bool ended = has_ended(pid_);
    const std::size_t before = received_.size();
    read_available();
    const bool has_grown = received_.size() > before;
    if (has_grown) {
      if (auto line = take_line()) {
        return line;
      }
    }
    // Only a whole line breaks the silence: one byte now and then would keep us here for ever.
    const bool is_late = Clock::now() > deadline;
    if (has_grown && !is_late) {
      continue;
    }
    if (ended) {
      throw LineProcessFailure(kill());
    }
    if (is_late) {
      if (at_end_) {
        throw LineProcessFailure("closed its standard output");
      }
      if (!received_.empty()) {
        throw LineProcessSilence(
            fmt::format("has begun a line and not ended it within {:g} s", silence_s));
      }
      throw LineProcessSilence(fmt::format("has been silent for {:g} s", silence_s));
    }
    if (at_end_) {
      poll(nullptr, 0, 10);  // it is about to end
    } else {
      std::array<pollfd, 2> waiting{pollfd{output_.get(), POLLIN, 0},
                                    pollfd{log_.get(), POLLIN, 0}};
      poll(waiting.data(), waiting.size(), static_cast<int>(kSlice.count()));
    }
  }
}

std::string LineProcess::finish(double patience_s) {
  input_.close();
  const auto deadline = after(patience_s);
  while (!has_ended(pid_)) {
    received_.clear();
    taken_ = searched_ = 0;
    read_available();  // so that it does not wait for us
    log_.take_available();
    if (Clock::now() > deadline) {
      kill();
      return "";
    }
    poll(nullptr, 0, 2);
  }
  const std::string exit = kill();
  return exit == describe_exit(0) ? "" : exit;
}

}  // namespace armwright
