#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "base/expect_error.hpp"
#include "more_wild.hpp"
#include "optimizers/run_optimizer.hpp"
#include "optimizers/test_problems.hpp"
#include "problems/analytic/analytic.hpp"

namespace armwright {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::vector<DecisionVariable> make_box(std::size_t n, double lower, double upper, double start) {
  return std::vector<DecisionVariable>(n, {"x", "", lower, upper, start, Scale::linear});
}

// r = A (x - 0.3) of a fixed, well-conditioned A, with more residuals than variables.
std::vector<double> calc_linear_residuals(std::span<const double> x) {
  std::vector<double> residuals;
  for (std::size_t k = 0; k < x.size() + 3; ++k) {
    double sum = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      sum += std::cos(static_cast<double>((k + 1) * (i + 2))) * (x[i] - 0.3);
    }
    residuals.push_back(sum);
  }
  return residuals;
}

TEST(Dfls, SolvesLinearResidualsInTwoEvaluationsMoreThanVariables) {
  for (const std::size_t n : {1, 2, 7, 20}) {
    const ResidualProblem problem(make_box(n, -10, 10, 0), calc_linear_residuals);
    const auto budget = static_cast<std::int64_t>(n + 2);
    const MemoryEvaluator evaluator =
        run_optimizer("dfls", problem, {.budget = budget}, 1, {"radius=0.1"});
    EXPECT_LT(*evaluator.best(), 1e-20) << n;
  }
}

TEST(Dfls, StartsWithOneBatch) {
  const ResidualProblem problem(make_box(5, -10, 10, 0), calc_linear_residuals);
  const MemoryEvaluator evaluator =
      run_optimizer("dfls", problem, {.budget = 100}, 1, {"radius=0.05"});
  EXPECT_EQ(evaluator.batch_sizes().front(), 6U);
  EXPECT_EQ(evaluator.trace().front().asked, std::vector<double>(5, 0.0));
  EXPECT_EQ(evaluator.trace()[1].asked, (std::vector<double>{1, 0, 0, 0, 0}));
}

TEST(Dfls, FindsAnOptimumAtTheBounds) {
  // The minimum without bounds is 3 in every variable.
  const ResidualProblem problem(make_box(4, -1, 2, 0), [](std::span<const double> x) {
    std::vector<double> residuals;
    for (std::size_t i = 0; i < x.size(); ++i) {
      residuals.push_back((x[i] - 3) * (1 + 0.1 * x[(i + 1) % x.size()]));
    }
    return residuals;
  });
  const MemoryEvaluator evaluator = run_optimizer("dfls", problem, {.budget = 100});
  EXPECT_NEAR(*evaluator.best(), 4 * 1.44, 1e-9);
  EXPECT_LT(evaluator.trace().size(), 60U);
}

TEST(Dfls, MovesOnlyVariablesWithRoom) {
  std::vector<DecisionVariable> variables = make_box(3, -1, 1, 0);
  variables[1] = {"fixed", "", 0.5, 0.5, 0.5, Scale::linear};
  const ResidualProblem problem(variables, calc_linear_residuals);
  const MemoryEvaluator evaluator = run_optimizer("dfls", problem, {.budget = 100});
  EXPECT_TRUE(std::ranges::all_of(evaluator.trace(),
                                  [](const auto& entry) { return entry.asked[1] == 0.5; }));
  EXPECT_LT(*evaluator.best(), evaluator.trace().front().score.objectives[0]);
}

TEST(Dfls, SearchesLogarithmicVariablesByFactors) {
  const ResidualProblem problem(
      {{"p", "", 1, 10000, 100, Scale::logarithmic},
       {"n", "", -100, -0.1, -10, Scale::logarithmic}},
      [](std::span<const double> x) {
        return std::vector<double>{std::log(x[0] / 700), std::log(x[1] / -0.7)};
      });
  const MemoryEvaluator evaluator = run_optimizer("dfls", problem, {.budget = 12});
  EXPECT_LT(*evaluator.best(), 1e-15);
}

// Errors of controllers: a factor of a gain changes them by a factor.
TEST(Dfls, PowerLawsNeedFewerEvaluationsWhereFactorsMultiply) {
  const ResidualProblem problem(
      std::vector<DecisionVariable>(6, {"gain", "", 1, 10000, 100, Scale::logarithmic}),
      [](std::span<const double> x) {
        std::vector<double> residuals;
        for (std::size_t i = 0; i < x.size(); ++i) {
          const double next = x[(i + 1) % x.size()];
          residuals.push_back(3e3 / x[i] * std::pow(next / 100, 0.3));
          residuals.push_back(x[i] / 1e3);
        }
        return residuals;
      });
  const auto best = [&](std::int64_t budget, const char* option) {
    return *run_optimizer("dfls", problem, {.budget = budget}, 1, {option}).best();
  };
  const double limit = best(5000, "power_laws=false");
  EXPECT_LT(best(14, "power_laws=true"), 1.01 * limit);
  EXPECT_GT(best(14, "power_laws=false"), 1.1 * limit);
  EXPECT_LT(best(500, "power_laws=true"), (1 + 1e-9) * limit) << "the last descent refines";
}

// The steps of a model of atan are too long where it is flat, and end where evaluations fail.
TEST(Dfls, ShortensStepsThatFail) {
  const ResidualProblem problem(make_box(2, -2, 2, -1), [](std::span<const double> x) {
    return x[0] > 1.05 ? std::vector<double>{}
                       : std::vector<double>{std::atan(5 * (x[0] - 1)), x[1] - x[0] * x[0]};
  });
  const MemoryEvaluator evaluator =
      run_optimizer("dfls", problem, {.budget = 100}, 1, {"radius=0.4"});
  int failed = 0;
  double best = 1e9;
  for (const MemoryEvaluator::Entry& entry : evaluator.trace()) {
    EXPECT_TRUE(std::ranges::all_of(entry.asked, [](double x) { return std::isfinite(x); }));
    if (entry.score.residuals.empty()) {
      ++failed;
    } else {
      best = std::min(best, entry.score.objectives[0]);
    }
  }
  EXPECT_GT(failed, 0);
  EXPECT_LT(best, 1e-12);
}

TEST(Dfls, MakesUpForFailuresAmongTheFirstPoints) {
  const auto problem = make_analytic("rosenbrock", 10);
  const MemoryEvaluator evaluator =
      run_optimizer("dfls", *problem, {.budget = 2000, .fail_every = 7});
  EXPECT_LT(*evaluator.best(), 1e-8);
}

TEST(Dfls, UsesExactDerivatives) {
  const JacobianProblem problem(
      make_box(8, -3, 3, 2),
      [](std::span<const double> x) {
        std::vector<double> residuals;
        for (std::size_t i = 0; i < x.size(); ++i) {
          residuals.push_back(x[i] * x[i] * x[i] + x[(i + 1) % x.size()] - 0.5);
        }
        return residuals;
      },
      [](std::span<const double> x) {
        std::vector<double> jacobian(x.size() * x.size());
        for (std::size_t i = 0; i < x.size(); ++i) {
          jacobian[i * x.size() + i] = 3 * x[i] * x[i];
          jacobian[i * x.size() + (i + 1) % x.size()] += 1;
        }
        return jacobian;
      });
  const MemoryEvaluator exact =
      run_optimizer("dfls", problem, {.budget = 40}, 1, {"jacobian=true"});
  const MemoryEvaluator models = run_optimizer("dfls", problem, {.budget = 40});
  EXPECT_TRUE(exact.trace().front().with_jacobian);
  EXPECT_LT(*exact.best(), 1e-10);
  EXPECT_LT(*exact.best(), *models.best());
  EXPECT_LE(exact.charged(), 40);
}

TEST(Dfls, IsRefusedWithoutDerivativesOrResiduals) {
  const auto rosenbrock = make_analytic("rosenbrock", 10);
  const OptimizerRow& row = find_optimizer("dfls");
  const auto optimizer =
      row.make(Options::parse("dfls", row.options, std::vector<std::string>{"jacobian=true"}));
  EXPECT_THAT(usage_error_of([&] { optimizer->check_problem(rosenbrock->description()); }),
              AllOf(HasSubstr("optimizer 'dfls': option jacobian is true, but problem rosenbrock "
                              "offers no exact derivatives"),
                    HasSubstr("or use jacobian=false")));
  EXPECT_THAT(
      explain_unsuitable(row, make_log_bowl()->description()),
      AllOf(HasSubstr("it works on residuals"), HasSubstr("use one that needs none, as cmaes")));
}

TEST(Dfls, EndsWhenAnotherDescentGainsNothing) {
  const ResidualProblem problem(make_box(3, -10, 10, 0), [](std::span<const double> x) {
    return std::vector<double>{x[0] - 1, x[1] * x[0] - 2, x[2] + x[1], 0.5};
  });
  const auto count = [&](const std::vector<std::string>& options) {
    return run_optimizer("dfls", problem, {.budget = 5000}, 1, options).trace().size();
  };
  const std::size_t alone = count({"restarts=0"});
  EXPECT_LT(alone, 100U);
  EXPECT_GT(count({}), alone);
  EXPECT_LT(count({}), 400U);
  EXPECT_LT(count({"restarts=0", "smallest_radius=1e-3"}), alone);
}

// f_0 as the authors publish it, to six digits.
TEST(MoreWild, ProblemsHaveThePublishedValuesAtTheStart) {
  std::ifstream file(ARMWRIGHT_BENCHMARKS "/more_wild/best_known.csv");
  std::string line;
  std::getline(file, line);
  std::size_t number = 0;
  while (std::getline(file, line)) {
    const more_wild::Instance& instance = more_wild::kInstances.at(number++);
    std::istringstream cells(line.substr(line.find(',') + 1));
    double published = 0;
    cells >> published;
    const double f_0 = more_wild::calc_square_sum(
        more_wild::calc_residuals(instance, more_wild::make_start(instance)));
    EXPECT_NEAR(f_0, published, 1e-5 * published) << more_wild::get_name(instance) << ' ' << number;
  }
  EXPECT_EQ(number, more_wild::kInstances.size());
}

}  // namespace
}  // namespace armwright
