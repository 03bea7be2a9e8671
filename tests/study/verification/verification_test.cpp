// The settings that `verify` and the check of a winner try, and the verdicts, on hand-made numbers.
#include "study/verification/verification.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <limits>

namespace armwright {
namespace {

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

ErrorSummary make_summary(std::vector<double> errors_m) {
  return summarize(errors_m, 0.1);
}

Verdict judge(const std::vector<double>& errors_m, const std::vector<double>& own_m) {
  return judge_setting({}, make_summary(errors_m), make_summary(own_m)).verdict;
}

VerifyMatrix make_matrix(std::vector<std::string> engines) {
  return {std::move(engines), kUsualSubsteps, kUsualPlants, {}};
}
const VerifyMatrix kMatrix = make_matrix({"a", "b", "c"});

TEST(VerifySettings, AreAllCombinationsWithItsOwnFirst) {
  const auto settings = list_verify_settings({"b", 1, 1}, kMatrix);
  ASSERT_EQ(settings.size(), 3u * 4 * 3);
  EXPECT_EQ(settings[0].engine, "b");
  EXPECT_EQ(settings[0].substeps, 1);
  EXPECT_EQ(settings[0].mass_factor, 1);
  for (std::size_t i = 0; i < 12; ++i) {
    EXPECT_EQ(settings[i].engine, "b");
  }
  for (std::size_t i = 0; i < settings.size(); ++i) {
    EXPECT_EQ(std::ranges::count(settings, settings[i]), 1) << i;
  }
}

TEST(VerifySettings, HaveItsOwnInAnyCase) {
  VerifyMatrix matrix = kMatrix;
  EXPECT_EQ(list_verify_settings({"a", 4, 1}, matrix).size(), 1 + 3u * 4 * 3);
  matrix.substeps = {10};
  matrix.plants = {"friction"};
  EXPECT_EQ(list_verify_settings({"a", 10, 1}, matrix).size(), 1 + 3u);
}

TEST(VerifySettings, PresetsAreCombinedOrTriedUnderItsOwnAlone) {
  VerifyMatrix matrix = kMatrix;
  matrix.own_plants = {"friction", "sensor"};
  auto settings = list_verify_settings({"b", 1, 1}, matrix);
  EXPECT_EQ(settings.size(), 3u * 4 * 3 + 2);
  EXPECT_EQ(settings.back(), (VerifySetting{"b", 1, 1, "sensor"}));
  matrix = {{"a", "b"}, {1, 10}, {"none", "friction"}, {}};
  settings = list_verify_settings({"b", 1, 1}, matrix);
  EXPECT_EQ(settings.size(), 8u);
  EXPECT_EQ(std::ranges::count(settings, VerifySetting{"a", 10, 1, "friction"}), 1);
}

// In a problem with perturbed plants of its own, the masses of these plants change, and the nominal
// plant is a setting like others.
TEST(VerifySettings, TellItsOwnPlantsFromTheNominalOne) {
  const VerifySetting own{"a", 1, 1, ""};
  const auto settings = list_verify_settings(own, {{"a"}, {1}, kUsualPlants, {}});
  ASSERT_EQ(settings.size(), 4u);
  EXPECT_EQ(describe_plant(settings[0]), "own");
  EXPECT_EQ(describe_plant(settings[1]), "none");
  EXPECT_EQ(describe_plant(settings[2]), "masses -10 %");
  EXPECT_EQ(settings[2].perturbation, "");
}

TEST(CheckSettings, ChangeOneConditionEach) {
  const std::vector<std::string> engines = {"ode", "articulated", "mujoco"};
  using Settings = std::vector<VerifySetting>;
  EXPECT_EQ(list_check_settings({"articulated", 1, 1}, engines),
            (Settings{{"ode", 1, 1},
                      {"mujoco", 1, 1},
                      {"articulated", 2, 1},
                      {"articulated", 10, 1},
                      {"articulated", 1, 0.9},
                      {"articulated", 1, 1.1},
                      {"articulated", 1, 1, "friction"},
                      {"articulated", 1, 1, "sensor"}}));
  // The slow engine is no second opinion on one that computes in joint coordinates as well.
  const Settings of_mujoco = list_check_settings({"mujoco", 1, 1}, engines);
  EXPECT_EQ(std::ranges::count(of_mujoco, "ode", &VerifySetting::engine), 0);
  EXPECT_EQ(of_mujoco.front().engine, "articulated");
}

TEST(CheckSettings, HaveMoreSubstepsThanItsOwn) {
  const auto list_substeps = [](int own) {
    std::vector<int> substeps;
    for (const VerifySetting& setting : list_check_settings({"ode", own, 1}, {"ode"})) {
      if (setting.substeps != own) {
        substeps.push_back(setting.substeps);
      }
    }
    return substeps;
  };
  EXPECT_THAT(list_substeps(1), testing::ElementsAre(2, 10));
  EXPECT_THAT(list_substeps(4), testing::ElementsAre(10));
  EXPECT_THAT(list_substeps(10), testing::ElementsAre(20));
  EXPECT_THAT(list_substeps(kMostSubsteps), testing::IsEmpty());
}

// A preset takes the place of the problem's own plants; every other condition keeps them.
TEST(CheckSettings, KeepThePlantsOfTheProblem) {
  for (const VerifySetting& setting : list_check_settings({"ode", 1, 1, ""}, {"ode"})) {
    const bool is_preset =
        setting.perturbation == kFrictionPreset || setting.perturbation == kSensorPreset;
    EXPECT_TRUE(is_preset || setting.perturbation.empty()) << setting.perturbation;
  }
}

TEST(VerifyVerdict, FollowsTheMedianAndTheFailures) {
  const std::vector<double> own = {0.001, 0.002, 0.003};
  EXPECT_EQ(judge(own, own), Verdict::holds);
  EXPECT_EQ(judge({0.001, 0.00219, 0.09}, own), Verdict::holds);
  EXPECT_EQ(judge({0.0001, 0.0001, 0.0001}, own), Verdict::holds);
  EXPECT_EQ(judge({0.001, 0.00221, 0.003}, own), Verdict::worse);
  EXPECT_EQ(judge({0.01, 0.0199, 0.09}, own), Verdict::worse);
  EXPECT_EQ(judge({0.01, 0.0201, 0.09}, own), Verdict::fails);
  EXPECT_EQ(judge({0.001, 0.002, 0.101}, own), Verdict::fails);
  EXPECT_EQ(judge({0.001, 0.002, kMissing}, own), Verdict::fails);
  EXPECT_EQ(judge({kMissing, kMissing, kMissing}, own), Verdict::fails);
}

TEST(VerifyVerdict, AllowsAsManyFailuresAsItHasAnyway) {
  EXPECT_EQ(judge({0.001, 0.002, kMissing}, {0.001, 0.002, 0.2}), Verdict::holds);
  EXPECT_EQ(judge({0.001, 0.3, kMissing}, {0.001, 0.002, 0.2}), Verdict::fails);
}

TEST(VerifyVerdict, HasARatioWhereThereAreTwoMedians) {
  EXPECT_DOUBLE_EQ(*judge_setting({}, make_summary({0.003}), make_summary({0.002})).ratio, 1.5);
  EXPECT_FALSE(judge_setting({}, make_summary({kMissing}), make_summary({0.002})).ratio);
  EXPECT_FALSE(judge_setting({}, make_summary({0.002}), make_summary({kMissing})).ratio);
}

TEST(OtherPlants, HaveWordsOfTheirOwn) {
  for (const OtherPlant& plant : other_plants()) {
    EXPECT_EQ(std::ranges::count(other_plants(), plant.words, &OtherPlant::words), 1)
        << plant.words;
  }
}

TEST(OtherPlants, SuitWhatTheRobotHas) {
  RobotModel robot;
  robot.joints.resize(2);
  const auto list_suiting = [&] {
    std::vector<std::string> names;
    for (const OtherPlant& plant : other_plants()) {
      if (plant.suits(robot)) {
        names.push_back(plant.name);
      }
    }
    return names;
  };
  EXPECT_THAT(list_suiting(), testing::ElementsAre("added-rotors", "elastic-rotors"));
  robot.joints[1].plant.coulomb = 1;
  robot.joints[0].plant.armature = 1;
  EXPECT_THAT(list_suiting(),
              testing::ElementsAre("more-friction", "lighter-rotors", "heavier-rotors", "elastic"));
  robot.joints[0].plant.stiffness = 1;
  EXPECT_THAT(list_suiting(),
              testing::ElementsAre("more-friction", "lighter-rotors", "heavier-rotors", "softer"));
}

}  // namespace
}  // namespace armwright
