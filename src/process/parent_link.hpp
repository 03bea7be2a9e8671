// The inside of a child process (child_process.hpp): how it separates itself from its parent, and
// the frames that it sends to it.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

namespace armwright {

// Says how a child failed. The text completes a sentence that begins with the child's name: "was
// killed by signal 11 (Segmentation fault)". A body may throw it too; the parent then throws it
// with the same text.
class ChildFailure : public std::runtime_error {
 public:
  // `limit` is the member of ProcessLimits that the child exceeded; empty for none.
  explicit ChildFailure(const std::string& what, const char* limit = "")
      : std::runtime_error(what), limit_(limit) {}
  const char* limit() const { return limit_; }

 private:
  const char* limit_;
};

enum class FrameKind : std::uint64_t { message, finished, failure, exception, out_of_memory };

// A frame is this header and `size` bytes. The mark distinguishes frames from bytes that a child
// wrote into a wrong descriptor.
struct FrameHeader {
  std::uint64_t mark = 0x41524d5752494748;
  std::uint64_t size = 0;
  FrameKind kind = FrameKind::message;
};

std::string make_frame(FrameKind kind, std::string_view message);

// The child's end of the connection. If the parent has ended, the functions do not return; the
// child ends.
class ParentLink {
 public:
  explicit ParentLink(int socket) : socket_(socket) {}
  void send(std::string_view message) { send(FrameKind::message, message); }
  void send(FrameKind kind, std::string_view message);
  std::string receive();
  // Sends a request and waits for its answer.
  std::string ask(std::string_view question);

 private:
  int socket_;
};

struct ChildSettings {
  pid_t parent = -1;
  int socket = -1;
  int output = -1;  // where its output goes; -1: the standard error
  std::optional<std::int64_t> data_bytes_at_start = {};
  double memory_mib = 0;  // ProcessLimits::memory_mib
};

// Does all the work of a child between fork() and its end.
[[noreturn]] void run_child(const ChildSettings& settings,
                            const std::function<void(ParentLink&)>& body);

}  // namespace armwright
