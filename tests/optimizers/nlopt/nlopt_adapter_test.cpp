// What NLopt is told: finite numbers, whatever the evaluations come to.
#include "optimizers/nlopt/nlopt_adapter.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>

#include "problems/analytic/analytic.hpp"
#include "study/contract/memory_evaluator.hpp"

namespace armwright {
namespace {

const std::vector<double> kNoPoint(4, std::numeric_limits<double>::quiet_NaN());

class NloptAdapterTest : public testing::Test {
 protected:
  // On the problem `constrained`, of four variables.
  NloptAdapter& begin(const MemoryEvaluatorSettings& settings, bool takes_constraints) {
    settings_.takes_constraints = takes_constraints;
    settings_.constraint_weight = 1000;
    evaluator_.emplace(*problem_, settings);
    questions_.emplace(settings_, *evaluator_);
    questions_->begin([this] { ++stops_; });
    return *questions_;
  }
  const MemoryEvaluator& evaluator() const { return *evaluator_; }
  std::size_t constraint_count() const { return problem_->description().constraints.size(); }
  double penalty() const { return problem_->penalty_objectives().at(0); }
  int stops() const { return stops_; }

 private:
  std::unique_ptr<Problem> problem_ = make_analytic("constrained");
  NloptSettings settings_;
  std::optional<MemoryEvaluator> evaluator_;
  std::optional<NloptAdapter> questions_;
  int stops_ = 0;
};

TEST_F(NloptAdapterTest, AFailedStartIsAFinitePenaltyAndViolatedConstraints) {
  NloptAdapter& questions = begin({.budget = 10, .fail_every = 1}, true);
  const std::vector<double> start = questions.space().start();
  EXPECT_EQ(questions.ask_objective(start), penalty());
  for (std::size_t i = 0; i < constraint_count(); ++i) {
    EXPECT_GT(questions.ask_constraint(start, i), 1e6);
    EXPECT_TRUE(std::isfinite(questions.ask_constraint(start, i)));
  }
  EXPECT_EQ(evaluator().trace().size(), 1u);
  EXPECT_TRUE(evaluator().trace()[0].score.constraint_values.empty());
}

TEST_F(NloptAdapterTest, WithoutConstraintsAFailureIsThePenaltyAlone) {
  NloptAdapter& questions = begin({.budget = 10, .fail_every = 1}, false);
  EXPECT_EQ(questions.ask_objective(questions.space().start()), penalty());
}

TEST_F(NloptAdapterTest, APointThatIsNoneIsTheWorstSeenAndNoEvaluation) {
  NloptAdapter& questions = begin({.budget = 10}, true);
  const double start = questions.ask_objective(questions.space().start());
  const double corner = questions.ask_objective(questions.space().upper());
  EXPECT_EQ(questions.ask_objective(kNoPoint), std::max(start, corner));
  EXPECT_GT(questions.ask_constraint(kNoPoint, 0), 1e6);
  EXPECT_TRUE(std::isfinite(questions.ask_constraint(kNoPoint, 0)));
  EXPECT_EQ(evaluator().trace().size(), 2u);
  EXPECT_EQ(stops(), 0);
}

TEST_F(NloptAdapterTest, ASearchThatIsLostInPointsThatAreNoneIsGivenUp) {
  NloptAdapter& questions = begin({.budget = 10}, false);
  questions.ask_objective(questions.space().start());
  for (int i = 0; i < 999; ++i) {
    questions.ask_objective(kNoPoint);
  }
  EXPECT_EQ(stops(), 0);
  questions.ask_objective(kNoPoint);
  EXPECT_EQ(stops(), 1);
  EXPECT_FALSE(questions.has_ended());  // another search may begin
}

TEST_F(NloptAdapterTest, ObjectiveAndConstraintsOfAPointAreOneEvaluation) {
  NloptAdapter& questions = begin({.budget = 10}, true);
  const std::vector<double> start = questions.space().start();
  questions.ask_constraint(start, 0);
  questions.ask_constraint(start, 1);
  const double value = questions.ask_objective(start);
  EXPECT_EQ(evaluator().trace().size(), 1u);
  EXPECT_EQ(questions.ask_objective(start), value);  // asked for again: evaluated again
  EXPECT_EQ(evaluator().trace().size(), 2u);
}

TEST_F(NloptAdapterTest, AfterTheEndTheSolverIsStoppedAndAnsweredInFiniteNumbers) {
  NloptAdapter& questions = begin({.budget = 1}, true);
  questions.ask_objective(questions.space().start());
  const std::vector<double> corner = questions.space().lower();
  for (int i = 0; i < 10; ++i) {
    EXPECT_TRUE(std::isfinite(questions.ask_objective(corner)));
    EXPECT_TRUE(std::isfinite(questions.ask_constraint(corner, 0)));
  }
  EXPECT_GT(stops(), 0);
  EXPECT_TRUE(questions.has_ended());
  EXPECT_EQ(evaluator().calls_after_stop(), 1);
}

TEST_F(NloptAdapterTest, AnExceptionWaitsUntilItIsAskedFor) {
  NloptAdapter& questions = begin({.budget = 10, .throw_at = 1}, false);
  EXPECT_TRUE(std::isfinite(questions.ask_objective(questions.space().start())));
  EXPECT_TRUE(questions.has_ended());
  EXPECT_THROW(questions.rethrow(), BrokenEvaluator);
}

}  // namespace
}  // namespace armwright
