// Requirements: reading them from files, measuring them on simulations, and their part in
// evaluations.
#include "problems/tracking/requirement.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "base/bits.hpp"
#include "base/expect_error.hpp"
#include "problems/load_tracking.hpp"
#include "problems/problem_folder.hpp"
#include "problems/tracking/requirement_grade.hpp"
#include "sim/kinematics/kinematics.hpp"

namespace armwright {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;
using testing::StartsWith;

const std::vector<std::string> kQuick = {"physics.engine=articulated", "workspace.points=5"};

std::shared_ptr<const TrackingProblem> load_requiring(const std::string& requirements,
                                                      std::vector<std::string> overrides = kQuick) {
  overrides.push_back("requirement=[" + requirements + "]");
  return load_tracking("q1-complex", overrides);
}

// Returns why a problem file with these lines of a requirement is refused.
std::string refuse_requirement(const std::string& lines) {
  return ProblemFolder().refusal_of_base_with("[[requirement]]\n" + lines);
}

TEST(RequirementReader, SaysWhatIsWrong) {
  EXPECT_THAT(refuse_requirement("quantity = 'overshot'\nlimit_relative = 0.1"),
              StartsWith("p.toml:3: unknown requirement[0].quantity 'overshot'; did you mean "
                         "'overshoot'? Valid: overshoot, settling_time, rise_time, tip_error, "));
  EXPECT_THAT(refuse_requirement("quantity = 'overshoot'"), HasSubstr("limit_relative"));
  EXPECT_EQ(refuse_requirement("quantity = 'overshoot'\nlimit = 0.1"),
            "p.toml:4: requirement[0].limit is 0.1; the limit of overshoot is a share of the "
            "move's length; write limit_relative instead");
  EXPECT_EQ(refuse_requirement("quantity = 'settling_time'\nlimit_m = 0.1"),
            "p.toml:4: requirement[0].limit_m is 0.1; the limit of settling_time is in s; write "
            "limit_s instead");
  EXPECT_EQ(refuse_requirement("quantity = 'overshoot'\nlimit_relative = 5"),
            "p.toml:4: requirement[0].limit_relative is 5; it is a share of the move's length and "
            "must be at most 1; 0.05 is five percent");
  EXPECT_THAT(refuse_requirement("quantity = 'energy'\nlimit_j = 0"),
              StartsWith("p.toml:4: requirement[0].limit_j is 0; it must be a finite number > 0"));
  EXPECT_EQ(
      refuse_requirement("quantity = 'energy'\nlimit_j = 9\njoint = 'joint_1'"),
      "p.toml:5: requirement[0].joint is 'joint_1'; energy is not of a joint but of the whole "
      "arm; leave it out");
  EXPECT_THAT(refuse_requirement("quantity = 'peak_torque'\nlimit_n_m = 9\njoint = 'joint_9'"),
              HasSubstr("joint_1"));
  EXPECT_EQ(refuse_requirement("quantity = 'rise_time'\nlimit_s = 0.3\nband_m = 0.1"),
            "p.toml:5: requirement[0].band_m is 0.1; only settling_time has a band, and this is "
            "rise_time; leave it out");
  EXPECT_THAT(refuse_requirement("quantity = 'energy'\nlimit_j = 9\nuse = 'must'"),
              AllOf(HasSubstr("requirement[0].use"), HasSubstr("constraint")));
  EXPECT_THAT(refuse_requirement("quantity = 'energy'\nlimit_j = 9\nweight = 1"),
              HasSubstr("unknown key requirement[0].weight"));
  EXPECT_EQ(refuse_requirement("quantity = 'energy'\nlimit_j = 9\n"
                               "[[requirement]]\nquantity = 'energy'\nlimit_j = 8"),
            "p.toml:6: requirement[1].quantity is 'energy'; another [[requirement]] before it has "
            "the same; keep one of them");
}

TEST(RequirementReader, RefusesTimesThatAnUnsettledTipWouldKeep) {
  EXPECT_THAT(refuse_requirement("quantity = 'settling_time'\nlimit_s = 0.5"),
              AllOf(StartsWith("p.toml:4: requirement[0].limit_s is 0.5"), HasSubstr("0.49 s")));
  // The shortest move takes 0.9 m / (1.5 m/s), followed by the rest.
  EXPECT_THAT(refuse_requirement("quantity = 'rise_time'\nlimit_s = 1.1"), HasSubstr("1.1 s"));
  EXPECT_THAT(refuse_requirement("quantity = 'rise_time'\nlimit_s = 1.0\n[task]\n"
                                 "distance_limit_m = 0.3"),
              HasSubstr("0.7 s"));
}

TEST(Requirements, AreConstraintsOfFrontsToo) {
  std::vector<std::string> overrides = kQuick;
  overrides.emplace_back("objective.kind=error_vs_torque");
  const auto problem =
      load_requiring("{quantity='energy', limit_j=20000, use='constraint'}", overrides);
  const Evaluation evaluation = problem->evaluate(list_starts(problem->description().variables),
                                                  {CaseRole::training, "train/1", {0, 1}});
  EXPECT_THAT(evaluation.objectives, SizeIs(2));
  ASSERT_THAT(evaluation.constraint_values, SizeIs(1));
  EXPECT_EQ(evaluation.constraint_values[0], evaluation.metrics.back() / 20000 - 1);
}

TEST(Requirements, AreMetricsAndWhereTheyAreConstraintsLimits) {
  const auto problem = load_requiring(
      "{quantity='overshoot', limit_relative=0.05, use='constraint'},"
      "{quantity='peak_torque', limit_n_m=900, joint='joint_2'},"
      "{quantity='settling_time', limit_s=0.2, band_m=0.005, use='constraint'},"
      "{quantity='settling_time', limit_s=0.1}");
  const ProblemDescription& description = problem->description();
  ASSERT_THAT(description.requirements, SizeIs(4));
  std::vector<std::string> metrics;
  for (const RequiredMetric& requirement : description.requirements) {
    metrics.push_back(description.metrics.at(requirement.metric).name);
  }
  EXPECT_THAT(metrics, ElementsAre("requirement.overshoot", "requirement.peak_torque.joint_2",
                                   "requirement.settling_time", "requirement.settling_time.2"));
  EXPECT_EQ(description.requirements.back().metric, description.metrics.size() - 1);
  ASSERT_THAT(description.limits, SizeIs(2));
  EXPECT_EQ(description.limits[0].quantity.name, "overshoot");
  EXPECT_EQ(description.limits[1].quantity.name, "settling time to 5 mm");
  EXPECT_EQ(description.limits[1].quantity.unit, "s");
  EXPECT_EQ(description.limits[1].value, 0.2);
  EXPECT_EQ(description.requirements[3].limit.quantity.name, "settling time to 2 % of the move");
  EXPECT_EQ(description.constraints.size(), 2u);
  EXPECT_EQ(description.violation_scale, problem->config().objective.error_scale_m);
  EXPECT_FALSE(description.has_residuals);
  EXPECT_FALSE(description.has_jacobian);
  // Requirements that are only reported do not change the problem that optimizers see.
  const auto reporting = load_requiring("{quantity='overshoot', limit_relative=0.05}");
  EXPECT_TRUE(reporting->description().has_residuals);
  EXPECT_TRUE(reporting->description().constraints.empty());
}

TEST(Requirements, ComeAfterTheObjectivesOwnLimit) {
  const auto problem = load_tracking(
      "q2-torque", {"requirement=[{quantity='tip_error', limit_m=0.001, use='constraint'}]"});
  const ProblemDescription& description = problem->description();
  ASSERT_THAT(description.limits, SizeIs(2));
  EXPECT_EQ(description.limits[0].quantity.name, "error");
  EXPECT_EQ(description.limits[1].quantity.name, "tip error");
  EXPECT_EQ(description.violation_scale, problem->config().objective.torque_scale_n_m);
}

const char* const kAll =
    "{quantity='overshoot', limit_relative=0.05}, {quantity='settling_time', limit_s=0.2},"
    "{quantity='rise_time', limit_s=0.5}, {quantity='tip_error', limit_m=0.01},"
    "{quantity='peak_torque', limit_n_m=900}, {quantity='rms_torque', limit_n_m=300},"
    "{quantity='energy', limit_j=1000}, {quantity='joint_speed', limit_rad_per_s=3},"
    "{quantity='joint_speed', limit_rad_per_s=3, joint='joint_2'}";

// Computes the values from the recorded trajectory, in another way than the program does.
TEST(Requirements, AreWhatTheRecordedTrajectoryShows) {
  for (const std::string engine : {"articulated", "ode"}) {
    const auto problem = load_requiring(kAll, {"physics.engine=" + engine, "workspace.points=5"});
    const TestSet set = problem->get_set("test/2");
    const ArmDesign design = load_design("table-a5").design;
    const TrackingResult recorded = problem->track(design, set, 3, {.trajectory = true});
    const MeasuredCase measured = problem->measure(design, set, 3, 1).front();
    EXPECT_TRUE(measured.result.tips_m.empty());
    EXPECT_EQ(measured.result.mean_error_m, recorded.mean_error_m);
    const TargetTable targets = problem->setup().make_targets(set.make_case(3));
    double overshoot = 0;
    double settling_s = 0;
    double rise_s = 0;
    for (std::size_t k = 1; k < targets.segments.size(); ++k) {
      const Segment& segment = targets.segments[k];
      const Eigen::Vector3d way_m = segment.to_m - segment.from_m;
      double last_out_s = 0;
      double begin_s = 1e9;
      double end_s = 1e9;
      for (int step = 0; step < segment.steps; ++step) {
        const auto& tip_m =
            recorded.trajectory[static_cast<std::size_t>(segment.first_step + step)].tip_m;
        const double share = (tip_m - segment.from_m).dot(way_m) / way_m.squaredNorm();
        const double time_s = (step + 1) * 0.01;
        overshoot = std::max(overshoot, share - 1);
        begin_s = share >= 0.1 ? std::min(begin_s, time_s) : begin_s;
        end_s = share >= 0.9 ? std::min(end_s, time_s) : end_s;
        if ((tip_m - segment.to_m).norm() > 0.02 * way_m.norm()) {
          last_out_s = time_s;
        }
      }
      settling_s = std::max(settling_s, last_out_s - segment.duration_s);
      rise_s = std::max(rise_s, end_s - begin_s);
    }
    double speed = 0;
    double speed_2 = 0;
    std::vector<double> before = targets.start_positions;
    for (const TrajectorySample& sample : recorded.trajectory) {
      for (std::size_t i = 0; i < before.size(); ++i) {
        const double one = std::abs(wrap_angle(sample.q[i] - before[i])) / 0.01;
        speed = std::max(speed, one);
        speed_2 = i == 1 ? std::max(speed_2, one) : speed_2;
      }
      before = sample.q;
    }
    const auto& required = measured.required;
    const auto value = [&](std::size_t i) { return required[i].value.value(); };
    EXPECT_GT(overshoot, 0) << "a case that shows something";
    EXPECT_NEAR(value(0), overshoot, 1e-12);
    // The program interpolates times between two samples.
    EXPECT_NEAR(value(1), settling_s, 0.0101);
    EXPECT_NEAR(value(2), rise_s, 0.0101);
    EXPECT_EQ(value(3), *std::ranges::max_element(recorded.point_error_m.begin() + 1,
                                                  recorded.point_error_m.end()));
    EXPECT_EQ(value(4), std::ranges::max(recorded.peak_effort));
    EXPECT_EQ(value(5), std::ranges::max(recorded.rms_effort));
    EXPECT_EQ(value(6), recorded.energy_j);
    EXPECT_NEAR(value(7), speed, 1e-9);
    EXPECT_NEAR(value(8), speed_2, 1e-9);
    EXPECT_EQ(required[8].joint, 1u);
    EXPECT_EQ(required[4].joint,
              std::ranges::max_element(recorded.peak_effort) - recorded.peak_effort.begin());
    EXPECT_EQ(recorded.point_error_m.at(required[3].point.value() - 1), value(3));
  }
}

TEST(Requirements, OfAnEvaluationAreThoseOfItsWorstCase) {
  const auto problem = load_requiring(kAll);
  const CaseBlock block{CaseRole::test, "test/2", {0, 1, 2, 3}};
  const Evaluation evaluation = problem->evaluate(get_start(*problem), block);
  std::vector<double> worst(9);
  for (const MeasuredCase& one :
       problem->measure(problem->config().start, problem->get_set("test/2"), 0, 4)) {
    for (std::size_t i = 0; i < worst.size(); ++i) {
      worst[i] = std::max(worst[i], one.required[i].value.value());
    }
  }
  ASSERT_GE(evaluation.metrics.size(), 9u);
  EXPECT_TRUE(same_bits(std::vector<double>(evaluation.metrics.end() - 9, evaluation.metrics.end()),
                        worst));
  // All other numbers are the same as without requirements.
  const auto plain = load_tracking("q1-complex", kQuick);
  const Evaluation before = plain->evaluate(get_start(*plain), block);
  EXPECT_TRUE(same_bits(evaluation.objectives, before.objectives));
  EXPECT_TRUE(same_bits(evaluation.case_errors, before.case_errors));
  EXPECT_TRUE(same_bits(evaluation.residuals, before.residuals));
  EXPECT_TRUE(
      same_bits(std::vector<double>(evaluation.metrics.begin(), evaluation.metrics.end() - 9),
                before.metrics));
}

TEST(Requirements, ALostTrainingCaseIsWorseThanAnyThatWorksAndLessBadTheFurtherItGot) {
  const auto problem = load_requiring(
      "{quantity='tip_error', limit_m=1e-6, use='constraint'},"
      "{quantity='overshoot', limit_relative=0.05, use='constraint'}");
  const auto calc_g = [&](double torque_factor, CaseRole role) {
    ArmDesign design = problem->config().start;
    for (JointDrive& joint : design.joints) {
      joint.limits.min *= torque_factor;
      joint.limits.max *= torque_factor;
    }
    return problem->evaluate(problem->make_vector(design), {role, "train/1", {0}});
  };
  const Evaluation works = calc_g(1, CaseRole::training);
  ASSERT_LT(works.case_errors.front(), 0.1);
  // The value is thousands of micrometres; it counts as a thousand times the limit.
  EXPECT_NEAR(works.constraint_values.at(0), kWorstRatio - 1, 1e-9);
  EXPECT_LT(works.constraint_values.at(1), 20);
  EXPECT_GT(calc_g(1, CaseRole::test).constraint_values.at(0), kWorstRatio);
  const Evaluation lost = calc_g(0.02, CaseRole::training);  // the arm falls
  ASSERT_EQ(lost.constraint_values.size(), 2u);
  EXPECT_GT(lost.constraint_values[0], kWorstRatio - 1);
  EXPECT_LE(lost.constraint_values[0], 2 * kWorstRatio - 1);
  EXPECT_NEAR(lost.constraint_values[1], lost.constraint_values[0], 1e-9);
  // A case whose arm lies on the floor until the end of the case is one that ended at its end: small
  // torques do not count.
  const auto patient = load_requiring(
      "{quantity='peak_torque', joint='joint_2', limit_n_m=4000, use='constraint'}",
      {"physics.engine=articulated", "workspace.points=5", "training.cutoff_error_m=1000"});
  std::vector<double> x = get_start(*patient);
  const double standing =
      patient->evaluate(x, {CaseRole::training, "train/1", {0}}).constraint_values.at(0);
  for (std::size_t i = 0; i < x.size(); ++i) {
    x[i] *= patient->description().variables[i].unit == "N m" ? 0.02 : 1;
  }
  const Evaluation fallen = patient->evaluate(x, {CaseRole::training, "train/1", {0}});
  ASSERT_GT(fallen.case_errors.front(), 0.1);
  ASSERT_LT(fallen.case_errors.front(), 1000);
  EXPECT_LT(standing, kWorstRatio - 1);
  EXPECT_NEAR(fallen.constraint_values.at(0), kWorstRatio - 1, 1e-9);
  TrackingResult result;
  result.status = SimulationStatus::cut_off;
  TargetTable targets;
  targets.steps = 100;
  double before = 3 * kWorstRatio;
  for (const int steps : {0, 1, 50, 100}) {
    result.steps = steps;
    const double value =
        make_required_metrics(problem->config().requirements, {result, {{}, {}}}, targets, true)
            .at(1);
    EXPECT_LT(value, before);
    EXPECT_GE(value, 0.05 * kWorstRatio);
    before = value;
  }
}

TEST(Requirements, OfMovesAreRefusedWhereACaseHasNone) {
  const auto problem = load_tracking(
      "q1-complex",
      {"physics.engine=articulated", "requirement=[{quantity='overshoot', limit_relative=0.05}]"});
  const Eigen::Vector3d start(1.4, 0, 0.9);
  const Eigen::Vector3d next(1.4, 0.0005, 0.9);
  const TestSet set = TestSet::make_from_cases({{{start, next, start, next}}});
  const auto tracking = std::const_pointer_cast<TrackingProblem>(problem);
  tracking->add_set(set);
  const std::string message = error_of(ErrorKind::bad_data, [&] {
    tracking->evaluate(get_start(*problem), {CaseRole::test, set.name(), {0}});
  });
  EXPECT_THAT(message, HasSubstr("case 0 has no move long enough to measure the overshoot"));
  // When a design is only shown, the requirement has no value and nothing is refused.
  EXPECT_FALSE(tracking->measure(problem->config().start, set, 0, 1)[0].required[0].value);
}

RequiredMetric make_required(std::size_t metric, double limit) {
  return {metric, {{"q", "m"}, limit}, false};
}

TEST(RequirementGrades, AreTheLightsOfTheRatio) {
  const std::vector<RequiredMetric> requirements = {make_required(3, 10), make_required(0, 10),
                                                    make_required(1, 10), make_required(2, 4)};
  Evaluation evaluation;
  evaluation.metrics = {9.0, 9.5, 4.1, 0.5};
  const auto get_lights = [&] {
    std::vector<std::string> lights;
    for (const JudgedRequirement& one : judge_requirements(requirements, evaluation)) {
      lights.push_back(std::string(get_light(one.grade)) + (one.binds ? " binds" : ""));
    }
    return lights;
  };
  EXPECT_THAT(get_lights(), ElementsAre("green", "green", "yellow", "red binds"));
  evaluation.metrics[2] = 4;
  EXPECT_THAT(get_lights(), ElementsAre("green", "green", "yellow", "yellow binds"));
  // A case without an error could be the worst one. A missed requirement stays missed.
  evaluation.failed_cases = 1;
  evaluation.metrics[0] = 11;
  EXPECT_THAT(get_lights(), ElementsAre("grey", "red binds", "grey", "grey"));
  evaluation.metrics.clear();
  EXPECT_THAT(get_lights(), ElementsAre("grey", "grey", "grey", "grey"));
}

}  // namespace
}  // namespace armwright
