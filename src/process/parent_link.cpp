#include "process/parent_link.hpp"

#include <fcntl.h>
#include <stdio_ext.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <new>

#include "process/fork_support.hpp"
#include "process/process_watch.hpp"

namespace armwright {
namespace {

constexpr int kChildSocket = 3;
constexpr std::size_t kMaxTextBytes = 4000;  // of an exception; longer texts are cut

void leave_descriptors_behind(int socket, int output) {
  if (output >= 0) {
    dup2(output, STDERR_FILENO);
  }
  if (socket != kChildSocket) {
    dup3(socket, kChildSocket, O_CLOEXEC);
  }
  closefrom(kChildSocket + 1);
  const int nothing = open("/dev/null", O_RDWR | O_CLOEXEC);
  dup2(nothing, STDIN_FILENO);
  if (nothing > kChildSocket) {
    close(nothing);
  }
  dup2(STDERR_FILENO, STDOUT_FILENO);  // armwright's own output is for results only
}

// Limits the memory that the child can allocate. The parent kills a child that exceeds its limit;
// this limit stops a fast-growing child between two of the parent's checks. It is not used with the
// address sanitizer, whose allocator ends the program if an allocation fails.
[[maybe_unused]] void limit_memory(std::optional<std::int64_t> at_start, double memory_mib) {
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

std::string make_frame(FrameKind kind, std::string_view message) {
  const FrameHeader header{.size = message.size(), .kind = kind};
  std::string frame(reinterpret_cast<const char*>(&header), sizeof header);
  frame += message;
  return frame;
}

void ParentLink::send(FrameKind kind, std::string_view message) {
  const std::string frame = make_frame(kind, message);
  for (std::size_t sent = 0; sent < frame.size();) {
    const ssize_t count = ::send(socket_, frame.data() + sent, frame.size() - sent, MSG_NOSIGNAL);
    if (count < 0 && errno != EINTR) {
      _exit(EXIT_FAILURE);
    }
    sent += count > 0 ? static_cast<std::size_t>(count) : 0;
  }
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

void run_child(const ChildSettings& settings, const std::function<void(ParentLink&)>& body) {
  lead_own_group();
  die_with(settings.parent);
  leave_descriptors_behind(settings.socket, settings.output);
  // Discards the parent's unwritten output, which the child must not write again. The exit handler
  // below ends the process before the handlers that the parent registered earlier.
  __fpurge(stdout);
  setvbuf(stdout, nullptr, _IOLBF, 0);  // keeps lines that the child printed before a crash
  on_exit([](int status, void*) { _exit(status); }, nullptr);
#ifndef __SANITIZE_ADDRESS__
  limit_memory(settings.data_bytes_at_start, settings.memory_mib);
#endif
  reset_signals();
  ParentLink link(kChildSocket);
  try {
    body(link);
    std::fflush(stdout);
    link.send(FrameKind::finished, "");
  } catch (const std::bad_alloc&) {
    link.send(FrameKind::out_of_memory, "");
  } catch (const ChildFailure& failure) {
    std::fflush(stdout);
    link.send(FrameKind::failure, std::string_view(failure.what()).substr(0, kMaxTextBytes));
  } catch (const std::exception& error) {
    std::fflush(stdout);
    link.send(FrameKind::exception, std::string_view(error.what()).substr(0, kMaxTextBytes));
  } catch (...) {
    link.send(FrameKind::exception, "something that is no std::exception");
  }
  _exit(EXIT_SUCCESS);
}

}  // namespace armwright
