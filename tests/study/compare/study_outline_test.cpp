// Reading the title and the outline of a study's file.
#include <gmock/gmock.h>

#include <cstdint>
#include <fstream>

#include "base/expect_error.hpp"
#include "base/read_limit.hpp"
#include "base/temporary_folder.hpp"
#include "study/compare/study_plan.hpp"

namespace armwright {
namespace {

using testing::HasSubstr;

class StudyOutlines : public testing::Test {
 protected:
  StudyOutlines() {
    std::ofstream(file_) << "title = \"Motors\"\nbudget = 90\nproblems = [\"no-such-problem\"]\n"
                         << "optimizers = [\"ga\"]\n";
  }
  ~StudyOutlines() override { limit_time(1e9); }
  static void limit_time(double time_s) {
    static StopSignal stop;
    set_read_limit({.time_s = time_s, .memory_bytes = std::uint64_t{1} << 60}, stop,
                   [](const std::string&) {});
  }

  const TemporaryFolder folder_;
  const std::string file_ = (folder_ / "mine.toml").string();
};

TEST_F(StudyOutlines, ATitleNeedsNoProblem) {
  EXPECT_EQ(read_study_title(file_), "Motors");
  EXPECT_THAT(usage_error_of([&] { read_study_outline(file_); }), HasSubstr("no-such-problem"));
}

TEST_F(StudyOutlines, BothHaveTheLimitOfReading) {
  limit_time(0);
  const std::string refusal = "reading the study '" + file_ + "' took more than 0 s";
  EXPECT_THAT(error_of(ErrorKind::bad_data, [&] { read_study_title(file_); }), HasSubstr(refusal));
  EXPECT_THAT(error_of(ErrorKind::bad_data, [&] { read_study_outline(file_); }),
              HasSubstr(refusal));
}

}  // namespace
}  // namespace armwright
