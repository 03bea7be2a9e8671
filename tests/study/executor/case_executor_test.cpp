// Tests how pairs of candidates and cases are distributed, on a problem that stores its jobs.
#include "study/executor/case_executor.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <map>
#include <mutex>
#include <stdexcept>

namespace armwright {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::Le;
using testing::SizeIs;

// The error is x + 1000 case; the residuals, where asked for, are the error twice.
class NotingProblem : public Problem {
 public:
  explicit NotingProblem(BatchSize size) : size_(size) {}
  const ProblemDescription& description() const override { return description_; }
  BatchSize batch_size(CaseRole role) const override {
    return role == CaseRole::training ? size_ : BatchSize{};
  }
  std::vector<CaseOutcome> simulate(std::span<const CaseJob> jobs) const override {
    std::vector<CaseOutcome> outcomes(jobs.size());
    {
      const std::lock_guard lock(mutex_);
      calls_.emplace_back();
      for (const CaseJob& job : jobs) {
        calls_.back().emplace_back(job.x[0], job.number);
      }
    }
    for (std::size_t i = 0; i < jobs.size(); ++i) {
      if (jobs[i].x[0] == throw_for) {
        throw std::runtime_error("no such point");
      }
      outcomes[i].error = jobs[i].x[0] + 1000 * static_cast<double>(jobs[i].number);
      if (jobs[i].residuals || always_with_residuals) {
        outcomes[i].residuals = {outcomes[i].error, outcomes[i].error};
      }
      if (stop_at == outcomes[i].error) {
        stop->request(StopReason::interrupted);
      }
    }
    return outcomes;
  }
  Evaluation aggregate(std::span<const double> /*x*/,
                       std::span<const CaseOutcome> outcomes) const override {
    Evaluation evaluation;
    evaluation.objectives = {0};
    for (const CaseOutcome& outcome : outcomes) {
      evaluation.objectives[0] += outcome.error;
      evaluation.case_errors.push_back(outcome.error);
      evaluation.residuals.insert(evaluation.residuals.end(), outcome.residuals.begin(),
                                  outcome.residuals.end());
    }
    return evaluation;
  }
  std::vector<double> penalty_objectives() const override { return {1e12}; }

  using Pair = std::pair<double, std::uint64_t>;
  const std::vector<std::vector<Pair>>& calls() const { return calls_; }  // once all is done
  std::size_t count_calls() const {
    const std::lock_guard lock(mutex_);
    return calls_.size();
  }

  double throw_for = -1;
  bool always_with_residuals = false;
  double stop_at = -1;
  StopSignal* stop = nullptr;

 private:
  BatchSize size_;
  ProblemDescription description_;
  mutable std::mutex mutex_;
  mutable std::vector<std::vector<Pair>> calls_;
};

struct NotedRun {
  explicit NotedRun(BatchSize size, unsigned threads = 1) : problem(size), executor(threads) {
    problem.stop = &stop;
  }
  // Evaluates the candidates 0, 1, ... on the cases 7, 8, ... and returns the evaluations by
  // candidate.
  std::map<std::size_t, Evaluation> operator()(std::size_t candidates, std::size_t cases,
                                               CaseRole role = CaseRole::training,
                                               bool residuals = false) {
    std::vector<std::vector<double>> points;
    for (std::size_t i = 0; i < candidates; ++i) {
      points.push_back({static_cast<double>(i)});
    }
    std::vector<std::span<const double>> spans(points.begin(), points.end());
    CaseBlock block{role, "train/1", {}};
    for (std::uint64_t i = 0; i < cases; ++i) {
      block.numbers.push_back(7 + i);
    }
    std::mutex mutex;
    std::map<std::size_t, Evaluation> done;
    executor.evaluate(problem, spans, block, {.residuals = residuals}, stop,
                      [&](std::size_t candidate, Evaluation evaluation) {
                        const std::lock_guard lock(mutex);
                        order.push_back(candidate);
                        calls_before.push_back(problem.count_calls());
                        EXPECT_TRUE(done.emplace(candidate, std::move(evaluation)).second)
                            << candidate;
                      });
    return done;
  }

  StopSignal stop;
  NotingProblem problem;
  ThreadExecutor executor;
  std::vector<std::size_t> order;         // in which the candidates finished
  std::vector<std::size_t> calls_before;  // calls of simulate() until then; on one thread
};

// Neighbouring lanes must follow the same targets.
TEST(CaseExecutor, HandsOutTheCasesOfAsManyCandidatesAsThereAreLanes) {
  NotedRun run({.granularity = 2, .largest = 4});
  run(3, 3);
  using Pair = NotingProblem::Pair;
  EXPECT_THAT(run.problem.calls(),
              ElementsAre(ElementsAre(Pair(0, 7), Pair(1, 7), Pair(0, 8), Pair(1, 8)),
                          ElementsAre(Pair(0, 9), Pair(1, 9), Pair(2, 7), Pair(2, 8)),
                          ElementsAre(Pair(2, 9))));
}

TEST(CaseExecutor, WithoutBatchesEveryPairIsOnItsOwn) {
  NotedRun run({});
  run(3, 2);
  EXPECT_THAT(run.problem.calls(), SizeIs(6));
  EXPECT_THAT(run.problem.calls(), Each(SizeIs(1)));
}

TEST(CaseExecutor, TheBatchSizeIsThatOfTheBlocksRole) {
  NotedRun run({.granularity = 4, .largest = 8});
  run(2, 3, CaseRole::validation);
  EXPECT_THAT(run.problem.calls(), Each(SizeIs(1)));
}

TEST(CaseExecutor, TellsOfACandidateAsSoonAsItsLastCaseIsDone) {
  NotedRun run({.granularity = 2, .largest = 4});
  run(3, 3);
  EXPECT_THAT(run.order, ElementsAre(0, 1, 2));
  EXPECT_THAT(run.calls_before, ElementsAre(2, 2, 3));
}

TEST(CaseExecutor, ResultsDoNotDependOnBatchesAndThreads) {
  const auto expected = NotedRun({})(35, 5);
  ASSERT_EQ(expected.size(), 35U);
  for (const BatchSize size : {BatchSize{1, 1}, BatchSize{1, 3}, BatchSize{4, 16}, BatchSize{8, 64},
                               BatchSize{512, 512}}) {
    for (const unsigned threads : {1U, 2U, 5U}) {
      NotedRun run(size, threads);
      const auto done = run(35, 5);
      ASSERT_EQ(done.size(), 35U) << size.largest << " on " << threads;
      for (const auto& [candidate, evaluation] : done) {
        EXPECT_EQ(evaluation.objectives, expected.at(candidate).objectives);
        EXPECT_EQ(evaluation.case_errors, expected.at(candidate).case_errors);
      }
      EXPECT_THAT(run.problem.calls(), Each(SizeIs(Le(size.largest))));
      std::size_t pairs = 0;
      for (const auto& call : run.problem.calls()) {
        pairs += call.size();
      }
      EXPECT_EQ(pairs, 35U * 5U);
    }
  }
}

TEST(CaseExecutor, AStopCountsBetweenBatches) {
  NotedRun run({.granularity = 2, .largest = 4});
  run.problem.stop_at = 1 + 1000 * 9;  // candidate 1, third case: in the second batch
  const auto done = run(4, 3);
  EXPECT_THAT(run.problem.calls(), SizeIs(2));
  EXPECT_THAT(run.order,
              ElementsAre(0, 1));  // the batch ends, and candidate 1 with it; 2 has begun
}

TEST(CaseExecutor, ThrowsWhatTheProblemThrows) {
  NotedRun run({.granularity = 2, .largest = 4}, 2);
  run.problem.throw_for = 2;
  EXPECT_THROW(run(4, 3), std::runtime_error);
}

TEST(CaseExecutor, ResidualsOnlyIfAskedFor) {
  NotedRun run({.granularity = 2, .largest = 4});
  EXPECT_THAT(run(1, 3, CaseRole::training, true).at(0).residuals,
              ElementsAre(7000, 7000, 8000, 8000, 9000, 9000));
  EXPECT_THAT(run(1, 3, CaseRole::training, false).at(0).residuals, IsEmpty());
  run.problem.always_with_residuals = true;
  EXPECT_THAT(run(1, 3, CaseRole::training, false).at(0).residuals, IsEmpty());
}

TEST(CaseExecutor, NothingToDo) {
  NotedRun run({.granularity = 2, .largest = 4}, 2);
  EXPECT_THAT(run(0, 3), IsEmpty());
  EXPECT_THAT(run.problem.calls(), IsEmpty());
}

}  // namespace
}  // namespace armwright
