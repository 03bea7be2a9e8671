// The child process of an isolated optimizer: what it takes along and what it leaves behind. What
// goes over the border: isolation_test.cpp.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <thread>

#include "optimizers/interface/isolation.hpp"
#include "optimizers/isolation_support.hpp"
#include "optimizers/table/optimizer_table.hpp"
#include "problems/analytic/analytic.hpp"
#include "study/contract/memory_evaluator.hpp"

namespace armwright {
namespace {

using testing::HasSubstr;

TEST_F(Isolation, TheChildHoldsNoneOfOurDescriptors) {
  const int held = open("/dev/null", O_RDONLY);
  minimize_isolated(
      "demo",
      [](Evaluator& remote) {
        std::vector<int> open_ones;
        for (int fd = 0; fd < 64; ++fd) {
          if (fcntl(fd, F_GETFD) >= 0) {
            open_ones.push_back(fd);
          }
        }
        char byte = 0;
        remote.recommend(std::vector<double>{static_cast<double>(open_ones.size()),
                                             static_cast<double>(read(0, &byte, 1))});
      },
      evaluator_, kLimits);
  close(held);
  EXPECT_EQ(evaluator_.recommended().at(0), (std::vector<double>{4, 0}));
}

TEST_F(Isolation, UnwrittenOutputIsWrittenOnceAndTheChildsGoesToStderr) {
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  std::fputs("ours, unwritten;", stdout);
  minimize_isolated(
      "demo", [](Evaluator&) { std::fputs("the child's", stdout); }, evaluator_, kLimits);
  std::fflush(stdout);
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "ours, unwritten;");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "the child's");
}

TEST_F(Isolation, HandlersAndMasksOfOursAreNotTheChilds) {
  struct sigaction before {};
  struct sigaction handler {};
  handler.sa_handler = [](int) {};
  sigaction(SIGTERM, &handler, &before);
  sigset_t blocked;
  sigemptyset(&blocked);
  sigaddset(&blocked, SIGTERM);
  sigset_t mask_before;
  pthread_sigmask(SIG_BLOCK, &blocked, &mask_before);
  EXPECT_THAT(failure_of([](Evaluator&) {
                raise(SIGTERM);
                pause();
              }),
              HasSubstr("signal 15"));
  pthread_sigmask(SIG_SETMASK, &mask_before, nullptr);
  sigaction(SIGTERM, &before, nullptr);
}

TEST_F(Isolation, ProcessesThatTheChildStartedEndWithIt) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  // The grandchild keeps our pipe open for as long as it lives: as standard error, the one place
  // where a descriptor of ours gets through.
  const int error_before = dup(STDERR_FILENO);
  dup2(ends[1], STDERR_FILENO);
  minimize_isolated(
      "demo",
      [](Evaluator&) {
        if (fork() == 0) {
          while (true) {
            pause();
          }
        }
      },
      evaluator_, kLimits);
  dup2(error_before, STDERR_FILENO);
  close(error_before);
  close(ends[1]);
  char byte = 0;
  EXPECT_EQ(read(ends[0], &byte, 1), 0);  // its end: nobody holds it any more
  close(ends[0]);
}

TEST_F(Isolation, OtherThreadsGoOn) {
  std::atomic<bool> end = false;
  std::atomic<std::int64_t> steps = 0;
  std::thread busy([&] {
    while (!end) {
      ++steps;
    }
  });
  for (int i = 0; i < 20; ++i) {
    EXPECT_THAT(failure_of([](Evaluator&) { std::abort(); }), HasSubstr("signal 6"));
  }
  const std::int64_t before = steps;
  while (steps == before) {
  }
  end = true;
  busy.join();
}

TEST_F(Isolation, ChildrenOfSeveralThreadsDoNotDisturbEachOther) {
  const OptimizerRow& row = find_optimizer("ga");
  std::vector<std::unique_ptr<MemoryEvaluator>> evaluators;
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i) {
    evaluators.push_back(
        std::make_unique<MemoryEvaluator>(*problem_, MemoryEvaluatorSettings{.budget = 500}));
    threads.emplace_back([&row, evaluator = evaluators.back().get()] {
      const auto optimizer = row.make(Options::parse("ga", row.options, {}));
      minimize_isolated(
          "ga", [&](Evaluator& remote) { optimizer->minimize(remote, 1); }, *evaluator, kLimits);
    });
  }
  for (std::thread& thread : threads) {
    thread.join();
  }
  for (const auto& evaluator : evaluators) {
    EXPECT_EQ(evaluator->trace(), evaluators.front()->trace());
    EXPECT_EQ(evaluator->trace().size(), 500u);
  }
}

}  // namespace
}  // namespace armwright
