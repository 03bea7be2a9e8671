#include "process/line_process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <system_error>
#include <utility>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/text.hpp"
#include "process/fork_support.hpp"
#include "process/process_watch.hpp"
#include "process/stop_scope.hpp"

namespace armwright {
namespace {

constexpr auto kSlice = std::chrono::milliseconds(100);  // the time between two checks

// Of output that is thrown away. More than a pipe holds, so that what a program wrote before its end
// is read at once.
constexpr std::size_t kMostAtOnce = std::size_t{1} << 20;

using Clock = LineProcess::Clock;

Clock::time_point after(double seconds) {
  return Clock::now() +
         std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
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

// The data that the child needs to start the program. It is prepared before the fork, because the
// child must not allocate memory after it.
struct ChildPlan {
  pid_t parent = -1;
  std::array<int, 3> streams{};  // standard input, output and error
  int report = -1;               // the child writes errno here if it cannot start
  char* const* words = nullptr;
  const char* folder = nullptr;  // null: that of the parent
};

[[noreturn]] void become_program(const ChildPlan& plan) {
  constexpr int kReport = STDERR_FILENO + 1;
  lead_own_group();
  die_with(plan.parent);
  for (int stream = 0; stream < std::ssize(plan.streams); ++stream) {
    dup2(plan.streams[static_cast<std::size_t>(stream)], stream);
  }
  if (plan.report != kReport) {
    dup3(plan.report, kReport, O_CLOEXEC);
  }
  closefrom(kReport + 1);
  reset_signals();
  if (plan.folder == nullptr || chdir(plan.folder) == 0) {
    execvp(plan.words[0], plan.words);
  }
  const int error = errno;
  [[maybe_unused]] const ssize_t told = write(kReport, &error, sizeof error);
  _exit(EXIT_FAILURE);
}

// Returns 0 if the program has started, otherwise the errno that explains why not.
int read_report(int report) {
  int error = 0;
  ssize_t count = 0;
  do {
    count = read(report, &error, sizeof error);
  } while (count < 0 && errno == EINTR);
  return count == sizeof error ? error : 0;
}

}  // namespace

LineProcess::LineProcess(const std::vector<std::string>& words, OutputLog& log,
                         const std::filesystem::path& folder)
    : log_(log), next_memory_check_(Clock::now()) {
  // The child's input is a socket and not a pipe, so that send() can suppress SIGPIPE.
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

  std::array<int, 2> report{};
  if (pipe2(report.data(), O_CLOEXEC) != 0) {
    fail_io(words.front(), "connect to the process", errno);
  }
  const FileDescriptor our_report(report[0]);
  FileDescriptor child_report(report[1]);
  std::vector<char*> arguments;
  std::ranges::transform(words, std::back_inserter(arguments),
                         [](const std::string& word) { return const_cast<char*>(word.c_str()); });
  arguments.push_back(nullptr);
  const ChildPlan plan{.parent = getpid(),
                       .streams = {child_input.get(), child_output.get(), log_.child_end()},
                       .report = child_report.get(),
                       .words = arguments.data(),
                       .folder = folder.empty() ? nullptr : folder.c_str()};
  {
    const AllSignalsBlocked blocked;
    pid_ = fork();
    if (pid_ == 0) {
      become_program(plan);
    }
  }
  if (pid_ < 0) {
    fail_io(words.front(), "start a process for it", errno);
  }
  setpgid(pid_, pid_);  // the child does the same; either call may be first
  child_report.close();
  log_.close_child_end();
  const int error = read_report(our_report.get());
  if (error != 0) {
    reap(std::exchange(pid_, -1));
    const std::string name = sanitize(words.front());
    const std::string advice =
        error == EACCES && name.find('/') != std::string::npos
            ? "; make it executable: " +
                  quote_command(std::vector<std::string>{"chmod", "+x", name})
            : "; name a program on the PATH or give a program's path";
    throw Error(ErrorKind::usage, fmt::format("cannot start '{}': {}{}", name,
                                              std::generic_category().message(error), advice));
  }
}

LineProcess::~LineProcess() {
  try {
    kill();
  } catch (const std::exception&) {
    // The program is killed; only its last output is lost.
  }
}

void LineProcess::limit_memory(double mib) {
  memory_limit_mib_ = mib;
  memory_mib_at_start_ = measure_tree_mib(pid_, 0);
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
  const auto begin = Clock::now();
  if (memory_limit_mib_ <= 0 || begin < next_memory_check_) {
    return;
  }
  const double grown_mib =
      measure_tree_mib(pid_, memory_mib_at_start_ + memory_limit_mib_) - memory_mib_at_start_;
  // Shares of much memory take long to measure. The pause keeps that below 2 % of the time.
  const auto end = Clock::now();
  next_memory_check_ = end + std::max<Clock::duration>(kSlice, 50 * (end - begin));
  if (grown_mib > memory_limit_mib_) {
    throw LineProcessMemory(
        fmt::format("took {:.0f} MiB of memory beyond what it began with; {:.0f} MiB are allowed "
                    "(option memory_mib)",
                    grown_mib, memory_limit_mib_));
  }
}

void LineProcess::read_available(std::size_t most) {
  std::array<char, 65536> buffer;
  while (!at_end_ && received_.size() <= most) {
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
  WakingTime silence;
  std::size_t sent = 0;
  while (sent < text.size()) {
    const ssize_t count =
        ::send(input_.get(), text.data() + sent, text.size() - sent, MSG_NOSIGNAL);
    if (count >= 0) {
      sent += static_cast<std::size_t>(count);
      continue;
    }
    if (errno == EPIPE || errno == ECONNRESET) {
      return;  // the program has closed its input; receive() reports why
    }
    if (has_ended(pid_)) {
      return;
    }
    check_work_stop();
    silence.look();
    if (silence.get_s() > silence_s) {
      throw LineProcessSilence(fmt::format("has not read its input for {:g} s", silence_s));
    }
    check_memory();
    log_.take_available();
    // The program may have to write its output before it can read its input, so this reads too.
    const bool has_room = !at_end_ && received_.size() <= kLongestLine;
    std::array<pollfd, 3> waiting{pollfd{input_.get(), POLLOUT, 0}, pollfd{log_.get(), POLLIN, 0},
                                  pollfd{has_room ? output_.get() : -1, POLLIN, 0}};
    poll(waiting.data(), waiting.size(), static_cast<int>(kSlice.count()));
    read_available();
  }
}

std::optional<std::string> LineProcess::receive(double silence_s,
                                                const std::function<bool()>& is_given_up) {
  WakingTime silence;
  while (true) {
    if (auto line = take_line()) {
      return line;
    }
    check_work_stop();
    check_memory();
    log_.take_available();
    if (is_given_up()) {
      return std::nullopt;
    }
    // Checks for the program's end before reading: everything that it wrote before its end is then
    // read, even if another process keeps the output open.
    const bool ended = has_ended(pid_);
    const std::size_t before = received_.size();
    read_available();
    const bool has_grown = received_.size() > before;
    if (has_grown) {
      if (auto line = take_line()) {
        return line;
      }
    }
    // Only a whole line ends the silence. Otherwise a program that writes single bytes could block
    // this function forever.
    silence.look();
    const bool is_late = silence.get_s() > silence_s;
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
      poll(nullptr, 0, 10);  // the program ends soon
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
    read_available();  // so that the program does not block on its output
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

LineProcess::Ending LineProcess::complete(double limit_s, std::size_t most_bytes) {
  input_.close();
  // Wakes poll() when the program ends. Without it, poll() wakes after a slice.
  const FileDescriptor end(static_cast<int>(syscall(SYS_pidfd_open, pid_, 0)));
  Ending ending;
  WakingTime passed;
  while (true) {
    // As in receive(): what was written before the end is read after it has been noticed.
    const bool ended = has_ended(pid_);
    read_available(kMostAtOnce);
    const std::size_t room = most_bytes - ending.output.size();
    ending.is_cut |= received_.size() > room;
    ending.output += std::string_view(received_).substr(0, room);
    received_.clear();
    log_.take_available();
    if (ended) {
      break;
    }
    check_work_stop();
    check_memory();
    passed.look();
    if (passed.get_s() > limit_s) {
      throw LineProcessSilence(fmt::format("has not ended within {:g} s", limit_s));
    }
    std::array<pollfd, 3> waiting{pollfd{end.get(), POLLIN, 0},
                                  pollfd{at_end_ ? -1 : output_.get(), POLLIN, 0},
                                  pollfd{log_.get(), POLLIN, 0}};
    poll(waiting.data(), waiting.size(), static_cast<int>(kSlice.count()));
  }
  kill_group(pid_);
  const int status = reap(std::exchange(pid_, -1));
  log_.take_available();
  if (WIFEXITED(status)) {
    ending.exit_code = WEXITSTATUS(status);
  }
  ending.how = describe_exit(status);
  return ending;
}

}  // namespace armwright
