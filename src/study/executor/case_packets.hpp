// Pairs to simulate and their outcomes as bytes (process/packet.hpp), between processes of the same
// program. Every number keeps all its bits. The get_ functions throw PacketError for bytes that are
// not what they expect.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "process/packet.hpp"
#include "study/executor/case_executor.hpp"

namespace armwright {

// Some pairs of a batch, as received. The jobs refer to the block and the points of this object, so
// it cannot be copied.
struct ReceivedJobs {
  CaseBlock block;  // its numbers are empty: each job has its own
  std::vector<std::vector<double>> points;
  std::vector<CaseJob> jobs;

  ReceivedJobs() = default;
  ReceivedJobs(const ReceivedJobs&) = delete;
  ReceivedJobs& operator=(const ReceivedJobs&) = delete;
};
// Writes the pairs first, ..., first + count - 1 of the batch.
void put_jobs(PacketWriter& packet, const CaseBatch& batch, std::size_t first, std::size_t count);
void get_jobs(PacketReader& packet, ReceivedJobs& jobs);

void put_outcomes(PacketWriter& packet, std::span<const CaseOutcome> outcomes);
std::vector<CaseOutcome> get_outcomes(PacketReader& packet);

// A whole batch, as received. The candidates refer to the points of this object, so it cannot be
// copied.
struct ReceivedBatch {
  std::vector<std::vector<double>> points;
  std::vector<std::span<const double>> candidates;
  CaseBlock block;
  CaseExtras extras;

  ReceivedBatch() = default;
  ReceivedBatch(const ReceivedBatch&) = delete;
  ReceivedBatch& operator=(const ReceivedBatch&) = delete;
};
void put_batch(PacketWriter& packet, const CaseBatch& batch);
void get_batch(PacketReader& packet, ReceivedBatch& batch);

}  // namespace armwright
