// Tests the coordinator with ranks that are threads: the outcomes are the same whatever happens to
// the workers.
#include "study/executor/coordinator.hpp"

#include <gmock/gmock.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <thread>

#include "study/executor/case_executor.hpp"
#include "study/executor/memory_transport.hpp"
#include "study/executor/worker.hpp"
#include "wait_until.hpp"

namespace armwright {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using testing::AnyOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

// The error is sin(x + number). A simulation takes the given time.
class SlowSine final : public Problem {
 public:
  explicit SlowSine(microseconds cost, BatchSize size = {}) : cost_(cost), size_(size) {}
  const ProblemDescription& description() const override { return description_; }
  BatchSize batch_size(CaseRole /*role*/) const override { return size_; }
  std::vector<CaseOutcome> simulate(std::span<const CaseJob> jobs) const override {
    std::vector<CaseOutcome> outcomes;
    for (const CaseJob& job : jobs) {
      if (job.x[0] == throw_for) {
        throw std::runtime_error("no such point");
      }
      CaseOutcome& outcome = outcomes.emplace_back();
      outcome.error = std::sin(job.x[0] + static_cast<double>(job.number));
      outcome.metrics = {job.x[0], static_cast<double>(job.number)};
      if (job.residuals) {
        outcome.residuals = {outcome.error, job.block->role == CaseRole::test ? 1.0 : 0.0};
      }
      outcome.reason = job.block->set;
      ++simulated_;
      std::this_thread::sleep_for(cost_);
    }
    return outcomes;
  }
  Evaluation aggregate(std::span<const double> x,
                       std::span<const CaseOutcome> outcomes) const override {
    Evaluation evaluation;
    evaluation.objectives = {x[0]};
    for (const CaseOutcome& outcome : outcomes) {
      evaluation.case_errors.push_back(outcome.error);
      evaluation.metrics.insert(evaluation.metrics.end(), outcome.metrics.begin(),
                                outcome.metrics.end());
      evaluation.residuals.insert(evaluation.residuals.end(), outcome.residuals.begin(),
                                  outcome.residuals.end());
      evaluation.reason = outcome.reason;
    }
    return evaluation;
  }
  std::vector<double> penalty_objectives() const override { return {0}; }
  void forget_cases() const override { ++forgotten_; }

  std::size_t simulated() const { return simulated_; }
  int forgotten() const { return forgotten_; }
  double throw_for = -1;

 private:
  ProblemDescription description_;
  microseconds cost_;
  BatchSize size_;
  mutable std::atomic<std::size_t> simulated_ = 0;
  mutable std::atomic<int> forgotten_ = 0;
};

constexpr const char* kIdentity = R"({"problems": ["sine"]})";

// Every rank has its own problem object, as processes do.
class Ranks {
 public:
  explicit Ranks(std::size_t count, microseconds cost = milliseconds(1), std::size_t threads = 1,
                 BatchSize size = {})
      : network(count), transport_(network, 0), threads_(threads) {
    for (std::size_t rank = 0; rank < count; ++rank) {
      problems.push_back(std::make_unique<SlowSine>(cost, size));
    }
  }
  ~Ranks() {
    coordinator_.reset();
    end_workers(transport_, 0.5);
    for (std::thread& worker : workers_) {
      worker.join();
    }
  }

  // The introduction of workers that a test does not change.
  WorkerIntroduction introduction() const {
    return {
        .host = "host", .cpu = "cpu", .threads = threads_, .identity = kIdentity, .failure = ""};
  }
  void start_worker(std::size_t rank, const WorkerIntroduction& introduction) {
    workers_.emplace_back([this, rank, introduction] {
      MemoryTransport transport(network, rank);
      constexpr double kSilence_s = 3;  // after which a cut-off worker ends by itself
      Worker worker(transport, {problems[rank].get()}, introduction, kSilence_s);
      worker.serve();
    });
  }
  void start() {
    for (std::size_t rank = 1; rank < problems.size(); ++rank) {
      start_worker(rank, introduction());
    }
  }
  Coordinator& coordinator() {
    if (!coordinator_) {
      coordinator_ = std::make_unique<Coordinator>(
          transport_, std::vector<const Problem*>{problems[0].get()}, kIdentity,
          CoordinatorSettings{.threads = threads_, .cpu = "cpu", .late_after_s = late_after_s},
          [this](const std::string& message) {
            const std::lock_guard lock(mutex_);
            notices_.push_back(message);
          });
    }
    return *coordinator_;
  }
  std::vector<std::string> notices() {
    const std::lock_guard lock(mutex_);
    return notices_;
  }

  std::size_t count_simulated() const {
    std::size_t all = 0;
    for (const auto& problem : problems) {
      all += problem->simulated();
    }
    return all;
  }

  MemoryNetwork network;
  std::vector<std::unique_ptr<SlowSine>> problems;
  // Far longer than a busy machine delays a thread.
  double late_after_s = 10;

 private:
  MemoryTransport transport_;
  std::size_t threads_;
  std::mutex mutex_;
  std::vector<std::string> notices_;
  std::vector<std::thread> workers_;
  std::unique_ptr<Coordinator> coordinator_;
};

CaseBlock make_block(std::size_t cases) {
  CaseBlock block{CaseRole::test, "test/1", {}};
  for (std::uint64_t number = 0; number < cases; ++number) {
    block.numbers.push_back(7 * number);
  }
  return block;
}

// Returns one evaluation per candidate; those that a stop leaves out are empty.
std::vector<Evaluation> evaluate(CaseExecutor& executor, const Problem& problem,
                                 std::size_t candidates, std::size_t cases, StopSignal& stop) {
  std::vector<std::vector<double>> points;
  for (std::size_t i = 0; i < candidates; ++i) {
    points.push_back({0.25 * static_cast<double>(i)});
  }
  const std::vector<std::span<const double>> spans(points.begin(), points.end());
  std::vector<Evaluation> evaluations(candidates);
  std::vector<std::atomic<int>> told(candidates);
  executor.evaluate(problem, spans, make_block(cases), {.residuals = true}, stop,
                    [&](std::size_t candidate, Evaluation evaluation) {
                      EXPECT_EQ(++told[candidate], 1);
                      evaluations[candidate] = std::move(evaluation);
                    });
  return evaluations;
}

std::vector<Evaluation> evaluate(CaseExecutor& executor, const Problem& problem,
                                 std::size_t candidates, std::size_t cases) {
  StopSignal stop;
  return evaluate(executor, problem, candidates, cases, stop);
}

void expect_same_evaluations(const std::vector<Evaluation>& a, const std::vector<Evaluation>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].objectives, b[i].objectives) << i;
    EXPECT_EQ(a[i].case_errors, b[i].case_errors) << i;
    EXPECT_EQ(a[i].metrics, b[i].metrics) << i;
    EXPECT_EQ(a[i].residuals, b[i].residuals) << i;
    EXPECT_EQ(a[i].reason, b[i].reason) << i;
  }
}

std::vector<Evaluation> evaluate_alone(std::size_t candidates, std::size_t cases) {
  const SlowSine problem(microseconds(0));
  ThreadExecutor executor(1);
  return evaluate(executor, problem, candidates, cases);
}

TEST(Coordinator, HasTheSameOutcomesOnAnyNumberOfRanksAndThreads) {
  const auto expected = evaluate_alone(23, 3);
  for (const std::size_t ranks : {1u, 2u, 4u}) {
    for (const std::size_t threads : {1u, 3u}) {
      for (const std::size_t lanes : {1u, 8u}) {
        SCOPED_TRACE(testing::Message()
                     << ranks << " ranks, " << threads << " threads, " << lanes << " lanes");
        Ranks team(ranks, microseconds(200), threads, {.granularity = lanes, .largest = 2 * lanes});
        team.start();
        for (int repeat = 0; repeat < 3; ++repeat) {
          expect_same_evaluations(evaluate(team.coordinator(), *team.problems[0], 23, 3), expected);
        }
        EXPECT_EQ(team.count_simulated(), 3 * 23u * 3u);
        EXPECT_THAT(team.notices(), IsEmpty());
      }
    }
  }
}

TEST(Coordinator, GivesWorkersWhatTakesLong) {
  Ranks team(3, milliseconds(2));
  team.start();
  EXPECT_TRUE(wait_until([&] {
    evaluate(team.coordinator(), *team.problems[0], 60, 1);
    return team.problems[1]->simulated() > 40 && team.problems[2]->simulated() > 40;
  }));
}

// A batch that ends before a message could go and return stays with the coordinator.
TEST(Coordinator, KeepsWhatIsDoneSoonerHere) {
  Ranks team(2, microseconds(0));
  team.start();
  evaluate(team.coordinator(), *team.problems[0], 50, 1);  // costs are not known yet
  const std::size_t before = team.problems[1]->simulated();
  for (int repeat = 0; repeat < 20; ++repeat) {
    evaluate(team.coordinator(), *team.problems[0], 1, 1);
  }
  EXPECT_EQ(team.problems[1]->simulated(), before);
}

TEST(Coordinator, DoesTheWorkOfRanksThatDie) {
  const auto expected = evaluate_alone(100, 1);
  Ranks team(3, milliseconds(2));
  team.late_after_s = 0.3;
  team.start();
  evaluate(team.coordinator(), *team.problems[0], 30, 1);
  const std::size_t before = team.problems[2]->simulated();
  std::atomic<bool> is_dead = false;
  std::thread killer([&] {
    EXPECT_TRUE(wait_until([&] { return team.problems[2]->simulated() > before; }));
    team.network.kill(2);
    is_dead = true;
  });
  while (!is_dead) {
    expect_same_evaluations(evaluate(team.coordinator(), *team.problems[0], 100, 1), expected);
  }
  killer.join();
  EXPECT_TRUE(wait_until([&] {
    expect_same_evaluations(evaluate(team.coordinator(), *team.problems[0], 100, 1), expected);
    return !team.notices().empty();
  }));
  EXPECT_THAT(team.notices(), Contains(AllOf(HasSubstr("rank 2 on host has not answered"),
                                             HasSubstr("others do its work"))));
}

// Both answers arrive then, and one of them counts.
TEST(Coordinator, TakesBackARankThatWasLate) {
  const auto expected = evaluate_alone(60, 1);
  Ranks team(2, milliseconds(2));
  team.late_after_s = 0.3;
  team.start();
  evaluate(team.coordinator(), *team.problems[0], 30, 1);
  team.network.hold(1);
  EXPECT_TRUE(wait_until([&] {
    expect_same_evaluations(evaluate(team.coordinator(), *team.problems[0], 60, 1), expected);
    return !team.notices().empty();
  }));
  EXPECT_THAT(team.notices(), ElementsAre(HasSubstr("has not answered")));
  const std::size_t before = team.problems[1]->simulated();
  expect_same_evaluations(evaluate(team.coordinator(), *team.problems[0], 60, 1), expected);
  EXPECT_EQ(team.problems[1]->simulated(), before);
  team.network.let_go(1);
  EXPECT_TRUE(wait_until([&] { return team.notices().size() == 2; }));
  EXPECT_THAT(team.notices(), Contains(HasSubstr("answers again")));
  EXPECT_TRUE(wait_until([&] {
    expect_same_evaluations(evaluate(team.coordinator(), *team.problems[0], 60, 1), expected);
    return team.problems[1]->simulated() > before;
  }));
}

TEST(Coordinator, DoesWithoutRanksThatWouldComputeSomethingElse) {
  Ranks team(4);
  WorkerIntroduction other = team.introduction();
  other.identity = R"({"problems": ["cosine"]})";
  team.start_worker(1, other);
  WorkerIntroduction broken = team.introduction();
  broken.failure = "q1.toml: cannot open it";
  team.start_worker(2, broken);
  team.start_worker(3, team.introduction());
  expect_same_evaluations(evaluate(team.coordinator(), *team.problems[0], 40, 2),
                          evaluate_alone(40, 2));
  EXPECT_TRUE(wait_until([&] { return team.notices().size() == 2; }));
  EXPECT_THAT(team.notices(),
              Contains(AllOf(HasSubstr("rank 1 on host cannot be used"), HasSubstr("cosine"))));
  EXPECT_THAT(team.notices(), Contains(AllOf(HasSubstr("rank 2"), HasSubstr("q1.toml"))));
  EXPECT_EQ(team.problems[1]->simulated() + team.problems[2]->simulated(), 0u);
}

TEST(Coordinator, SaysWhenARankHasAnotherProcessor) {
  Ranks team(2);
  WorkerIntroduction other = team.introduction();
  other.cpu = "an older one";
  team.start_worker(1, other);
  team.coordinator();
  EXPECT_TRUE(wait_until([&] { return !team.notices().empty(); }));
  EXPECT_THAT(team.notices(),
              ElementsAre(HasSubstr("another processor (an older one; here: cpu)")));
}

// The coordinator simulates the pair itself. If that fails as well, the error is the same as
// without ranks.
TEST(Coordinator, DoesTheWorkOfARankThatCannot) {
  Ranks team(2, milliseconds(1));
  team.problems[1]->throw_for = 2.5;
  team.start();
  for (int repeat = 0; repeat < 4; ++repeat) {
    expect_same_evaluations(evaluate(team.coordinator(), *team.problems[0], 40, 1),
                            evaluate_alone(40, 1));
  }
  EXPECT_THAT(team.notices(), AnyOf(IsEmpty(), ElementsAre(HasSubstr("no such point"))));
}

TEST(Coordinator, ThrowsWhatTheProblemThrowsHere) {
  Ranks team(1);
  team.problems[0]->throw_for = 2.5;
  EXPECT_THROW(evaluate(team.coordinator(), *team.problems[0], 40, 1), std::runtime_error);
  team.problems[0]->throw_for = -1;
  expect_same_evaluations(evaluate(team.coordinator(), *team.problems[0], 40, 1),
                          evaluate_alone(40, 1));
}

TEST(Coordinator, RethrowsWhatTheReceiverOfOutcomesThrows) {
  Ranks team(3, milliseconds(1));
  team.start();
  const std::vector<double> x = {1};
  const std::span<const double> candidate = x;
  StopSignal stop;
  for (int repeat = 0; repeat < 3; ++repeat) {
    EXPECT_THROW(
        team.coordinator().simulate(*team.problems[0], {&candidate, 1}, make_block(100), {}, stop,
                                    [](std::size_t, std::span<CaseOutcome>) {
                                      throw std::runtime_error("the disk is full");
                                    }),
        std::runtime_error);
  }
}

TEST(Coordinator, StopsBetweenChunks) {
  Ranks team(2, milliseconds(2));
  team.start();
  evaluate(team.coordinator(), *team.problems[0], 20, 1);
  StopSignal stop;
  std::thread stopper([&] {
    const std::size_t before = team.count_simulated();
    EXPECT_TRUE(wait_until([&] { return team.count_simulated() > before + 10; }));
    stop.request(StopReason::interrupted);
  });
  const auto evaluations = evaluate(team.coordinator(), *team.problems[0], 100'000, 1, stop);
  stopper.join();
  const auto done = std::ranges::count_if(
      evaluations, [](const Evaluation& evaluation) { return !evaluation.objectives.empty(); });
  EXPECT_GT(done, 0);
  EXPECT_LT(done, 1000);
}

// A comparison does this with several cells at a time.
TEST(Coordinator, ServesSeveralBatchesAtOnce) {
  const auto expected = evaluate_alone(30, 2);
  Ranks team(3, microseconds(300), 2);
  team.start();
  Coordinator& coordinator = team.coordinator();
  std::vector<std::thread> callers;
  for (int caller = 0; caller < 6; ++caller) {
    callers.emplace_back([&] {
      for (int repeat = 0; repeat < 5; ++repeat) {
        expect_same_evaluations(evaluate(coordinator, *team.problems[0], 30, 2), expected);
      }
    });
  }
  for (std::thread& caller : callers) {
    caller.join();
  }
  EXPECT_EQ(team.count_simulated(), 6 * 5 * 30u * 2u);
}

TEST(Coordinator, SimulatesHereWhatWorkersDoNotKnow) {
  Ranks team(2);
  team.start();
  const SlowSine other(milliseconds(1));
  expect_same_evaluations(evaluate(team.coordinator(), other, 30, 1), evaluate_alone(30, 1));
  EXPECT_EQ(other.simulated(), 30u);
}

TEST(Coordinator, TellsWorkersWhatTheyMayForget) {
  Ranks team(2, milliseconds(1));
  team.start();
  EXPECT_TRUE(wait_until([&] { return !team.coordinator().expects_workers(); }));
  team.coordinator().forget(*team.problems[0]);
  EXPECT_TRUE(wait_until([&] { return team.problems[1]->forgotten() == 1; }));
  EXPECT_EQ(team.problems[0]->forgotten(), 1);
}

TEST(Worker, LeavesWhenItsCoordinatorIsNoMore) {
  MemoryNetwork network(2);
  MemoryTransport transport(network, 1);
  const SlowSine problem(microseconds(0));
  Worker worker(transport, {&problem}, {.host = "", .cpu = "", .identity = "", .failure = ""}, 0.2);
  EXPECT_EQ(worker.serve(), Worker::End::abandoned);
}

TEST(Coordinator, RanksLeaveInOrderOrAtLeastLeave) {
  for (const bool one_is_dead : {false, true}) {
    MemoryNetwork network(3);
    const SlowSine problem(microseconds(0));
    std::vector<Worker::End> ends(3, Worker::End::abandoned);
    std::vector<std::thread> workers;
    for (std::size_t rank = 1; rank < 3; ++rank) {
      if (one_is_dead && rank == 2) {
        continue;
      }
      workers.emplace_back([&, rank] {
        MemoryTransport transport(network, rank);
        Worker worker(transport, {&problem},
                      {.host = "", .cpu = "", .identity = kIdentity, .failure = ""});
        ends[rank] = worker.serve();
      });
    }
    MemoryTransport transport(network, 0);
    EXPECT_EQ(end_workers(transport, one_is_dead ? 0.2 : 30), !one_is_dead);
    for (std::thread& worker : workers) {
      worker.join();
    }
    EXPECT_EQ(ends[1], one_is_dead ? Worker::End::leave : Worker::End::finalize);
  }
}

}  // namespace
}  // namespace armwright
