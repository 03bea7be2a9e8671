#include "problems/tracking/target_cache.hpp"

#include <gmock/gmock.h>

#include <barrier>
#include <thread>
#include <vector>

#include "base/expect_error.hpp"
#include "problems/config/problem_loader.hpp"

namespace armwright {
namespace {

class TargetCacheTest : public testing::Test {
 protected:
  const std::shared_ptr<const TrackingProblem> problem_ = load_problem("q1-complex").tracking;
  const TrackingSetup& setup_ = problem_->setup();
  const TestSet set_ = problem_->get_set("train/1");
  // All cases of a generated set have the same moves, hence tables of the same size.
  const std::size_t table_bytes_ = setup_.make_targets(set_.make_case(0)).size_bytes();
};

TEST_F(TargetCacheTest, TableIsTheOneThatTheSetupMakes) {
  TargetCache cache(10 * table_bytes_);
  const TargetTable made = setup_.make_targets(set_.make_case(7));
  const auto cached = cache.get(setup_, set_, 7);
  EXPECT_EQ(cached->joint_positions, made.joint_positions);
  EXPECT_EQ(cached->start_positions, made.start_positions);
  EXPECT_EQ(cached->steps, made.steps);
  EXPECT_EQ(cache.get(setup_, set_, 7).get(), cached.get());
  EXPECT_EQ(cache.computed(), 1U);
}

TEST_F(TargetCacheTest, CasesAreToldApartBySetAndNumber) {
  TargetCache cache(10 * table_bytes_);
  const auto train = cache.get(setup_, set_, 0);
  EXPECT_NE(cache.get(setup_, set_, 1)->joint_positions, train->joint_positions);
  EXPECT_NE(cache.get(setup_, problem_->get_set("train/3"), 0)->joint_positions,
            train->joint_positions);
  EXPECT_EQ(cache.computed(), 3U);
}

TEST_F(TargetCacheTest, OldestTablesGoAtTheLimit) {
  TargetCache cache(3 * table_bytes_);  // exactly three
  for (const std::uint64_t number : {0, 1, 2, 2, 1, 0}) {
    cache.get(setup_, set_, number);
  }
  EXPECT_EQ(cache.computed(), 3U);
  const auto held = cache.get(setup_, set_, 0);
  const std::vector<double> angles = held->joint_positions;
  cache.get(setup_, set_, 3);  // 0 goes
  EXPECT_EQ(cache.computed(), 4U);
  for (const std::uint64_t number : {1, 2, 3}) {
    cache.get(setup_, set_, number);
  }
  EXPECT_EQ(cache.computed(), 4U);
  EXPECT_EQ(held->joint_positions, angles);  // it lives on for whoever holds it
  EXPECT_EQ(cache.get(setup_, set_, 0)->joint_positions, angles);
  EXPECT_EQ(cache.computed(), 5U);
  cache.get(setup_, set_, 1);  // went when 0 came back
  EXPECT_EQ(cache.computed(), 6U);
}

TEST_F(TargetCacheTest, LimitBelowOneTableKeepsTheLastOne) {
  TargetCache cache(1);
  EXPECT_EQ(cache.get(setup_, set_, 0)->steps, 2856);  // thesis: 25 moves at 1.5 m/s
  cache.get(setup_, set_, 0);
  EXPECT_EQ(cache.computed(), 1U);
  cache.get(setup_, set_, 1);
  cache.get(setup_, set_, 0);
  EXPECT_EQ(cache.computed(), 3U);
}

TEST_F(TargetCacheTest, CaseThatCannotBeMadeDoesNotStopEviction) {
  const TestSet file = TestSet::make_from_cases({set_.make_case(0)});
  TargetCache cache(table_bytes_);
  for (int trial = 0; trial < 2; ++trial) {
    EXPECT_THAT(usage_error_of([&] { cache.get(setup_, file, 5); }),
                testing::EndsWith(" has 1 cases, counted from 0; there is no case 5"));
  }
  EXPECT_EQ(cache.computed(), 0U);
  cache.get(setup_, set_, 0);
  cache.get(setup_, set_, 1);  // 0 goes
  cache.get(setup_, set_, 0);
  EXPECT_EQ(cache.computed(), 3U);
}

TEST_F(TargetCacheTest, ThreadsThatAskAtOnceComputeOnce) {
  constexpr int kThreads = 8;
  constexpr std::uint64_t kCases = 12;
  TargetCache cache(2 * kCases * table_bytes_);
  std::barrier start(kThreads);
  std::vector<std::vector<const TargetTable*>> seen(kThreads);
  std::vector<std::jthread> threads;
  for (int thread = 0; thread < kThreads; ++thread) {
    threads.emplace_back([&, thread] {
      for (std::uint64_t number = 0; number < kCases; ++number) {
        start.arrive_and_wait();  // all eight want the same case now
        seen[static_cast<std::size_t>(thread)].push_back(cache.get(setup_, set_, number).get());
      }
    });
  }
  threads.clear();  // joins
  EXPECT_EQ(cache.computed(), kCases);
  EXPECT_THAT(seen, testing::Each(seen.front()));
}

TEST_F(TargetCacheTest, ThreadsGetTheRightTablesWhileOthersAreEvicted) {
  constexpr std::uint64_t kCases = 6;
  std::vector<std::vector<double>> expected;
  for (std::uint64_t number = 0; number < kCases; ++number) {
    expected.push_back(setup_.make_targets(set_.make_case(number)).joint_positions);
  }
  TargetCache cache(2 * table_bytes_);
  std::vector<int> wrong(8);
  std::vector<std::jthread> threads;
  for (std::size_t thread = 0; thread < wrong.size(); ++thread) {
    threads.emplace_back([&, thread] {
      for (std::uint64_t i = 0; i < 30; ++i) {
        const std::uint64_t number = (i * (2 * thread + 1)) % kCases;
        wrong[thread] +=
            cache.get(setup_, set_, number)->joint_positions == expected[number] ? 0 : 1;
      }
    });
  }
  threads.clear();
  EXPECT_THAT(wrong, testing::Each(0));
}

TEST_F(TargetCacheTest, WhatIsForgottenIsMadeAgainAlikeAndLivesWhileItIsHeld) {
  const CaseBlock training{CaseRole::training, "train/1", {0, 1}};
  const std::vector<double> x = problem_->make_vector(problem_->config().start);
  const Evaluation before = problem_->evaluate(x, training);
  problem_->forget_cases();
  EXPECT_EQ(problem_->evaluate(x, training).case_errors, before.case_errors);
  EXPECT_EQ(problem_->targets().computed(), 4U);

  TargetCache cache(2 * table_bytes_);
  const auto held = cache.get(setup_, set_, 0);
  const std::vector<double> positions = held->joint_positions;
  cache.clear();
  EXPECT_EQ(held->joint_positions, positions);
  EXPECT_NE(cache.get(setup_, set_, 0), held);
}

TEST_F(TargetCacheTest, ProblemSolvesInverseKinematicsOnceACaseNotOnceACandidate) {
  const auto& variables = problem_->description().variables;
  const std::vector<std::uint64_t> numbers = {0, 1, 2};
  const CaseBlock training{CaseRole::training, "train/1", numbers};
  std::vector<double> x = problem_->make_vector(problem_->config().start);
  for (int candidate = 0; candidate < 4; ++candidate) {
    x[2] = variables[2].start * (1 + 0.1 * candidate);
    problem_->evaluate(x, training);
  }
  EXPECT_EQ(problem_->targets().computed(), 3U);
  // The role does not matter, the set does; so does tracking a design.
  problem_->evaluate(x, CaseBlock{CaseRole::test, "train/1", numbers});
  problem_->track(problem_->config().start, set_, 2);
  EXPECT_EQ(problem_->targets().computed(), 3U);
  problem_->evaluate(x, CaseBlock{CaseRole::validation, "validation/1", {0}});
  EXPECT_EQ(problem_->targets().computed(), 4U);
}

}  // namespace
}  // namespace armwright
