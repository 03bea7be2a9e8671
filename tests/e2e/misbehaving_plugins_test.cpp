// Optimizers of the user's that do wrong, as the user meets them: a message that names the plugin,
// what happened and what to do, a run marked as failed with everything kept, a program that goes
// on.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "base/temporary_folder.hpp"
#include "e2e/program.hpp"
#include "study/journal/journal.hpp"

namespace armwright {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

struct Fault {
  const char* how;
  std::vector<std::string> opt;  // limits short enough for a test
  const char* message;
};

class CliMisbehavingPlugins : public testing::Test {
 protected:
  static std::string library(const std::string& name) {
    return std::string(ARMWRIGHT_TEST_PLUGINS) + "/lib" + name + ".so";
  }
  static std::string script() { return std::string(ARMWRIGHT_TEST_DATA) + "/../plugins/faulty.py"; }

  Outcome run(const std::vector<std::string>& arguments, const Environment& environment = {}) {
    return run_program(folder_.path(), arguments, environment);
  }
  Outcome optimize(const std::string& optimizer, const std::vector<std::string>& opt,
                   const std::string& out, const Environment& environment = {}) {
    std::vector<std::string> words = {"optimize", "sphere", "--optimizer", optimizer,
                                      "--budget", "50",     "--out",       out};
    for (const std::string& assignment : opt) {
      words.insert(words.end(), {"--opt", assignment});
    }
    return run(words, environment);
  }

  // The run ends as every run of a failing optimizer must.
  void expect_failure(const Outcome& outcome, const std::string& optimizer, const std::string& out,
                      const std::string& message, std::size_t evaluations) {
    SCOPED_TRACE(outcome.err);
    EXPECT_EQ(outcome.exit_code, 3);
    EXPECT_THAT(
        outcome.err,
        AllOf(HasSubstr("armwright: error: optimizer '"), HasSubstr(message),
              HasSubstr(out + " is marked as failed; its evaluations are kept and judged."),
              HasSubstr("armwright check-plugin " + quoted(optimizer)), HasSubstr(" --new")));
    const json result = json::parse(read_text(folder_ / (out + "/result.json")));
    EXPECT_EQ(result["end_reason"], "optimizer failed");
    EXPECT_THAT(result["failure"].get<std::string>(), HasSubstr(message));
    EXPECT_EQ(result["counts"]["evaluations"], evaluations);
    EXPECT_FALSE(result["winner"].is_null());
    const JournalContent journal = read_journal(folder_ / (out + "/journal"));
    EXPECT_EQ(journal.training.size(), evaluations);
    EXPECT_FALSE(journal.ended);
    EXPECT_EQ(journal.torn_bytes, 0u);
  }

  static std::string quoted(const std::string& word) {
    return word.find(' ') == std::string::npos ? word : "'" + word + "'";
  }

  TemporaryFolder folder_;
};

TEST_F(CliMisbehavingPlugins, ALibraryCostsItsRunAlone) {
  const std::vector<Fault> faults = {
      {"throw", {}, "threw an exception (out of ideas) after 2 evaluations"},
      {"exit", {}, "ended its process with exit code 3 before it had finished"},
      {"segfault", {}, "was killed by signal 11 (Segmentation fault) after 2 evaluations"},
      {"loop",
       {"silence_s=2"},
       "was silent for more than 2 s and had to be killed (option silence_s)"},
      {"allocate", {"memory_mib=64"}, "(option memory_mib)"},
      {"nan", {}, "asked for a point (evaluation 3) with x_1 = nan, which is not a finite number"},
      {"outside", {}, "though it declares that it keeps to the bounds"},
      {"count", {"memory_mib=64"}, "after 2 evaluations"},
      {"fail", {}, "failed with code 7 (the matrix is singular) after 2 evaluations"},
  };
  const std::string plugin = library("misbehaving");
  for (const Fault& fault : faults) {
    auto opt = fault.opt;
    opt.push_back(std::string("how=") + fault.how);
    const Outcome outcome = optimize(plugin, opt, fault.how);
    SCOPED_TRACE(fault.how);
    expect_failure(outcome, plugin, fault.how, fault.message, 2);
    EXPECT_THAT(outcome.err, HasSubstr("error: optimizer '" + plugin + "' "));
    EXPECT_THAT(read_text(folder_ / (std::string(fault.how) + "/optimizer.log")),
                testing::StartsWith("two points are evaluated\n"));
  }
}

TEST_F(CliMisbehavingPlugins, AProgramCostsItsRunAlone) {
  const std::vector<Fault> faults = {
      {"throw", {}, "ended with exit code 1"},
      {"exit", {}, "ended with exit code 3"},
      {"crash", {}, "was killed by signal 11 (Segmentation fault)"},
      {"loop", {"silence_s=3"}, "has been silent for 3 s (option silence_s)"},
      {"memory", {"memory_mib=64"}, "64 MiB are allowed (option memory_mib)"},
      {"nan", {}, "JSON knows no NaN and no Infinity"},
      {"outside", {}, "declares the capability \"bounds\" and sent a point"},
      {"length", {}, "the problem has 10 variables"},
  };
  for (const Fault& fault : faults) {
    const std::string plugin = "exec:python3 " + script() + " " + fault.how;
    const Outcome outcome = optimize(plugin, fault.opt, fault.how);
    SCOPED_TRACE(fault.how);
    expect_failure(outcome, plugin, fault.how, fault.message, 1);
    EXPECT_THAT(outcome.err, HasSubstr("error: optimizer 'faulty' (exec:python3 "));
  }
  // What a program says of its death is shown, and kept.
  EXPECT_THAT(read_text(folder_ / "throw/optimizer.log"), HasSubstr("RuntimeError: out of ideas"));
}

TEST_F(CliMisbehavingPlugins, WhoLiesAboutItsInterfaceIsRefusedBeforeAnythingRuns) {
  for (const auto& [how, message] : std::vector<std::pair<std::string, std::string>>{
           {"abi", "is built for version 99 of the plugin interface, and this armwright has "},
           {"size", "says that its struct armwright_plugin has 8 bytes"},
           {"crash", "cannot be used: while it was opened, it was killed by signal 11"}}) {
    const Outcome outcome =
        optimize(library("unloadable"), {}, "run", {{{"ARMWRIGHT_TEST_PLUGIN", how}}, ""});
    EXPECT_EQ(outcome.exit_code, 4);
    EXPECT_THAT(outcome.err,
                AllOf(HasSubstr("error: " + library("unloadable") + ": "), HasSubstr(message)));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "run"));
  }
  const Outcome outcome = optimize("exec:python3 " + script() + " protocol", {}, "run");
  EXPECT_EQ(outcome.exit_code, 4);
  EXPECT_THAT(outcome.err, HasSubstr("speaks version '7' of the plugin protocol"));
  const Outcome early = optimize("exec:python3 " + script() + " early-exit", {}, "run");
  EXPECT_EQ(early.exit_code, 4);
  EXPECT_THAT(early.err, AllOf(HasSubstr("ended with exit code 4 before it described itself; the "
                                         "last that it printed:"),
                               HasSubstr("no licence")));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "run"));
}

// As docs/plugins.md has it: one run an optimizer, and a bad one spoils its own only.
TEST_F(CliMisbehavingPlugins, AComparisonGoesOnWithTheNext) {
  std::ofstream(folder_ / "compare.sh")
      << "for optimizer in random " << library("misbehaving") << " 'exec:python3 " << script()
      << " crash' ga; do\n"
         "  \"$PROGRAM\" optimize sphere --optimizer \"$optimizer\" --budget 50 --quiet\n"
         "  echo \"$optimizer $?\" >> codes\n"
         "done\n";
  const std::string command = "cd '" + folder_.path().string() + "' && PROGRAM='" +
                              ARMWRIGHT_BINARY "' sh compare.sh > out 2> err";
  ASSERT_EQ(std::system(command.c_str()), 0) << read_text(folder_ / "err");
  EXPECT_EQ(read_text(folder_ / "codes"), "random 0\n" + library("misbehaving") +
                                              " 3\nexec:python3 " + script() + " crash 3\nga 0\n");
  EXPECT_TRUE(std::filesystem::exists(folder_ / "results/sphere-ga-seed1/winner.toml") ||
              std::filesystem::exists(folder_ / "results/sphere-ga-seed1/result.json"));
}

TEST_F(CliMisbehavingPlugins, AFailedRunGoesOnWithAnotherPatience) {
  const std::string plugin = library("misbehaving");
  optimize(plugin, {"how=loop", "silence_s=2"}, "run");
  const Outcome again = optimize(plugin, {"how=loop", "silence_s=2.5", "memory_mib=512"}, "run");
  expect_failure(again, plugin, "run", "was silent for more than 2.5 s", 2);
  EXPECT_THAT(again.err, HasSubstr("resuming: 2 evaluations"));
  const Outcome other = optimize(plugin, {"how=fail"}, "run");
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.err, HasSubstr("how: recorded \"loop\", now \"fail\""));
}

TEST_F(CliMisbehavingPlugins, WhoPrintsWithoutEndFillsNoDisk) {
  const std::vector<std::pair<std::string, std::vector<std::string>>> plugins = {
      {library("misbehaving"), {"how=print", "silence_s=3"}},
      {"exec:python3 " + script() + " print", {"silence_s=3"}}};
  int number = 0;
  for (const auto& [plugin, opt] : plugins) {
    const std::string out = "run" + std::to_string(++number);
    EXPECT_EQ(optimize(plugin, opt, out).exit_code, 3);
    const std::string log = read_text(folder_ / (out + "/optimizer.log"));
    EXPECT_GT(log.size(), 1u << 20);
    EXPECT_LT(log.size(), (1u << 20) + (1u << 17));
    EXPECT_THAT(log, HasSubstr("bytes are left out here]\n"));
  }
}

TEST_F(CliMisbehavingPlugins, CheckPluginShowsWhatWasPrinted) {
  const Outcome outcome = run({"check-plugin", "exec:python3 " + script() + " throw"});
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.out, HasSubstr("RuntimeError: out of ideas"));
  EXPECT_THAT(run({"check-plugin", library("misbehaving"), "--opt", "how=segfault"}).out,
              HasSubstr("the last that it printed: two points are evaluated"));
}

TEST_F(CliMisbehavingPlugins, TheLogIsWhereTheUserWantsItAndOfThisRunAlone) {
  optimize(library("misbehaving"), {"how=fail"}, "a");
  EXPECT_TRUE(std::filesystem::exists(folder_ / "a/optimizer.log"));
  optimize(library("misbehaving"), {"how=fail", "log=mine.log"}, "a");
  const Outcome outcome = optimize(library("misbehaving"), {"how=fail", "log=mine.log"}, "a");
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("The output of the optimizer: mine.log\n"),
                                 HasSubstr("(silence_s, memory_mib and log may change)")));
  EXPECT_EQ(read_text(folder_ / "mine.log"),
            "two points are evaluated\ntwo points are evaluated\n");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "a/optimizer.log"));
  optimize(library("misbehaving"), {"how=fail"}, "b");
  optimize(library("misbehaving"), {"how=fail"}, "b");
  EXPECT_EQ(read_text(folder_ / "b/optimizer.log"), "two points are evaluated\n");
}

TEST_F(CliMisbehavingPlugins, WhatALibraryStartedDiesWithIt) {
  optimize(library("misbehaving"), {"how=children"}, "run");
  const std::string log = read_text(folder_ / "run/optimizer.log");
  const std::size_t at = log.find("child ");
  ASSERT_NE(at, std::string::npos) << log;
  const std::string status = "/proc/" + std::to_string(std::stoi(log.substr(at + 6))) + "/stat";
  // Killed, it is init's to reap; until then it is a zombie.
  const auto is_dead = [&] {
    const std::string text = read_text(status);
    return text.empty() || text.find(") Z") != std::string::npos ||
           text.find(") X") != std::string::npos;
  };
  for (int i = 0; i < 1000 && !is_dead(); ++i) {
    usleep(10000);
  }
  EXPECT_TRUE(is_dead());
}

}  // namespace
}  // namespace armwright
