// The conclusions of `verify` and the lines of a winner's check, on hand-made numbers.
#include "cli/views/verification.hpp"

#include <gmock/gmock.h>

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

VerifyMatrix make_matrix(std::vector<std::string> engines) {
  return {std::move(engines), kUsualSubsteps, kUsualPlants, {}};
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

TEST(VerifyConclusion, SaysWhenThereIsNothingToHold) {
  EXPECT_EQ(conclude("mine", std::vector<VerifyRow>{judge_setting({}, make_summary({kNone}),
                                                                  make_summary({kNone}))}),
            "mine has no median error even in its own setting, so the other settings say nothing.");
}

TEST(DescribeCheck, HasALinePerSettingAndSaysWhenThereIsNone) {
  WinnerCheck check{
      .test_set = "test/2", .own = make_summary({0.001}), .limit_m = 0.003, .settings = {}};
  CheckedSetting& fails = check.settings.emplace_back();
  fails.name = "2 physics steps per control period";
  fails.summary = make_summary({0.2});
  fails.verdict = Verdict::fails;
  CheckedSetting& missing = check.settings.emplace_back();
  missing.name = "engine ode";
  missing.verdict = Verdict::missing;
  missing.fault = "it has springs";
  const Style style(false);
  EXPECT_EQ(
      describe_check(check, style),
      "Under other conditions (the first 1 case of test/2; own error 1.000 mm, at most 3.000 mm "
      "works)\n"
      "  2 physics steps per control period  fails in 1 of 1 cases  200.0 mm\n"
      "  engine ode                          not simulated          it has springs\n");
  EXPECT_THAT(describe_check(std::nullopt, style), HasSubstr("not checked"));
}

}  // namespace
}  // namespace armwright
