// Whole runs of CMA-ES. What it is made of: cma_parts_test.cpp.
#include <gmock/gmock.h>

#include <cmath>
#include <functional>

#include "base/expect_error.hpp"
#include "optimizers/cma/cma_distribution.hpp"
#include "optimizers/cma/cma_search.hpp"
#include "optimizers/run_optimizer.hpp"
#include "optimizers/table/optimizer_table.hpp"
#include "optimizers/test_problems.hpp"
#include "problems/analytic/analytic.hpp"
#include "study/contract/memory_evaluator.hpp"

namespace armwright {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;

// Evaluations until the objective is below the target; the budget if it never is.
std::int64_t count_to_target(const Problem& problem, double target, std::int64_t budget,
                             std::uint64_t seed, const std::vector<std::string>& assignments = {}) {
  MemoryEvaluator evaluator(problem, {.budget = budget});
  minimize_with("cmaes", evaluator, seed, assignments);
  for (std::size_t i = 0; i < evaluator.trace().size(); ++i) {
    if (evaluator.trace()[i].score.objectives[0] < target) {
      return static_cast<std::int64_t>(i) + 1;
    }
  }
  return budget;
}

std::int64_t count_median_to_target(const Problem& problem, double target, std::int64_t budget,
                                    const std::vector<std::string>& assignments = {}) {
  std::vector<std::int64_t> counts;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    counts.push_back(count_to_target(problem, target, budget, seed, assignments));
  }
  std::ranges::sort(counts);
  return counts[2];
}

TEST(CmaEs, AnOptimumOnTheBoundIsReached) {
  // Falls towards two bounds without end, a bowl in the rest: minimum -1 - 2 at (0, 1, 0.3, 0.3).
  const auto problem = make_problem(4, 0.5, 0, 1, [](std::span<const double> x) {
    return -1 + x[0] - 2 * x[1] + std::pow(x[2] - 0.3, 2) + std::pow(x[3] - x[2], 2);
  });
  EXPECT_LT(count_median_to_target(problem, -3 + 1e-10, 4000, {"restarts=none"}), 4000);
}

TEST(CmaEs, NeverLeavesTheBox) {
  const auto problem = make_problem(3, 0.9, -1, 1, [](std::span<const double> x) {
    return -x[0] - 100 * x[1] + std::abs(x[2] + 1);
  });
  for (const char* sigma : {"sigma=0.05", "sigma=1"}) {
    MemoryEvaluator evaluator(problem, {.budget = 5000});
    minimize_with("cmaes", evaluator, 1, {sigma});
    for (const MemoryEvaluator::Entry& entry : evaluator.trace()) {
      ASSERT_FALSE(entry.score.clipped);
    }
    for (const std::vector<double>& point : evaluator.recommended()) {
      for (const double value : point) {
        ASSERT_LE(std::abs(value), 1);
      }
    }
  }
}

TEST(CmaEs, WorksInTheLogarithmOfLogarithmicVariables) {
  const FunctionProblem problem(
      {{"a", "", 1, 1e6, 10, Scale::logarithmic}, {"b", "", -1e4, -1, -5000, Scale::logarithmic}},
      [](std::span<const double> x, std::uint64_t) {
        return std::pow(std::log(x[0] / 3e5), 2) + std::pow(std::log(x[1] / -2), 2);
      });
  EXPECT_LT(count_median_to_target(problem, 1e-10, 1500), 1500);
}

// --- convergence

// The sphere and the ellipsoid: nobody prints these very runs; the limits are 1.5 times what
// docs/cmaes.md measures. Rosenbrock has a published run to hold to.
TEST(CmaEs, ConvergesOnTheSphere) {
  EXPECT_LT(count_median_to_target(*make_analytic("sphere", 10), 1e-8, 2200), 2200);
}

TEST(CmaEs, ConvergesOnTheEllipsoid) {
  EXPECT_LT(count_median_to_target(*make_analytic("ellipsoid", 10), 1e-8, 6000), 6000);
}

TEST(CmaEs, ConvergesOnRosenbrock) {
  // pycma: 6000 evaluations to 7e-11 from 0.1 with sigma 0.5, without the active update.
  const auto problem = make_problem(10, 0.1, -5, 5, [](std::span<const double> x) {
    double value = 0;
    for (std::size_t i = 0; i + 1 < x.size(); ++i) {
      value += 100 * std::pow(x[i + 1] - x[i] * x[i], 2) + std::pow(1 - x[i], 2);
    }
    return value;
  });
  EXPECT_LT(count_median_to_target(problem, 6.944e-11, 8400, {"restarts=none"}),
            6900);  // 1.15 times
}

TEST(CmaEs, RotationCostsNothing) {
  const auto calc = [](std::span<const double> y) {
    double value = 0;
    for (std::size_t i = 0; i < y.size(); ++i) {
      value +=
          std::pow(1e6, static_cast<double>(i) / static_cast<double>(y.size() - 1)) * y[i] * y[i];
    }
    return value;
  };
  const auto straight = make_problem(8, 0.2, -1, 1, calc);
  const auto turned = make_problem(8, 0.2, -1, 1, [calc](std::span<const double> x) {
    // A reflection I - 2 v v' / |v|^2, v = (1, 2, ..., 8): orthogonal, and it mixes all axes.
    double product = 0;
    for (std::size_t i = 0; i < 8; ++i) {
      product += static_cast<double>(i + 1) * x[i];
    }
    std::vector<double> y(x.begin(), x.end());
    for (std::size_t i = 0; i < 8; ++i) {
      y[i] -= 2 * product * static_cast<double>(i + 1) / 204;  // 204 = 1 + 4 + ... + 64
    }
    return calc(y);
  });
  const auto straight_count = static_cast<double>(count_median_to_target(straight, 1e-8, 20000));
  const auto turned_count = static_cast<double>(count_median_to_target(turned, 1e-8, 20000));
  EXPECT_LT(turned_count, 1.25 * straight_count);
  EXPECT_LT(straight_count, 1.25 * turned_count);
}

TEST(CmaEs, TheActiveUpdatePays) {
  const auto ellipsoid = make_analytic("ellipsoid", 10);
  const std::int64_t active = count_median_to_target(*ellipsoid, 1e-8, 20000);
  const std::int64_t passive = count_median_to_target(*ellipsoid, 1e-8, 20000, {"active=false"});
  EXPECT_LT(static_cast<double>(active), 0.9 * static_cast<double>(passive));  // measured: 0.72
}

// --- restarts

std::size_t count_largest_batch(const MemoryEvaluator& evaluator) {
  return *std::ranges::max_element(evaluator.batch_sizes());
}

TEST(CmaEs, RestartsWithLargerPopulations) {
  const auto problem = make_analytic("rastrigin", 5);
  for (const char* restarts : {"restarts=ipop", "restarts=bipop"}) {
    MemoryEvaluator evaluator(*problem, {.budget = 60000});
    minimize_with("cmaes", evaluator, 1, {restarts});
    EXPECT_GE(count_largest_batch(evaluator), 4 * calc_default_population(5)) << restarts;
    EXPECT_EQ(evaluator.trace().size(), 60000u);
    EXPECT_LT(evaluator.best().value(), 1e-8) << restarts;
  }
}

TEST(CmaEs, WithoutRestartsItEndsByItself) {
  const auto problem = make_analytic("rastrigin", 5);
  MemoryEvaluator evaluator(*problem, {.budget = 60000});
  minimize_with("cmaes", evaluator, 1, {"restarts=none"});
  EXPECT_LT(evaluator.trace().size(), 20000u);
  EXPECT_EQ(count_largest_batch(evaluator), calc_default_population(5));
}

TEST(CmaEs, AFlatFunctionEndsARun) {
  const auto problem = make_problem(3, 0.5, 0, 1, [](std::span<const double>) { return 7.0; });
  MemoryEvaluator evaluator(problem, {.budget = 100000});
  minimize_with("cmaes", evaluator, 1, {"restarts=none"});
  EXPECT_LT(evaluator.trace().size(), 1000u);
}

// --- noise

double calc_late_spread(const MemoryEvaluator& evaluator) {
  double square = 0;
  for (const MemoryEvaluator::Entry& entry : std::span(evaluator.trace()).last(200)) {
    square += std::pow(entry.asked[0] - 0.5, 2) / 200;
  }
  return std::sqrt(square);
}

TEST(CmaEs, UncertaintyHandlingEnlargesTheStepOnPureNoise) {
  const FunctionProblem problem(std::vector<DecisionVariable>(5, {"x", "", 0, 1, 0.5}),
                                [](std::span<const double> x, std::uint64_t number) {
                                  double phase = static_cast<double>(number);
                                  for (const double value : x) {
                                    phase += 1e6 * value;
                                  }
                                  return std::sin(phase * phase);
                                });
  const auto spread = [&](const char* handling) {
    MemoryEvaluator evaluator(problem, {.budget = 1000, .fresh = true});
    minimize_with("cmaes", evaluator, 1, {"sigma=0.001", handling, "restarts=none"});
    return calc_late_spread(evaluator);
  };
  EXPECT_LT(spread("uncertainty_handling=false"), 0.02);
  EXPECT_GT(spread("uncertainty_handling=true"), 0.05);
}

TEST(CmaEs, EveryGenerationIsDeclaredAndItsMeanRecommended) {
  const auto problem = make_analytic("sphere", 10);
  MemoryEvaluator evaluator(*problem, {.budget = 101});
  minimize_with("cmaes", evaluator, 1);
  EXPECT_THAT(std::span(evaluator.batch_sizes()).first(3), ElementsAre(1, 10, 10));
  EXPECT_EQ(evaluator.generations(), 10);
  EXPECT_EQ(evaluator.recommended().size(), 10u);
  EXPECT_EQ(evaluator.trace()[0].generation, 1);
  EXPECT_EQ(evaluator.trace()[10].generation, 1);  // the start shares the first one's cases
  EXPECT_EQ(evaluator.trace()[11].generation, 2);
}

// --- the row

TEST(CmaEs, TheSameSeedGivesTheSameTraceThroughRestartsAndNoise) {
  const auto problem = make_analytic("rastrigin", 3);
  const auto run = [&](std::uint64_t seed) {
    MemoryEvaluator evaluator(*problem, {.budget = 5000, .fresh = true});
    minimize_with("cmaes", evaluator, seed, {"uncertainty_handling=true"});
    return evaluator.trace();
  };
  EXPECT_EQ(run(7), run(7));
  EXPECT_NE(run(7), run(8));
}

TEST(CmaEs, BeginsAtTheStart) {
  const auto problem = make_analytic("sphere", 4);
  MemoryEvaluator evaluator(*problem, {.budget = 1});
  minimize_with("cmaes", evaluator, 1);
  EXPECT_THAT(evaluator.trace().front().asked, testing::Each(DoubleNear(-2.5, 1e-14)));
}

TEST(CmaEs, AZeroBudgetAsksForNothing) {
  const auto problem = make_analytic("sphere", 4);
  MemoryEvaluator evaluator(*problem, {.budget = 0});
  minimize_with("cmaes", evaluator, 1);
  EXPECT_TRUE(evaluator.trace().empty());
  EXPECT_TRUE(evaluator.recommended().empty());
}

TEST(CmaEs, PopulationsAreRoundedUpToTheBatchMultiple) {
  const auto problem = make_analytic("sphere", 10);
  MemoryEvaluator evaluator(*problem, {.budget = 100});
  minimize_with("cmaes", evaluator, 1, {"batch_multiple=16"});
  EXPECT_THAT(std::span(evaluator.batch_sizes()).first(2), ElementsAre(1, 16));
}

TEST(CmaEs, ImpossiblePopulationsAreRefused) {
  const auto problem = make_analytic("sphere", 4);
  MemoryEvaluator evaluator(*problem, {.budget = 100});
  const auto message = [&](const std::vector<std::string>& assignments) {
    return usage_error_of([&] { minimize_with("cmaes", evaluator, 1, assignments); });
  };
  EXPECT_THAT(message({"population=1"}), testing::HasSubstr("option 'population' is 1"));
  EXPECT_THAT(message({"mu=9"}), testing::HasSubstr("option 'mu' is 9"));
  EXPECT_TRUE(evaluator.trace().empty());
}

// The problem of Rosen and Suzuki: the optimum is -44, on two of its three constraints.
std::vector<double> find_feasible(const std::string& optimizer, std::int64_t budget,
                                  const std::vector<std::string>& assignments = {}) {
  const auto problem = make_analytic("constrained");
  const OptimizerRow& row = find_optimizer(optimizer);
  std::vector<double> best;
  for (std::uint64_t seed = 1; seed <= 9; ++seed) {
    MemoryEvaluator evaluator(*problem, {.budget = budget});
    row.make(Options::parse(row.name, row.options, assignments))->minimize(evaluator, seed);
    best.push_back(evaluator.best().value());
  }
  std::ranges::sort(best);
  return best;
}

TEST(CmaEs, WalksAlongConstraints) {
  const double random = find_feasible("random", 2000).front();
  for (const char* rule : {"feasibility_first=true", "feasibility_first=false"}) {
    const std::vector<double> best = find_feasible("cmaes", 2000, {rule});
    RecordProperty(rule, std::to_string(best[4]) + ", worst " + std::to_string(best.back()));
    EXPECT_LT(best.back(), -44 * 0.97) << rule;  // every seed within a few percent
    EXPECT_LT(best.back(), random) << rule;
  }
}

TEST(CmaEs, TheUnitOfTheObjectiveChangesNothing) {
  // In thousandths of the unit, and a violation worth as much less.
  class Thousandths : public Problem {
   public:
    Thousandths() : inner_(make_analytic("constrained")), description_(inner_->description()) {
      description_.violation_scale = 0x1p-10;
    }
    const ProblemDescription& description() const override { return description_; }
    std::vector<CaseOutcome> simulate(std::span<const CaseJob> jobs) const override {
      return inner_->simulate(jobs);
    }
    Evaluation aggregate(std::span<const double> x,
                         std::span<const CaseOutcome> outcomes) const override {
      Evaluation evaluation = inner_->aggregate(x, outcomes);
      evaluation.objectives[0] *= 0x1p-10;
      return evaluation;
    }
    std::vector<double> penalty_objectives() const override { return {1e12}; }

   private:
    std::unique_ptr<Problem> inner_;
    ProblemDescription description_;
  };
  const Thousandths other;
  const auto problem = make_analytic("constrained");
  for (const char* rule : {"feasibility_first=true", "feasibility_first=false"}) {
    MemoryEvaluator one(*problem, {.budget = 1000});
    MemoryEvaluator two(other, {.budget = 1000});
    minimize_with("cmaes", one, 1, {rule, "tol_fun=0"});
    minimize_with("cmaes", two, 1, {rule, "tol_fun=0"});
    ASSERT_EQ(one.trace().size(), two.trace().size());
    for (std::size_t i = 0; i < one.trace().size(); ++i) {
      ASSERT_EQ(one.trace()[i].asked, two.trace()[i].asked) << rule << ", evaluation " << i;
    }
  }
}

}  // namespace
}  // namespace armwright
