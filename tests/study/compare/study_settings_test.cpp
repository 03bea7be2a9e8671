#include <gmock/gmock.h>

#include "base/expect_error.hpp"
#include "base/file.hpp"
#include "base/temporary_folder.hpp"
#include "problems/changed_text.hpp"
#include "study/compare/study_reader.hpp"

namespace armwright {
namespace {

// Every table is there, so that any key can be put into any table.
constexpr const char* kStudy = R"(title = ""
[selection]
[[problem]]
name = "sphere"
[[optimizer]]
name = "random"
[[target]]
label = "t"
value = 1
)";

TEST(StudySettings, AStudysReaderReadsEveryOne) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "study.toml";
  for (const ListedSetting& one : list_settings(study_settings())) {
    EXPECT_THAT(one.setting->meaning, testing::Not(testing::IsEmpty())) << one.path;
    write_file_atomically(file,
                          change_text(kStudy, make_header(one.path), one.setting->key, kDate));
    EXPECT_THAT(
        usage_error_of([&] {
          StudyPlan plan;
          read_study_file(file, plan);
        }),
        testing::AllOf(testing::HasSubstr(": " + make_first_path(one.path) + " is " + kDate),
                       testing::EndsWith("it must be " + one.setting->describe_allowed())));
  }
}

}  // namespace
}  // namespace armwright
