// A plugin that a recorded study names: reading the study never starts it, and running it needs
// consent.
#include "study/compare/plugin_consent.hpp"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include <cstdlib>

#include "base/expect_error.hpp"
#include "base/hash.hpp"
#include "base/remove_checksums.hpp"
#include "optimizers/plugins/recorded_optimizer.hpp"
#include "study/compare/study_support.hpp"

namespace armwright {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class PluginConsent : public StudyTest {
 protected:
  void SetUp() override {
    ::setenv("XDG_STATE_HOME", (temporary_ / "state").c_str(), 1);
    const StudyFolder folder(study_, make_study_plan(make_small_request()));
  }
  void TearDown() override { ::unsetenv("XDG_STATE_HOME"); }

  std::string read_plan() const { return read_file(study_ / "study.toml", std::size_t{1} << 20); }
  // Stores the text as a plan with a valid hash, as anybody can.
  void write_plan(const std::string& text) const {
    remove_checksums(study_);
    const std::string body = text.substr(text.find('\n') + 1);
    write_file_atomically(study_ / "study.toml",
                          "plan_sha256 = \"" + calc_sha256_hex(body) + "\"\n" + body);
  }
  void replace_in_plan(const std::string& what, const std::string& by) const {
    std::string text = read_plan();
    ASSERT_NE(text.find(what), std::string::npos) << text;
    write_plan(text.replace(text.find(what), what.size(), by));
  }
  // The optimizer `ga` becomes a program that leaves a file behind. It describes nothing.
  void plant_program(const std::string& word = "") const {
    replace_in_plan("name = \"ga\"", R"(name = "exec:sh -c 'echo > )" +
                                         (temporary_ / "PWNED").string() + "' " + word + "\"");
  }
  bool has_run() const { return std::filesystem::exists(temporary_ / "PWNED"); }

  // Tries to load the study to run it. Returns the questions that the user was asked.
  std::vector<std::string> load(bool answer) const {
    std::vector<std::string> questions;
    error_of(answer ? ErrorKind::bad_data : ErrorKind::usage, [&] {
      load_study_plan(study_, [&](const std::string& question) {
        questions.push_back(question);
        return answer;
      });
    });
    return questions;
  }
  // Returns whether the next attempt to run the study asks.
  bool asks() const { return !load(false).empty(); }

  const std::filesystem::path study_ = temporary_ / "study";
};

TEST_F(PluginConsent, AStudyIsReadWithoutItsPlugins) {
  plant_program();
  const StudyPlan plan = load_study_plan(study_);
  EXPECT_FALSE(has_run());
  EXPECT_EQ(to_toml(plan), read_plan());
  EXPECT_EQ(plan.optimizers[0].label, "ga");
  EXPECT_THAT(usage_error_of([&] {
                StopSignal stop;
                run_cell(plan, list_cells(plan).front(), temporary_ / "cell", stop, observer_);
              }),
              HasSubstr("is known only from a study's record here"));
  StudyRequest request;
  request.file = (study_ / "study.toml").string();
  request.plugins = PluginUse::preview;
  EXPECT_EQ(to_toml(make_study_plan(request)), read_plan());
  EXPECT_FALSE(has_run());
}

TEST_F(PluginConsent, AFileOfTheUserMayHaveTheNameOfARecord) {
  const auto own = temporary_ / "own";
  std::filesystem::create_directory(own);
  StudyRequest request;
  request.file = (own / "study.toml").string();
  write_file_atomically(request.file, "problems = [\"exec:sh -c 'echo > " +
                                          (temporary_ / "PWNED").string() +
                                          "'\"]\noptimizers = [\"ga\"]\nbudget = 30\n");
  // In the folder of a study that has begun, it is a record that somebody has changed.
  for (const char* name : {"SHA256SUMS", "cells", "attempts"}) {
    std::filesystem::create_directory(own / name);
    EXPECT_THAT(error_of(ErrorKind::bad_data, [&] { make_study_plan(request); }),
                HasSubstr("its description is not recorded"));
    EXPECT_FALSE(has_run()) << name;
    std::filesystem::remove(own / name);
  }
  EXPECT_THAT(error_of(ErrorKind::bad_data, [&] { make_study_plan(request); }),
              HasSubstr("before it described itself"));
  EXPECT_TRUE(has_run());
}

TEST_F(PluginConsent, RunningNeedsConsentAndTheMessageSaysWhatWouldRun) {
  plant_program();
  StudyRequest request;
  request.file = (study_ / "study.toml").string();
  EXPECT_THAT(usage_error_of([&] { make_study_plan(request); }),
              AllOf(HasSubstr("the study in " + study_.string() + " would run"),
                    HasSubstr("exec:sh -c 'echo > " + (temporary_ / "PWNED").string() + "'"),
                    HasSubstr("--trust")));
  const auto questions = load(false);
  ASSERT_EQ(questions.size(), 1U);
  EXPECT_THAT(questions[0], HasSubstr("with all of your rights: exec:sh -c 'echo"));
  EXPECT_FALSE(has_run());
  EXPECT_EQ(load(true).size(), 1U);
  EXPECT_TRUE(has_run());
}

TEST_F(PluginConsent, ConsentIsRememberedForTheseVeryPlugins) {
  plant_program("first");
  EXPECT_EQ(load(true).size(), 1U);
  EXPECT_EQ(load(true).size(), 0U);
  replace_in_plan("' first", "' second");
  EXPECT_TRUE(asks());
  remember_study(study_, {});
  EXPECT_EQ(load(true).size(), 0U);
  // Another folder with the same plan is another study.
  std::filesystem::rename(study_, temporary_ / "moved");
  std::filesystem::create_directory_symlink(temporary_ / "moved", study_);
  EXPECT_TRUE(asks());
}

TEST_F(PluginConsent, AScriptThatWasChangedNeedsConsentAgain) {
  const auto script = temporary_ / "script";
  write_file_atomically(script, "exit 1\n");
  replace_in_plan("name = \"ga\"", "name = \"exec:sh " + script.string() + "\"");
  EXPECT_EQ(load(true).size(), 1U);
  EXPECT_EQ(load(true).size(), 0U);
  write_file_atomically(script, "exit 2\n");
  EXPECT_TRUE(asks());
}

TEST_F(PluginConsent, AnOptionThatWritesAFileNeedsConsent) {
  replace_in_plan("name = \"ga\"", "name = \"nlopt:cobyla\"");
  replace_in_plan("options = [", "options = [\"log=" + (temporary_ / "file").string() + "\", ");
  EXPECT_THAT(usage_error_of([&] { load_study_plan(study_, {}); }),
              HasSubstr("nlopt:cobyla, which writes to a file (log="));
}

TEST_F(PluginConsent, ACommandIsKnownByItsWordsAndByAllThatItsProblemSays) {
  const auto list = [&](const std::string& script, const std::string& word = "none") {
    const auto file = temporary_ / "p.toml";
    write_file_atomically(file,
                          "kind = \"command\"\ncommand.run = \"host:sh script\"\n"
                          "[[command.input]]\nfile = \"script\"\ntext = '" +
                              script +
                              "'\n[[variable]]\nname = \"x\"\nlower = 0\n"
                              "upper = 1\n[[variable]]\nname = \"mode\"\ntype = \"category\"\n"
                              "choices = [\"" +
                              word +
                              "\", \"other\"]\n[[objective]]\nname = \"f\"\n"
                              "exit_code = true\n");
    StudyProblem problem;
    problem.loaded = load_problem(file.string());
    return list_programs({&problem, 1});
  };
  const auto first = list("exit 3");
  ASSERT_EQ(first.size(), 1U) << "the name of a host program is no excuse for a command";
  EXPECT_EQ(first[0].options, list("exit 3")[0].options);
  EXPECT_NE(first[0].options, list("rm -r ~")[0].options);
  EXPECT_NE(first[0].options, list("exit 3", "rm -r ~")[0].options);
}

TEST_F(PluginConsent, TheMemoryIsPrivateAndMayBeMissing) {
  plant_program();
  load(true);
  struct stat status {};
  ASSERT_EQ(::stat((temporary_ / "state/armwright/studies").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0700U);
  std::size_t files = 0;
  for (const auto& file :
       std::filesystem::directory_iterator(temporary_ / "state/armwright/studies")) {
    ASSERT_EQ(::stat(file.path().c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777U, 0600U);
    ++files;
  }
  EXPECT_EQ(files, 1U);
  ::setenv("XDG_STATE_HOME", "/dev/null/nowhere", 1);
  EXPECT_EQ(load(true).size(), 1U);
  EXPECT_EQ(load(true).size(), 1U);  // it could not be remembered
}

TEST_F(PluginConsent, NoBaselineOfARecordIsAPlugin) {
  plant_program();
  replace_in_plan("label = \"ga\"\nbaseline = false", "label = \"other\"\nbaseline = true");
  StudyPlan plan = make_study_plan(make_small_request());
  adopt_recorded(study_, plan);
  EXPECT_FALSE(has_run());
}

TEST_F(PluginConsent, PluginsThatTheUserNamesNeedNone) {
  plant_program();
  StudyRequest request;
  request.file = (study_ / "study.toml").string();
  request.optimizers = {"cmaes"};
  EXPECT_EQ(make_study_plan(request).optimizers.front().label, "cmaes");
  EXPECT_FALSE(has_run());
}

// A plugin as load_optimizer() describes it.
OptimizerRow make_described_plugin() {
  OptimizerRow row;
  row.summary = "mine";
  row.capabilities.local = true;
  row.options = {{.name = "step", .description = "", .fallback = 0.5, .lower = 0, .upper = 1}};
  row.description = make_description(row);
  row.name = "/far/libmine.so";
  row.short_name = "mine";
  row.input_hashes = {{"libmine.so", "0123"}};
  row.make = read_plugin_row(row.name, row.description).make;
  return row;
}

TEST_F(PluginConsent, PlansOfVersionOneWithoutDescriptionsStayAsTheyAre) {
  StudyRequest request = make_small_request();
  request.optimizers = {"/far/libmine.so", "ga"};
  request.rows = {make_described_plugin()};
  std::filesystem::remove_all(study_);
  { const StudyFolder folder(study_, make_study_plan(request)); }
  EXPECT_EQ(to_toml(load_study_plan(study_)), read_plan());
  EXPECT_TRUE(load_study_plan(study_).optimizers[0].row.capabilities.local);

  std::string text = read_plan();
  const std::size_t begin = text.find("description = ");
  ASSERT_NE(begin, std::string::npos);
  write_plan(text.erase(begin, text.find('\n', begin) + 1 - begin));
  const std::string first = read_plan();
  const StudyPlan old = load_study_plan(study_);
  EXPECT_EQ(to_toml(old), first);
  EXPECT_EQ(old.optimizers[0].parsed.get_text("step"), "0.5");
  EXPECT_EQ(old.optimizers[0].row.input_hashes.at("libmine.so"), "0123");

  StudyPlan resumed = make_study_plan(request);
  adopt_recorded(study_, resumed);
  const StudyFolder folder(study_, resumed);
  EXPECT_TRUE(folder.additions().empty());
  EXPECT_EQ(read_plan(), first);
  EXPECT_EQ(to_toml(resumed), first);
}

}  // namespace
}  // namespace armwright
