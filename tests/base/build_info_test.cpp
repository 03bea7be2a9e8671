#include "base/build_info.hpp"

#include <gmock/gmock.h>

namespace armwright {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(BuildInfo, NamesEveryLibraryThatIsThereOrNot) {
  const auto build = describe_build();
  const auto libraries = list_libraries();
  EXPECT_GE(libraries.size(), 18U);
  for (const auto& [library, version] : libraries) {
    const std::string recorded = build.at(library);
    EXPECT_EQ(recorded, version.empty() ? kNotInBuild : version);
    EXPECT_NE(recorded, "unknown") << library;  // where the build did not find it out
  }
  EXPECT_EQ(build.at("version"), get_version());
}

TEST(BuildInfo, ComparesWhatAnEarlierVersionRecorded) {
  auto recorded = describe_build();
  EXPECT_THAT(describe_build_changes(recorded, "run"), IsEmpty());
  recorded.erase("fmt");      // it did not record that yet
  recorded["physx"] = "5.1";  // or something that is not asked for any more
  recorded["compiler"] = "gcc\n2";
  EXPECT_THAT(describe_build_changes(recorded, "run"),
              ElementsAre("compiler was 'gcc?2' when the run began and is '" +
                          describe_build().at("compiler") + "' now"));
}

}  // namespace
}  // namespace armwright
