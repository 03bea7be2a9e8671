// What coordinator and workers say to each other. Every message is a packet that begins with its
// kind.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>

#include "process/packet.hpp"

namespace armwright {

enum class RankMessage : std::uint8_t {
  // Of a worker.
  ready,     // its introduction (WorkerIntroduction)
  outcomes,  // chunk, seconds of a thread that each pair took, outcomes
  failed,    // chunk, why: this rank is of no use
  bye,       // it has ended its work, as it was told to
  // Of the coordinator.
  chunk,     // chunk, problem, pairs
  forget,    // problem: its cases are not needed any more
  alive,     // says nothing else
  end,       // no more work
  finalize,  // everybody has said bye: leave in order
  leave      // somebody has not: leave without
};

// What a worker says of itself. Results are the same only if all ranks have the same problems and
// the same program: `identity` is a JSON text that says what those are.
struct WorkerIntroduction {
  std::string host;
  std::string cpu;
  std::uint64_t threads = 1;
  std::string identity;
  std::string failure;  // why it cannot work at all; empty if it can
};

inline std::string make_rank_message(const WorkerIntroduction& introduction) {
  PacketWriter packet;
  packet.put(RankMessage::ready);
  packet.put(std::string_view(introduction.host));
  packet.put(std::string_view(introduction.cpu));
  packet.put(introduction.threads);
  packet.put(std::string_view(introduction.identity));
  packet.put(std::string_view(introduction.failure));
  return packet.bytes();
}
// Behind its kind.
inline WorkerIntroduction get_introduction(PacketReader& packet) {
  WorkerIntroduction introduction;
  introduction.host = packet.get_text();
  introduction.cpu = packet.get_text();
  introduction.threads = std::max<std::uint64_t>(1, packet.get<std::uint64_t>());
  introduction.identity = packet.get_text();
  introduction.failure = packet.get_text();
  return introduction;
}

inline std::string make_rank_message(RankMessage kind) {
  PacketWriter packet;
  packet.put(kind);
  return packet.bytes();
}

}  // namespace armwright
