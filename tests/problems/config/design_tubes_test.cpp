// Tracking problems whose links are tubes: variables, masses, deflection, and what is refused.
#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "problems/load_tracking.hpp"
#include "problems/problem_folder.hpp"
#include "sim/robot/tube.hpp"
#include "sim/tracking/designed_arm.hpp"

namespace armwright {
namespace {

using testing::HasSubstr;
using testing::Not;

const std::vector<std::string> kTubes = {
    "physics.engine=articulated", "tubes.diameter_m=[0.35,0.3,0.25,0.2]", "tubes.wall_m=[0.02]",
    "tubes.density_kg_per_m3=7850", "tubes.youngs_modulus_pa=2.1e11"};
const std::vector<std::string> kSizes = {
    R"(variables.optimize=["p","length_scale","tube_diameter","tube_wall"])",
    "tubes.diameter_bounds_m=[0.15,0.45]", "tubes.wall_bounds_m=[0.008,0.04]",
    "tubes.deflection_limit_m=0.002"};

std::vector<std::string> join_settings(std::vector<std::string> settings,
                                       const std::vector<std::string>& others) {
  settings.insert(settings.end(), others.begin(), others.end());
  return settings;
}

const CaseBlock kFirstTubeCase{CaseRole::training, "train/1", {0}};

TEST(DesignTubes, AreVariablesInMetresPerJoint) {
  const auto problem = load_tracking("co-design", join_settings(kTubes, kSizes));
  const auto& variables = problem->description().variables;
  ASSERT_EQ(variables.size(), 16u);
  EXPECT_EQ(variables[6].name, "joint_2.tube_diameter");
  EXPECT_EQ(variables[6].unit, "m");
  EXPECT_EQ(variables[6].lower, 0.15);
  EXPECT_EQ(variables[6].start, 0.3);
  EXPECT_EQ(variables[6].upper, 0.45);
  EXPECT_EQ(variables[6].scale, Scale::linear);
  EXPECT_EQ(variables[7].name, "joint_2.tube_wall");
  EXPECT_EQ(variables[7].start, 0.02);
  std::vector<double> x = get_start(*problem);
  x[6] = 0.4;
  x[7] = 0.03;
  const ArmDesign design = problem->make_design(x);
  EXPECT_EQ(design.joints[1].tube, (Tube{0.4, 0.03}));
  EXPECT_EQ(design.joints[0].tube, (Tube{0.35, 0.02}));
  EXPECT_EQ(problem->make_vector(design), x);
  EXPECT_FALSE(problem->description().has_jacobian);
}

TEST(DesignTubes, GiveTheMassesTheMetricsAndTheConstraint) {
  const auto problem = load_tracking("co-design", join_settings(kTubes, kSizes));
  std::vector<double> x = get_start(*problem);
  x[5] = 1.1;  // the length of link 2
  x[6] = 0.4;
  x[7] = 0.03;
  const Evaluation evaluation = problem->evaluate(x, kFirstTubeCase);
  const std::vector<Tube> tubes = {{0.35, 0.02}, {0.4, 0.03}, {0.25, 0.02}, {0.2, 0.02}};
  const TrackingConfig& config = problem->config();
  std::vector<double> lengths_m;
  double mass_kg = config.task.load_kg;
  const ArmDesign design = problem->make_design(x);
  for (std::size_t i = 0; i < 4; ++i) {
    lengths_m.push_back((i == 1 ? 1.1 : 1) * get_link_length_m(config.robot, i));
    const double pipe_kg = 7850 * tubes[i].section_m2() * lengths_m[i];
    EXPECT_NEAR(
        make_robot(config.robot, design, 0, config.tubes.material).links[i].inertial.mass_kg,
        pipe_kg, 1e-12 * pipe_kg);
    mass_kg += pipe_kg;
  }
  for (std::size_t i = 1; i < 4; ++i) {  // the motors of the joints after the first
    mass_kg += calc_largest_effort(design.joints[i]) / config.torque_per_mass_n_m_per_kg;
  }
  const double deflection_m = calc_deflection_m(
      tubes, lengths_m, TubeMaterial{.youngs_modulus_pa = 2.1e11, .density_kg_per_m3 = 7850},
      config.task.load_kg, config.task.physics.gravity_m_per_s2);
  const auto get = [&](const std::string& name) {
    const auto& metrics = problem->description().metrics;
    for (std::size_t i = 0; i < metrics.size(); ++i) {
      if (metrics[i].name == name) {
        return evaluation.metrics.at(i);
      }
    }
    ADD_FAILURE() << "no metric " << name;
    return 0.0;
  };
  ASSERT_EQ(evaluation.metrics.size(), problem->description().metrics.size());
  EXPECT_NEAR(get("moving_mass"), mass_kg, 1e-10 * mass_kg);
  EXPECT_NEAR(get("deflection"), deflection_m, 1e-12 * deflection_m);
  ASSERT_EQ(problem->description().limits.size(), 1u);
  EXPECT_EQ(problem->description().constraints[0].name, "deflection / limit - 1");
  ASSERT_EQ(evaluation.constraint_values.size(), 1u);
  EXPECT_NEAR(evaluation.constraint_values[0], deflection_m / 0.002 - 1, 1e-10);
}

TEST(DesignTubes, GiveMassAndDeflectionToAFront) {
  const auto problem = load_tracking(
      "co-design", join_settings(join_settings(kTubes, kSizes),
                                 {"objective.kind=front", "objective.energy_weight=0",
                                  R"(objective.quantities=["error","moving_mass","deflection"])"}));
  const ArmDesign start = problem->config().start;
  const Evaluation evaluation = problem->evaluate(get_start(*problem), kFirstTubeCase);
  ASSERT_EQ(evaluation.objectives.size(), 3u);
  EXPECT_EQ(evaluation.objectives[1],
            calc_moving_mass_kg(problem->make_robot(start)) + problem->config().task.load_kg);
  EXPECT_EQ(evaluation.objectives[2], problem->calc_deflection_m(start));
  EXPECT_EQ(problem->description().objectives[2].unit, "m");
  const std::vector<double> penalty = problem->penalty_objectives();
  EXPECT_GT(penalty[2], 100 * evaluation.objectives[2]);
}

// The problem's own tubes need no setup of their own, and a thicker tube is another arm.
TEST(DesignTubes, OfADesignReplaceThoseOfTheProblem) {
  const auto problem =
      load_tracking("co-design", join_settings(kTubes, {R"(variables.optimize=["p"])"}));
  const ArmDesign own = problem->config().start;
  EXPECT_EQ(own.joints[3].tube, (Tube{0.2, 0.02}));
  ArmDesign bare = own;
  for (JointDrive& joint : bare.joints) {
    joint.tube = {};
  }
  const auto track = [&](const ArmDesign& design) {
    return problem->track(design, problem->get_set("test/1"), 0).point_error_m;
  };
  EXPECT_EQ(track(own), track(bare));
  EXPECT_EQ(problem->make_robot(own).links[2].inertial.mass_kg,
            problem->make_robot(bare).links[2].inertial.mass_kg);
  ArmDesign thick = own;
  thick.joints[2].tube.wall_m = 0.03;
  EXPECT_NE(track(thick), track(own));
  // A wall above the radius makes a bar.
  ArmDesign bar = own, thicker = own;
  bar.joints[2].tube = {0.25, 0.125};
  thicker.joints[2].tube = {0.25, 0.2};
  EXPECT_EQ(problem->make_robot(bar).links[2].inertial.mass_kg,
            problem->make_robot(thicker).links[2].inertial.mass_kg);
  EXPECT_EQ(problem->calc_deflection_m(bar), problem->calc_deflection_m(thicker));
}

TEST(DesignTubes, AreWrittenOnlyWhereTheyAre) {
  const ProblemFolder folder;
  DesignFile file = load_design("table-a10");
  EXPECT_THAT(to_toml(file), Not(HasSubstr("tube")));
  file.design.joints[1].tube = {0.1, 0.0031};
  folder.write("d.toml", to_toml(file));
  const DesignFile again = load_design(folder.path("d.toml"));
  EXPECT_EQ(again.design.joints[0].tube, Tube{});
  EXPECT_EQ(again.design.joints[1].tube, (Tube{0.1, 0.0031}));
  EXPECT_EQ(to_toml(again), to_toml(file));
}

TEST(DesignTubes, AbsentKeysAreNotRecorded) {
  const LoadedProblem plain = load_problem("co-design");
  EXPECT_THAT(plain.resolved_json, Not(HasSubstr("tube")));
  for (const Quantity& metric : plain.problem->description().metrics) {
    EXPECT_NE(metric.name, "deflection");
  }
}

struct BadTubes {
  const char* name;
  std::vector<std::string> overrides;
  const char* message;
};
class BadTubesTest : public testing::TestWithParam<BadTubes> {};

TEST_P(BadTubesTest, AreRefusedBeforeAnythingRuns) {
  EXPECT_THAT(usage_error_of([&] { load_problem("co-design", GetParam().overrides); }),
              HasSubstr(GetParam().message));
}

INSTANTIATE_TEST_SUITE_P(
    All, BadTubesTest,
    testing::Values(
        BadTubes{"SizesWithoutTubes",
                 {R"(variables.optimize=["tube_wall"])"},
                 "the links are no tubes; add [tubes], or leave out 'tube_wall'"},
        BadTubes{"SizesWithoutBounds",
                 join_settings(kTubes, {R"(variables.optimize=["tube_diameter"])"}),
                 "'tube_diameter' has no bounds; add tubes.diameter_bounds_m"},
        BadTubes{"BoundsOfNoVariable",
                 join_settings(kTubes, {R"(variables.optimize=["p"])",
                                        "tubes.wall_bounds_m=[0.002,0.012]"}),
                 "tubes.wall_bounds_m bounds 'tube_wall', which is no variable; add 'tube_wall'"},
        BadTubes{"SectionsOfTubes",
                 join_settings(kTubes, {R"(variables.optimize=["section_scale"])"}),
                 "the links are tubes ([tubes]), so that section_scale cannot be a variable"},
        BadTubes{"AWallThickerThanTheRadius",
                 join_settings(kTubes, {R"(variables.optimize=["p"])", "tubes.wall_m=[0.12]"}),
                 "tubes.wall_m is [0.12]; the wall of link 'link_3' can be 0.12 m, thicker than "
                 "the radius of its tube, 0.1 m; make it thinner"},
        BadTubes{"AWallThatCanBecomeThicker",
                 join_settings(kTubes, {R"(variables.optimize=["tube_wall"])",
                                        "tubes.wall_bounds_m=[0.002,0.13]"}),
                 "the wall of link 'link_2' can be 0.13 m, thicker than the radius of its tube"},
        BadTubes{"AStartOutsideOfItsBounds",
                 join_settings(kTubes, {R"(variables.optimize=["tube_wall"])",
                                        "tubes.wall_bounds_m=[0.03,0.04]"}),
                 "joint_1.tube_wall starts at 0.02 m, outside of tubes.wall_bounds_m, 0.03 to "
                 "0.04 m"},
        BadTubes{
            "LengthsOfMotions",
            join_settings(kTubes, {R"(variables.optimize=["p"])", "tubes.length_bounds_m=[0.1,2]"}),
            "length_scale in variables.optimize makes lengths variables"},
        BadTubes{"MassesOfTheFile",
                 join_settings(kTubes, {R"(variables.optimize=["p"])", "robot.mass_scale=1.1"}),
                 "robot.mass_scale = 1.1 has no effect; leave that out"}),
    [](const auto& instance) { return std::string(instance.param.name); });

TEST(DesignTubes, OfDesignsAreRefusedWhereTheyDoNotFit) {
  const ProblemFolder folder;
  const auto write = [&](const std::string& lines) {
    std::string text;
    for (int i = 0; i < 4; ++i) {
      text += make_joint() + (i == 2 ? lines : "");
    }
    return text;
  };
  EXPECT_THAT(folder.refusal_of_design(write("tube_diameter_m = 0.1\n")),
              HasSubstr("joint[2].tube_wall_m is missing; a tube has tube_diameter_m and "
                        "tube_wall_m; give both or neither"));
  EXPECT_THAT(folder.refusal_of_design(write("tube_diameter_m = 0.1\ntube_wall_m = 0.06\n")),
              HasSubstr("joint[2].tube_wall_m is 0.06; it must be at most 0.05, the radius of the "
                        "tube"));
  folder.write("tubes.toml", write("tube_diameter_m = 0.1\ntube_wall_m = 0.01\n"));
  folder.write("wide.toml", write("section_scale = 1.2\n"));
  const std::string start = "variables.start=\"" + folder.path("tubes.toml") + "\"";
  const std::string wide = "variables.start=\"" + folder.path("wide.toml") + "\"";
  const std::string p = R"(variables.optimize=["p"])";
  EXPECT_THAT(
      usage_error_of([&] {
        load_problem("co-design", std::vector{start, p});
      }),
      HasSubstr("the design makes links tubes (tube_diameter_m), and problem co-design does "
                "not say of which material: add [tubes] to it"));
  EXPECT_THAT(usage_error_of([&] {
                load_problem("co-design", join_settings(kTubes, {wide, p}));
              }),
              HasSubstr("the design has section_scale = 1.2 for joint_3, and the links of problem "
                        "co-design are tubes ([tubes])"));
  EXPECT_THAT(usage_error_of([&] {
                load_problem("co-design",
                             join_settings(kTubes, {start, R"(variables.optimize=["tube_wall"])",
                                                    "tubes.wall_bounds_m=[0.002,0.06]"}));
              }),
              HasSubstr("the wall of link 'link_2' can be 0.06 m, thicker than the radius of its "
                        "tube, 0.05 m; make it thinner in the design, or change the bounds"));
}

// Obstacles see the tubes of a design.
TEST(DesignTubes, AreTheCapsulesThatMustKeepClear) {
  const auto problem = load_tracking(
      "co-design",
      join_settings(kTubes, {R"(variables.optimize=["p"])", "task.limits=warn",
                             "obstacle=[{kind=\"sphere\",centre_m=[9,9,9],radius_m=1}]"}));
  ArmDesign design = problem->config().start;
  EXPECT_EQ(problem->make_task(design).clearance, problem->config().task.clearance);
  design.joints[1].tube.diameter_m = 0.4;
  const auto capsules = problem->make_task(design).clearance->capsules();
  EXPECT_EQ(capsules[2]->radius_m, 0.2);
  EXPECT_EQ(capsules[2]->to_m, problem->config().robot.joints[2].origin.translation());
}

}  // namespace
}  // namespace armwright
