// Messages between the ranks of a job. Rank 0 is the coordinator, all other ranks are workers. No
// function here blocks, so a rank that has nothing to do can sleep between two calls of receive().
#pragma once

#include <cstddef>
#include <optional>
#include <string>

namespace armwright {

// A transport connects one rank with all others. Not thread-safe: only one thread at a time may
// call send() or receive().
class MessageTransport {
 public:
  struct Message {
    std::size_t from;  // rank
    std::string bytes;
  };

  virtual ~MessageTransport() = default;
  virtual std::size_t rank() const = 0;  // of this process
  virtual std::size_t size() const = 0;  // number of ranks

  // Starts to send the message and returns at once. Messages to one rank arrive in the order of
  // their sending. A message to a rank that has died is lost without an error.
  virtual void send(std::size_t to, std::string message) = 0;
  // Returns the next message that has arrived, or nothing if there is none.
  virtual std::optional<Message> receive() = 0;
};

}  // namespace armwright
