// Problems of users on the command line: runs, comparisons, what resumes and what is refused.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <ostream>

#include "base/temporary_folder.hpp"
#include "e2e/program.hpp"
#include "wait_until.hpp"

namespace armwright {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class CliUserProblem : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::copy_file(ARMWRIGHT_TEST_PLUGINS_SOURCE "/problem.py", folder_ / "mine.py");
  }

  Outcome run(const std::vector<std::string>& words) { return run_program(folder_.path(), words); }

  void write(const std::string& name, const std::string& text) {
    std::ofstream(folder_ / name) << text;
  }

  json read_result(const std::string& run_folder) {
    return json::parse(read_text(folder_ / run_folder / "result.json"));
  }

  // Optimizes into the folder "run". The command fails if a case of the winner does.
  void optimize(const std::string& problem) {
    const Outcome made = run({"optimize", problem, "--optimizer", "random", "--budget", "40",
                              "--out", "run", "--quiet"});
    ASSERT_EQ(made.exit_code, 0) << made.err;
  }

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
  EXPECT_THAT(made.out, AllOf(HasSubstr("faulty: auto, seed 1"), HasSubstr("auto chose "),
                              HasSubstr("failed")));
  std::filesystem::remove(folder_ / "mine.py");
  const std::string run_folder = "results/faulty-auto-seed1";
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
  EXPECT_THAT(
      changed.err,
      AllOf(HasSubstr("another configuration"), HasSubstr("the input 'mine.py' has changed"),
            HasSubstr("program.description.variables.0.lower: recorded -5.0, now -6.0")));
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

// Two objectives, of which one is maximised, a constraint, a metric and three test cases.
constexpr const char* kCommandProblem = R"raw(kind = "command"
[command]
run = "awk -f {folder}/mine.awk in.txt"
[[command.input]]
file = "in.txt"
text = "{x} {n} {word} {case}\n"
[[variable]]
name = "x"
lower = -5
upper = 5
[[variable]]
name = "n"
type = "integer"
lower = -3
upper = 8
[[variable]]
name = "word"
type = "category"
choices = ["plain", "dear"]
[[objective]]
name = "gain"
direction = "maximize"
regex = "gain (.+)"
[[objective]]
name = "cost"
regex = "cost (.+)"
[[constraint]]
name = "heat"
limit = 8
regex = "heat (.+)"
[[metric]]
name = "mass"
regex = "mass (.+)"
[cases]
training = 2
validation = 2
test = 3
)raw";

constexpr const char* kCommandProgram =
    R"({ printf "gain %.17g\ncost %.17g\n", $4 - $1 * $1, $2 + $4 + ($3 == "dear") }
{ printf "heat %.17g\nmass %.17g\n", $1 + 3 + $4, 10 * $4 }
)";

struct WrittenProblem {
  const char* name;
  const char* problem;
};

std::ostream& operator<<(std::ostream& out, const WrittenProblem& one) {
  return out << one.name;
}

class CliUserProblems : public CliUserProblem, public testing::WithParamInterface<WrittenProblem> {
 protected:
  void SetUp() override {
    CliUserProblem::SetUp();
    write("mine.toml", kCommandProblem);
    write("mine.awk", kCommandProgram);
  }
};

INSTANTIATE_TEST_SUITE_P(Kinds, CliUserProblems,
                         testing::Values(WrittenProblem{"Program", "exec:python3 mine.py rich"},
                                         WrittenProblem{"Command", "mine.toml"},
                                         WrittenProblem{"Library",
                                                        ARMWRIGHT_TEST_LIBRARIES "/libmixed.so"}),
                         [](const auto& kind) { return kind.param.name; });

TEST_P(CliUserProblems, EvaluateGivesTheRecordedNumbersOfTheWinner) {
  optimize(GetParam().problem);
  const Outcome evaluated =
      run({"evaluate", "run/winner.toml", "--problem", GetParam().problem, "--json"});
  ASSERT_EQ(evaluated.exit_code, 0) << evaluated.err;
  const json now = json::parse(evaluated.out);
  const json result = read_result("run");
  const json& recorded = result.at("winner").at("test");
  for (std::size_t i = 0; i < result.at("objectives").size(); ++i) {
    const auto name = result.at("objectives")[i].at("name").get<std::string>();
    EXPECT_EQ(now.at("objectives").at(name), recorded.at("objectives").at(i)) << name;
  }
  for (std::size_t i = 0; i < result.at("metrics").size(); ++i) {
    const auto name = result.at("metrics")[i].get<std::string>();
    EXPECT_EQ(now.at("metrics").at(name), recorded.at("metrics").at(i)) << name;
  }
  ASSERT_EQ(now.at("constraints").size(), 1u);
  EXPECT_TRUE(now.at("constraints").front().at("met"));
  EXPECT_EQ(now.at("cases"), recorded.at("case_errors").size());
}

TEST_P(CliUserProblems, CommandsForArmsSayWhyTheyRefuseAndWhatToDo) {
  const std::string problem = GetParam().problem;
  optimize(problem);
  const auto refuse = [&](const std::vector<std::string>& words) {
    const Outcome refused = run(words);
    EXPECT_THAT(refused.exit_code, testing::AnyOf(2, 4)) << words.front() << refused.out;
    EXPECT_EQ(refused.out, "") << words.front();
    EXPECT_THAT(refused.err, testing::StartsWith("armwright: error: "));
    return refused.err;
  };
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"verify", "start", "--problem", problem},
        {"verify", "table-a10", "--problem", problem},
        {"sweep", problem},
        {"sweep", problem, "--parameter", "x", "--values", "1,2", "--design", "run/winner.toml"},
        {"testset", "export", "test/1", "--cases", "3", "--problem", problem}}) {
    EXPECT_THAT(refuse(words), AllOf(HasSubstr("is one of your own and has no arm"),
                                     HasSubstr("'armwright evaluate winner.toml")))
        << words.front();
  }
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"verify", "run/winner.toml", "--problem", problem},
        {"verify", "run/winner.toml"},
        {"evaluate", "run/winner.toml"},
        {"sweep", "q2-e6", "--parameter", "task.load_kg", "--values", "1", "--design",
         "run/winner.toml"}}) {
    EXPECT_THAT(refuse(words), AllOf(HasSubstr("has the variables of a problem without an arm"),
                                     HasSubstr("'armwright evaluate FILE --problem PROBLEM'")))
        << words.front();
  }
  EXPECT_THAT(refuse({"reproduce", "--table", problem}), HasSubstr("Valid: A.5, A.6"));
  for (const char* format : {"ros2-control", "urdf", "datasheet"}) {
    EXPECT_THAT(refuse({"export", "run", "--format", format}),
                AllOf(HasSubstr("which has no arm"),
                      HasSubstr("The formats csv, ioh, coco and json work for every run")));
  }
  for (const char* format : {"csv", "ioh", "coco", "json"}) {
    EXPECT_EQ(run({"export", "run", "--format", format}).exit_code, 0) << format;
  }
  EXPECT_THAT(refuse({"import", "run/export-csv", "--config", problem}), HasSubstr("has no arm"));
}

}  // namespace
}  // namespace armwright
