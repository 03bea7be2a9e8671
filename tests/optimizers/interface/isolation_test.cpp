#include "optimizers/interface/isolation.hpp"

#include <gmock/gmock.h>
#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <thread>

#include "optimizers/isolation_support.hpp"
#include "optimizers/table/optimizer_table.hpp"
#include "problems/analytic/analytic.hpp"
#include "process/parent_link.hpp"
#include "study/contract/memory_evaluator.hpp"

namespace armwright {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST_F(Isolation, GivesTheTraceOfTheOptimizerRunHere) {
  for (const char* name : {"ga", "random"}) {
    const OptimizerRow& row = find_optimizer(name);
    const auto optimizer = row.make(Options::parse(name, row.options, {}));
    for (const MemoryEvaluatorSettings& settings :
         {MemoryEvaluatorSettings{.budget = 333}, {.budget = 200, .fail_every = 7}}) {
      MemoryEvaluator here(*problem_, settings);
      optimizer->minimize(here, 5);
      MemoryEvaluator isolated(*problem_, settings);
      minimize_isolated(
          name, [&](Evaluator& remote) { optimizer->minimize(remote, 5); }, isolated, kLimits);
      EXPECT_EQ(isolated.trace(), here.trace());
      EXPECT_EQ(isolated.batch_sizes(), here.batch_sizes());
      EXPECT_EQ(isolated.generations(), here.generations());
    }
  }
}

TEST_F(Isolation, TheChildSeesWhatTheEvaluatorAnswers) {
  // What the child learns comes back as points: it has no other way to talk.
  minimize_isolated(
      "demo",
      [](Evaluator& remote) {
        remote.begin_generation();
        const std::vector<std::vector<double>> points = {{1, 2}, {1e9, 0}};
        const std::vector<Score> scores = remote.evaluate(points);
        remote.recommend(std::vector<double>{scores.at(0).objectives.at(0),
                                             static_cast<double>(scores.at(0).clipped)});
        remote.recommend(std::vector<double>{static_cast<double>(remote.remaining()),
                                             static_cast<double>(scores.at(1).clipped)});
        remote.recommend(std::vector<double>{static_cast<double>(remote.stopped()),
                                             static_cast<double>(scores.size())});
        remote.recommend(std::vector<double>{static_cast<double>(remote.evaluate({}).size()),
                                             remote.problem().variables.at(1).upper});
      },
      evaluator_, kLimits);
  const double first = evaluator_.trace().at(0).score.objectives.at(0);
  const double upper = problem_->description().variables.at(1).upper;
  EXPECT_EQ(evaluator_.recommended(),
            (std::vector<std::vector<double>>{{first, 0}, {98, 1}, {0, 2}, {0, upper}}));
  EXPECT_EQ(evaluator_.generations(), 1);
}

TEST_F(Isolation, ScoresArriveWhole) {
  class Rich : public MemoryEvaluator {
   public:
    using MemoryEvaluator::MemoryEvaluator;
    std::vector<Score> evaluate(std::span<const std::vector<double>> points) override {
      std::vector<Score> scores = MemoryEvaluator::evaluate(points);
      for (Score& score : scores) {
        score.constraint_values = {-0.5, 0.25};
        score.residuals = {7, 8, 9};
        score.status = EvaluationStatus::unreachable;
      }
      return scores;
    }
  };
  Rich evaluator(*problem_, {.budget = 10});
  minimize_isolated(
      "demo",
      [](Evaluator& remote) {
        const std::vector<std::vector<double>> points = {{1, 2}};
        const Score score = remote.evaluate(points).at(0);
        remote.recommend(score.constraint_values);
        remote.recommend(std::vector<double>{score.residuals.at(2),
                                             static_cast<double>(score.residuals.size())});
        remote.recommend(std::vector<double>{static_cast<double>(score.status), 0});
      },
      evaluator, kLimits);
  const auto status = static_cast<double>(EvaluationStatus::unreachable);
  EXPECT_EQ(evaluator.recommended(),
            (std::vector<std::vector<double>>{{-0.5, 0.25}, {9, 3}, {status, 0}}));
}

TEST_F(Isolation, WithoutBudgetNothingIsStarted) {
  MemoryEvaluator spent(*problem_, {.budget = 0});
  minimize_isolated(
      "demo", [](Evaluator&) { _exit(1); }, spent, kLimits);
  EXPECT_TRUE(spent.trace().empty());
}

TEST_F(Isolation, AnExceptionIsAFailureWithItsText) {
  EXPECT_EQ(failure_of([](Evaluator& remote) {
              evaluate(remote, {{1, 2}});
              throw std::runtime_error("the simplex is \033[31mflat");
            }),
            "optimizer 'demo' threw an exception (the simplex is ?[31mflat) after 1 evaluation; "
            "what it had asked for is kept");
  EXPECT_EQ(evaluator_.trace().size(), 1u);
  EXPECT_THAT(failure_of([](Evaluator&) { throw 3; }), HasSubstr("no std::exception"));
}

TEST_F(Isolation, ExitsAreFailures) {
  static const pid_t kProgram = getpid();
  std::atexit([] {
    if (getpid() != kProgram) {
      std::fputs("an exit handler of the program ran in the child\n", stderr);
    }
  });
  testing::internal::CaptureStderr();
  EXPECT_EQ(failure_of([](Evaluator& remote) {
              evaluate(remote, {{1, 2}, {3, 4}});
              std::exit(3);
            }),
            "optimizer 'demo' ended its process with exit code 3 before it had finished after 2 "
            "evaluations; what it had asked for is kept");
  EXPECT_THAT(failure_of([](Evaluator&) { _exit(0); }), HasSubstr("exit code 0 before"));
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST_F(Isolation, DeathBySignalNamesIt) {
  EXPECT_EQ(failure_of([](Evaluator& remote) {
              for (int i = 0; i < 6; ++i) {
                evaluate(remote, {{1, 2}, {3, 4}});
              }
              raise(SIGSEGV);
            }),
            "optimizer 'demo' was killed by signal 11 (Segmentation fault) after 12 evaluations; "
            "what it had asked for is kept");
  EXPECT_THAT(failure_of([](Evaluator&) { std::abort(); }), HasSubstr("signal 6 (Aborted)"));
  EXPECT_THAT(failure_of([](Evaluator&) { std::terminate(); }), HasSubstr("signal 6 (Aborted)"));
}

TEST_F(Isolation, SilenceIsAFailure) {
  const auto body = [](Evaluator& remote) {
    evaluate(remote, {{1, 2}});
    loop_forever();
  };
  EXPECT_THAT(failure_of(body, {.silence_s = 0.3}),
              HasSubstr("was silent for more than 0.3 s and had to be killed after 1 evaluation;"));
  EXPECT_THAT(failure_of(body, {.silence_s = 0.3, .are_options = true}),
              HasSubstr("was silent for more than 0.3 s and had to be killed (option silence_s) "
                        "after 1 evaluation;"));
}

TEST_F(Isolation, APartOfAMessageDoesNotBreakTheSilence) {
  EXPECT_THAT(failure_of(
                  [](Evaluator&) {
                    constexpr int kConnection = 3;  // as TheChildHoldsNoneOfOurDescriptors has it
                    const FrameHeader header{.size = 1000};
                    [[maybe_unused]] auto written = write(kConnection, &header, sizeof header);
                    for (int i = 0; i < 100; ++i) {
                      std::this_thread::sleep_for(std::chrono::milliseconds(20));
                      written = write(kConnection, "x", 1);
                    }
                    _exit(3);
                  },
                  {.silence_s = 0.3, .memory_mib = 1024}),
              HasSubstr("was silent for more than 0.3 s"));
}

TEST_F(Isolation, TheEvaluatorsOwnTimeIsNoSilence) {
  class Slow : public MemoryEvaluator {
   public:
    using MemoryEvaluator::MemoryEvaluator;
    std::vector<Score> evaluate(std::span<const std::vector<double>> points) override {
      std::this_thread::sleep_for(std::chrono::milliseconds(700));
      return MemoryEvaluator::evaluate(points);
    }
  };
  Slow evaluator(*problem_, {.budget = 10});
  minimize_isolated("demo",
                    [](Evaluator& remote) {
                      evaluate(remote, {{1, 2}});
                    },
                    evaluator, {.silence_s = 0.5, .memory_mib = 1024});
  EXPECT_EQ(evaluator.trace().size(), 1u);
}

TEST_F(Isolation, HungerForMemoryIsAFailure) {
  const auto hungry = [](std::size_t step) {
    return [step](Evaluator& remote) {
      evaluate(remote, {{1, 2}});
      std::vector<std::vector<char>> hoard;
      while (true) {
        hoard.emplace_back(step, 'x');
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
      }
    };
  };
  // Slowly: the parent notices. At one stroke: the system refuses, or (address sanitizer) the
  // parent notices again.
  const ProcessLimits limits{.silence_s = 30, .memory_mib = 64, .are_options = true};
  EXPECT_THAT(failure_of(hungry(std::size_t{8} << 20), limits),
              HasSubstr("more memory than the 64 MiB it may and had to be killed (option "
                        "memory_mib)"));
  EXPECT_THAT(failure_of(hungry(std::size_t{512} << 20), limits),
              AllOf(HasSubstr("(option memory_mib)"), HasSubstr("64 MiB")));
  EXPECT_THAT(failure_of(hungry(std::size_t{512} << 20), {.silence_s = 30, .memory_mib = 64}),
              AllOf(HasSubstr("64 MiB"), Not(HasSubstr("memory_mib"))));
}

TEST_F(Isolation, PointsThatAreNoNumbersNameEvaluationAndVariable) {
  const std::string second = problem_->description().variables.at(1).name;
  EXPECT_EQ(failure_of([](Evaluator& remote) {
              evaluate(remote, {{1, 2}});
              evaluate(remote, {{3, 4}, {5, kNaN}});
            }),
            "optimizer 'demo' asked for a point (evaluation 3) with " + second +
                " = nan, which is not a finite number after 1 evaluation; what it had asked for "
                "is kept");
  EXPECT_THAT(failure_of([](Evaluator& remote) {
                evaluate(remote, {{1, -1.0 / 0.0}});
              }),
              HasSubstr("-inf"));
  EXPECT_THAT(failure_of([](Evaluator& remote) {
                remote.recommend(std::vector<double>{1, kNaN});
              }),
              HasSubstr("recommended a point with"));
}

TEST_F(Isolation, PointsOfTheWrongLengthAreFailures) {
  EXPECT_THAT(failure_of([](Evaluator& remote) {
                evaluate(remote, {{1, 2}, {1, 2, 3}});
              }),
              HasSubstr("(evaluation 2) of 3 coordinates for 2 decision variables"));
  EXPECT_THAT(failure_of([](Evaluator& remote) { evaluate(remote, {{}}); }),
              HasSubstr("(evaluation 1) of 0 coordinates"));
  EXPECT_TRUE(evaluator_.trace().empty());
}

TEST_F(Isolation, WhoAsksOnAndOnWithoutEvaluatingFails) {
  // Bounded, so that the test ends if nobody notices.
  const auto repeat = [](const std::function<void(Evaluator&)>& ask) {
    return [ask](Evaluator& remote) {
      evaluate(remote, {{1, 2}});
      for (int i = 0; i < 100001; ++i) {
        ask(remote);
      }
    };
  };
  EXPECT_EQ(failure_of(repeat([](Evaluator& remote) {
              remote.recommend(std::vector<double>{1, 2});
            })),
            "optimizer 'demo' asked 100000 questions in a row without evaluating a point (the "
            "last: recommend()) after 1 evaluation; what it had asked for is kept");
  EXPECT_THAT(failure_of(repeat([](Evaluator& remote) { evaluate(remote, {}); })),
              HasSubstr("the last: evaluate() without points"));
  EXPECT_THAT(failure_of(repeat([](Evaluator& remote) { remote.stopped(); })),
              HasSubstr("the last: stopped()"));
}

TEST_F(Isolation, WhoAsksMuchAndEvaluatesMayGoOn) {
  EXPECT_EQ(failure_of([](Evaluator& remote) {
              for (int i = 0; i < 2; ++i) {
                for (int k = 0; k < 60000; ++k) {
                  remote.stopped();
                }
                evaluate(remote, {{1, 2}});
              }
            }),
            "no failure");
  EXPECT_EQ(evaluator_.trace().size(), 2u);
}

TEST_F(Isolation, AStopFromOutsideEndsTheChildWhileItComputes) {
  class Stoppable : public MemoryEvaluator {
   public:
    using MemoryEvaluator::MemoryEvaluator;
    bool stopped() const override { return stop || MemoryEvaluator::stopped(); }
    std::atomic<bool> stop = false;
  };
  Stoppable evaluator(*problem_, {.budget = 10});
  std::thread user([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    evaluator.stop = true;
  });
  minimize_isolated(
      "demo",
      [](Evaluator& remote) {
        evaluate(remote, {{1, 2}});
        loop_forever();
      },
      evaluator, kLimits);
  user.join();
  EXPECT_EQ(evaluator.trace().size(), 1u);
}

TEST_F(Isolation, AnOptimizerThatIgnoresTheEndIsStopped) {
  minimize_isolated(
      "demo",
      [](Evaluator& remote) {
        while (true) {
          evaluate(remote, {{1, 2}});
        }
      },
      evaluator_, kLimits);
  EXPECT_EQ(evaluator_.trace().size(), 100u);
  EXPECT_EQ(evaluator_.calls_after_stop(), 0);
}

TEST_F(Isolation, TheEvaluatorsExceptionsComeOutUnchanged) {
  MemoryEvaluator broken(*problem_, {.budget = 10, .throw_at = 2});
  const auto body = [](Evaluator& remote) {
    while (true) {
      evaluate(remote, {{1, 2}});
    }
  };
  try {
    minimize_isolated("demo", body, broken, kLimits);
    FAIL() << "nothing came out";
  } catch (const OptimizerFailure&) {
    FAIL() << "taken for the optimizer's";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "the evaluator is broken");
  }
}

TEST_F(Isolation, AfterTheStopAChildMayRecommendForAWhile) {
  const auto body = [](Evaluator& remote) {
    while (!remote.stopped()) {
      evaluate(remote, {{1, 2}});
    }
    evaluate(remote, {{kNaN, 2}});  // no answer, and no fault
    remote.recommend(std::vector<double>{3, 4});
    while (true) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  };
  const auto begin = std::chrono::steady_clock::now();
  minimize_isolated("demo", body, evaluator_, kLimits, nullptr, 0.5);
  const std::chrono::duration<double> duration = std::chrono::steady_clock::now() - begin;
  EXPECT_EQ(evaluator_.recommended(), (std::vector<std::vector<double>>{{3, 4}}));
  EXPECT_EQ(evaluator_.trace().size(), 100u);
  EXPECT_GE(duration.count(), 0.5) << "it was not given its time";
  EXPECT_LT(duration.count(), 20) << "it was given silence_s instead";
}

TEST_F(Isolation, TheReasonOfAnEndReachesTheEvaluator) {
  class Listener : public MemoryEvaluator {
   public:
    using MemoryEvaluator::MemoryEvaluator;
    void explain_end(std::string_view reason) override { reason_ = reason; }
    std::string reason_;
  };
  Listener listener(*problem_, {.budget = 10});
  minimize_isolated(
      "demo", [](Evaluator& remote) { remote.explain_end("all is seen"); }, listener, kLimits);
  EXPECT_EQ(listener.reason_, "all is seen");
}

}  // namespace
}  // namespace armwright
