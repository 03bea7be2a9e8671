#include "study/matrix/command_output.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <vector>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/file_descriptor.hpp"

namespace armwright {
namespace {

constexpr std::size_t kMostOutput_bytes = std::size_t{1} << 20;

struct OutputEnds {
  FileDescriptor read;
  FileDescriptor write;
};

OutputEnds open_output(const std::string& program) {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) {
    fail_io(program, "connect to it", errno);
  }
  return {FileDescriptor(ends[0]), FileDescriptor(ends[1])};
}

// Appends some of the output to `text`. Returns false at the end of the stream.
bool read_some(const FileDescriptor& from, std::string& text) {
  std::array<char, 4096> buffer{};
  const ssize_t got = ::read(from.get(), buffer.data(), buffer.size());
  if (got < 0 && errno == EINTR) {
    return true;
  }
  if (got <= 0) {
    return false;
  }
  const std::size_t room = kMostOutput_bytes - text.size();
  text.append(buffer.data(), std::min(room, static_cast<std::size_t>(got)));
  return true;
}

pid_t start_command(std::span<const std::string> words, int out, int err) {
  std::vector<std::string> copies(words.begin(), words.end());
  std::vector<char*> pointers;
  for (std::string& word : copies) {
    pointers.push_back(word.data());
  }
  pointers.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, out, STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, err, STDERR_FILENO);
  // The program starts with the default action for signals that this process ignores.
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t ignored;
  sigemptyset(&ignored);
  sigaddset(&ignored, SIGPIPE);
  sigaddset(&ignored, SIGXFSZ);
  posix_spawnattr_setsigdefault(&attributes, &ignored);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF);
  pid_t pid = -1;
  const int error =
      ::posix_spawnp(&pid, pointers[0], &actions, &attributes, pointers.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (error == ENOENT) {
    throw Error(ErrorKind::usage,
                fmt::format("there is no program '{}' on this machine's PATH", words.front()));
  }
  if (error != 0) {
    fail_io(words.front(), "start it", error);
  }
  return pid;
}

}  // namespace

CommandOutput run_command(std::span<const std::string> words) {
  OutputEnds out = open_output(words.front());
  OutputEnds err = open_output(words.front());
  const pid_t pid = start_command(words, out.write.get(), err.write.get());
  out.write.close();
  err.write.close();
  CommandOutput output;
  bool out_open = true;
  bool err_open = true;
  while (out_open || err_open) {
    std::array<pollfd, 2> waits = {pollfd{out_open ? out.read.get() : -1, POLLIN, 0},
                                   pollfd{err_open ? err.read.get() : -1, POLLIN, 0}};
    if (::poll(waits.data(), waits.size(), -1) < 0) {
      continue;  // interrupted by a signal
    }
    out_open = out_open && (waits[0].revents == 0 || read_some(out.read, output.out));
    err_open = err_open && (waits[1].revents == 0 || read_some(err.read, output.err));
  }
  int status = 0;
  while (::waitpid(pid, &status, 0) < 0 && errno == EINTR) {
  }
  output.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return output;
}

}  // namespace armwright
