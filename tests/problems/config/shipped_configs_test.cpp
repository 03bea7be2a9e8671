// What is shipped, against what the thesis says: every setting that makes a published number is
// written out here a second time, because a wrong one would go unnoticed otherwise.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "base/hash.hpp"
#include "problems/analytic/analytic.hpp"
#include "problems/config/config_files.hpp"
#include "problems/config/design_file.hpp"
#include "problems/config/problem_loader.hpp"
#include "problems/load_tracking.hpp"

namespace armwright {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

constexpr std::int64_t kPopulation = 35;

struct Experiment {
  std::string name;
  SignalShape signal = SignalShape::complex;
  double distance_limit_m = 0.9;
  bool count_first_point = false;
  double load_kg = 0;
  std::string training = "train/1";
  std::int64_t generations = 400;
  std::optional<double> torque_weight = {};  // nothing: the error alone is minimised
  PublishedWinner published = {};
};

void PrintTo(const Experiment& experiment, std::ostream* out) {
  *out << experiment.name;
}

Experiment make_initial(std::string name, double limit_m, std::int64_t generations) {
  return {.name = std::move(name),
          .signal = SignalShape::triangular,
          .distance_limit_m = limit_m,
          .count_first_point = true,
          .generations = generations};
}

Experiment make_q1(std::string name, SignalShape signal, double error_m, std::string design,
                   std::optional<double> torque = {}, std::string where = "thesis, Fig. 6.4") {
  return {
      .name = std::move(name),
      .signal = signal,
      .published = {error_m, torque, std::move(design), std::move(where), {"task.ik_bug=true"}}};
}

Experiment make_q2(std::string name, double weight, double torque) {
  return {.name = std::move(name),
          .distance_limit_m = 1.6,
          .training = "train/3",
          .generations = 1000,
          .torque_weight = weight,
          .published = {{},
                        torque,
                        "",
                        "thesis, Table 6.4",
                        {"task.ik_bug=true", fmt::format("objective.torque_weight={}", weight)}}};
}

std::vector<Experiment> make_experiments() {
  std::vector<Experiment> all = {
      make_initial("initial", 0.9, 176),
      make_initial("initial-0cm", 0, 253),
      make_initial("initial-45cm", 0.45, 239),
      make_initial("initial-90cm", 0.9, 176),
      make_q1("q1-complex", SignalShape::complex, 0.0058, "table-a5", 963686, "thesis, Table 6.1"),
      make_q1("q1-triangular", SignalShape::triangular, 0.0069, "table-a6"),
      make_q1("q1-trapezoid", SignalShape::trapezoid, 0.0076, "table-a7"),
      make_q1("q1-ramp", SignalShape::ramp, 0.0126, "table-a8"),
      make_q1("q1-step", SignalShape::step, 0.0041, "table-a9"),
      make_q2("q2-e1", 100, 22104),
      make_q2("q2-e2", 100, 14963),
      make_q2("q2-e3", 5, 18754),
      make_q2("q2-e4", 1, 25455),
      make_q2("q2-e5", 0.2, 42661),
      make_q2("q2-e6", 1, 28927),
  };
  const auto find = [&](const std::string& name) -> Experiment& {
    return *std::find_if(all.begin(), all.end(), [&](const auto& e) { return e.name == name; });
  };
  find("q2-e1").distance_limit_m = 0.9;
  find("q2-e1").generations = 700;
  find("q2-e2").generations = 700;
  Experiment& e6 = find("q2-e6");
  e6.published = {
      0.000083, 28927, "table-a10", "thesis, Fig. 6.13 and Table 6.4", {"task.ik_bug=false"}};
  Experiment q4 = e6;
  q4.name = "q4-speed";
  Experiment q3 = e6;
  q3.name = "q3-load";
  q3.load_kg = 20;
  q3.published = {
      0.0027, 21603, "table-a11", "thesis, Fig. 6.15 and section 6.4.1", {"task.ik_bug=false"}};
  all.push_back(q3);
  all.push_back(q4);
  return all;
}

class ShippedExperiment : public testing::TestWithParam<Experiment> {};

TEST_P(ShippedExperiment, HasTheSettingsOfTheThesis) {
  const Experiment& expected = GetParam();
  const LoadedProblem loaded = load_problem(expected.name);
  EXPECT_EQ(loaded.name, expected.name);
  EXPECT_THAT(loaded.title, testing::Not(IsEmpty()));
  ASSERT_NE(loaded.tracking(), nullptr);
  const TrackingConfig& config = loaded.tracking()->config();

  const TrackingTask& task = config.task;
  EXPECT_EQ(task.signal, expected.signal);
  EXPECT_EQ(task.speed_m_per_s, 1.5);
  EXPECT_EQ(task.distance_limit_m, expected.distance_limit_m);
  EXPECT_EQ(task.trapezoid_acceleration_m_per_s2, 15);
  EXPECT_EQ(task.rest_s, 0.5);
  EXPECT_EQ(task.control_period_s, 0.01);
  EXPECT_EQ(task.count_first_point, expected.count_first_point);
  EXPECT_FALSE(task.ik_bug);
  EXPECT_EQ(task.load_kg, expected.load_kg);
  EXPECT_EQ(task.physics.gravity_m_per_s2, 9.80665);
  EXPECT_EQ(task.physics.substeps, 1);
  EXPECT_EQ(task.physics.erp, 0.25);
  EXPECT_EQ(task.physics.cfm, 0);
  EXPECT_EQ(config.engines.training_name, "articulated");
  EXPECT_EQ(config.engines.judging_name, "articulated");

  EXPECT_EQ(config.workspace.centre_m, Eigen::Vector3d(1.4, 0, 0.9));
  EXPECT_EQ(config.workspace.radius_m, 0.8);
  EXPECT_EQ(config.workspace.shortest_move_m, 0.05);
  EXPECT_EQ(config.workspace.points, 25);

  EXPECT_EQ(config.objective.kind == TrackingObjective::Kind::error_and_torque,
            expected.torque_weight.has_value());
  if (expected.torque_weight) {
    EXPECT_EQ(config.objective.torque_weight, *expected.torque_weight);
    EXPECT_EQ(config.objective.error_scale_m, 0.0058);
    EXPECT_EQ(config.objective.torque_scale_n_m, 963686);
  }
  EXPECT_EQ(config.cutoff_error_m, 1);
  EXPECT_EQ(config.failure_rule, FailureRule::ordered);

  EXPECT_EQ(loaded.sets.training, expected.training);
  EXPECT_EQ(loaded.sets.validation, "validation/1");
  EXPECT_EQ(loaded.sets.test, "test/2");
  // Where torque counts, designs fail in rare cases.
  EXPECT_EQ(loaded.sets.validation_cases, expected.torque_weight ? 500 : 100);
  EXPECT_EQ(loaded.sets.test_cases, 500);
  EXPECT_TRUE(loaded.schedule.changes_cases());
  EXPECT_EQ(loaded.schedule.cases, 1);
  EXPECT_EQ(loaded.optimizer, "auto");
  EXPECT_EQ(loaded.budget, kPopulation * expected.generations);

  EXPECT_EQ(loaded.published.design, expected.published.design);
  EXPECT_EQ(loaded.published.where, expected.published.where);
  EXPECT_EQ(loaded.published.set, expected.published.set);
  // The numbers are there with the settings that they were found with.
  const PublishedWinner published = load_problem(expected.name, expected.published.set).published;
  EXPECT_EQ(published.error_m, expected.published.error_m);
  EXPECT_EQ(published.total_torque_n_m, expected.published.total_torque_n_m);
  EXPECT_EQ(published.difference, "");
}

TEST(PublishedWinner, IsNotComparedWithOtherKinematicsOrAnotherWeightOfTheTorque) {
  const PublishedWinner q1 = load_problem("q1-complex").published;
  EXPECT_EQ(q1.error_m, std::nullopt);
  EXPECT_EQ(q1.total_torque_n_m, std::nullopt);
  EXPECT_EQ(q1.difference, "task.ik_bug is false here, and true for the published winner");
  const std::vector<std::string> heavier = {"task.ik_bug=true", "objective.torque_weight=3"};
  EXPECT_EQ(load_problem("q2-e4", heavier).published.difference,
            "objective.torque_weight is 3 here, and 1 for the published winner");
  EXPECT_EQ(load_problem("q2-e6").published.error_m, 0.000083);
}

TEST_P(ShippedExperiment, StartsAtTheBaseControllersWithEverythingVariable) {
  const LoadedProblem loaded = load_problem(GetParam().name);
  EXPECT_THAT(loaded.problem->description().variables, SizeIs(20));
  EXPECT_EQ(loaded.tracking()->config().bounds_factor, 100);
  EXPECT_EQ(loaded.tracking()->make_vector(loaded.tracking()->config().start),
            loaded.tracking()->make_vector(load_design("table-a1").design));
}

TEST_P(ShippedExperiment, MovesTheArmOfTheThesis) {
  const auto problem = load_tracking(GetParam().name);
  const RobotModel& robot = problem->setup().robot();
  std::vector<double> masses_kg;
  for (const Link& link : robot.links) {
    masses_kg.push_back(link.inertial.mass_kg);
  }
  EXPECT_THAT(masses_kg,
              ElementsAre(112.9, 266.3, 545.6, testing::DoubleEq(13.8 + GetParam().load_kg)));
}

TEST_P(ShippedExperiment, RecordsItsConfigurationAndWhatItWasMadeFrom) {
  const LoadedProblem loaded = load_problem(GetParam().name);
  const auto resolved = nlohmann::json::parse(loaded.resolved_json);
  EXPECT_EQ(resolved.at("kind"), "tracking");
  EXPECT_EQ(resolved.at("task").at("distance_limit_m"), GetParam().distance_limit_m);
  EXPECT_EQ(resolved.at("sets").at("training"), GetParam().training);
  EXPECT_FALSE(resolved.contains("extends"));
  ASSERT_THAT(loaded.input_hashes, SizeIs(2));
  for (const std::string name : {"robots/irb4600_40_255.urdf", "designs/table-a1.toml"}) {
    const std::filesystem::path path = find_config_folder() / name;
    std::ifstream stream(path, std::ios::binary);
    const std::string content(std::istreambuf_iterator<char>(stream), {});
    EXPECT_EQ(loaded.input_hashes.at(path.filename().string()), calc_sha256_hex(content));
  }
}

INSTANTIATE_TEST_SUITE_P(All, ShippedExperiment, testing::ValuesIn(make_experiments()),
                         [](const auto& parameters) {
                           std::string name = parameters.param.name;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

TEST(ShippedProblems, AreAllKnownHere) {
  std::vector<std::string> expected = analytic_names();
  for (const Experiment& experiment : make_experiments()) {
    expected.push_back(experiment.name);
  }
  expected.insert(
      expected.end(),
      {"subudhi-flexible", "abdessemed-fuzzy", "chaiyaratana-line", "co-design", "excite",
       "gasparetto", "gasparetto-front", "identify", "irb4600", "q1-requirements", "q2-energy",
       "q2-error", "q2-pareto", "q2-torque", "robot", "saravanan-puma", "shiakolas"});
  for (const std::string experiment : {"q1", "e6", "q3"}) {
    expected.push_back("robust-" + experiment);
    expected.push_back("faithful-" + experiment);
  }
  EXPECT_THAT(list_configs("problems"), testing::UnorderedElementsAreArray(expected));
  std::vector<std::string> listed;
  for (const ProblemTitle& problem : list_problems()) {
    EXPECT_EQ(problem.title, load_problem(problem.name).title);
    EXPECT_NE(problem.title, problem.name);
    listed.push_back(problem.name);
  }
  EXPECT_EQ(listed, list_configs("problems"));
}

// The plants of all three sets differ from each other and from the nominal arm, which has rotors and
// friction, and the time step is a quarter of the control period.
TEST(ShippedProblems, TheArmOfTheFirstTutorialIsNeverTheNominalOne) {
  const LoadedProblem loaded = load_problem("irb4600");
  const TrackingConfig& config = loaded.tracking()->config();
  EXPECT_FALSE(config.task.ik_bug);
  EXPECT_EQ(config.task.control_period_s, 0.004);
  EXPECT_EQ(config.task.physics.substeps, 4);
  for (const CaseRole role : {CaseRole::training, CaseRole::validation, CaseRole::test}) {
    EXPECT_TRUE(config.perturbation.applies_to(role));
  }
  const Perturbation& plants = config.perturbation;
  for (const double spread : {plants.mass_relative, plants.armature_relative,
                              plants.friction_relative, plants.delay_s, plants.quantisation_rad}) {
    EXPECT_GT(spread, 0);
  }
  for (const Joint& joint : config.robot.joints) {
    EXPECT_GT(joint.plant.armature, 0) << joint.name;
    EXPECT_GT(joint.plant.coulomb, 0) << joint.name;
  }
  EXPECT_THAT(loaded.problem->description().variables, SizeIs(12));
  EXPECT_LE(loaded.budget, 5000);
  // Another problem of the same robot keeps its ideal joints.
  EXPECT_EQ(load_tracking("q1-complex")->setup().robot().joints[0].plant.armature, 0);
}

// Only training is perturbed: what they are judged by is the problem that they extend, with the
// physics as it says.
TEST(ShippedProblems, DesignsThatHoldAreJudgedOnTheNominalArm) {
  const std::vector<std::string> articulated = {"physics.engine=articulated"};
  for (const auto& [name, base, set] : {std::tuple{"robust-e6", "q2-e6", "physics.substeps=1"},
                                        {"faithful-e6", "q2-e6", "physics.substeps=10"},
                                        {"robust-q1", "q1-complex", "task.ik_bug=false"},
                                        {"faithful-q3", "q3-load", "physics.substeps=10"}}) {
    std::vector<std::string> overrides = articulated;
    overrides.emplace_back(set);
    const LoadedProblem robust = load_problem(name);
    const LoadedProblem plain = load_problem(base, overrides);
    const std::vector<double> x = robust.tracking()->make_vector(robust.tracking()->config().start);
    const CaseBlock unseen{CaseRole::test, "test/2", {7}};
    EXPECT_EQ(robust.problem->evaluate(x, unseen).case_errors,
              plain.problem->evaluate(x, unseen).case_errors)
        << name;
    const CaseBlock seen{CaseRole::training, "train/1", {7}};
    EXPECT_NE(robust.problem->evaluate(x, seen).case_errors,
              plain.problem->evaluate(x, seen).case_errors)
        << name;
  }
}

// Error and torque as E6 counts them, and the energy besides; the same for the start of the
// co-design, whose motors are all that differs there.
TEST(ShippedProblems, EnergyAndMotorsComeOnTopOfE6) {
  const CaseBlock block{CaseRole::training, "train/3", {0, 1}};
  double before_j = 0;
  for (const std::string name : {"q2-energy", "co-design"}) {
    const LoadedProblem loaded =
        load_problem(name, std::vector<std::string>{"physics.engine=articulated"});
    const TrackingProblem& problem = *loaded.tracking();
    const Evaluation evaluation =
        problem.evaluate(problem.make_vector(problem.config().start), block);
    EXPECT_EQ(evaluation.status, EvaluationStatus::ok) << evaluation.reason;
    const double error_m = evaluation.metrics.at(0);
    const double torque_n_m = evaluation.metrics.at(1);
    const double energy_j = evaluation.metrics.at(3);
    EXPECT_NEAR(evaluation.objectives.at(0),
                error_m / 0.0058 + torque_n_m / 963686 + 0.05 * energy_j / 30555, 1e-12);
    EXPECT_GT(energy_j, before_j) << "heavier arms need more";
    before_j = energy_j;
  }
  EXPECT_THAT(load_problem("co-design").problem->description().variables, SizeIs(28));
}

TEST(ShippedProblems, TheParetoProblemIsE6WithoutWeights) {
  const LoadedProblem front = load_problem("q2-pareto");
  const ProblemDescription& description = front.problem->description();
  ASSERT_THAT(description.objectives, SizeIs(2));
  EXPECT_FALSE(front.schedule.changes_cases());
  const LoadedProblem e6 = load_problem("q2-e6");
  const TrackingTask& task = front.tracking()->config().task;
  EXPECT_EQ(task.ik_bug, false);
  EXPECT_EQ(task.distance_limit_m, e6.tracking()->config().task.distance_limit_m);
  EXPECT_EQ(front.sets.training, e6.sets.training);
  const std::vector<double> start = e6.tracking()->make_vector(e6.tracking()->config().start);
  const CaseBlock block{CaseRole::training, front.sets.training, {0, 1}};
  const Evaluation both = front.problem->evaluate(start, block);
  EXPECT_DOUBLE_EQ(calc_scalar(description, both.objectives),
                   e6.problem->evaluate(start, block).objectives.at(0));
}

// One task, one set of cases, and a limit that the published winner of E6 keeps.
TEST(ShippedProblems, TheLimitedOnesAreE6TakenApart) {
  const LoadedProblem e6 = load_problem("q2-e6");
  const CaseBlock block{CaseRole::training, e6.sets.training, {0, 1, 2, 3, 4}};
  const std::vector<double> published = e6.tracking()->make_vector(load_design("table-a10").design);
  const Evaluation whole = e6.problem->evaluate(published, block);
  for (const std::string name : {"q2-torque", "q2-error"}) {
    SCOPED_TRACE(name);
    const LoadedProblem loaded = load_problem(name);
    EXPECT_FALSE(loaded.schedule.changes_cases());
    EXPECT_EQ(loaded.schedule.cases, 5);
    EXPECT_EQ(loaded.budget, 35000);
    EXPECT_EQ(loaded.sets.training, e6.sets.training);
    const ProblemDescription& description = loaded.problem->description();
    const bool is_torque = name == "q2-torque";
    ASSERT_THAT(description.limits, SizeIs(1));
    EXPECT_EQ(description.limits[0].value, is_torque ? 1e-4 : 30000);
    const Evaluation own = loaded.problem->evaluate(published, block);
    EXPECT_EQ(own.case_errors, whole.case_errors);  // the same task
    EXPECT_THAT(own.objectives, ElementsAre(whole.metrics[is_torque ? 1 : 0]));
    EXPECT_TRUE(is_feasible(own));
    EXPECT_FALSE(is_feasible(loaded.problem->evaluate(
        loaded.tracking()->make_vector(loaded.tracking()->config().start), block)));
  }
}

TEST(ShippedProblems, OnlyQ4Sweeps) {
  for (const std::string& name : list_configs("problems")) {
    const auto sweep = load_problem(name).sweep;
    ASSERT_EQ(sweep.has_value(), name == "q4-speed") << name;
    if (sweep) {
      EXPECT_EQ(sweep->parameter, "task.speed_m_per_s");
      EXPECT_EQ(sweep->design, "table-a10");
      EXPECT_THAT(sweep->values, ElementsAre(0.5, 0.75, 1, 1.25, 1.5, 1.75, 2, 2.25, 2.5, 2.75, 3));
    }
  }
}

TEST(ShippedProblems, ReplicatesReachTheTrackingProblem) {
  const LoadedProblem loaded = load_problem("q1-complex");
  const LoadedProblem replicate = make_replicate(
      loaded, 2, "train/other", loaded.tracking()->make_vector(loaded.tracking()->config().start));
  EXPECT_NE(replicate.problem, loaded.problem);
  EXPECT_EQ(replicate.tracking(), loaded.tracking());
  EXPECT_EQ(replicate.problem->description().failure_error, kFailureError_m);
}

TEST(ShippedProblems, AnalyticFunctionsHaveOneCase) {
  for (const std::string& name : analytic_names()) {
    SCOPED_TRACE(name);
    const LoadedProblem loaded = load_problem(name);
    EXPECT_EQ(loaded.tracking(), nullptr);
    EXPECT_EQ(loaded.problem->description().failure_error, std::numeric_limits<double>::infinity());
    EXPECT_EQ(loaded.problem->description().name, name);
    EXPECT_THAT(loaded.problem->description().variables, SizeIs(name == "branin"        ? 2
                                                                : name == "constrained" ? 4
                                                                : name == "hartmann6"   ? 6
                                                                : name == "zdt1"        ? 30
                                                                : name == "dtlz2"       ? 12
                                                                                        : 10));
    EXPECT_FALSE(loaded.schedule.changes_cases());
    EXPECT_EQ(loaded.schedule.cases, 1);
    EXPECT_EQ(loaded.sets.validation_cases, 1);
    EXPECT_EQ(loaded.sets.test_cases, 1);
    const bool has_front = name == "zdt1" || name == "dtlz2";
    EXPECT_EQ(loaded.budget, has_front ? 25000 : 10000);
    EXPECT_EQ(loaded.optimizer, "auto");
    EXPECT_THAT(loaded.input_hashes, IsEmpty());
  }
  const std::vector<std::string> overrides = {"sets.test_cases=7", "function.dimension=3"};
  const LoadedProblem changed = load_problem("sphere", overrides);
  EXPECT_EQ(changed.sets.test_cases, 7);  // asked for, so done
  EXPECT_THAT(changed.problem->description().variables, SizeIs(3));
}

}  // namespace
}  // namespace armwright
