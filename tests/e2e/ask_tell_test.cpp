// armwright ask and tell on the command line: whole runs, what is refused, and what a kill leaves.
#include <gmock/gmock.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "base/temporary_folder.hpp"
#include "e2e/program.hpp"
#include "sample_or_all.hpp"

namespace armwright {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

constexpr const char* kBench = R"(kind = "external"
[[variable]]
name = "gain"
lower = 0
upper = 4
[[variable]]
name = "steps"
type = "integer"
lower = 1
upper = 6
[[variable]]
name = "oil"
type = "category"
choices = ["thin", "thick, old"]
[[objective]]
name = "error"
)";

class CliAskTell : public testing::Test {
 protected:
  void SetUp() override { write("bench.toml", kBench); }

  void write(const std::string& name, const std::string& text) {
    std::ofstream(folder_ / name) << text;
  }
  Outcome run(const std::vector<std::string>& words) { return run_program(folder_.path(), words); }
  json ask(std::vector<std::string> more = {}) {
    more.insert(more.begin(), {"ask", "run", "--json"});
    const Outcome asked = run(more);
    EXPECT_EQ(asked.exit_code, 0) << asked.err;
    return json::parse(asked.out);
  }
  Outcome tell(const std::string& text) {
    write("results.txt", text);
    return run({"tell", "run", "results.txt"});
  }
  static double measure(const json& x) {
    const double gain = x.at("gain").get<double>() - 1;
    const double steps = x.at("steps").get<double>() - 2;
    return gain * gain + steps * steps + (x.at("oil") == "thin" ? 1 : 0);
  }
  // Tells the newest point first.
  static std::string answer(const json& points) {
    std::string text;
    for (const json& point : points) {
      text = json{{"id", point.at("id")}, {"objectives", {measure(point.at("x"))}}}.dump() + "\n" +
             text;
    }
    return text;
  }
  void begin(const std::string& optimizer, const std::string& budget) {
    const Outcome begun = run({"ask", "run", "--problem", "bench.toml", "--optimizer", optimizer,
                               "--budget", budget, "--waiting"});
    ASSERT_EQ(begun.exit_code, 2) << "a run that has not begun has no waiting points";
    ask({"--problem", "bench.toml", "--optimizer", optimizer, "--budget", budget, "--count", "1"});
  }

  const TemporaryFolder folder_;
};

TEST_F(CliAskTell, ARunInAnyOrderAndWithAMissingResultEndsWithAWinner) {
  begin("cmaes", "40");
  json waiting = ask({"--waiting"}).at("points");
  ASSERT_EQ(waiting.size(), 1u);
  ASSERT_EQ(tell(R"({"id": 0, "missing": "the fuse blew"})").exit_code, 0);
  for (int round = 0; round < 60; ++round) {
    const json asked = ask({"--count", "3"});
    if (!asked.contains("points")) {
      EXPECT_TRUE(asked.contains("winner")) << asked;
      EXPECT_EQ(ask({}), asked) << "a finished run has its result again";
      EXPECT_THAT(run({"show", "run"}).out, HasSubstr("bench: cmaes"));
      EXPECT_EQ(run({"report", "run", "--out", "page.html"}).exit_code, 0);
      EXPECT_EQ(run({"doctor", "run"}).exit_code, 0);
      EXPECT_THAT(tell(R"({"id": 3, "objectives": [1]})").err, HasSubstr("has a result already"));
      return;
    }
    const Outcome told = tell(answer(asked.at("points")));
    ASSERT_EQ(told.exit_code, 0) << told.err;
  }
  FAIL() << "the run does not end";
}

TEST_F(CliAskTell, CsvHasWordsAndComesBackFilledIn) {
  ASSERT_EQ(run({"ask", "run", "--problem", "bench.toml", "--optimizer", "random", "--budget", "6",
                 "--csv", "next.csv"})
                .exit_code,
            0);
  std::string text = read_text(folder_ / "next.csv");
  EXPECT_THAT(text, AllOf(HasSubstr("id,gain,steps,oil,error,missing\n"), HasSubstr("thick, old")));
  for (std::size_t at = text.find(",,\n"); at != std::string::npos; at = text.find(",,\n", at)) {
    text.replace(at, 3, ",0.5,\n");
  }
  const Outcome told = tell(text);
  EXPECT_EQ(told.exit_code, 0) << told.err;
  EXPECT_THAT(run({"ask", "run"}).err, HasSubstr("the run has ended"));
}

TEST_F(CliAskTell, RefusedResultsNameTheLineAndRecordNothing) {
  begin("random", "40");
  ask({"--count", "1"});
  const std::string good = answer(ask({"--waiting"}).at("points"));
  const std::string journal = read_text(folder_ / "run/journal");
  const auto refuse = [&](const std::string& line) {
    const Outcome told = tell(good + line);
    EXPECT_NE(told.exit_code, 0) << line;
    EXPECT_EQ(read_text(folder_ / "run/journal"), journal) << line;
    return told.err;
  };
  EXPECT_THAT(refuse(R"({"id": 90, "objectives": [1]})"),
              HasSubstr("results.txt:3: point 90 was never handed out"));
  EXPECT_THAT(refuse(R"({"id": 1, "objectives": [1]})"),
              HasSubstr("results.txt:3: point 1 has another result at results.txt:1"));
  EXPECT_THAT(refuse(R"({"id": 0, "objectives": [1, 2]})"), HasSubstr("results.txt:3: "));
  EXPECT_THAT(refuse(R"({"id": 0, "objectives": [NaN]})"), HasSubstr("results.txt:3: "));
  EXPECT_THAT(refuse(R"({"id": 0, "objectives": ["high"]})"), HasSubstr("results.txt:3: "));
  EXPECT_THAT(refuse(R"({"id": 0, "objec)"), HasSubstr("results.txt:3: is"));
  EXPECT_THAT(tell("id,error\n0,nan\n").err, HasSubstr("results.txt:2: its 'error' is 'nan'"));
  EXPECT_THAT(tell("id,error\n0\n").err, HasSubstr("results.txt:2: has 1 fields"));
  EXPECT_EQ(read_text(folder_ / "run/journal"), journal);
  EXPECT_EQ(tell(good).exit_code, 0);
}

TEST_F(CliAskTell, AKilledTellRecordsWholeResultsAndTheRunGoesOn) {
  begin("random", "30");
  const json points = ask({}).at("points");
  write("results.txt", answer(points));
  {
    const Program killed(folder_.path(), {"tell", "run", "results.txt"});
    killed.send(SIGKILL);
  }
  // The points without a result are told now; those that the killed process recorded are not.
  const json waiting = ask({"--waiting"}).at("points");
  const Outcome told = tell(answer(waiting));
  ASSERT_EQ(told.exit_code, 0) << told.err;
  EXPECT_TRUE(ask({}).contains("winner"));
}

TEST_F(CliAskTell, ACobylaRunHasOnePointPerAsk) {
  write("bowl.toml",
        "kind = \"external\"\n[[variable]]\nname = \"x\"\nlower = -4\nupper = 4\nstart = 3\n"
        "[[objective]]\nname = \"f\"\n");
  const Outcome first = run({"ask", "run", "--problem", "bowl.toml", "--optimizer", "nlopt:cobyla",
                             "--budget", "15", "--json"});
  if (first.exit_code == 2 && first.err.find("without NLopt") != std::string::npos) {
    GTEST_SKIP() << "this build has no NLopt";
  }
  ASSERT_EQ(first.exit_code, 0) << first.err;
  json asked = json::parse(first.out);
  int points = 0;
  for (; asked.contains("points"); asked = ask({})) {
    ASSERT_EQ(asked.at("points").size(), 1u);
    ++points;
    const double x = asked.at("points")[0].at("x").at("x").get<double>();
    const json line = {{"id", asked.at("points")[0].at("id")}, {"objectives", {x * x}}};
    ASSERT_EQ(tell(line.dump()).exit_code, 0);
  }
  EXPECT_LE(points, 15);
  EXPECT_TRUE(asked.contains("winner"));
}

// Points that an optimizer recommends without an evaluation are judged by optimize only. With these
// budgets, the winners are evaluated points.
TEST_F(CliAskTell, ByHandARunEndsWithTheResultOfOptimize) {
  const std::string problem = "exec:python3 " ARMWRIGHT_TEST_PLUGINS_SOURCE "/problem.py";
  const auto read_evaluated = [&](const std::string& run_folder) {
    const json result = json::parse(read_text(folder_ / run_folder / "result.json"));
    json evaluated = json::array();
    for (const json& candidate : result.at("candidates")) {
      if (!candidate.contains("recommended")) {
        evaluated.push_back(candidate);
      }
    }
    return json{{"counts", result.at("counts")},
                {"end", result.at("end_reason")},
                {"test", result.at("winner").at("test")},
                {"candidates", evaluated}};
  };
  using Pairs = std::vector<std::pair<const char*, const char*>>;
  for (const auto& [optimizer, budget] :
       sample_or_all<Pairs>({{"ga", "75"}}, {{"ga", "75"}, {"cmaes", "90"}, {"lhs", "30"}})) {
    std::vector<std::string> words = {problem, "--optimizer", optimizer, "--budget",
                                      budget,  "--seed",      "7"};
    std::vector<std::string> optimize = {"optimize", "--quiet", "--out", "whole"};
    optimize.insert(optimize.end(), words.begin(), words.end());
    ASSERT_EQ(run(optimize).exit_code, 0) << optimizer;
    words.insert(words.begin(), "--problem");
    json asked = ask(words);
    for (; asked.contains("points"); asked = ask()) {
      std::string text;
      for (const json& point : asked.at("points")) {
        const json& x = point.at("x");
        const double f = x.at("x").get<double>() * x.at("x").get<double>() +
                         x.at("n").get<double>() * x.at("n").get<double>() +
                         (x.at("word") == "dear" ? 1 : 0);
        text += json{{"id", point.at("id")}, {"objectives", {f}}}.dump() + "\n";
      }
      ASSERT_EQ(tell(text).exit_code, 0) << optimizer;
    }
    EXPECT_EQ(read_evaluated("run"), read_evaluated("whole")) << optimizer;
    EXPECT_EQ(read_text(folder_ / "run/convergence.csv"),
              read_text(folder_ / "whole/convergence.csv"))
        << optimizer;
    std::filesystem::remove_all(folder_ / "run");
    std::filesystem::remove_all(folder_ / "whole");
  }
}

TEST_F(CliAskTell, OptimizeCompareAndEvaluateSayThatNobodyComputesAnExternalProblem) {
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"optimize", "bench.toml", "--optimizer", "random"},
        {"compare", "--problems", "bench.toml", "--optimizers", "random,ga"},
        {"evaluate", "start", "--problem", "bench.toml"}}) {
    const Outcome refused = run(words);
    EXPECT_EQ(refused.exit_code, 2) << words.front();
    EXPECT_THAT(refused.err, HasSubstr("'armwright ask RUN --problem FILE' hands out its points"));
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "results"));
}

TEST_F(CliAskTell, CommandsForArmsRefuseAProblemWithoutAnArm) {
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"verify", "start", "--problem", "bench.toml"},
        {"sweep", "bench.toml"},
        {"testset", "bench.toml"}}) {
    const Outcome refused = run(words);
    EXPECT_EQ(refused.exit_code, 2) << words.front();
    EXPECT_THAT(refused.err, HasSubstr("bench")) << words.front();
  }
}

}  // namespace
}  // namespace armwright
