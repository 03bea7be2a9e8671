// What the tests of isolation share.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cerrno>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <memory>
#include <string>
#include <vector>

#include "optimizers/interface/isolation.hpp"
#include "problems/analytic/analytic.hpp"
#include "study/contract/memory_evaluator.hpp"

namespace armwright {

inline constexpr ProcessLimits kLimits{.silence_s = 30, .memory_mib = 1024};

inline std::size_t count_descriptors() {
  std::size_t count = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
    ++count;
  }
  return count;
}

// Every test ends with no child and no descriptor more than it began with.
class Isolation : public testing::Test {
 protected:
  void SetUp() override { descriptors_ = count_descriptors(); }
  void TearDown() override {
    EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1);
    EXPECT_EQ(errno, ECHILD);
    EXPECT_EQ(count_descriptors(), descriptors_);
  }

  std::string failure_of(const std::function<void(Evaluator&)>& body,
                         const ProcessLimits& limits = kLimits) {
    try {
      minimize_isolated("demo", body, evaluator_, limits);
    } catch (const OptimizerFailure& failure) {
      return failure.what();
    }
    return "no failure";
  }

  std::unique_ptr<Problem> problem_ = make_analytic("sphere", 2);
  MemoryEvaluator evaluator_{*problem_, {.budget = 100}};
  std::size_t descriptors_ = 0;
};

inline void evaluate(Evaluator& evaluator, std::initializer_list<std::vector<double>> points) {
  evaluator.evaluate(std::vector<std::vector<double>>(points));
}

[[noreturn]] inline void loop_forever() {
  const volatile bool is_true = true;
  while (is_true) {
  }
  std::abort();
}

}  // namespace armwright
