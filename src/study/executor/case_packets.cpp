#include "study/executor/case_packets.hpp"

#include <algorithm>
#include <cstdint>

namespace armwright {
namespace {

void put_extras(PacketWriter& packet, CaseExtras extras) {
  packet.put(extras.residuals);
  packet.put(extras.jacobian);
}

CaseExtras get_extras(PacketReader& packet) {
  CaseExtras extras;
  extras.residuals = packet.get<bool>();
  extras.jacobian = packet.get<bool>();
  return extras;
}

CaseRole get_role(PacketReader& packet) {
  const auto role = packet.get<CaseRole>();
  if (role > CaseRole::test) {
    throw PacketError("a message has an unknown role of cases");
  }
  return role;
}

// A larger count is refused before any entry is read. Memory grows only with the entries that a
// message really has.
constexpr std::uint64_t kMostEntries = std::uint64_t{1} << 32;

std::uint64_t get_count(PacketReader& packet) {
  const auto count = packet.get<std::uint64_t>();
  if (count > kMostEntries) {
    throw PacketError("a message has a list that is too long");
  }
  return count;
}

std::vector<std::vector<double>> get_points(PacketReader& packet) {
  std::vector<std::vector<double>> points;
  for (std::uint64_t left = get_count(packet); left > 0; --left) {
    points.push_back(packet.get_numbers());
  }
  return points;
}

}  // namespace

void put_jobs(PacketWriter& packet, const CaseBatch& batch, std::size_t first, std::size_t count) {
  packet.put(batch.block().role);
  packet.put(std::string_view(batch.block().set));
  put_extras(packet, batch.extras());
  std::size_t lowest = batch.candidates().size(), highest = 0;
  for (std::size_t number = first; number < first + count; ++number) {
    lowest = std::min(lowest, batch[number].candidate);
    highest = std::max(highest, batch[number].candidate);
  }
  packet.put(std::uint64_t{highest + 1 - lowest});
  for (std::size_t candidate = lowest; candidate <= highest; ++candidate) {
    packet.put(batch.candidates()[candidate]);
  }
  packet.put(std::uint64_t{count});
  for (std::size_t number = first; number < first + count; ++number) {
    const CaseBatch::Pair pair = batch[number];
    packet.put(std::uint64_t{pair.candidate - lowest});
    packet.put(batch.block().numbers[pair.case_index]);
  }
}

void get_jobs(PacketReader& packet, ReceivedJobs& received) {
  received.block.role = get_role(packet);
  received.block.set = packet.get_text();
  const CaseExtras extras = get_extras(packet);
  received.points = get_points(packet);
  for (std::uint64_t left = get_count(packet); left > 0; --left) {
    const auto candidate = packet.get<std::uint64_t>();
    if (candidate >= received.points.size()) {
      throw PacketError("a message names a candidate that it does not hold");
    }
    received.jobs.push_back({.x = received.points[candidate],
                             .block = &received.block,
                             .number = packet.get<std::uint64_t>(),
                             .residuals = extras.residuals,
                             .jacobian = extras.jacobian});
  }
}

void put_outcomes(PacketWriter& packet, std::span<const CaseOutcome> outcomes) {
  packet.put(std::uint64_t{outcomes.size()});
  for (const CaseOutcome& outcome : outcomes) {
    packet.put(outcome.status);
    packet.put(std::string_view(outcome.reason));
    packet.put(outcome.error);
    packet.put(outcome.has_error);
    packet.put(std::span<const double>(outcome.metrics));
    packet.put(std::span<const double>(outcome.residuals));
    packet.put(std::span<const double>(outcome.jacobian));
  }
}

std::vector<CaseOutcome> get_outcomes(PacketReader& packet) {
  std::vector<CaseOutcome> outcomes;
  for (std::uint64_t left = get_count(packet); left > 0; --left) {
    CaseOutcome& outcome = outcomes.emplace_back();
    outcome.status = packet.get<EvaluationStatus>();
    if (outcome.status > EvaluationStatus::abandoned) {
      throw PacketError("a message has an unknown status");
    }
    outcome.reason = packet.get_text();
    outcome.error = packet.get<double>();
    outcome.has_error = packet.get<bool>();
    outcome.metrics = packet.get_numbers();
    outcome.residuals = packet.get_numbers();
    outcome.jacobian = packet.get_numbers();
  }
  return outcomes;
}

void put_batch(PacketWriter& packet, const CaseBatch& batch) {
  const CaseBlock& block = batch.block();
  packet.put(block.role);
  packet.put(std::string_view(block.set));
  packet.put(std::uint64_t{block.numbers.size()});
  for (const std::uint64_t number : block.numbers) {
    packet.put(number);
  }
  put_extras(packet, batch.extras());
  packet.put(std::uint64_t{batch.candidates().size()});
  for (const std::span<const double> x : batch.candidates()) {
    packet.put(x);
  }
}

void get_batch(PacketReader& packet, ReceivedBatch& received) {
  received.block.role = get_role(packet);
  received.block.set = packet.get_text();
  for (std::uint64_t left = get_count(packet); left > 0; --left) {
    received.block.numbers.push_back(packet.get<std::uint64_t>());
  }
  received.extras = get_extras(packet);
  received.points = get_points(packet);
  received.candidates.assign(received.points.begin(), received.points.end());
}

}  // namespace armwright
