#include "optimizers/interface/treated_problem.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <map>
#include <utility>

namespace armwright {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

ProblemDescription make_mixed() {
  ProblemDescription problem;
  problem.variables = {
      {"gain", "", 0.3, 7, 1, Scale::linear},
      {"teeth", "", -2, 9, 3, Scale::linear, VariableType::integer},
      {"turns", "", 1, 1000, 10, Scale::logarithmic, VariableType::integer},
      {"offset", "", -50, -1, -4, Scale::logarithmic, VariableType::integer},
      {"oil", "", 0, 2, 1, Scale::linear, VariableType::category, {"thin", "medium", "thick"}},
  };
  return problem;
}

TEST(TreatedProblem, AnOptimizerWithBothCapabilitiesGetsTheDescriptionItself) {
  const ProblemDescription problem = make_mixed();
  const TreatedProblem treated(problem, {.integer = true, .categorical = true});
  EXPECT_EQ(&treated.description(), &problem);
}

TEST(TreatedProblem, AProblemWithRealVariablesIsNeverCopied) {
  ProblemDescription problem = make_mixed();
  problem.variables.resize(1);
  EXPECT_EQ(&TreatedProblem(problem, {}).description(), &problem);
}

TEST(TreatedProblem, WithoutCategoricalACategoryIsAnInteger) {
  const ProblemDescription problem = make_mixed();
  const TreatedProblem treated(problem, {.integer = true});
  const DecisionVariable& oil = treated.description().variables[4];
  EXPECT_EQ(oil.type, VariableType::integer);
  EXPECT_THAT(oil.choices, IsEmpty());
  EXPECT_THAT((std::vector{oil.lower, oil.upper, oil.start}), ElementsAre(0, 2, 1));
  EXPECT_EQ(treated.description().variables[1].lower, -2);
}

TEST(TreatedProblem, WithoutIntegerWholeNumbersGetHalfAStepMoreRoomOnBothSides) {
  const ProblemDescription problem = make_mixed();
  const TreatedProblem treated(problem, {});
  const auto& variables = treated.description().variables;
  const std::vector<std::pair<double, double>> bounds = {
      {0.3, 7}, {-2.5, 9.5}, {0.5, 1000.5}, {-50.5, -0.5}, {-0.5, 2.5}};
  for (std::size_t i = 0; i < variables.size(); ++i) {
    EXPECT_EQ(variables[i].type, VariableType::real);
    EXPECT_EQ(variables[i].scale, problem.variables[i].scale);
    EXPECT_EQ(variables[i].start, problem.variables[i].start);
    EXPECT_EQ(std::pair(variables[i].lower, variables[i].upper), bounds[i]) << variables[i].name;
  }
}

TEST(TreatedProblem, EveryPointInTheWiderBoundsIsRoundedAndNoneCountsAsOutside) {
  const ProblemDescription problem = make_mixed();
  const TreatedProblem treated(problem, {});
  const std::vector<double> asked = {6.3, 9.5, 0.5, -50.5, -0.5};
  const TreatedProblem::Point point = treated.settle(asked);
  EXPECT_THAT(point.x, ElementsAre(6.3, 9, 1, -50, 0));
  EXPECT_EQ(point.proposed, asked);
  EXPECT_FALSE(point.clipped);
}

TEST(TreatedProblem, APointOutsideIsMovedBeforeItIsRounded) {
  const ProblemDescription problem = make_mixed();
  const TreatedProblem treated(problem, {});
  const TreatedProblem::Point point =
      treated.settle(std::vector<double>{8, -3, 2000, 4, std::numeric_limits<double>::quiet_NaN()});
  EXPECT_THAT(point.x, ElementsAre(7, -2, 1000, -1, 1));
  EXPECT_THAT(point.proposed, ElementsAre(7, -2.5, 1000.5, -0.5, 1));
  EXPECT_TRUE(point.clipped);
}

TEST(TreatedProblem, AWholePointHasNoProposal) {
  const ProblemDescription problem = make_mixed();
  const std::vector<double> whole = {0.3000001, 4, 12, -3, 2};
  for (const Capabilities& capabilities : {Capabilities{}, Capabilities{.integer = true}}) {
    const TreatedProblem::Point point = TreatedProblem(problem, capabilities).settle(whole);
    EXPECT_EQ(point.x, whole);
    EXPECT_THAT(point.proposed, IsEmpty());
    EXPECT_FALSE(point.clipped);
  }
}

// Of uniform points, each of the 12 values of `teeth` gets one twelfth.
TEST(TreatedProblem, EveryValueOfAnIntegerHasTheSameShare) {
  const ProblemDescription problem = make_mixed();
  const TreatedProblem treated(problem, {});
  const DecisionVariable& teeth = treated.description().variables[1];
  std::map<double, int> counts;
  constexpr int kPerValue = 100;
  for (int i = 0; i < 12 * kPerValue; ++i) {
    const double share = (i + 0.5) / (12 * kPerValue);
    std::vector<double> point = {1, teeth.lower + share * (teeth.upper - teeth.lower), 1, -1, 0};
    ++counts[treated.settle(point).x[1]];
  }
  EXPECT_EQ(counts.size(), 12u);
  for (const auto& [value, count] : counts) {
    EXPECT_EQ(count, kPerValue) << value;
  }
}

}  // namespace
}  // namespace armwright
