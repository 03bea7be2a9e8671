// Tests links, pipes and missing rights in folders of results that somebody else has prepared:
// nothing outside is overwritten, nothing hangs, and the messages name the file.
#include <sys/stat.h>

#include "faults/support.hpp"

namespace armwright::faults {
namespace {

namespace fs = std::filesystem;

class Links : public testing::Test {
 protected:
  Links() { write_text(victim_, "precious"); }
  Outcome run(const Words& words, const Environment& environment = {}) {
    return run_program(folder_.path(), words, environment);
  }
  Outcome compare() {
    write_text(folder_ / "plan.toml",
               "problems = [\"q1-complex\"]\noptimizers = [\"ga\", \"random\"]\nreplicates = 2\n"
               "budget = 60\nbaselines = false\nfinal_engine = \"ode\"\n");
    return run({"compare", "plan.toml", "--engine", "articulated", "--set", "sets.test_cases=4",
                "--set", "sets.validation_cases=2", "--out", "study", "--quiet"});
  }
  void plant(const std::string& name) {
    fs::remove_all(folder_ / name);
    fs::create_symlink(victim_, folder_ / name);
  }
  void expect_unharmed() const { EXPECT_EQ(read_text(victim_), "precious"); }

  TemporaryFolder folder_;
  const fs::path victim_ = folder_ / "victim";
};

TEST_F(Links, OfAUserToFoldersOfResultsAreFollowed) {
  fs::create_directories(folder_ / "data/other");
  fs::create_directory_symlink("data", folder_ / "results");
  fs::create_directory_symlink("data/other", folder_ / "link");
  EXPECT_EQ(run(make_run("results/run")).exit_code, 0);
  EXPECT_TRUE(fs::exists(folder_ / "data/run/results.sqlite"));
  EXPECT_EQ(run(make_run("link")).exit_code, 0);
  EXPECT_TRUE(fs::exists(folder_ / "data/other/result.json"));
  expect_same_run(folder_ / "data/run", folder_ / "data/other");
  EXPECT_EQ(run({"report", "link", "--out", "results/page.html"}).exit_code, 0);
  EXPECT_TRUE(fs::exists(folder_ / "data/page.html"));
}

TEST_F(Links, InAStudyAreReplacedByItsNewFiles) {
  ASSERT_EQ(compare().exit_code, 0);
  const auto whole = read_study(folder_ / "study");
  const std::string cell = "study/cells/q1-complex/ga/r01/";
  for (const std::string& name :
       {std::string("study/study.toml.new"), std::string("study/verdict.txt.new"),
        std::string("study/result.json.new"), std::string("study/problems/q1-complex.json.new"),
        std::string("study/tables/cells.csv.new"), std::string("study/tables/pairs.csv"),
        std::string("study/final/q1-complex/ga.json.new"), cell + "cell.json.new",
        cell + "result.json.new", cell + "winner.toml.new"}) {
    plant(name);
  }
  for (const std::string& name :
       {cell + "cell.json", cell + "result.json", std::string("study/final/q1-complex/ga.json")}) {
    fs::remove(folder_ / name);
  }
  const Outcome outcome = compare();
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(read_study(folder_ / "study"), whole);
  for (const auto& entry : fs::recursive_directory_iterator(folder_ / "study")) {
    EXPECT_TRUE(!entry.is_symlink() || entry.path().filename() == "study.toml.new") << entry;
  }
  expect_unharmed();
}

TEST_F(Links, InThePlaceOfAStudysFoldersAreRefusedByName) {
  ASSERT_EQ(compare().exit_code, 0);
  fs::create_directory(folder_ / "elsewhere");
  for (const char* name : {"tables", "problems", "cells", "final"}) {
    fs::rename(folder_ / "study" / name, folder_ / name);
    fs::create_directory_symlink(folder_ / "elsewhere", folder_ / "study" / name);
    const Outcome outcome = compare();
    // Cells run in processes of their own, whose errors are the study's failures.
    EXPECT_EQ(outcome.exit_code, name == std::string("cells") ? 3 : 4) << name << outcome.err;
    EXPECT_THAT(outcome.err,
                HasSubstr(std::string("study/") + name + ": is a symbolic link, and must be"));
    EXPECT_TRUE(fs::is_empty(folder_ / "elsewhere")) << name;
    fs::remove(folder_ / "study" / name);
    fs::rename(folder_ / name, folder_ / "study" / name);
  }
  plant("study/lock");
  const Outcome outcome = compare();
  EXPECT_EQ(outcome.exit_code, 4);
  EXPECT_THAT(outcome.err, HasSubstr("error: study/lock: is a symbolic link"));
  expect_unharmed();
}

TEST_F(Links, OfPagesAndFiguresAreReplacedOrRefused) {
  ASSERT_EQ(run(make_run("run")).exit_code, 0);
  plant("run/report.html.new");
  EXPECT_EQ(run({"report", "run", "--quiet"}).exit_code, 0);
  EXPECT_FALSE(fs::is_symlink(folder_ / "run/report.html"));
  fs::create_directory(folder_ / "elsewhere");
  fs::create_directory_symlink(folder_ / "elsewhere", folder_ / "run/figures");
  const Outcome outcome = run({"plot", "run", "--quiet"});
  EXPECT_EQ(outcome.exit_code, 4);
  EXPECT_THAT(outcome.err, HasSubstr("run/figures: is a symbolic link, and must be a folder"));
  EXPECT_TRUE(fs::is_empty(folder_ / "elsewhere"));
  EXPECT_EQ(run({"plot", "run", "--quiet", "--out", "elsewhere"}).exit_code, 0);
  EXPECT_FALSE(fs::is_empty(folder_ / "elsewhere"));
  expect_unharmed();
}

TEST_F(Links, AndPipesAsARunsFilesEndEveryReaderAtOnce) {
  ASSERT_EQ(run(make_run("run")).exit_code, 0);
  for (const std::string name : {"manifest.json", "result.json", "winner.toml", "journal"}) {
    fs::rename(folder_ / "run" / name, folder_ / name);
    ASSERT_EQ(::mkfifo((folder_ / "run" / name).c_str(), 0600), 0);
    const std::vector<Words> all = {{"show", "run"},
                                    {"doctor", "run"},
                                    {"report", "run", "--json"},
                                    {"export", "run", "--format", "csv", "--out", name + ".csv"},
                                    make_run("run")};
    for (const Words& words : all) {
      Program program(folder_.path(), words);
      EXPECT_TRUE(wait_until([&] { return !program.is_running(); })) << words[0] << " " << name;
      if (program.is_running()) {
        program.send(SIGKILL);
      }
      const Outcome outcome = program.wait();
      const bool reads_it = name != "manifest.json" || words[0] != "show";
      if (reads_it && (name == "manifest.json" || words[0] == "doctor")) {
        EXPECT_TRUE(outcome.exit_code == 4 || outcome.exit_code == 2)
            << words[0] << " " << name << outcome.out << outcome.err;
        EXPECT_THAT(outcome.out + outcome.err,
                    AnyOf(HasSubstr(name + ": is a named pipe"), HasSubstr("not a regular file")))
            << words[0];
      }
    }
    fs::remove(folder_ / "run" / name);
    fs::rename(folder_ / name, folder_ / "run" / name);
  }
}

TEST_F(Links, MissingRightsAreNoDamage) {
  open_to_all(folder_.path());
  Environment user;
  user.launcher = become_ordinary_user();
  ASSERT_EQ(run(make_run("run"), user).exit_code, 0);
  for (const char* name : {"journal", "result.json", "manifest.json"}) {
    fs::permissions(folder_ / "run" / name, fs::perms::none);
    for (const Words& words : {Words{"doctor", "run"}, Words{"report", "run", "--json"}}) {
      const Outcome outcome = run(words, user);
      EXPECT_EQ(outcome.exit_code, 74) << words[0] << outcome.out << outcome.err;
      EXPECT_THAT(outcome.err, HasSubstr(std::string("error: run/") + name + ": cannot "));
      EXPECT_THAT(outcome.err, HasSubstr("it: Permission denied"));
    }
    fs::permissions(folder_ / "run" / name, fs::perms::all);
  }
  fs::permissions(folder_ / "run", fs::perms::none);
  for (const Words& words :
       {Words{"show", "run"}, Words{"doctor", "run"}, Words{"report", "run"}, make_run("run")}) {
    const Outcome outcome = run(words, user);
    EXPECT_EQ(outcome.exit_code, 74) << words[0] << outcome.out << outcome.err;
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("error: run"), HasSubstr("Permission denied"),
                                   Not(HasSubstr("filesystem error"))));
  }
  fs::permissions(folder_ / "run", fs::perms::all);
}

TEST_F(Links, AFinishedRunInAFolderThatCanOnlyBeReadIsShown) {
  open_to_all(folder_.path());
  Environment user;
  user.launcher = become_ordinary_user();
  const Outcome first = run(make_run("run"), user);
  ASSERT_EQ(first.exit_code, 0);
  const auto all_write = fs::perms::owner_write | fs::perms::group_write | fs::perms::others_write;
  for (const char* name : {"run/lock", "run"}) {
    fs::permissions(folder_ / name, all_write, fs::perm_options::remove);
  }
  const Outcome again = run(make_run("run"), user);
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(again.out, first.out);
  // An unfinished one still says what prevents it.
  fs::permissions(folder_ / "run", fs::perms::all);
  fs::remove(folder_ / "run/result.json");
  fs::permissions(folder_ / "run", all_write, fs::perm_options::remove);
  const Outcome unfinished = run(make_run("run"), user);
  EXPECT_EQ(unfinished.exit_code, 74);
  EXPECT_THAT(unfinished.err, HasSubstr("error: run/lock: cannot open it: Permission denied"));
  fs::permissions(folder_ / "run", fs::perms::all);
}

TEST_F(Links, AStudyInAFolderThatCanOnlyBeReadNamesTheCommandThatShowsIt) {
  open_to_all(folder_.path());
  Environment user;
  user.launcher = become_ordinary_user();
  const Words compare = {"compare", "--problems", "sphere", "--optimizers", "ga",    "--replicates",
                         "2",       "--budget",   "20",     "--out",        "study", "--quiet"};
  ASSERT_EQ(run(compare, user).exit_code, 0);
  fs::permissions(folder_ / "study/lock", fs::perms::owner_read);
  for (const Words& words : {compare, Words{"merge", "study", "--quiet"}}) {
    const Outcome outcome = run(words, user);
    EXPECT_EQ(outcome.exit_code, 74);
    EXPECT_THAT(outcome.err,
                HasSubstr("study/lock: cannot open it: Permission denied; 'armwright show study' "
                          "reads the study and writes nothing"));
  }
  EXPECT_EQ(run({"show", "study"}, user).exit_code, 0);
}

}  // namespace
}  // namespace armwright::faults
