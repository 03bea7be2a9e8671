// The settings that `verify` tries, its verdicts and its conclusions, on hand-made numbers.
#include "cli/views/verification.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <limits>

namespace armwright {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

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

TEST(VerifyVerdict, FollowsTheMedianAndTheFailures) {
  const std::vector<double> own = {0.001, 0.002, 0.003};
  EXPECT_EQ(judge(own, own), Verdict::holds);
  EXPECT_EQ(judge({0.001, 0.00219, 0.09}, own), Verdict::holds);
  EXPECT_EQ(judge({0.0001, 0.0001, 0.0001}, own), Verdict::holds);
  EXPECT_EQ(judge({0.001, 0.00221, 0.003}, own), Verdict::worse);
  EXPECT_EQ(judge({0.01, 0.0199, 0.09}, own), Verdict::worse);
  EXPECT_EQ(judge({0.01, 0.0201, 0.09}, own), Verdict::fails);
  EXPECT_EQ(judge({0.001, 0.002, 0.101}, own), Verdict::fails);
  EXPECT_EQ(judge({0.001, 0.002, kNone}, own), Verdict::fails);
  EXPECT_EQ(judge({kNone, kNone, kNone}, own), Verdict::fails);
}

TEST(VerifyVerdict, AllowsAsManyFailuresAsItHasAnyway) {
  EXPECT_EQ(judge({0.001, 0.002, kNone}, {0.001, 0.002, 0.2}), Verdict::holds);
  EXPECT_EQ(judge({0.001, 0.3, kNone}, {0.001, 0.002, 0.2}), Verdict::fails);
}

TEST(VerifyVerdict, HasARatioWhereThereAreTwoMedians) {
  EXPECT_DOUBLE_EQ(*judge_setting({}, make_summary({0.003}), make_summary({0.002})).ratio, 1.5);
  EXPECT_FALSE(judge_setting({}, make_summary({kNone}), make_summary({0.002})).ratio);
  EXPECT_FALSE(judge_setting({}, make_summary({0.002}), make_summary({kNone})).ratio);
}

// Returns the conclusion on a design with a median error of 2 mm in its own setting and of
// errors_m(setting) in each setting.
template <class Errors>
std::string conclude_on(const std::vector<std::string>& engines, const Errors& errors_m) {
  std::vector<VerifyRow> rows;
  for (const VerifySetting& setting :
       list_verify_settings({engines[0], 1, 1}, make_matrix(engines))) {
    rows.push_back(
        judge_setting(setting, make_summary({errors_m(setting)}), make_summary({0.002})));
  }
  return conclude("mine", rows);
}

TEST(VerifyConclusion, SaysThatEverythingHolds) {
  const std::string text = conclude_on({"a", "b"}, [](const VerifySetting&) { return 0.002; });
  EXPECT_THAT(text,
              AllOf(StartsWith("mine holds in 23 of the 23 settings beside its own."),
                    HasSubstr("Engines: It holds in b."),
                    HasSubstr("It holds with 2 substeps, 5 substeps and 10 substeps."),
                    HasSubstr("Masses: It holds with -10 % and +10 %."),
                    HasSubstr("it holds in 17 of 17 settings."), Not(HasSubstr("depends on"))));
}

TEST(VerifyConclusion, NamesWhatDoesNotHold) {
  const std::string text = conclude_on({"a"}, [](const VerifySetting& setting) {
    return setting.substeps > 2                               ? kNone
           : setting.substeps == 2 || setting.mass_factor > 1 ? 0.003
                                                              : 0.002;
  });
  EXPECT_THAT(text,
              AllOf(StartsWith("mine holds in 1 of the 11 settings beside its own. Time steps:"),
                    HasSubstr("It gets worse with 2 substeps (median 1.50 times as large). "
                              "It fails with 5 substeps and 10 substeps."),
                    HasSubstr("depends on the time step of the simulation"),
                    HasSubstr("It holds with -10 %. It gets worse with +10 % (median 1.50"),
                    HasSubstr("it holds in 0 of 6 settings.")));
}

TEST(VerifyConclusion, NamesPerturbedPlants) {
  std::vector<VerifyRow> rows;
  const VerifyMatrix matrix{{"a"}, {1}, {"none", "friction", "sensor"}, {}};
  for (const VerifySetting& setting : list_verify_settings({"a", 1, 1}, matrix)) {
    rows.push_back(judge_setting(setting,
                                 make_summary({setting.perturbation == "sensor" ? 0.004 : 0.002}),
                                 make_summary({0.002})));
  }
  EXPECT_EQ(conclude("mine", rows),
            "mine holds in 1 of the 2 settings beside its own. Other plants: It holds with "
            "friction. It gets worse with sensor (median 2.00 times as large).");
}

TEST(VerifyConclusion, NamesWhatCouldNotBeSimulated) {
  std::vector<VerifyRow> rows;
  const VerifyMatrix matrix{{"a"}, {1}, {"none"}, {"friction", "elastic"}};
  for (const VerifySetting& setting : list_verify_settings({"a", 1, 1}, matrix)) {
    rows.push_back(setting.perturbation == "elastic"
                       ? make_missing_row(setting, "no armature")
                       : judge_setting(setting, make_summary({0.002}), make_summary({0.002})));
  }
  EXPECT_STREQ(to_string(rows.back().verdict), "not simulated");
  EXPECT_EQ(conclude("mine", rows),
            "mine holds in 1 of the 1 settings beside its own. 1 setting could not be simulated. "
            "Other plants: It holds with friction. It could not be simulated with elastic.");
}

TEST(VerifyConclusion, SaysThatNoOtherSettingWasSimulated) {
  std::vector<VerifyRow> rows = {judge_setting({}, make_summary({0.002}), make_summary({0.002}))};
  EXPECT_EQ(conclude("mine", rows), "mine was simulated in no setting beside its own.");
  rows.push_back(make_missing_row({"", 2, 1, "friction"}, "why"));
  EXPECT_EQ(conclude("mine", rows),
            "mine was simulated in no setting beside its own. 1 setting could not be simulated.");
}

// The substeps that springs need belong to their plant.
TEST(VerifyConclusion, CountsSubstepsOfSpringsAsNoChange) {
  const VerifySetting own{"a", 1, 1, "none"};
  std::vector<VerifyRow> rows = {judge_setting(own, make_summary({0.002}), make_summary({0.002}))};
  for (const bool springs : {true, false}) {
    rows.resize(1);
    const VerifySetting setting{"a", 10, 1, "elastic", springs};
    rows.push_back(judge_setting(setting, make_summary({0.002}), make_summary({0.002})));
    const std::string text = conclude("mine", rows);
    EXPECT_EQ(text.find("Other plants: It holds with elastic.") != std::string::npos, springs)
        << text;
    EXPECT_EQ(text.find("several of these change") != std::string::npos, !springs) << text;
  }
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

TEST(VerifyConclusion, SaysWhenThereIsNothingToHold) {
  EXPECT_EQ(conclude("mine", std::vector<VerifyRow>{judge_setting({}, make_summary({kNone}),
                                                                  make_summary({kNone}))}),
            "mine has no median error even in its own setting, so the other settings say nothing.");
}

}  // namespace
}  // namespace armwright
