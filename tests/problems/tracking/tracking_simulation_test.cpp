// The tracking problem with real simulations: the outcomes of cases in training, validation and
// test. Each outcome depends on its design and its case only.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <thread>

#include "base/expect_error.hpp"
#include "problems/config/design_file.hpp"
#include "problems/config/problem_loader.hpp"
#include "problems/load_tracking.hpp"
#include "problems/tracking/tracking_problem.hpp"

namespace armwright {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;
using testing::StartsWith;

std::shared_ptr<const TrackingProblem> load_q1(std::vector<std::string> overrides = {},
                                               const std::string& name = "q1-complex") {
  return load_tracking(name, overrides);
}

// Returns the corner of the box in which all magnitudes are smallest (-1) or largest (+1).
std::vector<double> get_corner(const TrackingProblem& problem, int side) {
  std::vector<double> x;
  for (const DecisionVariable& variable : problem.description().variables) {
    x.push_back((variable.start < 0) == (side < 0) ? variable.upper : variable.lower);
  }
  return x;
}

CaseBlock make_block(CaseRole role, const std::string& set, std::vector<std::uint64_t> numbers) {
  return {role, set, std::move(numbers)};
}

void expect_same(const CaseOutcome& a, const CaseOutcome& b) {
  EXPECT_EQ(a.status, b.status);
  EXPECT_EQ(a.reason, b.reason);
  EXPECT_EQ(a.has_error, b.has_error);
  EXPECT_EQ(a.error, b.error);
  EXPECT_EQ(a.metrics, b.metrics);
}

TEST(TrackingSimulation, EvaluationIsWhatTrackingTheDesignGives) {
  const auto problem = load_q1({}, "q2-e4");
  const auto x = get_start(*problem);
  const Evaluation evaluation =
      problem->evaluate(x, make_block(CaseRole::validation, "validation/1", {4, 0}));
  ASSERT_EQ(evaluation.status, EvaluationStatus::ok);
  const TestSet set = problem->get_set("validation/1");
  const TrackingResult four = problem->track(problem->config().start, set, 4);
  const TrackingResult zero = problem->track(problem->config().start, set, 0);
  EXPECT_THAT(evaluation.case_errors, ElementsAre(four.mean_error_m, zero.mean_error_m));
  // The mean of points 2 to 25. Both sides add 24 numbers in the same order, so the bits are equal.
  double sum = 0;
  for (std::size_t point = 1; point < 25; ++point) {
    sum += four.point_error_m.at(point);
  }
  EXPECT_EQ(four.mean_error_m, sum / 24);
  const double error = (four.mean_error_m + zero.mean_error_m) / 2;
  EXPECT_NEAR(evaluation.objectives.at(0), error / 0.0058 + 85200.0 / 963686, 1e-12);
  ASSERT_THAT(evaluation.residuals, SizeIs(2 * 24 + 4));
  double squares = 0;
  for (const double r : evaluation.residuals) {
    squares += r * r;
  }
  EXPECT_NEAR(squares, evaluation.objectives.at(0), 1e-12);
  ASSERT_THAT(evaluation.metrics, SizeIs(13));
  EXPECT_EQ(evaluation.metrics[3], (four.energy_j + zero.energy_j) / 2);
  double saturation = 0;
  for (std::size_t joint = 0; joint < 4; ++joint) {
    saturation += (four.saturated_share[joint] + zero.saturated_share[joint]) / 8;
    EXPECT_EQ(evaluation.metrics[5 + 2 * joint],
              std::max(four.peak_effort[joint], zero.peak_effort[joint]));
    EXPECT_EQ(evaluation.metrics[6 + 2 * joint],
              (four.rms_effort[joint] + zero.rms_effort[joint]) / 2);
  }
  EXPECT_NEAR(evaluation.metrics[4], saturation, 1e-15);
}

TEST(TrackingSimulation, TrainingCutsOffAndNothingElseDoes) {
  const auto problem = load_q1();
  const auto weak = get_corner(*problem, -1);  // cannot carry its own arm
  const std::vector<std::uint64_t> numbers = {0, 1};
  for (const CaseRole role : {CaseRole::validation, CaseRole::test}) {
    const Evaluation whole = problem->evaluate(weak, make_block(role, "train/1", numbers));
    EXPECT_EQ(whole.status, EvaluationStatus::ok);
    EXPECT_THAT(whole.case_errors, Each(testing::Gt(2)));  // it hangs down, metres away
    EXPECT_EQ(whole.metrics.at(2), 2);
  }
  const Evaluation cut =
      problem->evaluate(weak, make_block(CaseRole::training, "train/1", numbers));
  EXPECT_EQ(cut.status, EvaluationStatus::ok);  // a valid, bad result
  EXPECT_EQ(cut.reason, "");
  EXPECT_EQ(cut.failed_cases, 0);
  EXPECT_THAT(cut.case_errors, Each(testing::AllOf(testing::Lt(2), testing::Gt(1.9))));
  const auto half = load_q1({"training.cutoff_error_m=0.5"});
  EXPECT_THAT(half->evaluate(weak, make_block(CaseRole::training, "train/1", numbers)).case_errors,
              Each(testing::AllOf(testing::Lt(1), testing::Gt(0.9))));
}

// Returns the start with all effort limits times `factor`. With small factors the arm falls.
std::vector<double> make_weak(const TrackingProblem& problem, double factor) {
  std::vector<double> x = get_start(problem);
  for (std::size_t i = 0; i < x.size(); ++i) {
    x[i] *=
        problem.description().variables[i].name.find("effort") == std::string::npos ? 1 : factor;
  }
  return x;
}

// Returns the share of a training case's time after which the simulation of `x` ended.
double calc_share(const TrackingProblem& problem, const std::vector<double>& x) {
  const ArmDesign design = problem.make_design(x);
  const TargetTable targets = problem.setup().make_targets(problem.get_set("train/1").make_case(0));
  TrackingJob job;
  job.design = &design;
  job.targets = &targets;
  job.cutoff_m = 1;
  const auto results =
      problem.config().engines.training->simulate(problem.setup(), std::span(&job, 1));
  EXPECT_EQ(results.front().status, SimulationStatus::cut_off);
  return static_cast<double>(results.front().steps) / targets.steps;
}

// Two arms that fall, one of them later. The one that falls earlier gets a tenth of the torque, too.
TEST(FailureRule, TheDesignThatFailsLaterIsBetterWhateverItsTorque) {
  for (const std::string name : {"q1-complex", "q2-e6", "q2-torque", "q2-error", "q2-energy"}) {
    SCOPED_TRACE(name);
    const auto problem = load_q1({}, name);
    const CaseBlock block = make_block(CaseRole::training, "train/1", {0});
    const auto evaluate = [&](const std::vector<double>& x) {
      const Evaluation evaluation = problem->evaluate(x, block);
      return std::pair(calc_violation(evaluation.constraint_values),
                       calc_scalar(problem->description(), evaluation.objectives));
    };
    const std::vector<double> later = make_weak(*problem, 0.1);
    const std::vector<double> earlier = make_weak(*problem, 0.01);
    ASSERT_GT(calc_share(*problem, later), calc_share(*problem, earlier));
    EXPECT_LT(evaluate(later), evaluate(earlier));
    EXPECT_LT(evaluate(get_start(*problem)), evaluate(later));
    // At equal torque the earlier one has weaker controllers instead.
    std::vector<double> limp = later;
    for (std::size_t i = 0; i < limp.size(); ++i) {
      const bool is_gain =
          problem->description().variables[i].name.find("effort") == std::string::npos;
      limp[i] *= is_gain ? 0.01 : 1;
    }
    ASSERT_GT(calc_share(*problem, later), calc_share(*problem, limp));
    EXPECT_LT(evaluate(later), evaluate(limp));
  }
}

TEST(FailureRule, ACaseThatEndsAfterAShareOfItsTimeCountsAsTheCutOffTimesTwoMinusThatShare) {
  const auto problem = load_q1({}, "q2-e6");
  const std::vector<double> x = make_weak(*problem, 0.1);
  const Evaluation evaluation =
      problem->evaluate(x, make_block(CaseRole::training, "train/1", {0}));
  const double error_m = 2 - calc_share(*problem, x);
  EXPECT_THAT(evaluation.case_errors, ElementsAre(error_m));
  // The torque counted is the largest that the bounds allow: a hundred times that of the start.
  EXPECT_NEAR(evaluation.objectives.at(0), error_m / 0.0058 + 100 * 85200.0 / 963686, 1e-9);
  EXPECT_NEAR(evaluation.metrics.at(1), 0.1 * 85200, 1e-9);  // the metric stays the design's
  double squares = 0;
  for (const double r : evaluation.residuals) {
    squares += r * r;
  }
  EXPECT_NEAR(squares, evaluation.objectives.at(0), 1e-9);
}

TEST(FailureRule, ACaseThatFailsIsWorseThanEveryCaseThatDoesNotInTheSumOfResidualsToo) {
  const auto problem = load_q1({}, "q2-e6");
  // The strongest arm that follows its target, beside a weak one that does not.
  const std::vector<double> strong = make_weak(*problem, 99);
  const CaseBlock block = make_block(CaseRole::training, "train/1", {0});
  const Evaluation works = problem->evaluate(strong, block);
  ASSERT_LT(works.case_errors.at(0), kFailureError_m);
  EXPECT_LT(works.objectives, problem->evaluate(make_weak(*problem, 0.1), block).objectives);
}

TEST(FailureRule, OfAFailedCaseTheDerivativesAreZero) {
  const auto problem = load_q1({"objective.energy_weight=0"}, "q2-e6");
  const Evaluation evaluation = problem->evaluate(
      make_weak(*problem, 0.1), make_block(CaseRole::training, "train/1", {0}), true);
  EXPECT_THAT(evaluation.jacobian, SizeIs(evaluation.residuals.size() * 20));
  EXPECT_THAT(evaluation.jacobian, Each(0.0));
}

TEST(FailureRule, TheThesissCountsTheMissingPointsAsTheCutOffAndTheTorqueAsItIs) {
  const auto problem = load_q1({"training.failure_rule=thesis"}, "q2-e6");
  const std::vector<double> x = make_weak(*problem, 0.01);
  const Evaluation evaluation =
      problem->evaluate(x, make_block(CaseRole::training, "train/1", {0}));
  EXPECT_THAT(evaluation.case_errors, Each(testing::Le(1)));
  EXPECT_NEAR(evaluation.objectives.at(0),
              evaluation.case_errors.at(0) / 0.0058 + 0.01 * 85200 / 963686, 1e-9);
}

TEST(TrackingSimulation, CutOffLeavesGoodDesignsAlone) {
  const auto problem = load_q1();
  const auto x = get_start(*problem);
  EXPECT_EQ(problem->evaluate(x, make_block(CaseRole::training, "train/1", {0, 1})).case_errors,
            problem->evaluate(x, make_block(CaseRole::test, "train/1", {0, 1})).case_errors);
}

TEST(TrackingSimulation, DivergenceIsAStatusAndNeverANumberOutsideTraining) {
  // Efforts of 100 000 times those of the start make the simulation diverge.
  const auto problem = load_q1({"physics.engine=ode", "variables.bounds_factor=1e5"});
  const auto strong = get_corner(*problem, 1);
  const Evaluation test = problem->evaluate(strong, make_block(CaseRole::test, "train/1", {0, 1}));
  EXPECT_EQ(test.status, EvaluationStatus::diverged);
  EXPECT_THAT(test.reason, testing::MatchesRegex("diverged at 0.0[0-9] s, on the way to point 1: "
                                                 "joint [1-4] \\(joint_[1-4]\\): its link is .*"));
  EXPECT_EQ(test.failed_cases, 2);
  EXPECT_THAT(test.objectives, IsEmpty());
  EXPECT_THAT(test.metrics, IsEmpty());
  EXPECT_THAT(test.case_errors, Each(testing::IsNan()));

  const Evaluation training =
      problem->evaluate(strong, make_block(CaseRole::training, "train/1", {0, 1}));
  EXPECT_EQ(training.status, EvaluationStatus::diverged);
  EXPECT_EQ(training.reason, test.reason);
  EXPECT_EQ(training.failed_cases, 0);
  EXPECT_THAT(training.case_errors, Each(testing::AllOf(testing::Le(2), testing::Gt(1.9))));
  EXPECT_THAT(training.metrics,
              Each(testing::Truly([](double metric) { return std::isfinite(metric); })));
}

TEST(TrackingSimulation, UnreachableCasesAreLeftOutInEveryRole) {
  // In a larger sphere, some of the cases leave the arm's reach.
  const auto problem = load_q1({"workspace.radius_m=1.1"});
  const TestSet set = problem->get_set("train/1");
  std::vector<std::uint64_t> reachable, unreachable;
  std::string first_reason;
  for (std::uint64_t number = 0; number < 8; ++number) {
    const TargetTable table = problem->setup().make_targets(set.make_case(number));
    (table.unreachable.empty() ? reachable : unreachable).push_back(number);
    first_reason = first_reason.empty() ? table.unreachable : first_reason;
  }
  ASSERT_THAT(reachable, testing::Not(IsEmpty()));
  ASSERT_THAT(unreachable, testing::Not(IsEmpty()));
  const auto x = get_start(*problem);
  for (const CaseRole role : {CaseRole::training, CaseRole::validation, CaseRole::test}) {
    const Evaluation all =
        problem->evaluate(x, make_block(role, "train/1", {0, 1, 2, 3, 4, 5, 6, 7}));
    EXPECT_EQ(all.status, EvaluationStatus::unreachable);
    EXPECT_EQ(all.reason, first_reason);
    EXPECT_THAT(all.reason, testing::HasSubstr("m is out of reach: the wrist would be "));
    EXPECT_EQ(all.failed_cases, static_cast<int>(unreachable.size()));
    for (const std::uint64_t number : unreachable) {
      EXPECT_TRUE(std::isnan(all.case_errors.at(number)));
    }
    const Evaluation some = problem->evaluate(x, make_block(role, "train/1", reachable));
    EXPECT_EQ(some.status, EvaluationStatus::ok);
    EXPECT_EQ(all.objectives, some.objectives);  // the same numbers, summed in the same order
    const Evaluation none = problem->evaluate(x, make_block(role, "train/1", unreachable));
    EXPECT_EQ(none.status, EvaluationStatus::unreachable);
    EXPECT_THAT(none.objectives, IsEmpty());
    EXPECT_THAT(none.metrics, IsEmpty());
  }
}

// Three designs (one that works, one that fails and one that diverges) on mixed sets and roles.
struct Mixture {
  std::shared_ptr<const TrackingProblem> problem =
      load_q1({"variables.bounds_factor=1e4", "workspace.points=4"});
  std::vector<std::vector<double>> designs = {get_start(*problem), get_corner(*problem, -1),
                                              get_corner(*problem, 1)};
  std::vector<CaseBlock> blocks = {make_block(CaseRole::training, "train/1", {0, 1}),
                                   make_block(CaseRole::test, "train/1", {0, 1}),
                                   make_block(CaseRole::test, "test/2", {0, 1})};

  std::vector<CaseJob> make_jobs() const {
    std::vector<CaseJob> jobs;
    for (const auto& design : designs) {
      for (const CaseBlock& block : blocks) {
        for (const std::uint64_t number : block.numbers) {
          jobs.push_back({design, &block, number});
        }
      }
    }
    return jobs;
  }
};

TEST(TrackingSimulation, OutcomesDoNotDependOnOrderOrBatch) {
  const Mixture mixture;
  const std::vector<CaseJob> jobs = mixture.make_jobs();
  ASSERT_THAT(jobs, SizeIs(18));
  const auto together = mixture.problem->simulate(jobs);
  EXPECT_EQ(together.front().status, EvaluationStatus::ok);
  EXPECT_EQ(together.back().status, EvaluationStatus::diverged);
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    SCOPED_TRACE(i);
    // Alone, in a new problem that has simulated nothing before.
    expect_same(Mixture().problem->simulate({&jobs[i], 1}).at(0), together[i]);
  }
  // 7 and 18 have no common divisor, so this is a permutation. Designs and sets alternate in it.
  std::vector<CaseJob> shuffled;
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    shuffled.push_back(jobs[7 * i % jobs.size()]);
  }
  const auto again = mixture.problem->simulate(shuffled);
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    SCOPED_TRACE(i);
    expect_same(again[i], together[7 * i % jobs.size()]);
  }
}

TEST(TrackingSimulation, OutcomesDoNotDependOnThreads) {
  const Mixture mixture;
  const std::vector<CaseJob> jobs = mixture.make_jobs();
  const auto expected = mixture.problem->simulate(jobs);
  const Mixture fresh;  // the threads make its target tables
  std::vector<std::vector<CaseOutcome>> outcomes(8);
  std::vector<std::jthread> threads;
  for (std::size_t thread = 0; thread < outcomes.size(); ++thread) {
    threads.emplace_back([&, thread] {
      std::vector<CaseJob> rotated = jobs;  // every thread begins at another job
      std::rotate(rotated.begin(), rotated.begin() + static_cast<std::ptrdiff_t>(2 * thread),
                  rotated.end());
      outcomes[thread] = fresh.problem->simulate(rotated);
    });
  }
  threads.clear();  // joins
  for (std::size_t thread = 0; thread < outcomes.size(); ++thread) {
    for (std::size_t i = 0; i < jobs.size(); ++i) {
      SCOPED_TRACE(fmt::format("thread {}, job {}", thread, i));
      expect_same(outcomes[thread].at(i), expected[(i + 2 * thread) % jobs.size()]);
    }
  }
}

TEST(TrackingSimulation, NothingToDoGivesNothing) {
  EXPECT_THAT(load_q1()->simulate({}), IsEmpty());
}

TEST(TrackingFileSets, AreEvaluatedUnderTheirName) {
  const TestSet set = TestSet::load(kOracle);
  TrackingProblem problem(load_q1({}, "q2-e6")->config());
  const auto x = problem.make_vector(load_design("table-a10").design);
  EXPECT_EQ(usage_error_of([&] { problem.get_set(set.name()); }),
            fmt::format("problem q2-e6 has no test cases named {}; load the file they came from",
                        set.name()));
  problem.add_set(set);
  EXPECT_EQ(problem.get_set(set.name()).size(), 3U);
  const Evaluation evaluation =
      problem.evaluate(x, make_block(CaseRole::test, set.name(), {2, 0, 1}));
  EXPECT_THAT(evaluation.case_errors,
              ElementsAre(problem.track(problem.make_design(x), set, 2).mean_error_m,
                          problem.track(problem.make_design(x), set, 0).mean_error_m,
                          problem.track(problem.make_design(x), set, 1).mean_error_m));
  EXPECT_EQ(
      usage_error_of([&] { problem.evaluate(x, make_block(CaseRole::test, set.name(), {3})); }),
      fmt::format("test set {} has 3 cases, counted from 0; there is no case 3", set.name()));
}

TEST(TrackingFileSets, AnyOtherNameGeneratesCasesInTheProblemsWorkspace) {
  const auto problem = load_q1({"workspace.points=5", "workspace.centre_m=[1.3, 0.1, 1]"});
  WorkspaceSphere sphere;
  sphere.centre_m = {1.3, 0.1, 1};
  sphere.points = 5;
  EXPECT_EQ(problem->get_set("test/77").make_case(3).points_m,
            make_test_case("test/77", 3, sphere).points_m);
  EXPECT_EQ(problem->get_set("test/77").size(), std::nullopt);
}

TEST(TrackingFileSets, CaseOfOneMoveNeedsItsFirstPointCounted) {
  // Without a third point the error would be the mean over zero points.
  const TestSet set = TestSet::make_from_cases({TestCase{{{1.4, 0, 0.9}, {1.4, 0.3, 0.9}}}});
  const std::string message = fmt::format(
      "test set {}: case 0 has 2 points, but the first after the start does not count "
      "(task.count_first_point is false); give it a third one",
      set.name());
  TrackingProblem strict(load_q1()->config());
  strict.add_set(set);
  const auto x = get_start(strict);
  EXPECT_EQ(error_of(ErrorKind::bad_data, [&] { strict.track(strict.config().start, set, 0); }),
            message);
  EXPECT_EQ(error_of(ErrorKind::bad_data,
                     [&] { strict.evaluate(x, make_block(CaseRole::test, set.name(), {0})); }),
            message);
  const auto counting = load_q1({"task.count_first_point=true"});
  const TrackingResult result = counting->track(counting->config().start, set, 0);
  ASSERT_THAT(result.point_error_m, SizeIs(1));
  EXPECT_EQ(result.mean_error_m, result.point_error_m[0]);
  EXPECT_GT(result.mean_error_m, 0);
}

// The outcome of a case whose error exceeds the bound of its job.
TEST(TrackingSimulation, AnAbandonedCaseSaysWhatItsErrorIsAtLeast) {
  const auto problem = load_q1({"workspace.points=6"});
  const auto x = get_corner(*problem, -1);
  const CaseBlock block = make_block(CaseRole::test, "test/2", {0});
  CaseJob job{.x = x, .block = &block, .number = 0, .residuals = true};
  const CaseOutcome whole = problem->simulate({&job, 1}).at(0);
  ASSERT_EQ(whole.status, EvaluationStatus::ok) << whole.reason;
  EXPECT_THAT(whole.residuals, SizeIs(5));
  job.abandon_above = whole.error;
  expect_same(problem->simulate({&job, 1}).at(0), whole);
  job.abandon_above = 0.25 * whole.error;
  const CaseOutcome part = problem->simulate({&job, 1}).at(0);
  EXPECT_EQ(part.status, EvaluationStatus::abandoned);
  EXPECT_THAT(part.reason, StartsWith("abandoned after point "));
  EXPECT_TRUE(part.has_error);
  EXPECT_GT(part.error, job.abandon_above);
  EXPECT_LT(part.error, whole.error);
  EXPECT_THAT(part.residuals, IsEmpty());
  EXPECT_THAT(part.metrics, SizeIs(whole.metrics.size()));
}

TEST(TrackingSimulation, ResidualsAreThereIfAskedFor) {
  const auto problem = load_q1({"workspace.points=3"});
  const auto x = get_start(*problem);
  const CaseBlock block = make_block(CaseRole::training, "train/1", {0});
  CaseJob job{.x = x, .block = &block, .number = 0};
  const CaseOutcome without = problem->simulate({&job, 1}).at(0);
  EXPECT_THAT(without.residuals, IsEmpty());
  EXPECT_THAT(problem->aggregate(x, {&without, 1}).residuals, IsEmpty());
  job.residuals = true;
  const CaseOutcome with = problem->simulate({&job, 1}).at(0);
  EXPECT_THAT(with.residuals, SizeIs(2));
  expect_same(with, without);
  EXPECT_THAT(problem->aggregate(x, {&with, 1}).residuals, SizeIs(2));
}

}  // namespace
}  // namespace armwright
