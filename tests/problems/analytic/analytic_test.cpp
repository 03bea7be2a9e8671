#include "problems/analytic/analytic.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "base/expect_error.hpp"
#include "base/random.hpp"
#include "base/text.hpp"

namespace armwright {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

const CaseBlock kOneCase{CaseRole::training, "train/1", {0}};

double calc_value(const Problem& problem, const std::vector<double>& x) {
  return problem.evaluate(x, kOneCase).objectives.at(0);
}

std::vector<double> shifted(const Problem& problem, double by) {
  std::vector<double> x = problem.description().known_optimum;
  for (double& xi : x) {
    xi += by;
  }
  return x;
}

TEST(Analytic, NamesAndDimensionsAreChecked) {
  EXPECT_THAT(
      analytic_names(),
      ElementsAre("sphere", "ellipsoid", "rosenbrock", "rastrigin", "ackley", "branin", "hartmann6",
                  "constrained", "sphere-int", "ellipsoid-int", "zdt1", "dtlz2", "bbob-f1",
                  "bbob-f2", "bbob-f3", "bbob-f8", "bbob-f10", "bbob-f15"));
  EXPECT_EQ(usage_error_of([] { make_analytic("spere", 3); }),
            "unknown analytic function 'spere'; did you mean 'sphere'? Valid: " +
                list_valid("spere", analytic_names(), "armwright list settings function.name"));
  EXPECT_EQ(usage_error_of([] { make_analytic("sphere", 0); }),
            "analytic function 'sphere': dimension is 0; it must be between 1 and 1000");
  EXPECT_EQ(usage_error_of([] { make_analytic("rosenbrock", 1); }),
            "analytic function 'rosenbrock': dimension is 1; it must be between 2 and 1000");
  EXPECT_EQ(usage_error_of([] { make_analytic("rastrigin", 1001); }),
            "analytic function 'rastrigin': dimension is 1001; it must be between 1 and 1000");
  EXPECT_EQ(usage_error_of([] { make_analytic("constrained", 10); }),
            "analytic function 'constrained': dimension is 10; it must be 4");
}

TEST(Analytic, HandComputedValues) {
  // At z = (1, 1, 1) = x - minimiser, up to the rounding of x: a few ulps of 1 times the largest
  // derivative, 8e5 and 2e6.
  EXPECT_NEAR(calc_value(*make_analytic("sphere", 3), shifted(*make_analytic("sphere", 3), 1)), 3,
              1e-14);
  EXPECT_NEAR(
      calc_value(*make_analytic("ellipsoid", 3), shifted(*make_analytic("ellipsoid", 3), 1)),
      1 + 1e3 + 1e6, 1e-8);
  // y = (2, 2, 2): twice 100 (2 - 4)^2 + (1 - 2)^2
  EXPECT_NEAR(
      calc_value(*make_analytic("rosenbrock", 3), shifted(*make_analytic("rosenbrock", 3), 1)), 802,
      1e-11);
  // z = 1/2: three times 1/4 + 20
  EXPECT_NEAR(
      calc_value(*make_analytic("rastrigin", 3), shifted(*make_analytic("rastrigin", 3), 0.5)),
      60.75, 1e-12);
  // z = 1, all cosines are 1: 20 (1 - exp(-0.2)), up to the rounding of x times the slope, below 5.
  EXPECT_NEAR(calc_value(*make_analytic("ackley", 3), shifted(*make_analytic("ackley", 3), 1)),
              20 * (1 - std::exp(-0.2)), 1e-13);
  // The square is 2 + 5 - 6 = 1, and the cosine is 1: 1 + 20 - 10 / (8 pi)
  EXPECT_NEAR(calc_value(*make_analytic("branin"), {0, 2}), 21 - 10 / (8 * std::acos(-1.0)), 1e-13);
  // Its two other minima, in the coordinates with x_2 smaller by 5: b = 5.1 x^2 / (4 pi^2) - 5 x /
  // pi + 6 at -pi and 3 pi, where the cosine is -1 too.
  const double pi = std::acos(-1.0);
  EXPECT_NEAR(calc_value(*make_analytic("branin"), {-pi, 1.275 + 5 + 6 - 5}), 10 / (8 * pi), 1e-13);
  EXPECT_NEAR(calc_value(*make_analytic("branin"), {3 * pi, 11.475 - 15 + 6 - 5}), 10 / (8 * pi),
              1e-13);
  // The minimum that Dixon and Szego 1978 publish, with six digits.
  EXPECT_NEAR(calc_value(*make_analytic("hartmann6"),
                         {0.20169, 0.150011, 0.476874, 0.275332, 0.311652, 0.6573}),
              -3.32237, 1e-5);
  // x = (1, 1, 1, 1): 1 + 1 + 2 + 1 - 5 - 5 - 21 + 7; the third constraint 2 + 1 + 1 + 2 - 1 - 1 -
  // 5; all numbers exact
  const Evaluation constrained =
      make_analytic("constrained")->evaluate(std::vector<double>{1, 1, 1, 1}, kOneCase);
  EXPECT_THAT(constrained.objectives, ElementsAre(-19));
  EXPECT_THAT(constrained.constraint_values, ElementsAre(-4, -6, -1));
}

TEST(Analytic, OneDimensionIsEnough) {
  EXPECT_NEAR(
      calc_value(*make_analytic("ellipsoid", 1), shifted(*make_analytic("ellipsoid", 1), 2)), 4,
      1e-14);
}

// The formulas of the paper over z = x - minimiser, in five variables: three real, two integers.
TEST(Analytic, FunctionsWithIntegersAreThoseOfThePaper) {
  const std::vector<double> z = {0.5, -1, 0.25, 2, -1};
  for (const std::string name : {"sphere-int", "ellipsoid-int"}) {
    const auto problem = make_analytic(name, 5);
    std::vector<double> x = problem->description().known_optimum;
    double expected = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      x[i] += z[i];
      const double factor = std::pow(1000, static_cast<double>(i) / 4);
      expected += std::pow(name == "sphere-int" ? z[i] : factor * z[i], 2);
    }
    // A few roundings of x, at most 1e-15 each, times the slope, and of the sum.
    EXPECT_NEAR(calc_value(*problem, x), expected, 1e-13 * expected) << name;
  }
}

TEST(Analytic, TheSecondHalfOfTheVariablesAreIntegersWithAWholeMinimiser) {
  for (const std::string name : {"sphere-int", "ellipsoid-int"}) {
    for (const int dimension : {2, 3, 40, 41}) {
      for (int instance = 0; instance <= 20; ++instance) {
        const auto problem =
            make_analytic({.name = name, .dimension = dimension, .instance = instance});
        const ProblemDescription& description = problem->description();
        for (int i = 0; i < dimension; ++i) {
          const DecisionVariable& variable = description.variables[i];
          const double optimum = description.known_optimum[i];
          const bool is_integer = i >= (dimension + 1) / 2;
          EXPECT_EQ(variable.type, is_integer ? VariableType::integer : VariableType::real);
          EXPECT_EQ(variable.lower, -10);
          EXPECT_EQ(variable.upper, 10);
          EXPECT_EQ(optimum == std::round(optimum), is_integer) << variable.name;
          EXPECT_TRUE(instance > 0 || optimum != 0) << "the plain form is off the center";
        }
        EXPECT_EQ(calc_value(*problem, description.known_optimum), 0);
      }
    }
  }
}

class AnalyticTable : public testing::TestWithParam<std::string> {};

TEST_P(AnalyticTable, DescribesItselfConsistently) {
  const AnalyticFunction& row = find_analytic(GetParam());
  EXPECT_FALSE(row.summary.empty());
  EXPECT_FALSE(row.source.empty());
  for (const int dimension :
       {row.smallest_dimension, row.default_dimension, row.largest_dimension}) {
    const auto problem = make_analytic(GetParam(), dimension);
    const ProblemDescription& description = problem->description();
    EXPECT_EQ(description.name, GetParam());
    EXPECT_EQ(description.cost_unit, "function evaluation");
    EXPECT_THAT(description.objectives, SizeIs(1));
    ASSERT_THAT(description.variables, SizeIs(dimension));
    ASSERT_THAT(description.known_optimum, SizeIs(dimension));
    std::vector<double> start;
    for (int i = 0; i < dimension; ++i) {
      const DecisionVariable& variable = description.variables[i];
      const double optimum = description.known_optimum[i];
      start.push_back(variable.start);
      EXPECT_EQ(variable.name, "x_" + std::to_string(i + 1));
      EXPECT_LT(variable.lower, optimum);
      EXPECT_GT(variable.upper, optimum);
      EXPECT_LE(variable.lower, variable.start);
      EXPECT_GE(variable.upper, variable.start);
      EXPECT_NE(optimum, (variable.lower + variable.upper) / 2);
      EXPECT_NE(optimum, variable.start);
    }
    const Evaluation at_start = problem->evaluate(start, kOneCase);
    EXPECT_THAT(at_start.constraint_values, SizeIs(description.constraints.size()));
    EXPECT_THAT(at_start.constraint_values, testing::Each(testing::Le(0)));
    EXPECT_GT(at_start.objectives.at(0), calc_value(*problem, description.known_optimum));
    EXPECT_EQ(description.optimum, calc_value(*problem, description.known_optimum));
    EXPECT_EQ(description.resolution, 1e-8);
  }
}

TEST_P(AnalyticTable, NothingFeasibleBeatsTheKnownOptimum) {
  const auto problem = make_analytic(GetParam());
  const ProblemDescription& description = problem->description();
  const Evaluation optimum = problem->evaluate(description.known_optimum, kOneCase);
  EXPECT_EQ(optimum.objectives.at(0), description.optimum);  // exact in doubles
  EXPECT_THAT(optimum.constraint_values, testing::Each(testing::Le(0)));
  RandomStream random("test/analytic/" + GetParam());
  int feasible = 0;
  for (int sample = 0; sample < 20000; ++sample) {
    // Half of the points lie anywhere in the box. The others lie near the optimum, at distances
    // from the size of the box down to 1e-6 of it.
    const double radius = sample % 2 == 0 ? 1 : std::pow(10, random.uniform(-6, 0));
    std::vector<double> x;
    for (std::size_t i = 0; i < description.variables.size(); ++i) {
      const DecisionVariable& variable = description.variables[i];
      const double anywhere = random.uniform(variable.lower, variable.upper);
      x.push_back(sample % 2 == 0 ? anywhere
                                  : description.known_optimum[i] +
                                        radius * (anywhere - description.known_optimum[i]));
    }
    const Evaluation evaluation = problem->evaluate(x, kOneCase);
    bool is_feasible = true;
    for (const double g : evaluation.constraint_values) {
      is_feasible = is_feasible && g <= 0;
    }
    if (is_feasible) {
      ++feasible;
      EXPECT_GT(evaluation.objectives.at(0), optimum.objectives.at(0));
    }
    EXPECT_LT(evaluation.objectives.at(0), problem->penalty_objectives().at(0));
  }
  EXPECT_GT(feasible, 1000);
}

TEST_P(AnalyticTable, EveryCaseGivesTheSameAndTheMeanIsTaken) {
  const auto problem = make_analytic(GetParam());
  std::vector<double> x = problem->description().known_optimum;
  x[0] += 0.125;
  const Evaluation one = problem->evaluate(x, kOneCase);
  const Evaluation four = problem->evaluate(x, {CaseRole::test, "test/1", {3, 1, 4, 1}});
  EXPECT_EQ(four.objectives, one.objectives);  // the sum of four equal numbers over 4 is exact
  EXPECT_EQ(four.constraint_values, one.constraint_values);
  EXPECT_EQ(four.case_errors, std::vector<double>(4, one.objectives.at(0)));
  EXPECT_EQ(four.failed_cases, 0);
  EXPECT_EQ(four.status, EvaluationStatus::ok);
}

TEST_P(AnalyticTable, TheObjectiveIsTheSumOfTheSquaredResiduals) {
  const auto problem = make_analytic(GetParam());
  const ProblemDescription& description = problem->description();
  const bool has_f_opt = GetParam().starts_with("bbob");
  const std::vector<std::string> no_sums = {"ackley", "branin", "hartmann6", "constrained"};
  EXPECT_EQ(description.has_residuals, std::ranges::count(no_sums, GetParam()) == 0 && !has_f_opt);
  RandomStream random("test/analytic/residuals/" + GetParam());
  for (int sample = 0; sample < 100; ++sample) {
    std::vector<double> x;
    for (const DecisionVariable& variable : description.variables) {
      x.push_back(random.uniform(variable.lower, variable.upper));
    }
    // Three cases, so that the mean is tested too.
    for (const CaseBlock& block : {kOneCase, CaseBlock{CaseRole::test, "test/1", {3, 1, 4}}}) {
      const Evaluation evaluation = problem->evaluate(x, block);
      if (!description.has_residuals) {
        EXPECT_THAT(evaluation.residuals, IsEmpty());
        continue;
      }
      double sum = 0;
      for (const double residual : evaluation.residuals) {
        sum += residual * residual;
      }
      // The value has a few tens of positive terms with a few rounding errors each. Rastrigin's
      // cosine cancels against 1, with an error of at most one rounding of 10 per term.
      const double objective = evaluation.objectives.at(0);
      EXPECT_NEAR(sum, objective, 1e-14 * objective + 1e-13);
    }
  }
}

// zdt1 and dtlz2 have several objectives and no single optimum; tests/optimizers/fronts holds theirs.
std::vector<std::string> list_functions_of_one_objective() {
  std::vector<std::string> names = analytic_names();
  std::erase_if(names, [](const std::string& name) { return name == "zdt1" || name == "dtlz2"; });
  return names;
}

INSTANTIATE_TEST_SUITE_P(All, AnalyticTable, testing::ValuesIn(list_functions_of_one_objective()),
                         [](const auto& parameters) {
                           std::string name = parameters.param;
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

TEST(Analytic, ConstrainedOptimumMeetsKarushKuhnTucker) {
  // Objective and constraints are convex quadratics, so a stationary Lagrangian with multipliers
  // >= 0 proves the global minimum. Multipliers (1, 0, 2): Hock and Schittkowski 1981. For
  // quadratics, central differences have rounding errors only: eps |f| / step = 2e-16 * 44 / 1e-3
  // < 1e-11.
  const auto problem = make_analytic("constrained");
  const std::vector<double> optimum = problem->description().known_optimum;
  const std::vector<double> multipliers = {1, 0, 2};
  constexpr double kStep = 1e-3;
  for (std::size_t i = 0; i < optimum.size(); ++i) {
    std::vector<double> below = optimum;
    std::vector<double> above = optimum;
    below[i] -= kStep;
    above[i] += kStep;
    const Evaluation low = problem->evaluate(below, kOneCase);
    const Evaluation high = problem->evaluate(above, kOneCase);
    double gradient = high.objectives[0] - low.objectives[0];
    for (std::size_t j = 0; j < multipliers.size(); ++j) {
      gradient += multipliers[j] * (high.constraint_values[j] - low.constraint_values[j]);
    }
    EXPECT_NEAR(gradient / (2 * kStep), 0, 1e-10);
  }
  EXPECT_THAT(problem->evaluate(optimum, kOneCase).constraint_values, ElementsAre(0, -1, 0));
}

TEST(Analytic, EllipsoidHasItsConditionNumber) {
  const auto problem = make_analytic("ellipsoid", 10);
  const auto calc_along = [&](std::size_t axis) {
    std::vector<double> x = problem->description().known_optimum;
    x[axis] += 1;
    return calc_value(*problem, x);
  };
  EXPECT_NEAR(calc_along(9) / calc_along(0), 1e6, 1e6 * 1e-14);
  EXPECT_NEAR(calc_along(3) / calc_along(0), 100, 100 * 1e-14);
}

TEST(Analytic, AggregateLeavesOutCasesWithoutANumber) {
  const auto problem = make_analytic("sphere", 2);
  const std::vector<double> x = {0, 0};
  std::vector<CaseOutcome> outcomes(3);
  outcomes[0].error = 2;
  outcomes[1] = {.status = EvaluationStatus::timed_out,
                 .reason = "took too long",
                 .has_error = false,
                 .metrics = {},
                 .residuals = {},
                 .jacobian = {}};
  outcomes[2].error = 4;
  const Evaluation some = problem->aggregate(x, outcomes);
  EXPECT_THAT(some.objectives, ElementsAre(3));
  EXPECT_EQ(some.status, EvaluationStatus::timed_out);
  EXPECT_EQ(some.reason, "took too long");
  EXPECT_EQ(some.failed_cases, 1);
  ASSERT_THAT(some.case_errors, SizeIs(3));
  EXPECT_TRUE(std::isnan(some.case_errors[1]));
  const Evaluation none = problem->aggregate(x, std::span(outcomes).subspan(1, 1));
  EXPECT_THAT(none.objectives, IsEmpty());
}

TEST(Analytic, ResidualsAreHandComputed) {
  // z = (1, 2): y = (2, 3), 10 (3 - 4) and 1 - 2; the roundings of x are multiplied by at most 40.
  const auto rosenbrock = make_analytic("rosenbrock", 2);
  std::vector<double> x = rosenbrock->description().known_optimum;
  x[0] += 1;
  x[1] += 2;
  const Evaluation bent = rosenbrock->evaluate(x, kOneCase);
  ASSERT_THAT(bent.residuals, SizeIs(2));
  EXPECT_NEAR(bent.residuals[0], -10, 1e-13);
  EXPECT_NEAR(bent.residuals[1], -1, 1e-14);
  const auto rastrigin = make_analytic("rastrigin", 1);
  const Evaluation wave = rastrigin->evaluate(shifted(*rastrigin, -0.5), kOneCase);
  ASSERT_THAT(wave.residuals, SizeIs(2));
  EXPECT_NEAR(wave.residuals[0], -0.5, 1e-14);
  EXPECT_NEAR(wave.residuals[1], -std::sqrt(20.0), 1e-13);
}

TEST(Analytic, WithoutANumberThereAreNoResiduals) {
  const auto problem = make_analytic("sphere", 2);
  std::vector<CaseOutcome> outcomes(1);
  outcomes[0].has_error = false;
  outcomes[0].status = EvaluationStatus::failed;
  EXPECT_THAT(problem->aggregate(std::vector<double>{0, 0}, outcomes).residuals, IsEmpty());
}

TEST(EvaluationStatusText, EveryStatusHasItsName) {
  EXPECT_STREQ(to_string(EvaluationStatus::ok), "ok");
  EXPECT_STREQ(to_string(EvaluationStatus::diverged), "diverged");
  EXPECT_STREQ(to_string(EvaluationStatus::unreachable), "unreachable");
  EXPECT_STREQ(to_string(EvaluationStatus::timed_out), "timed out");
  EXPECT_STREQ(to_string(EvaluationStatus::failed), "failed");
  EXPECT_STREQ(to_string(EvaluationStatus::abandoned), "abandoned");
}

}  // namespace
}  // namespace armwright
