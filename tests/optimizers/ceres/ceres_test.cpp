#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/expect_error.hpp"
#include "optimizers/ceres/ceres_backend.hpp"
#include "optimizers/table/optimizer_table.hpp"
#include "optimizers/test_problems.hpp"
#include "problems/analytic/analytic.hpp"
#include "study/contract/memory_evaluator.hpp"

namespace armwright {
namespace {

using testing::AnyOf;
using testing::Each;
using testing::HasSubstr;

// As an arm's gains: errors, all positive and of very different size, that fall with the right
// ratios of logarithmic variables; a limit that does not matter. Minimum 2.25.
std::unique_ptr<Problem> make_arm_like() {
  return std::make_unique<ResidualProblem>(
      std::vector<DecisionVariable>{{"p", "", 1, 10000, 100, Scale::logarithmic},
                                    {"d", "", 0.1, 1000, 10, Scale::logarithmic},
                                    {"limit", "", -1e6, -100, -1e4, Scale::logarithmic}},
      [](std::span<const double> x) {
        const double a = std::log(x[0] / 400);
        const double b = std::log(x[1] / 30);
        return std::vector<double>{std::exp(a * a), std::exp(0.5 * a * a + 0.5 * b * b),
                                   0.5 * std::exp(std::pow(b - 0.2 * a, 2))};
      });
}

MemoryEvaluator run(const std::string& name, const Problem& problem,
                    const MemoryEvaluatorSettings& settings,
                    const std::vector<std::string>& assignments = {}) {
  MemoryEvaluator evaluator(problem, settings);
  const OptimizerRow& row = find_optimizer(name);
  row.make(Options::parse(name, row.options, assignments))->minimize(evaluator, 1);
  return evaluator;
}

std::vector<double> start_of(const Problem& problem) {
  std::vector<double> start;
  for (const DecisionVariable& variable : problem.description().variables) {
    start.push_back(variable.start);
  }
  return start;
}

class Ceres : public testing::Test {
 protected:
  void SetUp() override {
    if (!find_optimizer("ceres:lm").unavailable.empty()) {
      GTEST_SKIP() << find_optimizer("ceres:lm").unavailable;
    }
  }
};

TEST_F(Ceres, LmSolvesRosenbrock) {
  const auto problem = make_analytic("rosenbrock", 10);
  for (const char* transform : {"transform=none", "transform=auto"}) {  // no logarithmic variables
    const MemoryEvaluator evaluator = run("ceres:lm", *problem, {.budget = 2000}, {transform});
    EXPECT_LT(evaluator.best().value(), 1e-8);
    EXPECT_LT(evaluator.trace().size(), 600u);  // ends by itself; measured 530
    EXPECT_EQ(evaluator.trace().front().asked, start_of(*problem));
  }
}

TEST_F(Ceres, LmTakesLogarithmsWhereEveryVariableIsLogarithmic) {
  const auto problem = make_arm_like();
  const MemoryEvaluator evaluator = run("ceres:lm", *problem, {.budget = 300});
  EXPECT_LT(evaluator.best().value(), 2.26);  // forward differences; the start has 60
  EXPECT_GT(evaluator.best().value(), 2.25 - 1e-12);
  EXPECT_EQ(evaluator.trace().front().asked, start_of(*problem));
  const auto traced = [&](const char* transform) {
    return run("ceres:lm", *problem, {.budget = 300}, {transform}).trace();
  };
  EXPECT_EQ(evaluator.trace(), traced("transform=log"));
  EXPECT_NE(evaluator.trace(), traced("transform=none"));
  // What has no influence stays where it was, but for the shifts: 0.07 of the box and its halves.
  const auto best = std::ranges::min_element(
      evaluator.trace(), {}, [](const auto& entry) { return entry.score.objectives[0]; });
  EXPECT_LT(std::abs(std::log(best->asked[2] / -1e4)), 2 * 0.07 * std::log(1e4));
}

// Simulations ripple: over short distances the slope is that of the ripple.
TEST_F(Ceres, LmLooksBeyondRipples) {
  const ResidualProblem problem(
      std::vector<DecisionVariable>{{"p", "", 1, 10000, 100, Scale::logarithmic},
                                    {"d", "", 0.1, 1000, 10, Scale::logarithmic}},
      [](std::span<const double> x) {
        const double a = std::log(x[0] / 2000);
        const double b = std::log(x[1] / 50);
        const double ripple = 1 + 0.1 * std::sin(150 * (a + 2 * b));
        return std::vector<double>{(0.1 + std::abs(a)) * ripple, (0.1 + std::abs(b)) / ripple};
      });
  const double wide = run("ceres:lm", problem, {.budget = 200}).best().value();
  const double narrow = run("ceres:lm", problem, {.budget = 200}, {"step=0.0005"}).best().value();
  EXPECT_LT(wide, 0.1 * narrow);
}

// Extended Rosenbrock in two variables with its Jacobian; a logarithmic one that does not matter.
std::unique_ptr<Problem> make_exact_rosenbrock() {
  return std::make_unique<JacobianProblem>(
      std::vector<DecisionVariable>{{"x", "", -5, 10, -1.2, Scale::linear},
                                    {"y", "", -5, 10, 1, Scale::linear},
                                    {"z", "", 1, 100, 10, Scale::logarithmic}},
      [](std::span<const double> x) {
        return std::vector<double>{10 * (x[1] - x[0] * x[0]), 1 - x[0], 0.1};
      },
      [](std::span<const double> x) {
        return std::vector<double>{-20 * x[0], 10, 0, -1, 0, 0, 0, 0, 0};
      });
}

TEST_F(Ceres, LmTakesExactDerivativesWhereToldTo) {
  const auto problem = make_exact_rosenbrock();
  const MemoryEvaluator exact =
      run("ceres:lm", *problem, {.budget = 1000}, {"derivatives=exact", "function_tolerance=0"});
  EXPECT_NEAR(exact.best().value(), 0.01, 1e-12);
  EXPECT_LT(exact.charged(), 1000);  // ends by itself
  std::int64_t charge = 0;
  for (const MemoryEvaluator::Entry& entry : exact.trace()) {
    charge += entry.with_jacobian ? 2 : 1;
  }
  EXPECT_EQ(exact.charged(), charge);
  EXPECT_EQ(exact.trace().front().asked, start_of(*problem));
}

TEST_F(Ceres, LmMeetsTheBudgetWithExactDerivatives) {
  const auto problem = make_exact_rosenbrock();
  for (std::int64_t budget = 0; budget < 20; ++budget) {
    const MemoryEvaluator evaluator =
        run("ceres:lm", *problem, {.budget = budget}, {"derivatives=exact"});
    EXPECT_LE(evaluator.charged(), budget);
    EXPECT_GE(evaluator.charged(), budget - 1);  // too little may be left for derivatives
    EXPECT_LE(evaluator.calls_after_stop(), 1);
  }
  const OptimizerRow row = load_optimizer("multistart:ceres:lm");
  MemoryEvaluator evaluator(*problem, {.budget = 200});
  const std::vector<std::string> assignments = {"derivatives=exact", "evaluations_per_start=20"};
  row.make(Options::parse(row.name, row.options, assignments))->minimize(evaluator, 1);
  EXPECT_GE(evaluator.charged(), 199);
  EXPECT_LE(evaluator.charged(), 200);
}

TEST_F(Ceres, LmSaysWhatToDoWithoutExactDerivatives) {
  const auto problem = make_analytic("rosenbrock", 10);
  MemoryEvaluator evaluator(*problem, {.budget = 100});
  for (const std::string name : {"ceres:lm", "multistart:ceres:lm"}) {
    const OptimizerRow row = load_optimizer(name);
    const std::vector<std::string> exact = {"derivatives=exact"};
    const auto optimizer = row.make(Options::parse(name, row.options, exact));
    EXPECT_THAT(usage_error_of([&] { optimizer->check_problem(problem->description()); }),
                HasSubstr("option derivatives is exact, but problem rosenbrock offers no exact "
                          "derivatives"));
    EXPECT_THROW(optimizer->minimize(evaluator, 1), Error);
  }
  EXPECT_TRUE(evaluator.trace().empty());
}

TEST_F(Ceres, LmEvaluatesWhateverTheSmallestStep) {
  const auto problem = make_analytic("rosenbrock", 10);
  const MemoryEvaluator evaluator =
      run("ceres:lm", *problem, {.budget = 600}, {"step=1e-5", "smallest_step=0.1"});
  EXPECT_LT(evaluator.best().value(), 1e-6);
}

// Every round's derivatives are taken at, and so one shift away from, the best point of all before.
TEST_F(Ceres, LmStartsAgainFromTheBestPoint) {
  // The start is the best already, and no slope says so: no round gains anything.
  const ResidualProblem problem(
      std::vector<DecisionVariable>{{"a", "", -1, 1, 0}, {"b", "", -1, 1, 0}},
      [](std::span<const double> x) {
        return std::vector<double>{1 + std::abs(x[0]), 1 + std::abs(x[1])};
      });
  const MemoryEvaluator evaluator = run("ceres:lm", problem, {.budget = 3000}, {"step=0.1"});
  const auto& trace = evaluator.trace();
  // The step of a batch of shifts: the one coordinate in which it differs from its centre.
  double narrowest = std::numeric_limits<double>::infinity();
  std::vector<double> best;
  double best_value = std::numeric_limits<double>::infinity();
  int rounds = 0;
  for (std::size_t i = 0; i < trace.size(); ++i) {
    if (!best.empty()) {
      int differing = 0;
      double shift = 0;
      for (std::size_t k = 0; k < best.size(); ++k) {
        if (trace[i].asked[k] != best[k]) {
          ++differing;
          shift = std::abs(trace[i].asked[k] - best[k]);
        }
      }
      if (differing == 1 && shift < 0.6 * narrowest) {
        narrowest = shift;
        ++rounds;
      }
    }
    if (trace[i].score.objectives[0] < best_value) {
      best_value = trace[i].score.objectives[0];
      best = trace[i].asked;
    }
  }
  EXPECT_EQ(rounds, 8);  // 0.1 / 2^7 is the last above 0.0005
}

TEST_F(Ceres, DerivativesAreOneBatchAndNothingIsAskedForTwice) {
  const auto rosenbrock = make_analytic("rosenbrock", 10);
  EXPECT_THAT(run("ceres:lm", *rosenbrock, {.budget = 300}).batch_sizes(), Each(AnyOf(1, 10)));
  EXPECT_THAT(run("ceres:lm", *rosenbrock, {.budget = 300}, {"differences=central"}).batch_sizes(),
              Each(AnyOf(1, 20)));
  EXPECT_THAT(
      run("ceres:bfgs", *rosenbrock, {.budget = 300}, {"differences=forward"}).batch_sizes(),
      Each(AnyOf(1, 10, 11)));
  for (const char* name : {"ceres:lm", "ceres:bfgs"}) {
    std::vector<std::vector<double>> points;
    const MemoryEvaluator evaluator = run(name, *rosenbrock, {.budget = 2000});
    for (const MemoryEvaluator::Entry& entry : evaluator.trace()) {
      points.push_back(entry.asked);
    }
    std::ranges::sort(points);
    EXPECT_EQ(std::ranges::adjacent_find(points), points.end()) << name;
  }
}

TEST_F(Ceres, BfgsSolvesRosenbrock) {
  const auto problem = make_analytic("rosenbrock", 10);
  const MemoryEvaluator evaluator = run("ceres:bfgs", *problem, {.budget = 4000}, {"step=1e-6"});
  EXPECT_LT(evaluator.best().value(), 1e-8);
  EXPECT_LT(evaluator.trace().size(), 4000u);  // ends by itself; measured 2415
  EXPECT_EQ(evaluator.trace().front().asked, start_of(*problem));
}

TEST_F(Ceres, BfgsPaysForViolatedConstraints) {
  const auto problem = make_analytic("constrained");
  const MemoryEvaluator evaluator =
      run("ceres:bfgs", *problem, {.budget = 2000}, {"constraint_weight=10"});
  EXPECT_LT(evaluator.best().value(), -40);  // of -44, and the start is at 1.5
}

// A minimum outside the box: at the corner (2, -3).
std::unique_ptr<Problem> make_cornered(double start) {
  return std::make_unique<ResidualProblem>(
      std::vector<DecisionVariable>{{"x", "", -2, 2, start, Scale::linear},
                                    {"y", "", -3, 4, start, Scale::linear}},
      [](std::span<const double> x) {
        return std::vector<double>{x[0] - 5, x[1] + 4, 0.1 * x[0] * x[1]};
      });
}

TEST_F(Ceres, BoundsAreKeptAndMet) {
  constexpr double kMinimum = 9 + 1 + 0.36;
  for (const double start : {0.5, 2.0}) {  // inside and, for x, on the upper bound
    const auto problem = make_cornered(start);
    for (const char* name : {"ceres:lm", "ceres:bfgs"}) {
      const MemoryEvaluator evaluator = run(name, *problem, {.budget = 1000});
      for (const MemoryEvaluator::Entry& entry : evaluator.trace()) {
        EXPECT_FALSE(entry.score.clipped);
      }
      EXPECT_NEAR(evaluator.best().value(), kMinimum, 1e-3) << name << " from " << start;
    }
  }
}

TEST_F(Ceres, TheBudgetAndAStopAreHonoured) {
  const auto problem = make_analytic("rosenbrock", 10);
  for (const char* name : {"ceres:lm", "ceres:bfgs"}) {
    for (const std::int64_t budget : {0, 1, 2, 11, 12, 13, 45, 150}) {
      const MemoryEvaluator spent = run(name, *problem, {.budget = budget});
      EXPECT_EQ(std::ssize(spent.trace()), budget) << name;
      EXPECT_LE(spent.calls_after_stop(), 1) << name;
      const MemoryEvaluator stopped =
          run(name, *problem, {.budget = INT64_MAX, .stop_after = budget});
      EXPECT_EQ(stopped.trace(), spent.trace()) << name;
    }
  }
}

TEST_F(Ceres, AnExceptionComesThroughAndNothingIsAskedForAfterIt) {
  const auto problem = make_analytic("rosenbrock", 10);
  for (const char* name : {"ceres:lm", "ceres:bfgs"}) {
    for (const std::int64_t throw_at : {1, 2, 12, 40}) {
      MemoryEvaluator evaluator(*problem, {.budget = 200, .throw_at = throw_at});
      const OptimizerRow& row = find_optimizer(name);
      try {
        row.make(Options::parse(name, row.options, {}))->minimize(evaluator, 1);
        ADD_FAILURE() << name << " swallowed the exception at evaluation " << throw_at;
      } catch (const std::runtime_error& error) {
        EXPECT_STREQ(error.what(), "the evaluator is broken");
      }
      EXPECT_EQ(std::ssize(evaluator.trace()), throw_at - 1);
    }
  }
}

TEST_F(Ceres, FailuresAreSurvivedAndNothingIsPrinted) {
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  const auto rosenbrock = make_analytic("rosenbrock", 10);
  const auto arm_like = make_arm_like();
  const auto flat = std::make_unique<ResidualProblem>(  // nothing to descend, and huge numbers
      arm_like->description().variables, [](std::span<const double>) {
        return std::vector<double>{1e200, 0};
      });
  const auto cliff = std::make_unique<ResidualProblem>(
      arm_like->description().variables, [](std::span<const double> x) {
        return std::vector<double>{x[0] < 90 ? std::nan("") : x[0], x[0] > 105 ? 1e308 : x[1]};
      });
  for (const char* name : {"ceres:lm", "ceres:bfgs"}) {
    for (const std::int64_t fail_every : {1, 2, 3, 7, 13}) {
      const MemoryEvaluator evaluator =
          run(name, *rosenbrock, {.budget = 2000, .fail_every = fail_every});
      EXPECT_GE(evaluator.trace().size(), 1u);
      if (fail_every > 2) {
        EXPECT_LT(evaluator.best().value(), evaluator.trace().front().score.objectives[0]);
      }
      run(name, *arm_like, {.budget = 2000, .fail_every = fail_every});
    }
    for (const char* transform : {"none", "log"}) {
      const bool is_lm = name == std::string("ceres:lm");
      const std::vector<std::string> assignments =
          is_lm ? std::vector<std::string>{std::string("transform=") + transform}
                : std::vector<std::string>{};
      run(name, *flat, {.budget = 500}, assignments);
      run(name, *cliff, {.budget = 500}, assignments);
    }
  }
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(CeresRows, AreHonestAboutWhatTheyNeed) {
  const OptimizerRow& lm = find_optimizer("ceres:lm");
  EXPECT_TRUE(lm.capabilities.local);
  EXPECT_FALSE(lm.capabilities.stochastic);
  const auto description = make_analytic("constrained")->description();
  EXPECT_THAT(explain_unsuitable(lm, description), HasSubstr("it works on residuals"));
  EXPECT_EQ(explain_unsuitable(find_optimizer("ceres:bfgs"), description), "");
  if (!lm.unavailable.empty()) {
    EXPECT_EQ(lm.unavailable,
              "built without Ceres Solver (CMake option ARMWRIGHT_WITH_CERES is OFF)");
    EXPECT_THROW(load_optimizer("ceres:lm"), Error);
    EXPECT_THROW(lm.make(Options::parse("ceres:lm", lm.options, {})), Error);
  }
}

TEST_F(Ceres, CanBeRestarted) {
  const auto problem = make_analytic("rastrigin", 2);
  const double once = run("ceres:lm", *problem, {.budget = 3000}).best().value();
  const OptimizerRow row = load_optimizer("multistart:ceres:lm");
  EXPECT_TRUE(row.requirements.residuals);
  MemoryEvaluator evaluator(*problem, {.budget = 3000});
  row.make(Options::parse(row.name, row.options, {}))->minimize(evaluator, 1);
  EXPECT_EQ(evaluator.trace().size(), 3000u);
  EXPECT_GT(once, 0.9);
  EXPECT_LT(evaluator.best().value(), 1e-6);
}

}  // namespace
}  // namespace armwright
