// Perturbed plants: how they are drawn, and how the tracking problem simulates them.
#include "problems/tracking/perturbation.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "problems/config/config_files.hpp"
#include "problems/config/problem_readers.hpp"
#include "problems/load_tracking.hpp"
#include "problems/problem_folder.hpp"

namespace armwright {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

Perturbation make_everything() {
  Perturbation p;
  p.mass_relative = 0.1;
  p.load_kg = {5, 40};
  p.viscous_friction_n_m_s_per_rad = {1, 2, 3, 4};
  p.coulomb_friction_n_m = {5, 6, 7, 8};
  p.quantisation_rad = 1e-4;
  p.delay_s = 0.01;
  p.torque_ripple_relative = 0.02;
  p.effort_limit_sigma = 0.2;
  p.gain_sigma = 0.1;
  return p;
}

Plant draw(const Perturbation& p, std::string_view set, std::uint64_t number) {
  return draw_plant(p, 4, 0.001, set, number);
}

TEST(DrawnPlant, IsAFunctionOfTheNamesAndTheNumber) {
  Perturbation p = make_everything();
  const Plant plant = draw(p, "train/1", 7);
  const Plant again = draw(p, "train/1", 7);
  EXPECT_EQ(again.mass_factors, plant.mass_factors);
  EXPECT_EQ(again.load_kg, plant.load_kg);
  EXPECT_EQ(again.limit_factors, plant.limit_factors);
  EXPECT_EQ(again.gain_factors, plant.gain_factors);
  EXPECT_EQ(again.variation->coulomb_friction, plant.variation->coulomb_friction);
  EXPECT_EQ(again.variation->ripple_phase_rad, plant.variation->ripple_phase_rad);
  EXPECT_NE(draw(p, "train/1", 8).mass_factors, plant.mass_factors);
  EXPECT_NE(draw(p, "test/2", 7).mass_factors, plant.mass_factors);
  p.set = "plant/2";
  EXPECT_NE(draw(p, "train/1", 7).mass_factors, plant.mass_factors);
}

TEST(DrawnPlant, KindsDoNotShiftEachOther) {
  Perturbation everything = make_everything();
  everything.friction_relative = 0.5;
  everything.armature_relative = 0.4;
  everything.stiffness_relative = 0.3;
  everything.viscous_friction_share = 0.1;
  everything.efforts = {10, 20, 30, 40};
  const Plant all = draw(everything, "train/1", 3);
  const Plant of_version_1 = draw(make_everything(), "train/1", 3);
  EXPECT_EQ(all.gain_factors, of_version_1.gain_factors);
  EXPECT_EQ(all.variation->ripple_phase_rad, of_version_1.variation->ripple_phase_rad);
  EXPECT_THAT(of_version_1.friction_factors, ElementsAre(1, 1, 1, 1));
  Perturbation armatures;
  armatures.armature_relative = 0.4;
  EXPECT_EQ(draw(armatures, "train/1", 3).armature_factors, all.armature_factors);
  Perturbation masses;
  masses.mass_relative = 0.1;
  EXPECT_EQ(draw(masses, "train/1", 3).mass_factors, all.mass_factors);
  Perturbation gains;
  gains.gain_sigma = 0.1;
  EXPECT_EQ(draw(gains, "train/1", 3).gain_factors, all.gain_factors);
  EXPECT_THAT(draw(gains, "train/1", 3).limit_factors, ElementsAre(1, 1, 1, 1));
}

// The moments of the numbers of 4000 plants are right within five standard errors.
TEST(DrawnPlant, NumbersHaveTheirDistributions) {
  constexpr int kPlants = 4000;
  double masses = 0;
  double squares = 0;
  double loads = 0;
  double limits = 0;
  double friction = 0;
  double ripple = 0;
  double delays = 0;
  double gains = 0;
  double gain_squares = 0;
  for (int i = 0; i < kPlants; ++i) {
    const Plant plant = draw(make_everything(), "train/1", static_cast<std::uint64_t>(i));
    for (const double factor : plant.mass_factors) {
      EXPECT_GE(factor, 0.9);
      EXPECT_LE(factor, 1.1);
      masses += factor / (4 * kPlants);
      squares += (factor - 1) * (factor - 1) / (4 * kPlants);
    }
    EXPECT_GE(*plant.load_kg, 5);
    EXPECT_LE(*plant.load_kg, 40);
    loads += *plant.load_kg / kPlants;
    const PlantVariation& variation = *plant.variation;
    EXPECT_EQ(variation.quantum, 1e-4);
    EXPECT_GE(variation.delay_substeps, 0);
    EXPECT_LE(variation.delay_substeps, 10);
    delays += static_cast<double>(variation.delay_substeps) / kPlants;
    friction += variation.coulomb_friction[3] / kPlants;
    ripple += variation.torque_ripple[1] / kPlants;
    for (std::size_t joint = 0; joint < 4; ++joint) {
      EXPECT_LE(plant.limit_factors[joint], 1);
      limits += std::log(plant.limit_factors[joint]) / (4 * kPlants);
      const double gain = std::log(plant.gain_factors[joint][2]);
      gains += gain / (4 * kPlants);
      gain_squares += gain * gain / (4 * kPlants);
    }
  }
  const double numbers = 4 * kPlants;
  EXPECT_NEAR(masses, 1, 5 * 0.1 / std::sqrt(3 * numbers));
  EXPECT_NEAR(squares, 0.01 / 3, 5 * 0.01 * std::sqrt(4.0 / 45 / numbers));
  EXPECT_NEAR(loads, 22.5, 5 * 35 / std::sqrt(12.0 * kPlants));
  EXPECT_NEAR(limits, -0.2 * std::sqrt(2 / M_PI), 5 * 0.2 / std::sqrt(numbers));
  EXPECT_NEAR(friction, 4, 5 * 8 / std::sqrt(12.0 * kPlants));
  EXPECT_NEAR(ripple, 0.01, 5 * 0.02 / std::sqrt(12.0 * kPlants));
  EXPECT_NEAR(delays, 5, 5 * 10 / std::sqrt(12.0 * kPlants));  // of 10 ms in substeps of 1 ms
  EXPECT_NEAR(gains, 0, 5 * 0.1 / std::sqrt(numbers));
  EXPECT_NEAR(gain_squares, 0.01, 5 * 0.01 * std::sqrt(2 / numbers));
}

TEST(DrawnPlant, ChangesLinkByLink) {
  const RobotModel nominal = load_urdf(ARMWRIGHT_CONFIGS "/robots/irb4600_40_255.urdf");
  const Plant plant = draw(make_everything(), "train/1", 0);
  const RobotModel arm = plant.make_arm(nominal);
  for (std::size_t i = 0; i < 4; ++i) {
    const Inertial& before = nominal.links[i].inertial;
    const Inertial& after = arm.links[i].inertial;
    EXPECT_EQ(after.mass_kg, before.mass_kg * plant.mass_factors[i]);
    EXPECT_EQ(after.inertia_kg_m2, before.inertia_kg_m2 * plant.mass_factors[i]);
    EXPECT_EQ(after.com_m, before.com_m);
  }
  EXPECT_EQ(std::set(plant.mass_factors.begin(), plant.mass_factors.end()).size(), 4U);
}

TEST(DrawnPlant, VariesAroundThePlantsOwnValues) {
  RobotModel nominal = load_urdf(ARMWRIGHT_CONFIGS "/robots/irb4600_40_255.urdf");
  for (std::size_t i = 0; i < 4; ++i) {
    JointPlant& own = nominal.joints[i].plant;
    own.armature = 2;
    own.viscous = 3;
    own.coulomb = 5;
    own.offset = -7;
    own.stiffness = 11;
  }
  Perturbation p;
  p.friction_relative = 0.5;
  p.armature_relative = 0.4;
  p.stiffness_relative = 0.3;
  p.coulomb_friction_share = 0.1;
  p.efforts = {10, 20, 30, 40};
  std::set<double> factors;
  for (std::uint64_t number = 0; number < 100; ++number) {
    const Plant plant = draw(p, "train/1", number);
    const RobotModel arm = plant.make_arm(nominal);
    for (std::size_t i = 0; i < 4; ++i) {
      const JointPlant& joint = arm.joints[i].plant;
      const double friction = plant.friction_factors[i];
      EXPECT_GE(friction, 0.5);
      EXPECT_LE(friction, 1.5);
      EXPECT_GE(joint.armature, 2 * 0.6);
      EXPECT_LE(joint.armature, 2 * 1.4);
      EXPECT_GE(joint.stiffness, 11 * 0.7);
      EXPECT_LE(joint.stiffness, 11 * 1.3);
      EXPECT_EQ(joint.viscous, 3 * friction);
      EXPECT_EQ(joint.offset, -7 * friction);
      EXPECT_GE(joint.coulomb - 5 * friction, 0);
      EXPECT_LE(joint.coulomb - 5 * friction, 0.1 * p.efforts[i]);
      factors.insert({friction, joint.armature, joint.stiffness});
    }
    EXPECT_FALSE(plant.variation);
  }
  EXPECT_EQ(factors.size(), 3U * 4 * 100);
}

TEST(DrawnPlant, ChangesGainsAndLimitsOfEveryJoint) {
  const Plant plant = draw(make_everything(), "train/1", 0);
  ArmDesign design;
  design.joints.assign(4, {{2, 3, 5}, {-7, 11}});
  plant.change_design(design);
  for (std::size_t i = 0; i < 4; ++i) {
    const JointDrive& joint = design.joints[i];
    const std::vector<double>& factors = plant.gain_factors[i];
    EXPECT_THAT(joint.gains, ElementsAre(2 * factors[0], 3 * factors[1], 5 * factors[2]));
    EXPECT_EQ(joint.limits.min, -7 * plant.limit_factors[i]);
    EXPECT_EQ(joint.limits.max, 11 * plant.limit_factors[i]);
  }
}

class PerturbedProblem : public testing::Test {
 protected:
  static std::shared_ptr<const TrackingProblem> load(std::vector<std::string> overrides) {
    overrides.insert(overrides.begin(), {"physics.engine=articulated", "workspace.points=4"});
    return load_tracking("q1-complex", overrides);
  }
  static double track(const TrackingProblem& problem, std::uint64_t number) {
    return problem.track(problem.config().start, problem.get_set("test/2"), number).mean_error_m;
  }
  static CaseOutcome simulate(const TrackingProblem& problem, CaseRole role, const std::string& set,
                              std::uint64_t number, bool jacobian = false) {
    const std::vector<double> x = problem.make_vector(problem.config().start);
    const CaseBlock block{role, set, {number}};
    const CaseJob job{
        .x = x, .block = &block, .number = number, .residuals = jacobian, .jacobian = jacobian};
    return problem.simulate({&job, 1}).front();
  }
};

// A plant's masses, load, limits and gains act like the same numbers in robot, task and design.
TEST_F(PerturbedProblem, SimulatesThePlantThatWasDrawn) {
  const auto problem = load({"perturbation.mass_relative=0.2", "perturbation.load_kg=[1,30]",
                             "perturbation.effort_limit_sigma=1", "perturbation.gain_sigma=0.2"});
  const TrackingConfig& config = problem->config();
  for (const std::uint64_t number : {0U, 5U}) {
    const Plant plant = draw_plant(config.perturbation, 4, 0.01, "test/2", number);
    TrackingConfig nominal = config;
    nominal.perturbation = {};
    nominal.robot = plant.make_arm(config.robot);
    nominal.task.load_kg = *plant.load_kg;
    plant.change_design(nominal.start);
    const TrackingProblem alike(nominal);
    EXPECT_EQ(track(*problem, number), track(alike, number));
    EXPECT_EQ(simulate(*problem, CaseRole::test, "test/2", number).error,
              simulate(alike, CaseRole::test, "test/2", number).error);
    EXPECT_NE(track(*problem, number), track(*load({}), number));
  }
}

TEST_F(PerturbedProblem, AppliesWhereItSays) {
  const auto nominal = load({});
  for (const std::string where : {"training", "judging", "everywhere"}) {
    SCOPED_TRACE(where);
    const auto problem = load({"perturbation.mass_relative=0.2", "perturbation.apply_to=" + where});
    const auto is_nominal = [&](CaseRole role) {
      return simulate(*problem, role, "test/2", 1).error ==
             simulate(*nominal, role, "test/2", 1).error;
    };
    EXPECT_EQ(is_nominal(CaseRole::training), where == "judging");
    EXPECT_EQ(is_nominal(CaseRole::validation), where == "training");
    EXPECT_EQ(is_nominal(CaseRole::test), where == "training");
    EXPECT_EQ(track(*problem, 1) == track(*nominal, 1), where == "training");
  }
}

// Every kind of perturbation alone changes the error, in lanes and in a single arm.
TEST_F(PerturbedProblem, EveryKindCountsInEveryEngine) {
  const std::vector<std::vector<std::string>> kinds = {
      {"perturbation.mass_relative=0.3"},
      {"perturbation.load_kg=[10,40]"},
      {"perturbation.viscous_friction_n_m_s_per_rad=[400,400,200,2]"},
      {"perturbation.coulomb_friction_n_m=[400,400,200,1]",
       "perturbation.friction_transition_rad_per_s=1"},
      {"perturbation.quantisation_rad=0.001"},
      {"perturbation.delay_s=0.004"},
      {"perturbation.torque_ripple_relative=0.2", "perturbation.ripple_cycles_per_turn=20"},
      {"perturbation.gain_sigma=0.3"}};
  const std::vector<std::string> task = {"physics.substeps=10", "objective.kind=error"};
  const double nominal = track(*load(task), 1);
  for (const std::vector<std::string>& kind : kinds) {
    SCOPED_TRACE(kind.front());
    std::vector<std::string> overrides = task;
    overrides.insert(overrides.end(), kind.begin(), kind.end());
    const double lanes = track(*load(overrides), 1);
    EXPECT_GT(std::abs(lanes / nominal - 1), 1e-4);
    overrides.emplace_back("physics.engine=ode");
    EXPECT_NEAR(track(*load(overrides), 1), lanes, 0.01 * lanes);
  }
}

TEST_F(PerturbedProblem, HasNoDerivativesUnderWhatLoopsAdd) {
  for (const std::string key : {"delay_s=0.004", "quantisation_rad=1e-4",
                                "torque_ripple_relative=0.1", "coulomb_friction_n_m=[1,1,1,0.1]"}) {
    const auto problem = load({"perturbation." + key});
    EXPECT_FALSE(problem->description().has_jacobian);
    EXPECT_THAT(problem->description().jacobian_advice, HasSubstr("apply_to to judging"));
    EXPECT_TRUE(
        load({"perturbation." + key, "perturbation.apply_to=judging"})->description().has_jacobian);
  }
}

TEST_F(PerturbedProblem, CountsTheDesignsOwnTorque) {
  const auto problem = load({"perturbation.effort_limit_sigma=1"});
  const std::vector<double> x = problem->make_vector(problem->config().start);
  const Evaluation evaluation = problem->evaluate(x, {CaseRole::training, "train/1", {0, 1}});
  EXPECT_EQ(evaluation.metrics.at(1), calc_total_effort(problem->config().start));
}

// Compares the exact derivatives of a perturbed plant with central differences.
TEST_F(PerturbedProblem, DerivativesAreThoseOfThePlant) {
  const auto problem = load({"perturbation.mass_relative=0.2", "perturbation.gain_sigma=0.3"});
  ASSERT_TRUE(problem->description().has_jacobian);
  const std::vector<double> x = problem->make_vector(problem->config().start);
  const CaseBlock block{CaseRole::training, "train/1", {2}};
  const Evaluation exact = problem->evaluate(x, block, true);
  ASSERT_EQ(exact.jacobian.size(), exact.residuals.size() * x.size());
  for (const std::size_t variable : {0U, 5U, 10U}) {  // P of three joints
    constexpr double kStep = 1e-5;
    std::vector<double> up = x;
    std::vector<double> down = x;
    up[variable] *= 1 + kStep;
    down[variable] *= 1 - kStep;
    const Evaluation above = problem->evaluate(up, block);
    const Evaluation below = problem->evaluate(down, block);
    for (std::size_t row = 0; row < exact.residuals.size(); ++row) {
      const double slope =
          (above.residuals[row] - below.residuals[row]) / (2 * kStep * x[variable]);
      EXPECT_NEAR(exact.jacobian[row * x.size() + variable], slope, 1e-4 * std::abs(slope) + 1e-12);
    }
  }
}

TEST(PerturbationTable, PresetIsReadAndKeysBesideItGoFirst) {
  const ProblemFolder folder;
  folder.write("mine.toml", "mass_relative = 0.3\ngain_sigma = 0.2\n");
  folder.write("p.toml",
               "extends = \"base\"\n[perturbation]\npreset = \"mine.toml\"\ngain_sigma = 0.5\n");
  const LoadedProblem loaded = folder.load("p.toml");
  const Perturbation& p = loaded.tracking()->config().perturbation;
  EXPECT_EQ(p.mass_relative, 0.3);
  EXPECT_EQ(p.gain_sigma, 0.5);
  EXPECT_TRUE(loaded.input_hashes.contains("mine.toml"));
  EXPECT_THAT(loaded.resolved_json, HasSubstr("\"mass_relative\":0.3"));
  EXPECT_THAT(loaded.resolved_json, HasSubstr("\"gain_sigma\":0.5"));
  EXPECT_THAT(loaded.resolved_json, Not(HasSubstr("mine")));
}

TEST(PerturbationTable, IsNothingByDefault) {
  const LoadedProblem loaded = load_problem("q1-complex");
  EXPECT_FALSE(loaded.tracking()->config().perturbation.changes_anything());
  EXPECT_THAT(loaded.resolved_json, Not(HasSubstr("perturbation")));
}

// The shipped presets without those for robots whose plant was identified.
std::vector<std::string> list_usual_presets() {
  std::vector<std::string> names = list_configs("perturbations");
  EXPECT_EQ(std::erase_if(names, [](const auto& name) { return name.starts_with("identified"); }),
            2u);
  return names;
}

TEST(PerturbationTable, ShippedPresetsAreRead) {
  for (const std::string& name : list_usual_presets()) {
    const std::vector<std::string> overrides = {"perturbation.preset=" + name};
    EXPECT_TRUE(
        load_problem("q1-complex", overrides).tracking()->config().perturbation.changes_anything());
  }
}

// The numbers per joint are for the thesis's arm, as in version 1.0; other arms get shares.
TEST(PerturbationTable, ShippedPresetsSuitEveryRobot) {
  const std::vector<std::string> all = {"perturbation.preset=all"};
  const LoadedProblem thesis = load_problem("q1-complex", all);
  const Perturbation& own = thesis.tracking()->config().perturbation;
  EXPECT_THAT(own.viscous_friction_n_m_s_per_rad, ElementsAre(60, 120, 40, 0.5));
  EXPECT_THAT(own.coulomb_friction_n_m, ElementsAre(100, 200, 60, 0.2));
  EXPECT_EQ(own.load_kg, std::pair(0.0, 40.0));
  EXPECT_EQ(own.coulomb_friction_share, 0);
  EXPECT_THAT(thesis.resolved_json, Not(HasSubstr("share")));
  EXPECT_TRUE(thesis.input_hashes.contains("all.toml"));
  EXPECT_FALSE(thesis.input_hashes.contains("_all.toml"));
  for (const std::string name : {"arm7", "planar2", "irb4600_six"}) {
    const std::vector<std::string> overrides = {"perturbation.preset=all", "robot.urdf=" + name};
    const LoadedProblem loaded = load_problem("robot", overrides);
    const TrackingConfig& config = loaded.tracking()->config();
    const Perturbation& p = config.perturbation;
    EXPECT_TRUE(p.viscous_friction_n_m_s_per_rad.empty());
    EXPECT_EQ(p.coulomb_friction_share, 0.02);
    ASSERT_EQ(p.efforts.size(), config.robot.joint_count());
    for (std::size_t i = 0; i < p.efforts.size(); ++i) {
      EXPECT_EQ(p.efforts[i], config.start.joints[i].limits.max);
    }
    double mass_kg = 0;
    for (const Link& link : config.robot.links) {
      mass_kg += link.inertial.mass_kg;
    }
    EXPECT_NEAR(p.load_kg->second, 0.1 * mass_kg, 1e-12 * mass_kg);
    EXPECT_THAT(loaded.resolved_json, Not(HasSubstr("load_kg")));
    EXPECT_TRUE(loaded.input_hashes.contains("_all.toml"));
    EXPECT_FALSE(loaded.input_hashes.contains("all.toml"));
    const LoadedProblem again = load_recorded_problem(loaded.resolved_json, loaded.name, "");
    EXPECT_EQ(again.tracking()->config().perturbation, p);
    EXPECT_EQ(again.resolved_json, loaded.resolved_json);
  }
}

// A run's inputs have hashes. With other bytes, runs of version 1.0 could not be resumed.
TEST(PerturbationWords, NameWhatDiffersInTheCasesOfARole) {
  Perturbation p = make_everything();
  p.where = Perturbation::Where::judging;
  EXPECT_EQ(describe_plants(p, CaseRole::training), "");
  EXPECT_EQ(describe_plants(p, CaseRole::test),
            "masses +- 10 %, load 5 to 40 kg, friction added at the joints, encoder steps of "
            "0.0001 rad, delay up to 10 ms, torque ripple up to 2 %, effort limits reduced, sigma "
            "20 %, gains off, sigma 10 %");
  EXPECT_EQ(describe_plants(Perturbation{}, CaseRole::test), "");
}

TEST(PerturbationTable, PresetsOfTheThesisKeepTheBytesOfVersion1) {
  const std::pair<std::string, std::string> hashes[] = {
      {"all", "517872b4859e6315bad39cc3afb569237f191b16ea001a7dbd1dca6bcc6a5c98"},
      {"friction", "11e333d5277bb85c9c2336eb9fe033b033f7e3a9335e782c6c7ba48646b539db"},
      {"load-0-40", "1f48a9312f98c751572c2be7aa66609088ba7ec3084559139a079b75bbbe5618"}};
  for (const auto& [name, hash] : hashes) {
    const std::vector<std::string> preset = {"perturbation.preset=" + name};
    EXPECT_EQ(load_problem("q1-complex", preset).input_hashes.at(name + ".toml"), hash);
  }
}

// For the thesis's arm and for others.
TEST(PerturbationTable, AllIsTheFivePresetsTogether) {
  for (const std::string robot : {"irb4600_40_255", "irb4600_six"}) {
    SCOPED_TRACE(robot);
    const auto load_with = [&](const std::string& preset) {
      const std::vector<std::string> overrides = {
          "perturbation.preset=" + preset, "robot.urdf=" + robot, "workspace.centre_m=[1.4,0,0.9]",
          "workspace.radius_m=0.3"};
      return load_problem("robot", overrides).tracking()->config().perturbation;
    };
    Perturbation together = load_with("friction");
    together.mass_relative = load_with("masses-10").mass_relative;
    together.load_kg = load_with("load-0-40").load_kg;
    together.load_share = load_with("load-0-40").load_share;
    together.quantisation_rad = load_with("sensor").quantisation_rad;
    together.delay_s = load_with("sensor").delay_s;
    together.torque_ripple_relative = load_with("ripple").torque_ripple_relative;
    together.ripple_cycles_per_turn = load_with("ripple").ripple_cycles_per_turn;
    EXPECT_EQ(load_with("all"), together);
  }
}

// A load beside the preset in another form than there, and the same for friction. The record says
// the same as the file.
TEST(PerturbationTable, KeysBesideAPresetReplaceItsOtherForm) {
  const auto load_with = [](const std::string& robot, std::vector<std::string> keys) {
    for (std::string& key : keys) {
      key = "perturbation." + key;
    }
    keys.push_back("robot.urdf=" + robot);
    if (robot != "planar2") {  // none has to be proposed
      keys.insert(keys.end(), {"workspace.centre_m=[1.4,0,0.9]", "workspace.radius_m=0.3"});
    }
    const LoadedProblem loaded = load_problem("robot", keys);
    const Perturbation& p = loaded.tracking()->config().perturbation;
    const LoadedProblem again = load_recorded_problem(loaded.resolved_json, loaded.name, "");
    EXPECT_EQ(again.tracking()->config().perturbation, p);
    EXPECT_EQ(again.resolved_json, loaded.resolved_json);
    return p;
  };
  using Load = std::optional<std::pair<double, double>>;
  const std::string thesis = "irb4600_40_255";
  for (const std::string preset : {"preset=load-0-40", "preset=all"}) {
    SCOPED_TRACE(preset);
    const Perturbation kg = load_with("irb4600_six", {preset, "load_kg=[0,5]"});
    EXPECT_EQ(kg.load_kg, Load({0, 5}));
    EXPECT_EQ(kg.load_share, Load());
    const Perturbation share = load_with(thesis, {preset, "load_share=[0,0.2]"});
    EXPECT_EQ(share.load_share, Load({0, 0.2}));
    EXPECT_NE(share.load_kg, Load({0, 40}));
    EXPECT_EQ(load_with("irb4600_six", {preset, "load_share=[]"}).load_kg, Load());
    EXPECT_EQ(load_with("irb4600_six", {preset, "load_kg=[]"}).load_kg, Load());
    EXPECT_EQ(load_with(thesis, {preset, "load_share=[]"}).load_kg, Load());
  }
  const Perturbation own =
      load_with("planar2", {"preset=friction", "viscous_friction_n_m_s_per_rad=[3,4]"});
  EXPECT_EQ(own.viscous_friction_share, 0);
  EXPECT_EQ(own.coulomb_friction_share, 0.02);
  EXPECT_EQ(load_with("planar2", {"preset=all", "coulomb_friction_n_m=[]"}).coulomb_friction_share,
            0);
  const Perturbation shares = load_with(
      thesis, {"preset=friction", "viscous_friction_share=0.1", "coulomb_friction_share=0.2"});
  EXPECT_TRUE(shares.viscous_friction_n_m_s_per_rad.empty());
  EXPECT_TRUE(shares.coulomb_friction_n_m.empty());
}

// Every key of a preset survives being written as overrides and read back.
TEST(PerturbationTable, OverridesSayEverything) {
  for (const std::string& name : list_usual_presets()) {
    SCOPED_TRACE(name);
    const LoadedProblem thesis = load_problem("q1-complex");
    const TrackingConfig& config = thesis.tracking()->config();
    const Perturbation p = load_perturbation(name, {config.robot, config.start});
    std::vector<std::string> overrides = {"perturbation.preset=all", "perturbation.gain_sigma=1"};
    const auto keys = make_overrides(p);
    overrides.insert(overrides.end(), keys.begin(), keys.end());
    const Perturbation read =
        load_problem("q1-complex", overrides).tracking()->config().perturbation;
    EXPECT_EQ(make_overrides(read), keys);
    EXPECT_EQ(read.changes_arm(), p.changes_arm());
    EXPECT_EQ(read.changes_loop(), p.changes_loop());
    EXPECT_EQ(read.changes_design(), p.changes_design());
  }
}

TEST(PerturbationTable, MistakesAreNamed) {
  const ProblemFolder folder;
  const auto refusal_of = [&](const std::string& line) {
    return folder.refusal_of_base_with("[perturbation]\n" + line);
  };
  EXPECT_THAT(refusal_of("load_kg = [40, 0]"),
              HasSubstr("p.toml:3: perturbation.load_kg is [40, 0]; it must be two numbers"));
  EXPECT_THAT(refusal_of("load_kg = [-1, 0]"), HasSubstr("perturbation.load_kg"));
  EXPECT_THAT(refusal_of("load_kg = [0, 4]\nload_share = [0, 0.1]"),
              HasSubstr("p.toml:4: perturbation.load_share is [0, 0.1]; load_kg is given, too"));
  EXPECT_THAT(refusal_of("friction_relative = 0.95"),
              HasSubstr("friction_relative is 0.95; it must be a finite number >= 0 and <= 0.9"));
  EXPECT_THAT(refusal_of("coulomb_friction_n_m = [1, 2]"),
              HasSubstr("p.toml:3: perturbation.coulomb_friction_n_m is [1, 2]; it must hold 4 "
                        "numbers, one a joint, or none"));
  EXPECT_THAT(refusal_of("quantisation_rad = 1e-9"), HasSubstr("0 (none) or at least 1e-6"));
  EXPECT_THAT(refusal_of("ripple_cycles_per_turn = 2.5"), HasSubstr("ripple_cycles_per_turn"));
  EXPECT_THAT(refusal_of("friction_transition_rad_per_s = 0"), HasSubstr("friction_transition"));
  EXPECT_THAT(refusal_of("mass_relative = 1"), HasSubstr("p.toml:3: perturbation.mass_relative"));
  EXPECT_THAT(refusal_of("effort_limit_sigma = -0.1"), HasSubstr("effort_limit_sigma is -0.1"));
  EXPECT_THAT(refusal_of("set = \"train/1\""), HasSubstr("must be named plant/ID"));
  EXPECT_THAT(refusal_of("apply_to = \"test\""), HasSubstr("training, judging, everywhere"));
  EXPECT_THAT(refusal_of("mass_relativ = 0.1"), HasSubstr("mass_relative"));
  EXPECT_THAT(refusal_of("preset = \"mases-10\""), HasSubstr("masses-10"));
  folder.write("bad.toml", "mass_relative = 0.1\ngain_sigmas = 0.1\n");
  EXPECT_THAT(refusal_of("preset = \"bad.toml\""),
              HasSubstr("bad.toml:2: unknown key gain_sigmas"));
}

}  // namespace
}  // namespace armwright
