// One run of a comparison run anew, as a user meets it.
#include <gmock/gmock.h>
#include <signal.h>

#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "base/remove_checksums.hpp"
#include "base/temporary_folder.hpp"
#include "e2e/program.hpp"

namespace armwright {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class CliRerun : public testing::Test {
 protected:
  void make_study(const std::string& optimizers = "ga,cmaes,nlopt:bobyqa",
                  const std::string& budget = "60") {
    const Outcome outcome = run_program(
        folder_.path(),
        {"compare", "--problems", "q1-complex", "--optimizers", optimizers, "--replicates", "2",
         "--budget", budget, "--engine", "articulated", "--set", "sets.test_cases=5", "--set",
         "sets.validation_cases=5", "--no-baselines", "--out", "study", "--quiet"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  Outcome rerun(const std::vector<std::string>& words) {
    std::vector<std::string> all = {"rerun", "study"};
    all.insert(all.end(), words.begin(), words.end());
    return run_program(folder_.path(), all);
  }
  TemporaryFolder folder_;
};

TEST_F(CliRerun, IsIdenticalForEveryOptimizerOnAnyNumberOfThreads) {
  make_study();
  for (const std::string optimizer : {"ga", "cmaes", "nlopt:bobyqa"}) {
    for (const std::string jobs : {"1", "2"}) {
      const Outcome outcome =
          rerun({"q1-complex/" + optimizer + "/r02", "--jobs", jobs, "--quiet"});
      EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
      EXPECT_THAT(outcome.out, HasSubstr("result.json, winner.toml and cell.json are the same to "
                                         "the last bit"));
      EXPECT_EQ(outcome.err, "");
    }
  }
  EXPECT_TRUE(std::filesystem::exists(folder_ / "study/reruns/q1-complex/ga/r02-002/cell.json"));
}

TEST_F(CliRerun, SaysAsJsonWhatWasCompared) {
  make_study();
  const Outcome outcome = rerun({"q1-complex/ga/r01", "--json", "--quiet", "--out", "anew"});
  const json j = json::parse(outcome.out);
  EXPECT_TRUE(j["identical"]);
  EXPECT_TRUE(j["difference"].is_null());
  EXPECT_EQ(j["evaluations"], 12);  // on five cases each
  EXPECT_EQ(j["folder"], "anew");
  const Outcome again = rerun({"q1-complex/ga/r01", "--out", "anew"});
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_THAT(again.err, HasSubstr("--out is 'anew', which holds a run that has ended"));
}

TEST_F(CliRerun, FindsACellThatWasTamperedWith) {
  make_study();
  const auto file = folder_ / "study/cells/q1-complex/ga/r01/cell.json";
  std::string text = read_text(file);
  const std::string what = "\"evaluations\": 12";
  ASSERT_NE(text.find(what), std::string::npos);
  text.replace(text.find(what), what.size(), "\"evaluations\": 13");
  std::ofstream(file) << text;
  const Outcome refused = rerun({"q1-complex/ga/r01", "--quiet"});
  EXPECT_EQ(refused.exit_code, 4);
  EXPECT_THAT(refused.err, HasSubstr("r01/cell.json: was changed after it was written"));
  remove_checksums(folder_ / "study");
  const Outcome outcome = rerun({"q1-complex/ga/r01", "--quiet"});
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.out, HasSubstr("different: cell.json, evaluations: recorded 13, now 12"));
  EXPECT_THAT(outcome.out, HasSubstr("the recorded files were changed after the run"));
}

TEST_F(CliRerun, RefusesWhatTheStudyHasNot) {
  make_study();
  const auto expect = [&](const std::string& cell, const std::string& message) {
    const Outcome outcome = rerun({cell});
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.err, HasSubstr(message));
  };
  expect("q1-complx/ga/r01", "unknown problem 'q1-complx'; did you mean 'q1-complex'?");
  expect("q1-complex/cmaess/r01", "did you mean 'cmaes'?");
  expect("q1-complex/ga/r03", "it has r01 to r02");
  expect("ga", "a cell is PROBLEM/OPTIMIZER/rNN");
  std::filesystem::remove(folder_ / "study/cells/q1-complex/ga/r02/cell.json");
  expect("q1-complex/ga/r02", "has not ended in this study");
  expect("q1-complex/ga/r02", "compare study/study.toml --out study");
  const Outcome no_study = run_program(folder_.path(), {"rerun", "nowhere", "q1-complex/ga/r01"});
  EXPECT_EQ(no_study.exit_code, 2);
  EXPECT_THAT(no_study.err, HasSubstr("there is no folder 'nowhere'"));
}

TEST_F(CliRerun, InterruptedItGoesOnWithTheSameCommand) {
  make_study("ga", "10000");
  Program program(folder_.path(), {"rerun", "study", "q1-complex/ga/r01", "--jobs", "1"});
  const auto journal = folder_ / "study/reruns/q1-complex/ga/r01/journal";
  std::error_code ignored;
  while (program.is_running() && !(std::filesystem::exists(journal, ignored) &&
                                   std::filesystem::file_size(journal, ignored) > 8)) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  program.send(SIGINT);
  const Outcome stopped = program.wait();
  EXPECT_EQ(stopped.exit_code, 130) << stopped.err;
  EXPECT_THAT(stopped.err, HasSubstr("nothing is lost. To resume:"));
  const Outcome last = rerun({"q1-complex/ga/r01"});
  EXPECT_EQ(last.exit_code, 0) << last.err;
  EXPECT_THAT(last.out, HasSubstr("identical: 2000 evaluations"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "study/reruns/q1-complex/ga/r01-002"));
}

TEST_F(CliRerun, TakesLabelsOfAnyKind) {
  std::ofstream(folder_ / "mine.toml") << R"(
problems = ["sphere"]
replicates = 2
budget = 60
baselines = false
[[optimizer]]
name = "ga"
label = "my ga, 'small': 50% / \"half\" $HOME"
options = ["population=10"]
)";
  ASSERT_EQ(
      run_program(folder_.path(), {"compare", "mine.toml", "--quiet", "--out", "study"}).exit_code,
      0);
  for (const char* cell :
       {"sphere/my ga, 'small': 50% / \"half\" $HOME/r02",
        "sphere/my%20ga%2C%20%27small%27%3A%2050%25%20%2F%20%22half%22%20%24HOME/r02"}) {
    const Outcome outcome = rerun({cell});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("identical"));
  }
}

}  // namespace
}  // namespace armwright
