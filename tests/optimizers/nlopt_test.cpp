#ifdef ARMWRIGHT_WITH_NLOPT

#include "optimizers/nlopt.hpp"

#include <gmock/gmock.h>
#include <nlopt.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <span>

#include "base/expect_error.hpp"
#include "optimizers/nlopt_points.hpp"
#include "optimizers/run_optimizer.hpp"
#include "optimizers/test_problems.hpp"
#include "problems/analytic.hpp"

namespace armwright {
namespace {

using testing::AllOf;
using testing::HasSubstr;

double calc_start_value(const Problem& problem) {
  std::vector<double> start;
  for (const DecisionVariable& variable : problem.description().variables) {
    start.push_back(variable.start);
  }
  return calc_value(problem, start);
}

class NloptRow : public testing::TestWithParam<std::string> {
 protected:
  const OptimizerRow& row() const { return find_optimizer(GetParam()); }
};

TEST_P(NloptRow, BeatsTheStartOnASphere) {
  const auto problem = make_analytic("sphere", 4);
  const MemoryEvaluator evaluator = run_optimizer(GetParam(), *problem, {.budget = 500});
  EXPECT_LT(evaluator.best().value(), 0.5 * calc_start_value(*problem));
}

TEST_P(NloptRow, BeatsTheStartOnLogarithmicVariables) {
  const auto problem = make_log_bowl();
  const MemoryEvaluator evaluator = run_optimizer(GetParam(), *problem, {.budget = 500});
  EXPECT_LT(evaluator.best().value(), 0.2 * calc_start_value(*problem));
}

TEST_P(NloptRow, TheSeedMattersIfAndOnlyIfItSaysSo) {
  const auto problem = make_log_bowl();
  const Points one = asked_points(run_optimizer(GetParam(), *problem, {.budget = 400}, 1));
  EXPECT_EQ(one, asked_points(run_optimizer(GetParam(), *problem, {.budget = 400}, 1)));
  const Points other = asked_points(run_optimizer(GetParam(), *problem, {.budget = 400}, 2));
  EXPECT_EQ(one != other, row().capabilities.stochastic);
  // Also where the seeds differ in their upper half only.
  const Points far =
      asked_points(run_optimizer(GetParam(), *problem, {.budget = 400}, 1 + (2ULL << 32)));
  EXPECT_EQ(one != far, row().capabilities.stochastic);
}

TEST_P(NloptRow, AnExceptionOfTheEvaluatorComesThroughUnchanged) {
  const auto problem = make_analytic("constrained");
  for (const std::int64_t number : {1, 2, 30}) {
    try {
      run_optimizer(GetParam(), *problem, {.budget = 100, .throw_at = number});
      ADD_FAILURE() << "swallowed at evaluation " << number;
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "the evaluator is broken");
    }
  }
}

TEST_P(NloptRow, AStopEndsIt) {
  const auto problem = make_analytic("constrained");
  for (const std::int64_t count : {1, 2, 30, 77}) {
    const MemoryEvaluator evaluator =
        run_optimizer(GetParam(), *problem, {.budget = INT64_MAX, .stop_after = count});
    EXPECT_LE(evaluator.trace().size(), static_cast<std::size_t>(count));
    EXPECT_GE(evaluator.trace().size(), std::min<std::size_t>(count, 30));
    EXPECT_LE(evaluator.calls_after_stop(), 1);
  }
}

TEST_P(NloptRow, WithoutPopulationOrStepTheLibraryChooses) {
  const auto problem = make_analytic("sphere", 4);
  for (const OptionSpec& option : row().options) {
    if (option.name == "initial_step") {
      EXPECT_LT(run_optimizer(GetParam(), *problem, {.budget = 500}, 1, {"initial_step=0"})
                    .best()
                    .value(),
                0.5 * calc_start_value(*problem));
    }
    if (option.name == "population") {
      EXPECT_NE(
          asked_points(run_optimizer(GetParam(), *problem, {.budget = 500}, 1, {"population=17"})),
          asked_points(run_optimizer(GetParam(), *problem, {.budget = 500}, 1)));
    }
  }
}

std::vector<std::string> nlopt_names() {
  std::vector<std::string> names;
  for (const OptimizerRow& row : make_nlopt_rows()) {
    names.push_back(row.name);
  }
  return names;
}

INSTANTIATE_TEST_SUITE_P(Rows, NloptRow, testing::ValuesIn(nlopt_names()),
                         [](const auto& parameters) { return parameters.param.substr(6); });

TEST(Nlopt, EveryGradientFreeAlgorithmOfTheLibraryHasARow) {
  std::size_t count = 0;
  for (int i = 0; i < NLOPT_NUM_ALGORITHMS; ++i) {
    const std::string name = nlopt_algorithm_to_string(static_cast<nlopt_algorithm>(i));
    // LN_AUGLAG, LN_AUGLAG_EQ, GN_MLSL, GN_MLSL_LDS: older names of AUGLAG and so on.
    count += name.starts_with("GN_") || name.starts_with("LN_") ? 1 : 0;
  }
  EXPECT_EQ(make_nlopt_rows().size(), count);
}

// One evaluation serves objective and constraints.
class NloptConstraints : public testing::TestWithParam<std::string> {};

TEST_P(NloptConstraints, AreRespectedAndCostNoEvaluations) {
  const auto problem = make_analytic("constrained");
  const MemoryEvaluator evaluator = run_optimizer(GetParam(), *problem, {.budget = 3000});
  ASSERT_TRUE(evaluator.best().has_value());
  // The minimum is -44 and the start's value is 8 or so: within a quarter of the way.
  EXPECT_LT(*evaluator.best(), -30);
  EXPECT_GE(*evaluator.best(), -44.0 - 1e-9);
  const Points points = asked_points(evaluator);
  const std::set<std::vector<double>> different(points.begin(), points.end());
  EXPECT_GT(static_cast<double>(different.size()), 0.8 * static_cast<double>(points.size()));
}

INSTANTIATE_TEST_SUITE_P(Rows, NloptConstraints,
                         testing::Values("nlopt:cobyla", "nlopt:isres", "nlopt:ags", "nlopt:auglag",
                                         "nlopt:auglag_eq", "nlopt:orig_direct"),
                         [](const auto& parameters) { return parameters.param.substr(6); });

TEST(Nlopt, CobylaFindsTheConstrainedMinimum) {
  const auto problem = make_analytic("constrained");
  EXPECT_NEAR(run_optimizer("nlopt:cobyla", *problem, {.budget = 3000}).best().value(), -44, 1e-4);
}

TEST(Nlopt, EveryLocalOptimizerFitsEveryRowThatHasOne) {
  const auto problem = make_analytic("sphere", 3);
  for (const OptimizerRow& row : make_nlopt_rows()) {
    for (const OptionSpec& option : row.options) {
      for (const std::string& choice : option.choices) {
        const MemoryEvaluator evaluator =
            run_optimizer(row.name, *problem, {.budget = 300}, 1, {"local=" + choice});
        EXPECT_LT(evaluator.best().value(), 0.1 * calc_start_value(*problem))
            << row.name << " with " << choice;
      }
    }
  }
}

TEST(Nlopt, RestartsGoOnWhereTheFirstSearchEndsTooEarly) {
  const auto problem = make_analytic("rosenbrock", 5);
  const std::vector<std::string> loose = {"xtol_rel=0.1", "restarts=0"};
  const MemoryEvaluator once = run_optimizer("nlopt:bobyqa", *problem, {.budget = 2000}, 1, loose);
  const MemoryEvaluator again =
      run_optimizer("nlopt:bobyqa", *problem, {.budget = 2000}, 1, {"xtol_rel=0.1"});
  ASSERT_LT(once.trace().size(), 2000u);
  EXPECT_GT(again.trace().size(), once.trace().size());
  EXPECT_LT(again.best().value(), once.best().value());
  EXPECT_TRUE(std::equal(once.trace().begin(), once.trace().end(), again.trace().begin()));
}

TEST(Nlopt, ASimplexThatCollapsesInACornerIsSetUpAgain) {
  // The slope leads from the start into a corner and past it the way goes along a face.
  const FunctionProblem problem({{"a", "", 0, 1, 0.02}, {"b", "", 0, 1, 0.02}},
                                [](std::span<const double> x, std::uint64_t) {
                                  return std::pow(x[0] - 0.5, 2) + std::pow(x[1] - 0.5, 2);
                                });
  const MemoryEvaluator evaluator = run_optimizer("nlopt:neldermead", problem, {.budget = 1000});
  EXPECT_LT(evaluator.best().value(), 1e-6);
}

TEST(Nlopt, DimensionsThatAnAlgorithmDoesNotHaveAreRefused) {
  const auto large = make_analytic("sphere", 11);
  EXPECT_THAT(usage_error_of([&] { run_optimizer("nlopt:ags", *large, {.budget = 10}); }),
              AllOf(HasSubstr("optimizer 'nlopt:ags': the problem has 11 decision"),
                    HasSubstr("10 at most")));
  const auto line = make_analytic("sphere", 1);
  EXPECT_THAT(usage_error_of([&] { run_optimizer("nlopt:mlsl", *line, {.budget = 10}); }),
              HasSubstr("at least 2"));
  EXPECT_LT(run_optimizer("nlopt:mlsl", *line, {.budget = 100}, 1, {"local=sbplx"}).best().value(),
            1e-3);
}

TEST(Nlopt, OneVariableIsEnoughWhereTheRowSaysSo) {
  const auto line = make_analytic("sphere", 1);
  for (const OptimizerRow& row : make_nlopt_rows()) {
    if (!explain_unsuitable(row, line->description()).empty()) {
      continue;
    }
    std::vector<std::string> options;
    if (row.name.starts_with("nlopt:mlsl") || row.name == "nlopt:auglag") {
      options = {"local=sbplx"};  // BOBYQA needs two
    }
    EXPECT_LT(run_optimizer(row.name, *line, {.budget = 100}, 1, options).best().value(), 0.1)
        << row.name;
  }
}

}  // namespace
}  // namespace armwright

#endif
