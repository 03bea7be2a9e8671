#include <gmock/gmock.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "base/temporary_folder.hpp"
#include "cli/list/list_views.hpp"

namespace armwright {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

// A study on a problem whose program leaves a file behind if it is started.
std::string write_study(const TemporaryFolder& folder, const std::string& problem) {
  const auto file = folder / "mine.toml";
  std::ofstream(file) << "title = \"Motors\"\nreplicates = 4\nbudget = 90\n"
                      << "problems = [" << nlohmann::json(problem).dump() << "]\n"
                      << "optimizers = [\"ga\", \"cmaes\"]\n";
  return file.string();
}

TEST(ListStudies, SaysWhatTheFileSaysIfAProgramDescribesTheProblem) {
  const TemporaryFolder folder;
  const std::string command = "exec:sh -c 'echo > " + (folder / "STARTED").string() + "'";
  const std::string file = write_study(folder, command);
  EXPECT_THAT(make_study_kind().explain(file, Style(false)),
              AllOf(HasSubstr("mine: Motors"), HasSubstr("exec:sh -c"), HasSubstr("ga, cmaes"),
                    HasSubstr("4 replicates, budget 90 cases"),
                    HasSubstr("armwright compare " + file + " --dry-run")));
  const auto outline = make_study_kind().explain_as_json(file);
  EXPECT_EQ(outline.at("problems"), nlohmann::json({command}));
  EXPECT_TRUE(outline.at("cells").is_null());
  EXPECT_FALSE(std::filesystem::exists(folder / "STARTED"));
}

TEST(ListStudies, AProblemFileThatNamesAProgramIsListedToo) {
  const TemporaryFolder folder;
  const auto problem = folder / "motor.toml";
  std::ofstream(problem) << "kind = \"program\"\n[program]\ncommand = \"exec:sh -c 'echo > "
                         << (folder / "STARTED").string() << "'\"\n";
  EXPECT_THAT(make_study_kind().explain(write_study(folder, problem.string()), Style(false)),
              AllOf(HasSubstr("motor.toml"), HasSubstr("starts no program")));
  EXPECT_FALSE(std::filesystem::exists(folder / "STARTED"));
}

TEST(ListStudies, TheNextCommandHasTheProgramsNameAsTyped) {
  const TemporaryFolder folder;
  const std::string file = write_study(folder, "exec:true");
  EXPECT_THAT(make_study_kind("./bin/arm").explain(file, Style(false)),
              HasSubstr("\n  ./bin/arm compare " + file + " --dry-run"));
}

TEST(ListStudies, OtherStudiesAreListedAsAWhole) {
  const TemporaryFolder folder;
  EXPECT_THAT(make_study_kind().explain(write_study(folder, "sphere"), Style(false)),
              AllOf(HasSubstr("20 cells"), Not(HasSubstr("starts no program"))));
}

}  // namespace
}  // namespace armwright
