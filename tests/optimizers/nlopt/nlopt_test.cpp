#ifdef ARMWRIGHT_WITH_NLOPT

#include <gmock/gmock.h>
#include <nlopt.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <span>

#include "base/expect_error.hpp"
#include "optimizers/nlopt/nlopt_algorithms.hpp"
#include "optimizers/nlopt_points.hpp"
#include "optimizers/run_optimizer.hpp"
#include "optimizers/table/optimizer_table.hpp"
#include "optimizers/test_problems.hpp"
#include "problems/analytic/analytic.hpp"

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

// The first evaluation fails, whatever it is.
class FailingStart : public Evaluator {
 public:
  FailingStart(MemoryEvaluator& evaluator, double penalty)
      : evaluator_(evaluator), penalty_(penalty) {}

  const ProblemDescription& problem() const override { return evaluator_.problem(); }
  std::vector<Score> evaluate(std::span<const std::vector<double>> points) override {
    const bool is_start = evaluator_.trace().empty();
    std::vector<Score> scores = evaluator_.evaluate(points);
    if (is_start && !scores.empty()) {
      scores[0] = Score{};
      scores[0].objectives = {penalty_};
      scores[0].status = EvaluationStatus::diverged;
    }
    return scores;
  }
  bool stopped() const override { return evaluator_.stopped(); }
  std::int64_t remaining() const override { return evaluator_.remaining(); }
  void begin_generation() override { evaluator_.begin_generation(); }
  void recommend(std::span<const double> x) override { evaluator_.recommend(x); }

 private:
  MemoryEvaluator& evaluator_;
  double penalty_;
};

// NLopt gives up, or never returns, where the start is NaN; it is told the penalty.
TEST_P(NloptRow, AFailedStartIsSurvived) {
  for (const char* name : {"sphere", "constrained"}) {
    const auto problem = make_analytic(name, 4);
    MemoryEvaluator evaluator(*problem, {.budget = 500});
    FailingStart failing(evaluator, problem->penalty_objectives().front());
    row().make(Options::parse(row().name, row().options, {}))->minimize(failing, 1);
    double best = INFINITY;
    for (const MemoryEvaluator::Entry& entry : std::span(evaluator.trace()).subspan(1)) {
      best = std::min(best, entry.score.objectives[0]);
    }
    EXPECT_LT(best, 0.5 * calc_start_value(*problem)) << name;
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
  EXPECT_EQ(make_nlopt_rows().size(), count + 1);  // slsqp gets its gradients by differences
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
                         testing::Values("nlopt:cobyla", "nlopt:slsqp", "nlopt:isres", "nlopt:ags",
                                         "nlopt:auglag", "nlopt:auglag_eq", "nlopt:orig_direct"),
                         [](const auto& parameters) { return parameters.param.substr(6); });

// Every point of a difference is an evaluation: 4 variables take 4 or 8 points at a place.
TEST(Nlopt, SlsqpCountsItsDifferencesAndIsExactOnAQuadraticFunction) {
  const auto problem = make_analytic("constrained");
  const MemoryEvaluator central = run_optimizer("nlopt:slsqp", *problem, {.budget = 1000});
  // A point on the limit counts only if rounding puts it inside.
  EXPECT_NEAR(*central.best(), -44, 1e-4);
  EXPECT_LT(central.trace().size(), 500u);
  const MemoryEvaluator forward =
      run_optimizer("nlopt:slsqp", *problem, {.budget = 1000}, 1, {"differences=forward"});
  EXPECT_NEAR(*forward.best(), -44, 1e-3);
  const auto count_first_place = [&](const MemoryEvaluator& evaluator) {
    // The start, then the points that differ from it in one coordinate.
    const Points points = asked_points(evaluator);
    std::size_t count = 1;
    while (count < points.size()) {
      std::size_t changed = 0;
      for (std::size_t i = 0; i < points[0].size(); ++i) {
        changed += points[count][i] != points[0][i] ? 1 : 0;
      }
      if (changed != 1) {
        break;
      }
      ++count;
    }
    return count;
  };
  EXPECT_EQ(count_first_place(central), 9u);
  EXPECT_EQ(count_first_place(forward), 5u);
}

// They are told beforehand how many evaluations there will be, for their storage, and must not plan
// by it.
TEST(Nlopt, OrigDirectBeginsTheSameWhateverTheBudget) {
  for (const char* name : {"nlopt:orig_direct", "nlopt:orig_direct_l"}) {
    for (const char* function : {"rosenbrock", "constrained"}) {
      const auto problem = make_analytic(function, 4);
      const Points all = asked_points(run_optimizer(name, *problem, {.budget = 5000}));
      ASSERT_EQ(all.size(), 5000u);
      for (const std::int64_t budget : {1, 2, 10, 200, 2000}) {
        const Points some = asked_points(run_optimizer(name, *problem, {.budget = budget}));
        EXPECT_EQ(std::ssize(some), budget);
        EXPECT_TRUE(std::ranges::equal(some, std::span(all).first(some.size())))
            << name << " on " << function << " with " << budget;
      }
    }
  }
}

TEST(Nlopt, CobylaFindsTheConstrainedMinimum) {
  const auto problem = make_analytic("constrained");
  EXPECT_NEAR(run_optimizer("nlopt:cobyla", *problem, {.budget = 3000}).best().value(), -44, 1e-4);
}

TEST(Nlopt, EveryLocalOptimizerFitsEveryRowThatHasOne) {
  const auto problem = make_analytic("sphere", 3);
  for (const OptimizerRow& row : make_nlopt_rows()) {
    for (const OptionSpec& option : row.options) {
      if (option.name != "local") {
        continue;
      }
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
