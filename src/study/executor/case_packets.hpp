// Pairs to be simulated and their outcomes as bytes, from one process of the same program to
// another (optimizers/packet.hpp): every number with all its bits.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "process/packet.hpp"
#include "study/executor/case_batch.hpp"

namespace armwright {

// Some pairs of a batch, as they arrive: they refer to what they came with.
struct ReceivedJobs {
  CaseBlock block;  // without numbers: the jobs have theirs
  std::vector<std::vector<double>> points;
  std::vector<CaseJob> jobs;

  ReceivedJobs() = default;
  ReceivedJobs(const ReceivedJobs&) = delete;
  ReceivedJobs& operator=(const ReceivedJobs&) = delete;
};
void put_jobs(PacketWriter& packet, const CaseBatch& batch, std::size_t first, std::size_t count);
void get_jobs(PacketReader& packet, ReceivedJobs& jobs);

void put_outcomes(PacketWriter& packet, std::span<const CaseOutcome> outcomes);
std::vector<CaseOutcome> get_outcomes(PacketReader& packet);

// A whole batch.
struct ReceivedBatch {
  std::vector<std::vector<double>> points;
  std::vector<std::span<const double>> candidates;  // these
  CaseBlock block;
  CaseExtras extras;

  ReceivedBatch() = default;
  ReceivedBatch(const ReceivedBatch&) = delete;
  ReceivedBatch& operator=(const ReceivedBatch&) = delete;
};
void put_batch(PacketWriter& packet, const CaseBatch& batch);
void get_batch(PacketReader& packet, ReceivedBatch& batch);

}  // namespace armwright
