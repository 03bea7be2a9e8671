// A result depends on its own job only, not on the thread, the batch or earlier simulations.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <numeric>
#include <thread>
#include <vector>

#include "tracking_arms.hpp"

namespace armwright::physics_test {
namespace {

// Sixteen jobs of every kind: good designs, one that explodes and one that is too weak, with and
// without cut-off and recording, and an unreachable case.
class SixteenJobs : public testing::Test {
 protected:
  SixteenJobs() {
    for (std::uint64_t number = 0; number < 3; ++number) {
      targets_.push_back(setup_.make_targets(make_case(number, 5)));
    }
    TestCase far = make_case(3, 5);
    far.points_m[4] = {2.9, 0.4, 1.1};
    targets_.push_back(setup_.make_targets(far));
    for (std::size_t i = 0; i < 4; ++i) {
      const TargetTable* table = &targets_[i];
      jobs_.push_back({&kTableA1, table, kNever, {true, i == 1}});
      jobs_.push_back({&kTableA5, table, 1.0, {}});
      jobs_.push_back({&kTableA10, table, kNever, {}});
      jobs_.push_back({i % 2 == 0 ? &kExploding : &kLimp, table, 0.5, {false, true}});
    }
    serial_ = engine_->simulate(setup_, jobs_);
  }

  TrackingSetup setup_{load_irb4600(), make_e6_task()};
  std::vector<TargetTable> targets_;
  std::vector<TrackingJob> jobs_;
  std::unique_ptr<PhysicsEngine> engine_ = make_engine("ode");
  std::vector<TrackingResult> serial_;
};

TEST_F(SixteenJobs, AreOfEveryKind) {
  ASSERT_EQ(serial_.size(), 16u);
  for (const auto status : {SimulationStatus::ok, SimulationStatus::cut_off,
                            SimulationStatus::diverged, SimulationStatus::unreachable}) {
    EXPECT_TRUE(std::any_of(serial_.begin(), serial_.end(), [&](const TrackingResult& r) {
      return r.status == status;
    })) << to_string(status);
  }
}

TEST_F(SixteenJobs, RepeatedAreTheSame) {
  const auto again = engine_->simulate(setup_, jobs_);
  ASSERT_EQ(again.size(), serial_.size());
  for (std::size_t i = 0; i < serial_.size(); ++i) {
    SCOPED_TRACE(i);
    expect_identical(again[i], serial_[i]);
  }
}

TEST_F(SixteenJobs, AloneAndInOtherBatchesAreTheSame) {
  for (std::size_t i = 0; i < jobs_.size(); ++i) {
    SCOPED_TRACE(i);
    expect_identical(simulate_one(setup_, jobs_[i]), serial_[i]);
  }
  std::vector<TrackingJob> reversed(jobs_.rbegin(), jobs_.rend());
  const auto results = engine_->simulate(setup_, reversed);
  ASSERT_EQ(results.size(), serial_.size());
  for (std::size_t i = 0; i < jobs_.size(); ++i) {
    SCOPED_TRACE(i);
    expect_identical(results[15 - i], serial_[i]);
  }
  EXPECT_TRUE(engine_->simulate(setup_, {}).empty());
}

// Every thread begins with another job, so that different simulations run at the same time. There
// are several rounds because state shared by mistake shows only when two steps run at the same
// time.
TEST_F(SixteenJobs, InEightThreadsAreTheSame) {
  constexpr std::size_t kThreads = 8, kRounds = 6;
  std::vector<std::vector<TrackingResult>> results(kThreads);
  std::atomic<std::size_t> waiting = kThreads;
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < kThreads; ++t) {
    threads.emplace_back([&, t] {
      for (--waiting; waiting > 0;) {
        std::this_thread::yield();
      }
      for (std::size_t k = 0; k < kRounds * jobs_.size(); ++k) {
        const std::size_t i = (k + 2 * t + t / 4) % jobs_.size();
        results[t].push_back(engine_->simulate(setup_, {&jobs_[i], 1}).at(0));
      }
    });
  }
  for (std::thread& thread : threads) {
    thread.join();
  }
  for (std::size_t t = 0; t < kThreads; ++t) {
    for (std::size_t k = 0; k < results[t].size(); ++k) {
      const std::size_t i = (k + 2 * t + t / 4) % jobs_.size();
      SCOPED_TRACE(testing::Message() << "thread " << t << ", job " << i);
      expect_identical(results[t][k], serial_[i]);
    }
  }
}

}  // namespace
}  // namespace armwright::physics_test
