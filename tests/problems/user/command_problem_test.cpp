// Problems that are a command per case: places, results, limits, folders, and what is refused.
#include <gmock/gmock.h>
#include <signal.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "base/expect_error.hpp"
#include "problems/changed_text.hpp"
#include "problems/problem_folder.hpp"
#include "problems/user/user_problem.hpp"
#include "process/process_watch.hpp"
#include "process/stop_scope.hpp"
#include "wait_until.hpp"

namespace armwright {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;
using testing::StartsWith;

// A problem whose command is a script of sh, with one variable of each type.
std::string make_problem(const std::string& script, const std::string& objective,
                         const std::string& more = "") {
  return "kind = \"command\"\n[command]\nrun = \"sh script\"\ntime_limit_s = 20\n" + more +
         "[[command.input]]\nfile = \"script\"\ntext = '''\n" + script +
         "'''\n"
         "[[variable]]\nname = \"x\"\nlower = -5\nupper = 5\n"
         "[[variable]]\nname = \"n\"\ntype = \"integer\"\nlower = 0\nupper = 9\n"
         "[[variable]]\nname = \"kind\"\ntype = \"category\"\nchoices = [\"round\", \"two "
         "words\"]\n"
         "[[objective]]\nname = \"f\"\n" +
         objective;
}

Evaluation evaluate_command(const LoadedProblem& loaded, std::vector<double> x,
                            std::vector<std::uint64_t> cases = {0},
                            CaseRole role = CaseRole::training) {
  return loaded.problem->evaluate(x, {role, "train/1", std::move(cases)});
}

Evaluation run(const std::string& script, const std::string& objective,
               const std::string& more = "", std::vector<double> x = {0.25, 3, 1}) {
  const ProblemFolder folder;
  folder.write("p.toml", make_problem(script, objective, more));
  return evaluate_command(folder.load("p.toml"), std::move(x));
}

TEST(CommandProblem, ValuesGoIntoPlacesAndResultsComeOutOfFiles) {
  EXPECT_THAT(run("echo '{{\"a\": [{x}, {n}]}' > out.json\n",
                  "from = \"out.json\"\njson = \"/a/0\"\n[[objective]]\nname = \"g\"\n"
                  "from = \"out.json\"\njson = \"/a/1\"\ndirection = \"maximize\"\n")
                  .objectives,
              ElementsAre(0.25, -3));
}

TEST(CommandProblem, AColumnGivesItsRow) {
  const std::string script = "printf 't, v\\n0, 3\\n1, -1.5e0\\n2, +7\\n' > o.csv\n";
  const auto read = [&](const std::string& reading) {
    return run(script, "from = \"o.csv\"\n" + reading).objectives.at(0);
  };
  EXPECT_EQ(read("column = \"v\"\n"), 7);
  EXPECT_EQ(read("column = \"v\"\nrow = \"first\"\n"), 3);
  EXPECT_EQ(read("column = \"v\"\nrow = \"min\"\n"), -1.5);
  EXPECT_EQ(read("column = \"v\"\nrow = \"max\"\n"), 7);
  EXPECT_EQ(read("column = \"2\"\nrow = \"mean\"\n"), 8.5 / 3);
}

TEST(CommandProblem, ColumnsMayHaveBlanksBetweenThemAndNoHeader) {
  EXPECT_THAT(
      run("printf ' 0.0   1.5 \\n 1.0 2.5\\n'\n", "column = \"2\"\nrow = \"first\"\n").objectives,
      ElementsAre(1.5));
}

TEST(CommandProblem, TheLastLineThatMatchesCounts) {
  EXPECT_THAT(
      run("echo error: 3; echo error: 2e-1 m; echo done\n", "regex = 'error: ([0-9.e+-]+)'\n")
          .objectives,
      ElementsAre(0.2));
}

TEST(CommandProblem, TheExitCodeCanBeTheResult) {
  EXPECT_THAT(run("exit {n}\n", "exit_code = true\n").objectives, ElementsAre(3));
  const Evaluation killed = run("kill -9 $$\n", "exit_code = true\n");
  EXPECT_EQ(killed.reason, "the command was killed by signal 9 (Killed)");
}

// The stop arrives when the command has ended; after a death by a signal even later.
TEST(CommandProblem, ADeathWithTheStopOfTheRunIsNoFailedCase) {
  for (const auto& [end, looks] : {std::pair{"kill -TERM $$", 3}, {"exit 143", 3}, {"exit 4", 1}}) {
    const ProblemFolder folder;
    folder.write("p.toml", make_problem(std::string("echo $$ > '{folder}/pid'; ") + end + "\n",
                                        "regex = '(1)'\n"));
    const LoadedProblem loaded = folder.load("p.toml");
    StopSignal stop;
    int left = looks;
    stop.set_lookout([&] {
      std::ifstream file(folder.path("pid"));
      pid_t pid = 0;
      if (file >> pid && kill(pid, 0) != 0 && --left == 0) {
        stop.request(StopReason::terminated);
      }
    });
    const StopScope scope(&stop);
    EXPECT_THROW(evaluate_command(loaded, {0, 0, 0}), WorkStopped) << end;
  }
}

TEST(CommandProblem, AValueNeverAddsAWord) {
  const ProblemFolder folder;
  std::string text = make_problem("echo $#\n", "regex = '([0-9]+)'\n");
  text = change_text(text, "[command]", "run", "\"sh script {kind} '{n} {kind}'\"");
  folder.write("p.toml", text);
  EXPECT_THAT(evaluate_command(folder.load("p.toml"), {0, 3, 1}).objectives, ElementsAre(2));
}

TEST(CommandProblem, PlacesTellTheCaseAndItsSeed) {
  const ProblemFolder folder;
  folder.write("p.toml", make_problem("echo {role} {case} {seed} > '{folder}/{case}'; echo 1\n",
                                      "regex = '(1)'\n", "") +
                             "[cases]\ntraining = 0\n");
  const LoadedProblem loaded = folder.load("p.toml");
  evaluate_command(loaded, {0, 0, 0}, {4, 7});
  const auto read = [&](const std::string& name) {
    std::ifstream file(folder.path(name));
    std::string role;
    std::uint64_t number = 0;
    std::uint64_t seed = 0;
    file >> role >> number >> seed;
    EXPECT_EQ(role, "training");
    EXPECT_EQ(std::to_string(number), name);
    return seed;
  };
  EXPECT_NE(read("4"), read("7"));
}

TEST(CommandProblem, FailuresHaveReasonsThatAreTheSameEachTime) {
  const std::string result = "from = \"out.json\"\njson = \"/f\"\n";
  const auto reason = [&](const std::string& script, const std::string& objective,
                          const std::string& more = "") {
    const Evaluation evaluation = run(script, objective, more);
    EXPECT_THAT(evaluation.objectives, IsEmpty());
    EXPECT_EQ(evaluation.reason, run(script, objective, more).reason);
    return evaluation.reason;
  };
  EXPECT_EQ(reason("exit 3\n", result), "the command ended with exit code 3");
  EXPECT_EQ(reason("true\n", result), "the command left no result: it wrote no file 'out.json'");
  EXPECT_EQ(reason("echo '{{' > out.json\n", result),
            "the command left no result: 'out.json' is not JSON");
  EXPECT_EQ(reason("echo '{{\"g\":1}' > out.json\n", result),
            "the command left no result: 'out.json' has nothing at '/f'");
  EXPECT_EQ(reason("echo '{{\"f\":\"a\"}' > out.json\n", result),
            "the command left no result: 'out.json' has no finite number at '/f'");
  EXPECT_EQ(reason("mkdir out.json\n", result),
            "the command left no result: 'out.json' is no readable file of at most 64 MiB");
  EXPECT_EQ(reason("printf 'a,b\\n1,nan\\n'\n", "column = \"b\"\n"),
            "the command left no result: column 'b' of its standard output is not a finite number");
  EXPECT_EQ(reason("printf 'a,b\\n1,2\\n'\n", "column = \"c\"\n"),
            "the command left no result: its standard output has no column 'c'");
  EXPECT_EQ(reason("printf 'a,b\\n'\n", "column = \"b\"\n"),
            "the command left no result: its standard output has no row with the column 'b'");
  EXPECT_EQ(reason("echo none\n", "regex = 'e: (.*)'\n"),
            "the command left no result: its standard output has no line that matches 'e: (.*)'");
}

TEST(CommandProblem, AWarningHasWhatTheCommandWroteAndTheRecordedReasonHasNot) {
  const ProblemFolder folder;
  folder.write("p.toml", make_problem("echo \"process $$: no mesh\" >&2; echo f = $$-{x}\n",
                                      "regex = 'f = (.*)'\n"));
  const LoadedProblem loaded = folder.load("p.toml");
  const std::string reason =
      "the command left no result: the match of 'f = (.*)' in its standard output is not a finite "
      "number";
  EXPECT_EQ(evaluate_command(loaded, {0.25, 0, 0}).reason, reason);
  const auto told = find_warnings(*loaded.problem)->take();
  ASSERT_THAT(told, SizeIs(1));
  EXPECT_THAT(told.front(),
              AllOf(StartsWith(reason + "; it is '"), HasSubstr("-0.25'"), HasSubstr(": no mesh")));
}

TEST(CommandProblem, ATimeLimitKillsWhatTheCommandStarted) {
  const ProblemFolder folder;
  std::string text =
      make_problem("sleep 1000 & echo $! > '{folder}/pid'; wait\n", "regex = '(.)'\n");
  text = change_text(text, "[command]", "time_limit_s", "3");
  folder.write("p.toml", text);
  const Evaluation evaluation = evaluate_command(folder.load("p.toml"), {0, 0, 0});
  EXPECT_EQ(evaluation.status, EvaluationStatus::timed_out);
  EXPECT_EQ(evaluation.reason, "the command has not ended within 3 s (command.time_limit_s)");
  std::string pid;
  std::ifstream(folder.path("pid")) >> pid;
  ASSERT_THAT(pid, Not(IsEmpty()));
  EXPECT_TRUE(wait_until([&] {
    std::ifstream state("/proc/" + pid + "/stat");
    std::string number, name, letter;
    return !(state >> number >> name >> letter) || letter == "Z";
  })) << "the command's own child still runs";
}

TEST(CommandProblem, MemoryHasALimit) {
  const Evaluation evaluation =
      run("exec awk 'BEGIN {{ s = \"0123456789abcdef\"; while (1) s = s s }'\n", "regex = '(.)'\n",
          "memory_mib = 64\n");
  EXPECT_EQ(evaluation.reason, "the command took more than 64 MiB of memory (command.memory_mib)");
}

TEST(CommandProblem, OutputWithoutEndIsNotKept) {
  const std::int64_t before = measure_memory("self")->data_bytes;
  const Evaluation evaluation = run("head -c 200000000 /dev/zero; echo 5 > out.txt\n",
                                    "from = \"out.txt\"\ncolumn = \"1\"\n");
  EXPECT_THAT(evaluation.objectives, ElementsAre(5));
  EXPECT_EQ(run("head -c 100000000 /dev/zero\n", "column = \"1\"\n").reason,
            "the command left no result: its standard output is longer than 64 MiB");
  EXPECT_LT(measure_memory("self")->data_bytes - before, std::int64_t{160} << 20);
}

TEST(CommandProblem, WorkingFoldersAreRemovedOrKeptAsAsked) {
  const auto list = [](const std::string& keep) {
    const ProblemFolder folder;
    const std::string workspace = folder.path("cases");
    std::filesystem::create_directory(workspace);
    folder.write("p.toml",
                 make_problem("echo made > made; exit {n}\n", "from = \"made\"\nregex = 'm(.)'\n",
                              "workspace = \"" + workspace + "\"\nkeep = \"" + keep + "\"\n"));
    // Both fail: one by its exit code, one because 'a' is no number.
    evaluate_command(folder.load("p.toml"), {0, 0, 0});
    evaluate_command(folder.load("p.toml"), {0, 1, 0});
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(workspace)) {
      names.push_back(entry.path().filename().string());
      EXPECT_TRUE(std::filesystem::exists(entry.path() / "made"));
      EXPECT_TRUE(std::filesystem::exists(entry.path() / "armwright.command"));
    }
    return names;
  };
  EXPECT_THAT(list("none"), IsEmpty());
  EXPECT_THAT(list("failed"), SizeIs(2));
  EXPECT_THAT(list("all"), testing::Each(testing::StartsWith("training-case0-")));
}

TEST(CommandProblem, ARecordIsReadWithoutItsTemplate) {
  const ProblemFolder folder;
  folder.write("script.in", "echo {x}\n");
  std::string text = make_problem("", "regex = '(.+)'\n");
  text.replace(text.find("text = '''\n'''\n"), 15, "template = \"script.in\"\n");
  folder.write("p.toml", text);
  const LoadedProblem loaded = folder.load("p.toml");
  EXPECT_THAT(evaluate_command(loaded, {0.5, 0, 0}).objectives, ElementsAre(0.5));
  EXPECT_TRUE(loaded.input_hashes.contains("script.in"));
  EXPECT_EQ(loaded.program, "sh script");
  const LoadedProblem recorded = load_recorded_problem(loaded.resolved_json, "p", "/nowhere");
  EXPECT_EQ(recorded.resolved_json, loaded.resolved_json);
  EXPECT_EQ(recorded.input_hashes, loaded.input_hashes);
  EXPECT_THROW(evaluate_command(recorded, {0.5, 0, 0}), Error) << "a record starts nothing";
}

TEST(CommandProblem, BadFilesAreRefusedWithTheirLine) {
  const ProblemFolder folder;
  const std::string good = make_problem("echo {x}\n", "regex = '(.+)'\n");
  const auto refuse = [&](const std::string& what, const std::string& with) {
    std::string text = good;
    text.replace(text.find(what), what.size(), with);
    return folder.refusal_of(text);
  };
  EXPECT_EQ(refuse("lower = -5", "lower = 7"),
            "p.toml:12: variable[0].lower is 7; it must be less than upper, which is 5");
  EXPECT_EQ(refuse("lower = 0", "lower = 0.5").substr(0, 38),
            "p.toml:17: variable[1].lower is 0.5; a");
  EXPECT_THAT(refuse("name = \"n\"", "name = \"x\""),
              HasSubstr("p.toml:15: variable[1].name is 'x', which another one has"));
  EXPECT_THAT(refuse("name = \"n\"", "name = \"seed\""), HasSubstr("have other meanings"));
  EXPECT_THAT(refuse("name = \"n\"", "name = \"a b\""), HasSubstr("it must be a name"));
  EXPECT_THAT(refuse("\"two words\"", "\"round\""),
              HasSubstr("variable[2].choices has an empty word or the same word twice"));
  EXPECT_THAT(refuse("echo {x}", "echo {y}"),
              HasSubstr("unknown place 'y'. Valid: x, n, kind, seed, case, role, "
                        "folder; write {{ for a brace"));
  EXPECT_THAT(refuse("echo {x}", "echo {x"), HasSubstr("write {{ for a brace"));
  EXPECT_THAT(refuse("sh script", "sh 'script"), HasSubstr("every quote must be closed"));
  EXPECT_THAT(refuse("regex = '(.+)'", "regex = '.+'"), HasSubstr("must have a group"));
  EXPECT_THAT(refuse("regex = '(.+)'", "regex = '('"), HasSubstr("must be a regular expression"));
  EXPECT_THAT(refuse("regex = '(.+)'", "json = 'a'"), HasSubstr("must be a JSON pointer"));
  EXPECT_THAT(refuse("regex = '(.+)'", ""),
              HasSubstr("has 0 of json, column, regex and exit_code = true; give one"));
  EXPECT_THAT(refuse("regex = '(.+)'", "regex = '(.)'\nfrom = \"../a\""),
              HasSubstr("it must be the name of a file in the working folder"));
  EXPECT_THAT(refuse("file = \"script\"", "file = \"a/b\""),
              HasSubstr("it must be the name of a file in the working folder"));
  EXPECT_THAT(refuse("time_limit_s = 20", "keep = \"all\""), HasSubstr("name a folder for them"));
  EXPECT_THAT(folder.refusal_of(good.substr(0, good.find("[[objective]]"))),
              HasSubstr("[[objective]] is empty; a problem needs one objective or more"));
  EXPECT_THAT(folder.refusal_of(good + "[sets]\n[task]\n"), HasSubstr("unknown key"));
}

}  // namespace
}  // namespace armwright
