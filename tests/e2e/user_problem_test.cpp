// Problems of users on the command line: runs, comparisons, what resumes and what is refused.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include "base/temporary_folder.hpp"
#include "e2e/program.hpp"
#include "wait_until.hpp"

namespace armwright {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class CliUserProblem : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::copy_file(ARMWRIGHT_TEST_PLUGINS_SOURCE "/problem.py", folder_ / "mine.py");
  }

  Outcome run(const std::vector<std::string>& words) { return run_program(folder_.path(), words); }

  // Replaces a text in the program of the problem.
  void edit_program(const std::string& what, const std::string& by) {
    std::string text = read_text(folder_ / "mine.py");
    ASSERT_NE(text.find(what), std::string::npos);
    text.replace(text.find(what), what.size(), by);
    std::ofstream(folder_ / "mine.py") << text;
  }

  const TemporaryFolder folder_;
};

TEST_F(CliUserProblem, RunsAndShowsAndReportsAndNeedsItsProgramForNoneOfTheLastTwo) {
  const Outcome made = run({"optimize", "exec:python3 mine.py exit", "--budget", "105", "--quiet"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_THAT(made.out, AllOf(HasSubstr("faulty: ga, seed 1"), HasSubstr("failed")));
  std::filesystem::remove(folder_ / "mine.py");
  const std::string run_folder = "results/faulty-ga-seed1";
  EXPECT_EQ(run({"show", run_folder}).exit_code, 0);
  const Outcome report = run({"report", run_folder, "--out", "page.html"});
  EXPECT_EQ(report.exit_code, 0) << report.err;
  EXPECT_GT(read_text(folder_ / "page.html").size(), 100'000U);
  EXPECT_EQ(run({"doctor", run_folder}).exit_code, 0);
}

TEST_F(CliUserProblem, AProgramThatIsChangedSinceTheRunBeganIsRefusedWithTheDifference) {
  const std::vector<std::string> words = {"optimize", "exec:python3 mine.py", "--budget", "35",
                                          "--quiet"};
  ASSERT_EQ(run(words).exit_code, 0);
  edit_program(R"("lower": -5)", R"("lower": -6)");
  const Outcome changed = run(words);
  EXPECT_EQ(changed.exit_code, 2);
  EXPECT_THAT(changed.err,
              AllOf(HasSubstr("another configuration"),
                    HasSubstr("the input 'mine.py' has changed"), HasSubstr("description")));
}

TEST_F(CliUserProblem, AFaultyAnswerEndsTheRunAndTheMendedProgramGoesOnInAnotherFolder) {
  const Outcome broken = run({"optimize", "exec:python3 mine.py text", "--optimizer", "random",
                              "--budget", "200", "--quiet", "--jobs", "1"});
  EXPECT_EQ(broken.exit_code, 4);
  EXPECT_THAT(broken.err, AllOf(HasSubstr("problem 'exec:python3 mine.py text'"),
                                HasSubstr("that is no object and no number: '\"large\"'")));
  // What was evaluated before is on the disk.
  const Outcome status = run({"doctor", "results/faulty-random-seed1"});
  EXPECT_EQ(status.exit_code, 0) << status.out;
  EXPECT_GT(read_text(folder_ / "results/faulty-random-seed1/journal").size(), 100U);
}

TEST_F(CliUserProblem, HasItsOwnSettingsInAFileOfTheProblem) {
  std::ofstream(folder_ / "mine.toml")
      << "kind = \"program\"\nname = \"tuned\"\nprogram.command = \"exec:python3 mine.py rich\"\n"
         "program.time_limit_s = 5\nrun.optimizer = \"random\"\nrun.budget = 40\n"
         "schedule.cases = 4\nsets.test_cases = 2\n";
  const Outcome made = run({"optimize", "mine.toml", "--quiet"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_TRUE(std::filesystem::exists(folder_ / "results/tuned-random-seed1/result.json"));
  const Outcome many = run({"optimize", "mine.toml", "--schedule", "fixed:5"});
  EXPECT_EQ(many.exit_code, 2);
  EXPECT_THAT(many.err, HasSubstr("needs more training cases than tuned has, which are 4"));
  const Outcome bred =
      run({"optimize", "mine.toml", "--optimizer", "ga", "--schedule", "coevolution:4"});
  EXPECT_THAT(bred.err, HasSubstr("coevolution breeds the paths of a robot's tool"));
}

}  // namespace
}  // namespace armwright
