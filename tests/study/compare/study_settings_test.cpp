#include "study/compare/study_settings.hpp"

#include <gmock/gmock.h>

#include <set>

#include "problems/config/config_files.hpp"
#include "study/compare/study_plan.hpp"

namespace armwright {
namespace {

using testing::IsEmpty;
using testing::Not;

TEST(StudySettings, AreThoseThatTheReaderAsksFor) {
  std::set<std::string> known;
  for (const Setting& setting : list_study_settings()) {
    EXPECT_THAT(setting.meaning, Not(IsEmpty())) << setting.path;
    EXPECT_THAT(setting.allowed, Not(IsEmpty())) << setting.path;
    known.insert(setting.path);
  }
  for (const std::string& name : list_configs("studies")) {
    for (const AskedKey& key : ask_study_keys(ConfigTable::load(resolve_config("studies", name)))) {
      const bool is_table = key.allowed.empty() || key.allowed.starts_with("a table") ||
                            key.allowed.starts_with("an array of tables");
      EXPECT_TRUE(is_table || known.contains(key.path)) << name << ": " << key.path;
    }
  }
  EXPECT_FALSE(known.contains("optimizer[].budget"));  // looked up only to refuse it
}

}  // namespace
}  // namespace armwright
