#include "study/executor/chunk_planner.hpp"

#include <gtest/gtest.h>

namespace armwright {
namespace {

constexpr BatchSize kOne{};
constexpr BatchSize kLanes{.granularity = 8, .largest = 64};
constexpr double kLong = 1e9;  // the threads here would take forever

TEST(ChunkPlanner, LeavesAllToTheOnlyThread) {
  EXPECT_EQ(plan_local_chunk(kLanes, 1000, {.here = 1}, 1e-3), 64u);
  EXPECT_EQ(plan_local_chunk(kLanes, 10, {.here = 1}, {}), 10u);
}

TEST(ChunkPlanner, AChunkLastsTenMilliseconds) {
  const TeamSize team{.here = 1, .elsewhere = 1};
  EXPECT_EQ(plan_remote_chunk(kOne, 100'000, team, 50e-6, kLong, {}), 200u);
  EXPECT_EQ(plan_remote_chunk(kOne, 100'000, team, 5e-3, kLong, {}), 2u);
  EXPECT_EQ(plan_remote_chunk(kOne, 100'000, team, 17.0, kLong, {}), 1u);
  EXPECT_EQ(plan_remote_chunk(kOne, 100'000, team, 50e-6, kLong, {.threads = 16}), 3200u);
}

TEST(ChunkPlanner, ChunksShrinkTowardsTheEnd) {
  const TeamSize team{.here = 1, .elsewhere = 3};
  std::size_t last = 1'000'000;
  for (std::size_t left = 4000; left > 0;) {
    const std::size_t pairs = plan_remote_chunk(kOne, left, team, 50e-6, kLong, {});
    ASSERT_GT(pairs, 0u);
    EXPECT_LE(pairs, last);
    EXPECT_LE(pairs, left / 8 + 1);
    last = pairs;
    left -= pairs;
  }
}

TEST(ChunkPlanner, LanesAreFilled) {
  const TeamSize team{.here = 2, .elsewhere = 2};
  for (const std::size_t left : {500u, 77u, 9u}) {
    EXPECT_EQ(plan_local_chunk(kLanes, left, team, 1e-4) % 8, 0u) << left;
    EXPECT_EQ(plan_remote_chunk(kLanes, left, team, 1e-4, kLong, {}) % 8, 0u) << left;
  }
  EXPECT_EQ(plan_local_chunk(kLanes, 3, team, 1e-4), 3u);
}

TEST(ChunkPlanner, AWorkerGetsNothingThatItWouldHaveDoneTooLate) {
  const TeamSize team{.here = 1, .elsewhere = 1};
  const WorkerLoad load{.latency_s = 1e-3};
  // Two pairs of 5 ms: one here and one there is faster, unless the worker has another one already.
  EXPECT_EQ(plan_remote_chunk(kOne, 2, team, 5e-3, 10e-3, load), 1u);
  EXPECT_EQ(plan_remote_chunk(kOne, 1, team, 5e-3, 5e-3, load), 0u);
  EXPECT_EQ(plan_remote_chunk(kOne, 2, team, 5e-3, 10e-3,
                              {.chunks = 1, .busy_s = 5e-3, .latency_s = 1e-3}),
            0u);
  // A batch that takes half as long as a message.
  EXPECT_EQ(plan_remote_chunk(kOne, 10, team, 50e-6, 0.5e-3, load), 0u);
}

TEST(ChunkPlanner, AWorkerHasOneChunkAheadAndNoMore) {
  const TeamSize team{.here = 1, .elsewhere = 1};
  EXPECT_GT(plan_remote_chunk(kOne, 1000, team, 5e-3, 5.0, {.chunks = 1, .busy_s = 10e-3}), 0u);
  EXPECT_EQ(plan_remote_chunk(kOne, 1000, team, 5e-3, 5.0, {.chunks = 2, .busy_s = 20e-3}), 0u);
}

TEST(ChunkPlanner, GoesCarefullyWhereCostsAreUnknown) {
  const TeamSize team{.here = 2, .elsewhere = 4};
  EXPECT_EQ(plan_local_chunk(kLanes, 1000, team, {}), 8u);
  EXPECT_EQ(plan_remote_chunk(kLanes, 1000, team, {}, 0, {.threads = 4}), 32u);
  EXPECT_EQ(plan_remote_chunk(kLanes, 1000, team, {}, 0, {.threads = 4, .chunks = 1}), 0u);
  EXPECT_EQ(plan_remote_chunk(kLanes, 16, team, {}, 0, {.threads = 4}), 0u);
}

TEST(PairCost, FollowsWhatIsMeasured) {
  PairCost cost;
  EXPECT_FALSE(cost.get_s());
  cost.add(1, 0);
  EXPECT_FALSE(cost.get_s());
  cost.add(1, 100);
  EXPECT_DOUBLE_EQ(*cost.get_s(), 0.01);
  for (int i = 0; i < 30; ++i) {
    cost.add(2, 100);
  }
  EXPECT_NEAR(*cost.get_s(), 0.02, 1e-5);
}

TEST(WorkerLatency, ASlowAnswerIsSoonForgotten) {
  WorkerLatency latency;
  for (int i = 0; i < 20; ++i) {
    latency.add(2e-4);
  }
  EXPECT_NEAR(latency.get_s(0), 2e-4, 1e-5);
  latency.add(5);  // the machine was suspended
  EXPECT_LT(latency.get_s(0), 5e-4);
  for (int i = 0; i < 100; ++i) {
    latency.add(0.05);  // the latency stays high
  }
  EXPECT_NEAR(latency.get_s(0), 0.05, 1e-3);
  EXPECT_LT(latency.get_s(100), 1e-3);
}

}  // namespace
}  // namespace armwright
