// The cache of values per test case, with target tables as values.
#include "problems/tracking/case_cache.hpp"

#include <gmock/gmock.h>

#include <barrier>
#include <thread>
#include <vector>

#include "base/expect_error.hpp"
#include "problems/load_tracking.hpp"

namespace armwright {
namespace {

class CaseCacheTest : public testing::Test {
 protected:
  std::shared_ptr<const TargetTable> get(CaseCache<TargetTable>& cache, const TestSet& set,
                                         std::uint64_t number) const {
    return cache.get(set.name(), number,
                     [&] { return setup_.make_targets(set.make_case(number)); });
  }

  const std::shared_ptr<const TrackingProblem> problem_ = load_tracking("q1-complex");
  const TrackingSetup& setup_ = problem_->setup();
  const TestSet set_ = problem_->get_set("train/1");
  // All cases of a generated set have the same moves, so their tables have the same size.
  const std::size_t table_bytes_ = setup_.make_targets(set_.make_case(0)).size_bytes();
};

TEST_F(CaseCacheTest, TableIsTheOneThatTheSetupMakes) {
  CaseCache<TargetTable> cache(10 * table_bytes_);
  const TargetTable made = setup_.make_targets(set_.make_case(7));
  const auto cached = get(cache, set_, 7);
  EXPECT_EQ(cached->joint_positions, made.joint_positions);
  EXPECT_EQ(cached->start_positions, made.start_positions);
  EXPECT_EQ(cached->steps, made.steps);
  EXPECT_EQ(get(cache, set_, 7).get(), cached.get());
  EXPECT_EQ(cache.computed(), 1U);
}

TEST_F(CaseCacheTest, CasesAreToldApartBySetAndNumber) {
  CaseCache<TargetTable> cache(10 * table_bytes_);
  const auto train = get(cache, set_, 0);
  EXPECT_NE(get(cache, set_, 1)->joint_positions, train->joint_positions);
  EXPECT_NE(get(cache, problem_->get_set("train/3"), 0)->joint_positions, train->joint_positions);
  EXPECT_EQ(cache.computed(), 3U);
}

TEST_F(CaseCacheTest, OldestTablesAreDroppedAtTheLimit) {
  CaseCache<TargetTable> cache(3 * table_bytes_);  // exactly three
  for (const std::uint64_t number : {0, 1, 2, 2, 1, 0}) {
    get(cache, set_, number);
  }
  EXPECT_EQ(cache.computed(), 3U);
  const auto held = get(cache, set_, 0);
  const std::vector<double> angles = held->joint_positions;
  get(cache, set_, 3);  // drops 0
  EXPECT_EQ(cache.computed(), 4U);
  for (const std::uint64_t number : {1, 2, 3}) {
    get(cache, set_, number);
  }
  EXPECT_EQ(cache.computed(), 4U);
  EXPECT_EQ(held->joint_positions, angles);  // it lives as long as `held`
  EXPECT_EQ(get(cache, set_, 0)->joint_positions, angles);
  EXPECT_EQ(cache.computed(), 5U);
  get(cache, set_, 1);  // was dropped when 0 came back
  EXPECT_EQ(cache.computed(), 6U);
}

TEST_F(CaseCacheTest, FillMakesAtOnceWhatIsLackingAndNothingElse) {
  CaseCache<TargetTable> cache(10 * table_bytes_);
  get(cache, set_, 5);
  std::vector<std::uint64_t> asked;
  const std::vector<std::uint64_t> numbers = {4, 5, 6, 4};
  cache.fill(set_.name(), numbers, [&](std::span<const std::uint64_t> lacking) {
    asked.assign(lacking.begin(), lacking.end());
    std::vector<TestCase> cases;
    for (const std::uint64_t number : lacking) {
      cases.push_back(set_.make_case(number));
    }
    return setup_.make_targets(cases);
  });
  EXPECT_THAT(asked, testing::ElementsAre(4, 6));
  EXPECT_EQ(cache.computed(), 3U);
  for (const std::uint64_t number : {4, 5, 6}) {
    EXPECT_EQ(get(cache, set_, number)->joint_positions,
              setup_.make_targets(set_.make_case(number)).joint_positions);
  }
  EXPECT_EQ(cache.computed(), 3U);
}

TEST_F(CaseCacheTest, FillThatThrowsLeavesTheCacheUsable) {
  CaseCache<TargetTable> cache(10 * table_bytes_);
  const std::vector<std::uint64_t> numbers = {1, 2};
  EXPECT_THROW(cache.fill(set_.name(), numbers,
                          [](std::span<const std::uint64_t>) -> std::vector<TargetTable> {
                            throw Error(ErrorKind::usage, "no");
                          }),
               Error);
  EXPECT_EQ(get(cache, set_, 2)->steps, 2856);
  EXPECT_EQ(cache.computed(), 1U);
}

TEST_F(CaseCacheTest, LimitBelowOneTableKeepsTheLastOne) {
  CaseCache<TargetTable> cache(1);
  EXPECT_EQ(get(cache, set_, 0)->steps, 2856);  // thesis: 25 moves at 1.5 m/s
  get(cache, set_, 0);
  EXPECT_EQ(cache.computed(), 1U);
  get(cache, set_, 1);
  get(cache, set_, 0);
  EXPECT_EQ(cache.computed(), 3U);
}

TEST_F(CaseCacheTest, CaseThatCannotBeMadeDoesNotStopEviction) {
  const TestSet file = TestSet::make_from_cases({set_.make_case(0)});
  CaseCache<TargetTable> cache(table_bytes_);
  for (int trial = 0; trial < 2; ++trial) {
    EXPECT_THAT(usage_error_of([&] { get(cache, file, 5); }),
                testing::EndsWith(" has 1 cases, counted from 0; there is no case 5"));
  }
  EXPECT_EQ(cache.computed(), 0U);
  get(cache, set_, 0);
  get(cache, set_, 1);  // drops 0
  get(cache, set_, 0);
  EXPECT_EQ(cache.computed(), 3U);
}

TEST_F(CaseCacheTest, ThreadsThatAskAtOnceComputeOnce) {
  constexpr int kThreads = 8;
  constexpr std::uint64_t kCases = 12;
  CaseCache<TargetTable> cache(2 * kCases * table_bytes_);
  std::barrier start(kThreads);
  std::vector<std::vector<const TargetTable*>> seen(kThreads);
  std::vector<std::jthread> threads;
  for (int thread = 0; thread < kThreads; ++thread) {
    threads.emplace_back([&, thread] {
      for (std::uint64_t number = 0; number < kCases; ++number) {
        start.arrive_and_wait();  // all eight threads ask for the same case now
        seen[static_cast<std::size_t>(thread)].push_back(get(cache, set_, number).get());
      }
    });
  }
  threads.clear();  // joins
  EXPECT_EQ(cache.computed(), kCases);
  EXPECT_THAT(seen, testing::Each(seen.front()));
}

TEST_F(CaseCacheTest, ThreadsGetTheRightTablesWhileOthersAreEvicted) {
  constexpr std::uint64_t kCases = 6;
  std::vector<std::vector<double>> expected;
  for (std::uint64_t number = 0; number < kCases; ++number) {
    expected.push_back(setup_.make_targets(set_.make_case(number)).joint_positions);
  }
  CaseCache<TargetTable> cache(2 * table_bytes_);
  std::vector<int> wrong(8);
  std::vector<std::jthread> threads;
  for (std::size_t thread = 0; thread < wrong.size(); ++thread) {
    threads.emplace_back([&, thread] {
      for (std::uint64_t i = 0; i < 30; ++i) {
        const std::uint64_t number = (i * (2 * thread + 1)) % kCases;
        wrong[thread] += get(cache, set_, number)->joint_positions == expected[number] ? 0 : 1;
      }
    });
  }
  threads.clear();
  EXPECT_THAT(wrong, testing::Each(0));
}

TEST_F(CaseCacheTest, DroppedTablesAreMadeAgainAlikeAndLiveWhileHeld) {
  const CaseBlock training{CaseRole::training, "train/1", {0, 1}};
  const std::vector<double> x = problem_->make_vector(problem_->config().start);
  const Evaluation before = problem_->evaluate(x, training);
  problem_->forget_cases();
  EXPECT_EQ(problem_->evaluate(x, training).case_errors, before.case_errors);
  EXPECT_EQ(problem_->targets().computed(), 4U);

  CaseCache<TargetTable> cache(2 * table_bytes_);
  const auto held = get(cache, set_, 0);
  const std::vector<double> joint_positions = held->joint_positions;
  cache.clear();
  EXPECT_EQ(held->joint_positions, joint_positions);
  EXPECT_NE(get(cache, set_, 0), held);
}

TEST_F(CaseCacheTest, ProblemSolvesInverseKinematicsOnceACaseNotOnceACandidate) {
  const auto& variables = problem_->description().variables;
  const std::vector<std::uint64_t> numbers = {0, 1, 2};
  const CaseBlock training{CaseRole::training, "train/1", numbers};
  std::vector<double> x = problem_->make_vector(problem_->config().start);
  for (int candidate = 0; candidate < 4; ++candidate) {
    x[2] = variables[2].start * (1 + 0.1 * candidate);
    problem_->evaluate(x, training);
  }
  EXPECT_EQ(problem_->targets().computed(), 3U);
  // The cache depends on the set, not on the role. Tracking a design uses it too.
  problem_->evaluate(x, CaseBlock{CaseRole::test, "train/1", numbers});
  problem_->track(problem_->config().start, set_, 2);
  EXPECT_EQ(problem_->targets().computed(), 3U);
  problem_->evaluate(x, CaseBlock{CaseRole::validation, "validation/1", {0}});
  EXPECT_EQ(problem_->targets().computed(), 4U);
}

}  // namespace
}  // namespace armwright
