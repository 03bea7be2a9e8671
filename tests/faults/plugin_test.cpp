// Tests faulty optimizers of users, besides those of tests/e2e/misbehaving_plugins_test.cpp. Only
// their own run fails, never the program, and the budget is never exceeded.
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "faults/support.hpp"

namespace armwright::faults {
namespace {

using nlohmann::json;

class Plugins : public testing::Test {
 protected:
  Outcome optimize(const std::string& optimizer, const Words& more = {}) {
    std::filesystem::remove_all(folder_ / "run");
    Environment environment;
    environment.variables = {{"FAULTS_MARK", mark_}};
    return run_program(folder_.path(),
                       Words{"optimize", "sphere", "--budget", "50", "--out", "run", "--quiet",
                             "--optimizer", optimizer} +
                           more,
                       environment);
  }
  // The run is marked as failed and keeps its evaluations, and no process is left.
  void expect_failed(const Outcome& outcome, const std::string& message) {
    EXPECT_EQ(outcome.exit_code, 3) << outcome.err;
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("armwright: error: optimizer '"), HasSubstr(message),
                                   HasSubstr("its evaluations are kept and judged")));
    EXPECT_EQ(json::parse(read_text(folder_ / "run/result.json"))["end_reason"],
              "optimizer failed");
    EXPECT_TRUE(wait_until([&] { return list_processes(mark_).empty(); }));
  }
  TemporaryFolder folder_;
  // Other tests of this class may run at the same time and have processes too.
  const std::string mark_ = "plugin-" + std::to_string(::getpid());
};

TEST_F(Plugins, FilesThatAreNoLibraryOfThisMachineAreRefused) {
  const std::string good = read_text(get_plugin("good"));
  std::string of_another_machine = good;  // the header's e_machine: AArch64
  of_another_machine[18] = static_cast<char>(183);
  std::string of_32_bits = good;
  of_32_bits[4] = 1;
  for (const auto& [name, bytes] :
       std::map<std::string, std::string>{{"empty.so", ""},
                                          {"header.so", good.substr(0, 64)},
                                          {"half.so", good.substr(0, good.size() / 2)},
                                          {"machine.so", of_another_machine},
                                          {"bits.so", of_32_bits},
                                          {"text.so", "#!/bin/sh\nexit 0\n"},
                                          {"zeros.so", std::string(good.size(), '\0')}}) {
    SCOPED_TRACE(name);
    write_text(folder_ / name, bytes);
    const Outcome outcome = optimize("./" + name);
    EXPECT_EQ(outcome.exit_code, 4) << outcome.err;
    EXPECT_THAT(outcome.err, AllOf(StartsWith("armwright: error: "), HasSubstr(name)));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "run"));
  }
}

TEST_F(Plugins, TheHostCountsTheBudgetWhateverTheyBelieve) {
  for (const auto& [optimizer, how] : std::vector<std::pair<std::string, Words>>{
           {get_plugin("misbehaving"), {"--opt", "how=endless"}},
           {"exec:python3 " + get_script("faulty.py") + " never-stops", {}}}) {
    SCOPED_TRACE(optimizer);
    const Outcome outcome = optimize(optimizer, how);
    EXPECT_TRUE(has_ended(outcome)) << outcome.err;
    EXPECT_EQ(read_journal(folder_ / "run/journal").training.size(), 50u);
    EXPECT_EQ(json::parse(read_text(folder_ / "run/result.json"))["end_reason"], "budget");
    EXPECT_TRUE(wait_until([&] { return list_processes(mark_).empty(); }));
  }
}

TEST_F(Plugins, WhoClosesThePipesOrWritesGarbageIntoThemFails) {
  expect_failed(optimize(get_plugin("misbehaving"), {"--opt", "how=close"}),
                "ended its process with exit code 1 before it had finished");
  expect_failed(optimize(get_plugin("misbehaving"), {"--opt", "how=garbage"}),
                "has written into the connection to its parent");
  const std::string faulty = "exec:python3 " + get_script("faulty.py") + " ";
  expect_failed(optimize(faulty + "closed", {"--opt", "silence_s=2"}),
                "closed its standard output");
  expect_failed(optimize(faulty + "not-json"), "not JSON");
  expect_failed(optimize(faulty + "deep"), "nested");
  expect_failed(optimize(faulty + "long-line"), "sent a line of more than 64 MiB");
  expect_failed(optimize(faulty + "huge-number"), "");
}

TEST_F(Plugins, WhatTheyStartedDiesWithThem) {
  expect_failed(optimize(get_plugin("misbehaving"), {"--opt", "how=children"}),
                "was killed by signal 6");
  expect_failed(optimize("exec:python3 " + get_script("faulty.py") + " children pid"),
                "ended with exit code 5");
}

TEST_F(Plugins, WhoEatsMemoryIsEndedWithinItsLimit) {
  expect_failed(
      optimize(get_plugin("misbehaving"), {"--opt", "how=allocate", "--opt", "memory_mib=64"}),
      "(option memory_mib)");
  expect_failed(
      optimize("exec:python3 " + get_script("faulty.py") + " memory", {"--opt", "memory_mib=64"}),
      "64 MiB are allowed (option memory_mib)");
}

}  // namespace
}  // namespace armwright::faults
