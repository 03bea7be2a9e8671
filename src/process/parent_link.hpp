// The inside of a child process (child_process.hpp): how it cuts itself off from the process it was
// forked from, and what it sends there.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

namespace armwright {

// What became of a child, as the end of a sentence that begins with its name: "was killed by signal
// 11 (Segmentation fault)". A body may throw it too, and it comes out with the same words.
class ChildFailure : public std::runtime_error {
 public:
  // `limit`: the member of ProcessLimits that it went beyond; empty for none.
  explicit ChildFailure(const std::string& what, const char* limit = "")
      : std::runtime_error(what), limit_(limit) {}
  const char* limit() const { return limit_; }

 private:
  const char* limit_;
};

enum class FrameKind : std::uint64_t { message, finished, failure, exception, out_of_memory };

// A frame: this, then `size` bytes. The mark tells apart what a child wrote into a descriptor that
// is not its own.
struct FrameHeader {
  std::uint64_t mark = 0x41524d5752494748;
  std::uint64_t size = 0;
  FrameKind kind = FrameKind::message;
};

std::string make_frame(FrameKind kind, std::string_view message);

// The child's end. If the parent is gone, the child ends: no function returns then.
class ParentLink {
 public:
  explicit ParentLink(int socket) : socket_(socket) {}
  void send(std::string_view message) { send(FrameKind::message, message); }
  void send(FrameKind kind, std::string_view message);
  std::string receive();
  // Sends a question and waits for its answer.
  std::string ask(std::string_view question);

 private:
  int socket_;
};

struct ChildSettings {
  pid_t parent = -1;
  int socket = -1;
  int output = -1;  // where what it prints goes; -1: to the error stream
  std::optional<std::int64_t> data_bytes_at_start = {};
  double memory_mib = 0;  // that it may take beyond that
};

// What a child does between fork() and its end.
[[noreturn]] void run_child(const ChildSettings& settings,
                            const std::function<void(ParentLink&)>& body);

}  // namespace armwright
