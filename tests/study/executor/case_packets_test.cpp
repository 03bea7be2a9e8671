// Tests that pairs and outcomes arrive with all their bits, and that damaged packets are refused.
#include "study/executor/case_packets.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "base/bits.hpp"

namespace armwright {
namespace {

class Nothing final : public Problem {
 public:
  const ProblemDescription& description() const override { return description_; }
  BatchSize batch_size(CaseRole /*role*/) const override {
    return {.granularity = 2, .largest = 4};
  }
  std::vector<CaseOutcome> simulate(std::span<const CaseJob> jobs) const override {
    return std::vector<CaseOutcome>(jobs.size());
  }
  Evaluation aggregate(std::span<const double> /*x*/,
                       std::span<const CaseOutcome> /*outcomes*/) const override {
    return {};
  }
  std::vector<double> penalty_objectives() const override { return {0}; }

 private:
  ProblemDescription description_;
};

const std::vector<std::vector<double>> kPoints = {
    {1, -0.0}, {std::numeric_limits<double>::denorm_min(), 1e308}, {3, 0.1}, {4, 4}, {5, 5}};

struct SomeBatch {
  Nothing problem;
  std::vector<std::span<const double>> candidates{kPoints.begin(), kPoints.end()};
  CaseBlock block{CaseRole::validation, "validation/1", {3, std::uint64_t{1} << 63, 5}};
  CaseBatch batch{problem,
                  candidates,
                  block,
                  {.residuals = true, .jacobian = false},
                  [](const CaseBatch&, std::size_t, std::vector<CaseOutcome>) {}};
};

TEST(CasePackets, JobsArriveAsTheyWere) {
  const SomeBatch some;
  for (std::size_t first = 0; first < some.batch.size(); ++first) {
    for (std::size_t count = 1; first + count <= some.batch.size(); ++count) {
      PacketWriter packet;
      put_jobs(packet, some.batch, first, count);
      PacketReader reader(packet.bytes());
      ReceivedJobs received;
      get_jobs(reader, received);
      const auto jobs = some.batch.make_jobs(first, count);
      ASSERT_EQ(received.jobs.size(), jobs.size());
      for (std::size_t i = 0; i < jobs.size(); ++i) {
        EXPECT_TRUE(same_bits(received.jobs[i].x, jobs[i].x));
        EXPECT_EQ(received.jobs[i].number, jobs[i].number);
        EXPECT_EQ(received.jobs[i].block->role, CaseRole::validation);
        EXPECT_EQ(received.jobs[i].block->set, "validation/1");
        EXPECT_TRUE(received.jobs[i].residuals);
        EXPECT_FALSE(received.jobs[i].jacobian);
      }
    }
  }
}

TEST(CasePackets, BatchesArriveAsTheyWere) {
  const SomeBatch some;
  PacketWriter packet;
  put_batch(packet, some.batch);
  PacketReader reader(packet.bytes());
  ReceivedBatch received;
  get_batch(reader, received);
  EXPECT_EQ(received.block.numbers, some.block.numbers);
  EXPECT_EQ(received.block.set, some.block.set);
  EXPECT_EQ(received.block.role, some.block.role);
  EXPECT_TRUE(received.extras.residuals);
  ASSERT_EQ(received.candidates.size(), kPoints.size());
  for (std::size_t i = 0; i < kPoints.size(); ++i) {
    EXPECT_TRUE(same_bits(received.candidates[i], kPoints[i]));
  }
}

TEST(CasePackets, OutcomesArriveAsTheyWere) {
  std::vector<CaseOutcome> outcomes(2);
  outcomes[0].status = EvaluationStatus::diverged;
  outcomes[0].reason = "joint_2 at 0.5 s";
  outcomes[0].error = std::numeric_limits<double>::quiet_NaN();
  outcomes[0].has_error = false;
  outcomes[1].error = -0.0;
  outcomes[1].metrics = {1, 2};
  outcomes[1].residuals = {3};
  outcomes[1].jacobian = {4, 5, 6};
  PacketWriter packet;
  put_outcomes(packet, outcomes);
  PacketReader reader(packet.bytes());
  const auto received = get_outcomes(reader);
  ASSERT_EQ(received.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(received[i].status, outcomes[i].status);
    EXPECT_EQ(received[i].reason, outcomes[i].reason);
    EXPECT_TRUE(same_bits({&received[i].error, 1}, {&outcomes[i].error, 1}));
    EXPECT_EQ(received[i].has_error, outcomes[i].has_error);
    EXPECT_EQ(received[i].metrics, outcomes[i].metrics);
    EXPECT_EQ(received[i].residuals, outcomes[i].residuals);
    EXPECT_EQ(received[i].jacobian, outcomes[i].jacobian);
  }
}

TEST(CasePackets, WhatEndsEarlyOrIsNoneIsRefused) {
  const SomeBatch some;
  PacketWriter jobs, batch, outcomes;
  put_jobs(jobs, some.batch, 0, 5);
  put_batch(batch, some.batch);
  put_outcomes(outcomes, std::vector<CaseOutcome>(2));
  for (const PacketWriter* packet : {&jobs, &batch, &outcomes}) {
    for (std::size_t size = 0; size < packet->bytes().size(); ++size) {
      PacketReader reader(std::string_view(packet->bytes()).substr(0, size));
      ReceivedJobs received_jobs;
      ReceivedBatch received_batch;
      if (packet == &jobs) {
        EXPECT_THROW(get_jobs(reader, received_jobs), PacketError) << size;
      } else if (packet == &batch) {
        EXPECT_THROW(get_batch(reader, received_batch), PacketError) << size;
      } else {
        EXPECT_THROW(get_outcomes(reader), PacketError) << size;
      }
    }
  }
  std::string no_role = jobs.bytes();
  no_role[0] = 17;
  PacketReader reader(no_role);
  ReceivedJobs received;
  EXPECT_THROW(get_jobs(reader, received), PacketError);
}

}  // namespace
}  // namespace armwright
