// Messages between the ranks of a job: rank 0 coordinates, all others work for it. Nobody waits in
// here, so that nobody spins: whoever has nothing to do sleeps between two looks.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

namespace armwright {

class Links {
 public:
  virtual ~Links() = default;
  virtual std::size_t rank() const = 0;
  virtual std::size_t size() const = 0;  // ranks

  // Hands the message over and returns; it arrives behind those sent to that rank before, or never
  // if the rank is no more. Not to be called from two threads at once, nor beside receive().
  virtual void send(std::size_t to, std::string message) = 0;
  struct Message {
    std::size_t from;
    std::string bytes;
  };
  virtual std::optional<Message> receive() = 0;  // nothing if none has arrived
};

}  // namespace armwright
