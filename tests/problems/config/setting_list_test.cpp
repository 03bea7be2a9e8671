#include "problems/config/setting_list.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "problems/config/config_files.hpp"
#include "problems/config/problem_tables.hpp"
#include "problems/config/setting_descriptions.hpp"

namespace armwright {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::Not;

const Setting& find(const std::vector<Setting>& settings, const std::string& path) {
  const auto found = std::ranges::find(settings, path, &Setting::path);
  EXPECT_NE(found, settings.end()) << path;
  return found == settings.end() ? settings.front() : *found;
}

TEST(SettingList, SaysWhatTheReadersAskFor) {
  const auto settings = list_problem_settings();
  const Setting& speed = find(settings, "task.speed_m_per_s");
  EXPECT_EQ(speed.unit, "m/s");
  EXPECT_THAT(speed.allowed, ElementsAre("a finite number >= 0.01 and <= 100"));
  EXPECT_THAT(speed.fallbacks, ElementsAre("1.5"));
  EXPECT_THAT(find(settings, "schedule.kind").allowed,
              ElementsAre("one of these strings: fixed, fresh, coevolution"));
  // Required, and read only where its kind asks for it.
  EXPECT_THAT(find(settings, "objective.error_limit_m").fallbacks, IsEmpty());
  EXPECT_EQ(find(settings, "requirement[].limit_rad_per_s").unit, "rad/s");
}

// No shipped arm has joints that slide, so that their limits are in none.
const std::set<std::string> kOfSliders = {"requirement[].limit_n", "requirement[].limit_m_per_s"};

// Neither a key without words nor words without a key; and a key that only its presence was asked
// of lacks a specimen in which it is read.
void expect_complete(const std::vector<Setting>& settings, std::span<const SettingWords> words) {
  std::set<std::string> paths;
  for (const Setting& setting : settings) {
    EXPECT_THAT(setting.meaning, Not(IsEmpty())) << setting.path;
    EXPECT_EQ(setting.allowed.empty(), kOfSliders.contains(setting.path)) << setting.path;
    paths.insert(setting.path);
  }
  for (const SettingWords& one : words) {
    EXPECT_TRUE(paths.contains(one.path)) << one.path << " is not read in any specimen";
  }
}

TEST(SettingList, HasEveryKeyAndNoOther) {
  expect_complete(list_problem_settings(), problem_setting_words());
  expect_complete(list_design_settings(), design_setting_words());
}

TEST(SettingList, HasEveryKeyThatShippedProblemsAskFor) {
  std::set<std::string> known;
  for (const Setting& setting : list_problem_settings()) {
    known.insert(setting.path);
  }
  for (const std::string& name : list_configs("problems")) {
    const auto path = resolve_config("problems", name);
    std::vector<ConfigTable> read;
    load_problem_tables(
        path,
        [&](std::span<const std::string> overrides) {
          read.push_back(ConfigTable::load(path, overrides));
          return read.back();
        },
        {}, engine_table());
    for (const AskedKey& key : read.front().asked()) {
      const bool is_table = key.allowed.empty() || key.allowed.starts_with("a table") ||
                            key.allowed.starts_with("an array of tables");
      EXPECT_TRUE(is_table || known.contains(key.path)) << name << ": " << key.path;
    }
  }
}

TEST(SettingList, GainsAreThoseOfAllControllers) {
  const auto settings = list_design_settings();
  EXPECT_EQ(find(settings, "joint[].p_n_m_per_rad").unit, "N m/rad");
  EXPECT_THAT(find(settings, "joint[].p_n_m_per_rad").meaning,
              testing::StartsWith("gain of controller pid, "));
  for (const ControllerRow& controller : controller_table()) {
    for (const controllers::Gain& gain : controller.gains) {
      find(settings, std::string("joint[].") + gain.key);
    }
  }
}

TEST(SettingList, AlternativesStandBesideEachOther) {
  const std::vector<std::vector<AskedKey>> documents = {
      {{"t.a", "a string", "\"x\""}, {"t", "a table, [t]", ""}},
      {{"t.a", "a string", "\"y\""}, {"t.refused", "", ""}}};
  const std::vector<SettingWords> words = {{"t.gone", "?"}, {"t.a", "some text"}};
  const auto settings = make_settings(documents, words);
  ASSERT_EQ(settings.size(), 1U);
  EXPECT_EQ(settings[0].path, "t.a");
  EXPECT_EQ(settings[0].meaning, "some text");
  EXPECT_THAT(settings[0].allowed, ElementsAre("a string"));
  EXPECT_THAT(settings[0].fallbacks, ElementsAre("\"x\"", "\"y\""));
}

}  // namespace
}  // namespace armwright
