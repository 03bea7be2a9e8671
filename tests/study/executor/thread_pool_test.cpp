#include "study/executor/thread_pool.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

namespace armwright {
namespace {

TEST(ThreadPool, RunsEveryJobOnce) {
  for (const std::size_t threads : {1, 2, 3, 8}) {
    ThreadPool pool(threads);
    EXPECT_EQ(pool.size(), threads);
    for (const std::size_t jobs : {0, 1, 2, 3, 7, 8, 9, 1000}) {
      SCOPED_TRACE(std::to_string(threads) + " threads, " + std::to_string(jobs) + " jobs");
      std::vector<std::atomic<int>> calls(jobs);
      pool.run(jobs, [&](std::size_t i) { ++calls.at(i); });
      for (const auto& count : calls) {
        EXPECT_EQ(count, 1);
      }
    }
  }
}

// The caller sees the results of the workers over many short batches. A lost wake-up would hang
// here.
TEST(ThreadPool, SurvivesManyShortBatches) {
  ThreadPool pool(4);
  std::vector<std::size_t> squares(5);
  for (std::size_t batch = 0; batch < 20'000; ++batch) {
    const std::size_t jobs = batch % 6;
    pool.run(jobs, [&](std::size_t i) { squares[i] = batch + i * i; });
    for (std::size_t i = 0; i < jobs; ++i) {
      ASSERT_EQ(squares[i], batch + i * i);
    }
  }
}

TEST(ThreadPool, TheCallerTakesPart) {
  ThreadPool pool(2);
  // Two jobs that wait for each other need two threads: the caller and the only worker.
  std::atomic<int> arrived = 0;
  std::vector<std::thread::id> ids(2);
  pool.run(2, [&](std::size_t i) {
    ids[i] = std::this_thread::get_id();
    ++arrived;
    while (arrived < 2) {
      std::this_thread::yield();
    }
  });
  EXPECT_NE(ids[0], ids[1]);
  EXPECT_THAT(ids, ::testing::Contains(std::this_thread::get_id()));
}

TEST(ThreadPool, OneThreadRunsInOrderOnTheCaller) {
  ThreadPool pool(1);
  const auto caller = std::this_thread::get_id();
  std::vector<std::size_t> order;
  pool.run(4, [&](std::size_t i) {
    EXPECT_EQ(std::this_thread::get_id(), caller);
    order.push_back(i);
  });
  EXPECT_THAT(order, ::testing::ElementsAre(0, 1, 2, 3));
}

TEST(ThreadPool, WaitsForTheSlowestJob) {
  ThreadPool pool(2);
  const auto caller = std::this_thread::get_id();
  std::atomic<int> arrived = 0;
  std::atomic<bool> slow_job_ended = false;
  pool.run(2, [&](std::size_t) {
    ++arrived;
    while (arrived < 2) {
      std::this_thread::yield();
    }
    if (std::this_thread::get_id() != caller) {
      // Long enough to notice a caller that returns too early.
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      slow_job_ended = true;
    }
  });
  EXPECT_TRUE(slow_job_ended);
}

// If two jobs fail, the exception of the lower one is thrown, whichever fails first.
TEST(ThreadPool, TheOrderOfFailuresInTimeDoesNotMatter) {
  ThreadPool pool(2);
  for (const std::size_t later : {0, 1}) {
    std::atomic<int> arrived = 0;
    try {
      pool.run(2, [&](std::size_t i) {
        ++arrived;
        while (arrived < 2) {
          std::this_thread::yield();
        }
        if (i == later) {
          std::this_thread::sleep_for(std::chrono::milliseconds(50));
        }
        throw std::runtime_error("job " + std::to_string(i));
      });
      FAIL() << "nothing was thrown";
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "job 0");
    }
  }
}

// The lowest failing job decides for any number of threads, and all jobs below it are run.
TEST(ThreadPool, RethrowsTheExceptionOfTheLowestJob) {
  for (const std::size_t threads : {1, 2, 4}) {
    ThreadPool pool(threads);
    for (int repeat = 0; repeat < 200; ++repeat) {
      std::vector<std::atomic<bool>> begun(100);
      try {
        pool.run(100, [&](std::size_t i) {
          begun[i] = true;
          if (i >= 40 && i % 2 == 0) {
            throw std::runtime_error("job " + std::to_string(i));
          }
        });
        FAIL() << "nothing was thrown";
      } catch (const std::runtime_error& error) {
        EXPECT_STREQ(error.what(), "job 40");
      }
      for (std::size_t i = 0; i <= 40; ++i) {
        EXPECT_TRUE(begun[i]) << i;
      }
    }
    // The pool still works.
    std::atomic<int> calls = 0;
    pool.run(50, [&](std::size_t) { ++calls; });
    EXPECT_EQ(calls, 50);
  }
}

// Every job throws, so no thread takes a second one: of a million jobs at most `threads` begin.
TEST(ThreadPool, LeavesOutWhatFollowsAFailure) {
  for (const std::size_t threads : {1, 2, 4}) {
    ThreadPool pool(threads);
    std::atomic<std::size_t> begun = 0;
    EXPECT_THROW(pool.run(1'000'000,
                          [&](std::size_t) {
                            ++begun;
                            throw std::runtime_error("every job fails");
                          }),
                 std::runtime_error);
    EXPECT_LE(begun, threads);
  }
}

TEST(ThreadPool, RefusesNoThreads) {
  try {
    ThreadPool pool(0);
    FAIL() << "a pool of 0 threads was made";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "a thread pool of 0 threads; it needs at least 1, the caller");
  }
}

// Runs in a child process that may start no more threads. Root is exempt from that limit, so the
// child changes its user first.
TEST(ThreadPool, WorksWithFewerThreadsThanAskedFor) {
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    const rlimit limit = {0, 0};
    if ((::getuid() == 0 && ::setuid(65534) != 0) || ::setrlimit(RLIMIT_NPROC, &limit) != 0) {
      ::_exit(2);
    }
    try {
      std::thread([] {}).join();
      ::_exit(3);  // the system does not apply the limit
    } catch (const std::system_error&) {
      // expected
    }
    ThreadPool pool(8);
    int calls = 0;
    pool.run(10, [&](std::size_t) { ++calls; });
    ::_exit(pool.size() == 1 && calls == 10 ? 0 : 1);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status));
  if (WEXITSTATUS(status) == 3) {
    GTEST_SKIP() << "this system grants threads beyond RLIMIT_NPROC";
  }
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

}  // namespace
}  // namespace armwright
