#include "base/setting.hpp"

#include <gmock/gmock.h>

#include "base/some_settings.hpp"

namespace armwright {
namespace {

TEST(Setting, DescribesWhatIsAllowed) {
  EXPECT_EQ(text("x").describe_allowed(), "a string");
  EXPECT_EQ(choice("x", {"a", "b"}).describe_allowed(), "one of these strings: a, b");
  EXPECT_EQ(number("x").describe_allowed(), "a finite number");
  EXPECT_EQ(number("x", {.lower = 0, .upper = 0.5, .lower_open = true}).describe_allowed(),
            "a finite number > 0 and <= 0.5");
  EXPECT_EQ(number("x", {.upper = 1e-5}).describe_allowed(), "a finite number <= 1e-05");
  EXPECT_EQ(integer("x", {.lower = 1, .upper = 1e12}).describe_allowed(),
            "an integer from 1 to 1000000000000");
  EXPECT_EQ(integer("x", {.lower = 0}).describe_allowed(), "an integer >= 0");
  EXPECT_EQ(integer("x", {.upper = 3}).describe_allowed(), "an integer <= 3");
  EXPECT_EQ(integer("x", {}).describe_allowed(), "an integer");
  EXPECT_EQ(boolean("x").describe_allowed(), "true or false");
  EXPECT_EQ(texts("x").describe_allowed(), "an array of strings");
  EXPECT_EQ(numbers("x", {.lower = 0}).describe_allowed(),
            "an array, each element of it a finite number >= 0");
}

TEST(Setting, WritesItsDefaultAsToml) {
  EXPECT_EQ(text("x").default_text, "");
  EXPECT_EQ(text("x", "").default_text, "\"\"");
  EXPECT_EQ(text("x", "a \"b\"").default_text, R"("a \"b\"")");
  EXPECT_EQ(number("x", {}, 1.5).default_text, "1.5");
  EXPECT_EQ(number("x", {}, 10).default_text, "10");
  EXPECT_EQ(integer("x", {}, 10).default_text, "10");
  EXPECT_EQ(boolean("x", false).default_text, "false");
}

TEST(Setting, ItsKeyEndsWithItsUnit) {
  EXPECT_EQ(number("speed_m_per_s").unit, "m/s");
  EXPECT_EQ(number("friction_n_m_s_per_rad").unit, "N m s/rad");
  EXPECT_EQ(number("limit_n").unit, "N");
  EXPECT_EQ(number("limit_n_m").unit, "N m");
  EXPECT_EQ(number("erp").unit, "");
}

TEST(Setting, MayBeNarrowed) {
  const auto speed = number("speed", {.lower = 0, .upper = 9}, 1);
  EXPECT_EQ(speed.within({.upper = 2}).describe_allowed(), "a finite number <= 2");
  EXPECT_EQ(speed.within({.upper = 2}).fallback, 1);
  EXPECT_EQ(choice("kind", {"a", "b"}).among({"c"}).describe_allowed(), "one of these strings: c");
}

TEST(Setting, AreListedWithTheirTables) {
  const auto title = text("title");
  const auto speed = number("speed");
  const auto use = text("use");
  SettingTable inner = array("inner");
  inner.settings = {&use};
  SettingTable task = table("task");
  task.settings = {&speed};
  task.tables = {&inner};
  std::vector<std::string> paths;
  for (const ListedSetting& one :
       list_settings({.key = "", .settings = {&title}, .tables = {&task}})) {
    paths.push_back(one.path);
  }
  EXPECT_THAT(paths, testing::ElementsAre("title", "task.speed", "task.inner[].use"));
}

}  // namespace
}  // namespace armwright
