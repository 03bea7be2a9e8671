// Study folders that somebody else made: looking at them starts nothing, and running what they name
// needs consent.
#include <gmock/gmock.h>
#include <signal.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "base/hash.hpp"
#include "base/temporary_folder.hpp"
#include "e2e/program.hpp"

namespace armwright {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

using Words = std::vector<std::string>;

constexpr const char* kProgram = R"(exec:sh -c "id > PWNED")";
constexpr const char* kLibrary = "./study/evil.so";

class CliTrust : public testing::Test {
 protected:
  Outcome run(const Words& words, const Environment& environment = {}) {
    return run_program(folder_.path(), words, environment);
  }

  void make_study(const std::string& optimizers = "ga,cmaes") {
    const Outcome outcome =
        run({"compare", "--problems", "sphere", "--optimizers", optimizers, "--replicates", "5",
             "--budget", "30", "--out", "study", "--quiet"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }

  // Replaces a text in the plan and gives the plan a valid hash, as anybody can. Checksums of the
  // study go away, as anybody can remove them.
  void edit_plan(const std::string& what, const std::string& by) {
    const auto file = folder_ / "study/study.toml";
    std::string text = read_text(file);
    ASSERT_NE(text.find(what), std::string::npos) << text;
    text.replace(text.find(what), what.size(), by);
    const std::string body = text.substr(text.find('\n') + 1);
    std::filesystem::remove(folder_ / "study/SHA256SUMS");
    std::ofstream(file) << "plan_sha256 = \"" << calc_sha256_hex(body) << "\"\n" << body;
  }

  // A finished study two optimizers of which have become plugins.
  void make_hostile_study() {
    make_study();
    edit_plan("name = \"ga\"", "name = " + nlohmann::json(kProgram).dump());
    edit_plan("name = \"cmaes\"", std::string("name = \"") + kLibrary + "\"");
    std::filesystem::copy_file(std::string(ARMWRIGHT_TEST_PLUGINS) + "/libgood.so",
                               folder_ / kLibrary);
  }

  // Commands that only read the study.
  static std::vector<Words> list_readers() {
    return {{"show", "study"},
            {"show", "study", "--json"},
            {"status", "study"},
            {"report", "study", "--out", "report.html"},
            {"report", "study", "study", "--out", "comparison.html"},
            {"plot", "study", "--out", "figures"},
            {"export", "study", "--format", "csv", "--out", "export"},
            {"doctor", "study"},
            {"merge", "study", "--quiet"},
            {"list", "studies", "study/study.toml"},
            {"compare", "study/study.toml", "--out", "study", "--dry-run"},
            {"show", "study/cells/sphere/ga/r01"},
            {"report", "study/cells/sphere/ga/r01", "--out", "cell.html"}};
  }

  // Watches the study until its page is served.
  void watch(Environment environment = {}) {
    environment.own_group = true;
    Program program(folder_.path(), {"watch", "study"}, environment);
    wait_for_address(folder_.path());
    program.send_group(SIGINT);
    EXPECT_EQ(program.wait().exit_code, 0);
  }

  TemporaryFolder folder_;
};

TEST_F(CliTrust, LookingAtAStudyStartsNothing) {
  make_hostile_study();
  for (const Words& words : list_readers()) {
    const Outcome outcome = run(words);
    EXPECT_FALSE(std::filesystem::exists(folder_ / "PWNED")) << words[0];
    EXPECT_TRUE(outcome.exit_code == 0 || words[0] == "doctor") << words[0] << outcome.err;
    std::filesystem::remove_all(folder_ / "figures");
  }
  watch();
  EXPECT_FALSE(std::filesystem::exists(folder_ / "PWNED"));
}

TEST_F(CliTrust, RunningAForeignStudyNeedsTrust) {
  make_hostile_study();
  const std::vector<Words> runners = {
      {"rerun", "study", "sphere/random/r01", "--out", "anew"},
      {"cell", "study", "0"},
      {"compare", "study/study.toml", "--out", "study"},
      {"compare", "study/study.toml", "--out", "another", "--executor", "script"}};
  for (const Words& words : runners) {
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.exit_code, 2) << words[0];
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("the study in " + (folder_ / "study").string()),
                                   HasSubstr("exec:sh -c \"id > PWNED\"; the library "),
                                   HasSubstr("evil.so"), HasSubstr("--trust")));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "PWNED")) << words[0];
    EXPECT_FALSE(std::filesystem::exists(folder_ / "another")) << words[0];
  }
  for (const Words& words : runners) {
    Words trusted = words;
    trusted.push_back("--trust");
    const Outcome outcome =
        run(trusted, {.variables = {{"XDG_STATE_HOME", "/dev/null/none"}}, .out_file = ""});
    EXPECT_EQ(outcome.exit_code, 4) << outcome.err;  // the program describes nothing
    EXPECT_TRUE(std::filesystem::remove(folder_ / "PWNED")) << words[0];
  }
}

TEST_F(CliTrust, OnATerminalTheUserIsAsked) {
  make_hostile_study();
  const Words words = {"rerun", "study", "sphere/random/r01", "--out", "anew"};
  EXPECT_THAT(run_on_terminal(folder_.path(), words, {}, 100, "n\n"),
              AllOf(HasSubstr("exec:sh -c \"id > PWNED\""), HasSubstr("Run it? [y/N]"),
                    HasSubstr("--trust")));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "PWNED"));
  run_on_terminal(folder_.path(), words, {}, 100, "y\n");
  EXPECT_TRUE(std::filesystem::remove(folder_ / "PWNED"));
  // The answer is remembered, until the study names something else.
  EXPECT_EQ(run(words).exit_code, 4);
  EXPECT_TRUE(std::filesystem::remove(folder_ / "PWNED"));
  edit_plan("id > PWNED", "id -u > PWNED");
  EXPECT_EQ(run(words).exit_code, 2);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "PWNED"));
}

TEST_F(CliTrust, WhoStartedAStudyIsNotAsked) {
  const std::string library = std::string(ARMWRIGHT_TEST_PLUGINS) + "/libgood.so";
  make_study("random," + library);
  const Words rerun = {"rerun", "study", "sphere/pattern/r01", "--quiet"};
  EXPECT_EQ(run(rerun).exit_code, 0);
  EXPECT_EQ(run({"compare", "study/study.toml", "--out", "study", "--quiet"}).exit_code, 0);
  const auto state = folder_ / ".state";
  ASSERT_TRUE(std::filesystem::exists(state / "armwright/studies"));
  std::filesystem::remove_all(state);
  EXPECT_EQ(run(rerun).exit_code, 2);
  EXPECT_EQ(run({"rerun", "study", "sphere/pattern/r01", "--quiet", "--trust"}).exit_code, 0);
  EXPECT_EQ(run(rerun).exit_code, 0);
}

// The program of a problem is a plugin, too: its description is recorded.
TEST_F(CliTrust, AProblemIsReadWithoutItsProgramAndRunsWithConsentOnly) {
  std::filesystem::copy_file(std::string(ARMWRIGHT_TEST_PLUGINS_SOURCE) + "/problem.py",
                             folder_ / "mine.py");
  const Outcome made =
      run({"compare", "--problems", "exec:python3 mine.py", "--optimizers", "random",
           "--no-baselines", "--replicates", "2", "--budget", "20", "--out", "study", "--quiet"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  std::filesystem::remove(folder_ / "mine.py");
  for (const Words& words : list_readers()) {
    if (words[1].find("cells") == std::string::npos) {
      const Outcome outcome = run(words);
      EXPECT_EQ(outcome.exit_code, 0) << words[0] << outcome.err;
      std::filesystem::remove_all(folder_ / "figures");
      std::filesystem::remove_all(folder_ / "export");
    }
  }
  const std::string plan = read_text(folder_ / "study/study.toml");
  const std::size_t hash = plan.find("configuration_sha256");
  edit_plan(plan.substr(hash, plan.find('\n', hash) - hash), "");
  edit_plan("exec:python3 mine.py", R"(exec:sh -c \"id > PWNED\")");
  for (const Words& words : list_readers()) {
    if (words[1].find("cells") == std::string::npos) {
      run(words);
      EXPECT_FALSE(std::filesystem::exists(folder_ / "PWNED")) << words[0];
    }
  }
  const Words rerun = {"rerun", "study", "faulty/random/r01", "--out", "anew"};
  EXPECT_THAT(run(rerun).err, AllOf(HasSubstr(kProgram), HasSubstr("--trust")));
  edit_plan("program.description=", R"(program.time_limit_s=5", "title=)");
  const Outcome refused = run({"show", "study"});
  EXPECT_EQ(refused.exit_code, 4);
  EXPECT_THAT(refused.err, HasSubstr("its description is not recorded"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "PWNED"));
}

// Without cells and without a hash, the file may be a user's own, but not where the folder is named.
TEST_F(CliTrust, AFolderThatHoldsOnlyAStudysFileIsNotOfTheUser) {
  const std::filesystem::path received = folder_ / "received";
  std::filesystem::create_directory(received);
  const std::string study = "replicates = 2\nbudget = 20\n";
  const std::string problem = "[[problem]]\nname = " + nlohmann::json(kProgram).dump() + "\n";
  const std::string optimizer = "[[optimizer]]\nname = " + nlohmann::json(kProgram).dump() + "\n";
  for (const std::string& text : {problem + "[[optimizer]]\nname = \"random\"\n",
                                  "[[problem]]\nname = \"sphere\"\n" + optimizer}) {
    std::ofstream(received / "study.toml") << study << text;
    const std::vector<Words> all = {{"rerun", "received", "sphere/random/r01"},
                                    {"cell", "received", "0"},
                                    {"show", "received"},
                                    {"status", "received"},
                                    {"doctor", "received"}};
    for (const Words& words : all) {
      const Outcome outcome = run(words);
      EXPECT_NE(outcome.exit_code, 0) << words[0] << outcome.out;
      EXPECT_THAT(outcome.out + outcome.err, Not(HasSubstr("compare received/study.toml")));
      EXPECT_FALSE(std::filesystem::exists(folder_ / "PWNED")) << words[0] << text;
    }
  }
}

TEST_F(CliTrust, JobsInheritTheConsent) {
  const std::string library = std::string(ARMWRIGHT_TEST_PLUGINS) + "/libgood.so";
  const Outcome script =
      run({"compare", "--problems", "sphere", "--optimizers", "random," + library, "--replicates",
           "2", "--budget", "30", "--out", "study", "--executor", "script", "--quiet"});
  ASSERT_EQ(script.exit_code, 0) << script.err;
  EXPECT_THAT(script.out, HasSubstr("cell --jobs 1 --trust \"$study\""));
  EXPECT_EQ(run({"cell", "study", "0-5", "--trust", "--quiet"},
                {.variables = {{"XDG_STATE_HOME", "/dev/null/none"}}, .out_file = ""})
                .exit_code,
            0);
  EXPECT_EQ(run({"merge", "study", "--quiet"}).exit_code, 0);
}

TEST_F(CliTrust, AStudyIsReadWhenItsPluginsAreGone) {
  std::filesystem::copy_file(std::string(ARMWRIGHT_TEST_PLUGINS) + "/libgood.so",
                             folder_ / "mine.so");
  std::filesystem::copy_file(std::string(ARMWRIGHT_TEST_PLUGINS_SOURCE) + "/good.py",
                             folder_ / "mine.py");
  make_study("multistart:./mine.so,./mine.so,exec:python3 mine.py");
  const std::string plan = read_text(folder_ / "study/study.toml");
  const std::string shown = run({"show", "study"}).out;
  const auto tables = read_study(folder_ / "study");
  EXPECT_THAT(shown, AllOf(HasSubstr("pattern"), HasSubstr("lcg")));
  std::filesystem::remove(folder_ / "mine.so");
  std::filesystem::remove(folder_ / "mine.py");
  EXPECT_EQ(run({"show", "study"}).out, shown);
  for (const Words& words : list_readers()) {
    if (words[1].find("cells") == std::string::npos) {
      const Outcome outcome = run(words);
      EXPECT_EQ(outcome.exit_code, 0) << words[0] << outcome.err;
    }
  }
  EXPECT_EQ(read_study(folder_ / "study"), tables);
  EXPECT_EQ(read_text(folder_ / "study/study.toml"), plan);
  EXPECT_THAT(read_text(folder_ / "report.html"), HasSubstr("multistart:pattern"));
  EXPECT_NE(run({"rerun", "study", "sphere/pattern/r01", "--trust"}).exit_code, 0);
}

// Returns whether strace may watch a program here.
bool can_trace(const std::filesystem::path& folder) {
  return run_program(
             folder, {"--version"},
             {.variables = {},
              .out_file = "",
              .launcher = {"sh", "-c", "strace -f -qq -o trace \"$@\" >/dev/null 2>&1", "sh"}})
             .exit_code == 0;
}

TEST_F(CliTrust, NoReaderExecutesAProgramOrOpensALibraryOfTheStudy) {
  if (!can_trace(folder_.path())) {
    GTEST_SKIP() << "strace cannot watch a program here: it is not installed, or ptrace is not "
                    "permitted";
  }
  make_hostile_study();
  const Environment traced{.variables = {},
                           .out_file = "",
                           .launcher = {"strace", "-f", "-qq", "-e",
                                        "trace=execve,execveat,open,openat", "-o", "trace"}};
  const auto expect_harmless = [&](const std::string& command) {
    std::ifstream trace(folder_ / "trace");
    int executed = 0;
    int opened = 0;
    for (std::string line; std::getline(trace, line);) {
      executed += line.find("execve") != std::string::npos ? 1 : 0;  // the command's own
      opened += line.find("\"study") != std::string::npos ? 1 : 0;
      EXPECT_THAT(line, Not(HasSubstr("evil.so"))) << command;
    }
    EXPECT_EQ(executed, 1) << command;
    EXPECT_GT(opened, 0) << command;
  };
  for (const Words& words : list_readers()) {
    run(words, traced);
    expect_harmless(words[0]);
    std::filesystem::remove_all(folder_ / "figures");
  }
  watch(traced);
  expect_harmless("watch");
}

}  // namespace
}  // namespace armwright
