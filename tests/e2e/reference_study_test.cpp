// The script of the reference study, everything tiny: runs, collects, goes on.
#include <gmock/gmock.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "base/temporary_folder.hpp"
#include "e2e/program.hpp"
#include "sample_or_all.hpp"

namespace armwright {
namespace {

using testing::HasSubstr;

int run_script(const TemporaryFolder& folder, const std::string& arguments) {
  const std::string command = "ARMWRIGHT='" ARMWRIGHT_BINARY "' '" ARMWRIGHT_SCRIPTS
                              "/reference-study' --folder '" +
                              (folder / "study").string() + "' " + arguments + " > '" +
                              (folder / "out.txt").string() + "' 2>&1";
  const int status = std::system(command.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(ReferenceStudy, RunsCollectsAndGoesOn) {
  const TemporaryFolder folder;
  const auto tables = folder / "study" / "tables";
  const auto parts = sample_or_all<std::vector<std::string>>(
      {"cases"}, {"running-times", "cases", "coevolution", "controllers", "q2-front"});
  std::string arguments = "--quick --jobs 2";
  for (const std::string& part : parts) {
    arguments += " " + part;
  }
  ASSERT_EQ(run_script(folder, arguments), 0) << read_text(folder / "out.txt");
  for (const std::string& part : parts) {
    EXPECT_THAT(read_text(tables / part / "study.toml"), HasSubstr("plan_sha256")) << part;
    EXPECT_THAT(read_text(tables / part / "verdict.txt"),
                HasSubstr("no pair of optimizers can be decided"));
  }
  if (parts.size() > 1) {
    const std::string targets = read_text(tables / "running-times" / "targets.csv");
    EXPECT_THAT(targets, HasSubstr("q2-e6,the thesis's E6,0.0428,0,ga (one fresh case),"));
    EXPECT_THAT(targets, HasSubstr("q1-complex,0.3 mm,0.0003,,cmaes,"));
    EXPECT_THAT(read_text(tables / "coevolution" / "summary.csv"), HasSubstr("ga, coevolution:20"));
  }
  EXPECT_FALSE(std::filesystem::exists(tables / "cases" / "curves.csv"));  // large
  // A cell that is lost is made again, alike, and nothing else is run.
  const std::string before = read_text(tables / "cases" / "cells.csv");
  ASSERT_GT(std::filesystem::remove_all(folder / "study/runs/cases/cells/q2-e6"), 0u);
  ASSERT_EQ(run_script(folder, "--quick --jobs 1 cases"), 0);
  EXPECT_EQ(read_text(tables / "cases" / "cells.csv"), before);
}

TEST(ReferenceStudy, SaysWhichPartsThereAre) {
  const TemporaryFolder folder;
  EXPECT_EQ(run_script(folder, "q5"), 2);
  EXPECT_THAT(read_text(folder / "out.txt"), HasSubstr("parts: designs running-times few cases"));
  EXPECT_EQ(run_script(folder, "--jobs many"), 2);
}

}  // namespace
}  // namespace armwright
