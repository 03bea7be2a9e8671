// The messages between the coordinator (rank 0) and its workers. Every message is a packet
// (process/packet.hpp) that begins with its kind.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "process/packet.hpp"

namespace armwright {

struct LoadedProblem;

// The kind of a message and, in its comment, the fields that follow it.
enum class RankMessage : std::uint8_t {
  // From a worker to the coordinator:
  ready,     // the worker's WorkerIntroduction
  outcomes,  // chunk number, thread seconds per pair, outcomes
  failed,    // chunk number, the reason; the worker cannot be used any more
  bye,       // the worker has ended its work, as `end` asked it to
  // From the coordinator to a worker:
  chunk,     // chunk number, problem number, pairs
  forget,    // problem number; its cases are not needed any more
  alive,     // no fields; tells the worker that the coordinator still runs
  end,       // no fields; there is no more work
  finalize,  // no fields; every worker has said bye: end MPI in order
  leave      // no fields; some worker is missing: exit without ending MPI
};

// A worker's description of itself. Results are bit-identical only if all ranks have the same
// program and the same problems; `identity` is a JSON text that names both.
struct WorkerIntroduction {
  std::string host;
  std::string cpu;
  std::uint64_t threads = 1;
  std::string identity;
  std::string failure;  // why the worker cannot work at all; empty if it can
};

// Returns a message of one field or none.
std::string make_rank_message(const WorkerIntroduction& introduction);
std::string make_rank_message(RankMessage kind);
// Reads the introduction behind the kind. Throws PacketError if the packet is too short.
WorkerIntroduction get_introduction(PacketReader& packet);

// Returns what must be the same on all ranks: program, libraries and the whole configuration of
// the problems, as JSON text.
std::string make_rank_identity(std::span<const LoadedProblem* const> problems);

// Returns the introduction of this machine, with an empty identity.
WorkerIntroduction make_introduction(unsigned threads);

}  // namespace armwright
