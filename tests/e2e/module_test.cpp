// Modules (process/module_loader.hpp), with that of pagmo as the example: when the program loads
// them, where it looks for them, and which ones it refuses.

#include <dlfcn.h>
#include <gmock/gmock.h>
#include <sys/stat.h>

#include <fstream>
#include <string>

#include "base/temporary_folder.hpp"
#include "e2e/program.hpp"
#include "optimizers/table/optimizer_table.hpp"
#include "process/module_loader.hpp"

namespace armwright {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kModule = "libarmwright_pagmo.so";
using Words = std::vector<std::string>;

// The loader writes what it opens to stderr.
const Environment kTraced{.variables = {{"LD_DEBUG", "files"}}, .out_file = ""};

class ModuleLoading : public testing::Test {
 protected:
  void SetUp() override {
    if (find_optimizer("pagmo:de").unavailable.starts_with("built without")) {
      GTEST_SKIP() << find_optimizer("pagmo:de").unavailable;
    }
    // An installation: bin/armwright and lib/armwright. The configurations come from the variable.
    const std::filesystem::path program = ARMWRIGHT_BINARY;
    std::filesystem::create_directories(folder_ / "bin");
    std::filesystem::create_directories(folder_ / "lib");
    std::filesystem::copy_file(program, folder_ / "bin/armwright");
    std::filesystem::copy(program.parent_path().parent_path() / "lib/armwright",
                          module().parent_path());
  }

  std::filesystem::path module() const { return folder_ / "lib/armwright" / kModule; }

  // Runs the copied program in its folder.
  Outcome run_copy(const Words& words, Environment environment = {}) const {
    environment.variables.emplace_back("ARMWRIGHT_CONFIGS", ARMWRIGHT_CONFIGS);
    environment.launcher = {"sh", "-c", "shift; exec bin/armwright \"$@\"", "sh"};
    return run_program(folder_.path(), words, environment);
  }
  Outcome optimize(Environment environment = {}) const {
    return run_copy({"optimize", "sphere", "--optimizer", "pagmo:de", "--budget", "60", "--out",
                     "run", "--new"},
                    std::move(environment));
  }
  void write_module(const std::string& bytes) const {
    std::filesystem::remove(module());  // a program may still have it open
    std::ofstream(module(), std::ios::binary) << bytes;
  }

  TemporaryFolder folder_;
};

TEST_F(ModuleLoading, IsLoadedOnlyByAnOptimizerOfPagmo) {
  ASSERT_EQ(run_program(folder_.path(),
                        {"compare", "--problems", "sphere", "--optimizers", "pagmo:de,pagmo:cmaes",
                         "--replicates", "3", "--budget", "60", "--out", "study"})
                .exit_code,
            0);
  ASSERT_EQ(optimize().exit_code, 0);
  for (const Words& words : std::vector<Words>{
           {"--help"},
           {"--version"},
           {"list", "optimizers"},
           {"list", "optimizers", "pagmo:nsga2"},
           {"list", "optimizers", "pagmo:de", "--json"},
           {"optimize", "sphere", "--optimizer", "ga", "--budget", "60", "--out", "ga"},
           {"show", "run"},
           {"show", "study"},
           {"status", "study"},
           {"list", "studies", "study/study.toml"},
           {"compare", "study/study.toml", "--out", "study", "--dry-run"},
           {"doctor", "study"},
           {"report", "study", "--quiet"}}) {
    const Outcome outcome = run_copy(words, kTraced);
    EXPECT_EQ(outcome.exit_code, 0) << words[0] << outcome.out;
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("file=libode.so"), Not(HasSubstr("pagmo.so")),
                                   Not(HasSubstr("ceres.so")), Not(HasSubstr("liblapack"))))
        << words[0];
  }
  const Outcome outcome = optimize(kTraced);
  EXPECT_THAT(outcome.err,
              AllOf(HasSubstr("file=" + module().string()), HasSubstr("file=libpagmo.so")));
}

TEST_F(ModuleLoading, AMissingOneIsNamedAndNothingElseIsTaken) {
  // Decoys where a loader that searches would find them.
  std::filesystem::create_directories(folder_ / "elsewhere");
  for (const char* place : {".", "elsewhere", "lib"}) {
    std::filesystem::copy_file(module(), folder_ / place / kModule);
  }
  std::filesystem::remove(module());
  const std::string elsewhere = folder_ / "elsewhere";
  const Outcome outcome = optimize({.variables = {{"LD_DEBUG", "files"},
                                                  {"LD_LIBRARY_PATH", elsewhere + ":.:"},
                                                  {"ARMWRIGHT_PLUGINS", elsewhere},
                                                  {"PATH", elsewhere + ":/usr/bin:/bin"}},
                                    .out_file = ""});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err,
              AllOf(HasSubstr("optimizer 'pagmo:de' is not available: its module " +
                              module().string() + " is missing; install armwright again"),
                    Not(HasSubstr(std::string("file=") + kModule)), Not(HasSubstr("libpagmo"))));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "run"));
  EXPECT_EQ(run_copy({"list", "optimizers"}).exit_code, 0);
  EXPECT_THAT(run_copy({"list", "optimizers", "pagmo:de"}).out,
              HasSubstr("Not available  its module"));
  EXPECT_THAT(run_copy({"doctor", "--json"}).out, HasSubstr("is missing"));
}

TEST_F(ModuleLoading, AFinishedStudyIsReadWithoutAModule) {
  const Words compare = {"compare",     "--problems",   "sphere", "--optimizers",
                         "pagmo:de,ga", "--replicates", "2",      "--budget",
                         "60",          "--out",        "study"};
  ASSERT_EQ(run_copy(compare).exit_code, 0);
  std::filesystem::remove(module());
  for (const Words& words : std::vector<Words>{{"show", "study"},
                                               {"status", "study"},
                                               {"merge", "study"},
                                               {"report", "study", "--quiet"},
                                               {"export", "study", "--format", "csv"}}) {
    const Outcome outcome = run_copy(words);
    EXPECT_EQ(outcome.exit_code, 0) << words[0] << outcome.err;
  }
  Words another = compare;
  another.back() = "another";
  const Outcome outcome = run_copy(another);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("is not available: its module"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "another"));
}

TEST_F(ModuleLoading, OneOfAnotherBuildIsRefused) {
  void* const opened = dlopen(module().c_str(), RTLD_NOW | RTLD_LOCAL);
  ASSERT_NE(opened, nullptr) << dlerror();
  const std::string own = static_cast<const char*>(dlsym(opened, kModuleIdSymbol));
  ASSERT_EQ(own.size(), 16u);
  std::string bytes = read_text(module());
  const std::size_t at = bytes.find(own);
  ASSERT_NE(at, std::string::npos);
  const std::string other = "0123456789abcdef";
  write_module(bytes.replace(at, 16, other));
  const Outcome outcome = optimize();
  EXPECT_EQ(outcome.exit_code, 4);
  EXPECT_THAT(outcome.err,
              HasSubstr("optimizer 'pagmo:de': its module " + module().string() +
                        " belongs to another build of armwright: its id is " + other +
                        ", and this build needs " + own + "; install armwright again"));
  const Outcome doctor = run_copy({"doctor", "--json"});
  EXPECT_NE(doctor.exit_code, 0);
  EXPECT_THAT(doctor.out, HasSubstr("belongs to another build"));
}

TEST_F(ModuleLoading, OneThatIsNotWholeIsRefused) {
  const std::string bytes = read_text(module());
  for (const std::size_t size :
       {std::size_t{0}, std::size_t{40}, std::size_t{4096}, bytes.size() / 2, bytes.size() - 1}) {
    write_module(bytes.substr(0, size));
    const Outcome outcome = optimize();
    EXPECT_EQ(outcome.exit_code, 4) << size;
    EXPECT_THAT(outcome.err,
                AllOf(HasSubstr(module().string()),
                      HasSubstr(size < 64 ? "is not a shared library"
                                          : "has only " + std::to_string(size) + " of its")));
  }
  write_module("no library, but a text that is longer than the header of a library would be\n");
  EXPECT_THAT(optimize().err, HasSubstr("is not a shared library"));
  std::filesystem::remove(module());
  ASSERT_EQ(mkfifo(module().c_str(), 0600), 0);
  EXPECT_THAT(optimize().err, HasSubstr("is not a file"));
}

TEST_F(ModuleLoading, ALibraryWithoutItsSymbolsIsRefused) {
  std::filesystem::remove(module());
  std::filesystem::copy_file(std::string(ARMWRIGHT_TEST_PLUGINS) + "/libgood.so", module());
  const Outcome outcome = optimize();
  EXPECT_EQ(outcome.exit_code, 4);
  EXPECT_THAT(outcome.err, HasSubstr("lacks the symbols"));
}

// A RUNPATH with an empty element would do that.
TEST_F(ModuleLoading, NoLibraryIsTakenFromTheCurrentFolder) {
  for (const char* library : {"libode.so.8", "libmpi.so.40", "libstdc++.so.6"}) {
    std::ofstream(folder_ / library) << "no library";
  }
  const Outcome outcome = run_program(folder_.path(), {"--version"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
}

// A user's program that links armwright's libraries has the module in its own folder.
TEST_F(ModuleLoading, MayLieBesideTheProgram) {
  std::filesystem::rename(module(), folder_ / "bin" / kModule);
  const Outcome outcome = optimize();
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
}

}  // namespace
}  // namespace armwright
