// What `verify` tries, how it judges and what it concludes, on numbers made by hand.
#include "cli/verification.hpp"

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

Verdict judge(const std::vector<double>& errors_m, const std::vector<double>& own_m) {
  return judge_setting({}, make_summary(errors_m), make_summary(own_m)).verdict;
}

const std::vector<std::string> kEngines = {"a", "b", "c"};

TEST(VerifySettings, AreAllCombinationsWithItsOwnFirst) {
  const auto settings = list_verify_settings({"b", 1, 1}, kEngines);
  ASSERT_EQ(settings.size(), 3u * 4 * 3);
  EXPECT_EQ(settings[0].engine, "b");
  EXPECT_EQ(settings[0].substeps, 1);
  EXPECT_EQ(settings[0].mass_factor, 1);
  for (std::size_t i = 0; i < 12; ++i) {
    EXPECT_EQ(settings[i].engine, "b");
  }
  for (std::size_t i = 0; i < settings.size(); ++i) {
    for (std::size_t k = i + 1; k < settings.size(); ++k) {
      EXPECT_FALSE(settings[i].engine == settings[k].engine &&
                   settings[i].substeps == settings[k].substeps &&
                   settings[i].mass_factor == settings[k].mass_factor)
          << i << " and " << k;
    }
  }
}

TEST(VerifySettings, HaveItsOwnSubstepsToo) {
  EXPECT_EQ(list_verify_settings({"a", 4, 1}, kEngines).size(), 3u * 5 * 3);
  EXPECT_EQ(list_verify_settings({"a", 10, 1}, kEngines).size(), 3u * 4 * 3);
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

// A design whose median is its own, but for what `errors_m` says of a setting.
template <class Errors>
std::string conclude_on(const std::vector<std::string>& engines, const Errors& errors_m) {
  std::vector<VerifyRow> rows;
  for (const VerifySetting& setting : list_verify_settings({engines[0], 1, 1}, engines)) {
    rows.push_back(
        judge_setting(setting, make_summary({errors_m(setting)}), make_summary({0.002})));
  }
  return conclude("mine", rows);
}

TEST(VerifyConclusion, SaysThatEverythingHolds) {
  const std::string text = conclude_on({"a", "b"}, [](const VerifySetting&) { return 0.002; });
  EXPECT_THAT(text, AllOf(StartsWith("mine holds in 23 of the 23 settings beside its own."),
                          HasSubstr("Engines: It holds in b."),
                          HasSubstr("It holds with 2 substeps, 5 substeps and 10 substeps."),
                          HasSubstr("Masses: It holds with -10 % and +10 %."),
                          HasSubstr("it holds in 17 of 17."), Not(HasSubstr("relies"))));
}

TEST(VerifyConclusion, NamesWhatDoesNotHold) {
  const std::string text = conclude_on({"a"}, [](const VerifySetting& setting) {
    return setting.substeps > 2                               ? kNone
           : setting.substeps == 2 || setting.mass_factor > 1 ? 0.003
                                                              : 0.002;
  });
  EXPECT_THAT(text, AllOf(StartsWith("mine holds in 1 of the 11 settings beside its own. No other "
                                     "engine is built in."),
                          HasSubstr("It gets worse with 2 substeps (median 1.50 times as large). "
                                    "It fails with 5 substeps and 10 substeps."),
                          HasSubstr("relies on the simulation's own time step"),
                          HasSubstr("It holds with -10 %. It gets worse with +10 % (median 1.50"),
                          HasSubstr("it holds in 0 of 6.")));
}

TEST(VerifyConclusion, SaysWhenThereIsNothingToHold) {
  EXPECT_EQ(conclude("mine", std::vector<VerifyRow>{judge_setting({}, make_summary({kNone}),
                                                                  make_summary({kNone}))}),
            "mine has no median error even under its own setting: there is nothing that could "
            "hold.");
}

}  // namespace
}  // namespace armwright
