// What a user finds out about the optimizers: on the terminal, as JSON, and as the pages under
// docs/optimizers, which scripts/docs writes and checks.

#include <gmock/gmock.h>

#include <array>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "base/temporary_folder.hpp"
#include "e2e/program.hpp"
#include "optimizers/interface/optimizer.hpp"
#include "optimizers/table/optimizer_table.hpp"

namespace armwright {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class ListOptimizers : public testing::Test {
 protected:
  Outcome run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"list", "optimizers"});
    return run_program(folder_.path(), arguments);
  }
  std::string show(std::vector<std::string> arguments, unsigned short columns) {
    arguments.insert(arguments.begin(), {"list", "optimizers"});
    return run_on_terminal(folder_.path(), arguments, {{{"NO_COLOR", "1"}}, ""}, columns);
  }
  TemporaryFolder folder_;
};

std::vector<std::string> get_lines(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) {
    if (line.ends_with('\r')) {
      line.pop_back();
    }
    lines.push_back(line);
  }
  return lines;
}

TEST_F(ListOptimizers, FitsTheTerminal) {
  for (const std::uint16_t columns : std::array<std::uint16_t, 2>{80, 100}) {
    for (const char* name : {"", "ga", "ceres:lm", "nlopt:mlsl", "pagmo:moead", "nlopt:ags"}) {
      const std::vector<std::string> arguments(*name == '\0' ? 0 : 1, name);
      for (const std::string& line : get_lines(show(arguments, columns))) {
        EXPECT_LE(line.size(), columns) << line;
      }
    }
  }
}

TEST_F(ListOptimizers, IsOneLineARowInAPipeAndAt100Columns) {
  const std::vector<std::string> piped = get_lines(run({}).out);
  const std::vector<std::string> shown = get_lines(show({}, 100));
  std::size_t k = 1;  // below the title
  for (const OptimizerRow& row : optimizer_table()) {
    ASSERT_LT(k, piped.size());
    EXPECT_THAT(piped[k], AllOf(testing::StartsWith(row.name + " "), HasSubstr(row.summary)));
    if (row.unavailable.empty()) {  // a star may need another line
      EXPECT_THAT(shown, testing::Contains(piped[k]));
    }
    ++k;
  }
}

TEST_F(ListOptimizers, SaysWhyOneIsNotAvailable) {
  const std::string list = run({}).out;
  for (const OptimizerRow& row : optimizer_table()) {
    EXPECT_EQ(list.find("\n" + row.name + " * ") != list.npos, !row.unavailable.empty())
        << row.name;
  }
  EXPECT_THAT(list, AllOf(HasSubstr("* not available here:"), HasSubstr("nlopt:ags: ")));
  EXPECT_THAT(run({"nlopt:ags"}).out, HasSubstr("Not available"));
  EXPECT_THAT(run({"ga"}).out, Not(HasSubstr("ot available")));
}

TEST_F(ListOptimizers, JsonHoldsEveryRowInFull) {
  const json list = json::parse(run({"--json"}).out);
  ASSERT_EQ(list.size(), optimizer_table().size());
  for (const json& row : list) {
    EXPECT_EQ(row, json::parse(run({row.at("name"), "--json"}).out));
  }
  const json& ga = list.at(1);
  EXPECT_EQ(ga.at("name"), "ga");
  EXPECT_EQ(ga.at("capabilities").at("constraints"), true);
  EXPECT_EQ(ga.at("requirements").at("objectives"), 1);
  EXPECT_EQ(ga.at("isolated"), "");
}

TEST_F(ListOptimizers, TellsWhatRunsInAProcessOfItsOwn) {
  EXPECT_THAT(run({"nlopt:cobyla"}).out, HasSubstr("  Runs       in a process of its own"));
  EXPECT_THAT(run({"nlopt:mlsl"}).out,
              HasSubstr("with local=cobyla or local=newuoa_bound in a process of its own"));
  EXPECT_THAT(run({"nlopt:auglag_eq"}).out, HasSubstr("  Runs       in a process of its own"));
  EXPECT_THAT(run({"multistart:compass"}).err, HasSubstr("unknown optimizer"));
  EXPECT_THAT(run({"ga"}).out, HasSubstr("in armwright's own process"));
}

TEST_F(ListOptimizers, MarkdownIsForKindsThatHavePages) {
  const auto refusal_of = [&](const std::vector<std::string>& words) {
    const Outcome outcome = run_program(folder_.path(), words);
    EXPECT_EQ(outcome.exit_code, 2);
    return outcome.err;
  };
  EXPECT_THAT(refusal_of({"list", "robots", "--markdown"}),
              HasSubstr("--markdown works for problems, optimizers and settings, not for robots"));
  EXPECT_THAT(refusal_of({"list", "settings", "task.rest_s", "--markdown"}),
              HasSubstr("the page of settings contains all settings; leave out the name"));
  const Outcome both = run({"--markdown", "--json"});
  EXPECT_EQ(both.exit_code, 2);
  EXPECT_THAT(both.err, HasSubstr("choose one"));
  EXPECT_EQ(run({"gaa", "--markdown"}).exit_code, 2);
}

// scripts/docs in a project of its own, with a program of two optimizers.
class Docs : public ListOptimizers {
 protected:
  Docs() {
    std::filesystem::create_directories(folder_ / "scripts");
    std::filesystem::create_directories(folder_ / "include/armwright");
    for (const char* file :
         {"scripts/docs", "scripts/c_abi_page.py", "include/armwright/plugin.h"}) {
      std::filesystem::copy_file(std::filesystem::path(ARMWRIGHT_SCRIPTS "/..") / file,
                                 folder_ / file);
    }
    const auto program = folder_ / "program";
    std::ofstream(program) << R"(#!/bin/sh
case "$3" in
  --markdown) printf '| [`a:b`](a-b.md) | one |\n| [`c`](c.md) | two |\n' ;;
  *) echo "page of $3" ;;
esac
)";
    std::filesystem::permissions(program, std::filesystem::perms::owner_all);
  }
  int run_docs(const std::string& flags, const std::string& program) {
    const std::string command = "ARMWRIGHT='" + program + "' '" +
                                (folder_ / "scripts/docs").string() + "' " + flags + " >'" +
                                (folder_ / "said").string() + "' 2>&1";
    return std::system(command.c_str());
  }
  int run_docs(const std::string& flags) { return run_docs(flags, folder_ / "program"); }
  void expect_refused() {
    EXPECT_NE(run_docs("--check"), 0);
    EXPECT_THAT(read_text(folder_ / "said"), HasSubstr("run scripts/docs"));
  }
};

TEST_F(Docs, WritesAPageForEveryRow) {
  ASSERT_EQ(run_docs("", ARMWRIGHT_BINARY), 0) << read_text(folder_ / "said");
  // A next step follows what the program prints.
  EXPECT_THAT(read_text(folder_ / "docs/optimizers/README.md"),
              testing::StartsWith(run({"--markdown"}).out + "\nNext: ["));
  EXPECT_THAT(read_text(folder_ / "docs/optimizers/nlopt-cobyla.md"),
              testing::StartsWith(run({"nlopt:cobyla", "--markdown"}).out + "\nNext: ["));
  const auto count = std::distance(std::filesystem::directory_iterator(folder_ / "docs/optimizers"),
                                   std::filesystem::directory_iterator());
  EXPECT_EQ(count, std::ssize(optimizer_table()) + 1);
  EXPECT_THAT(read_text(folder_ / "docs/reference/plugin-c-abi.md"),
              HasSubstr("\nstruct armwright_evaluator {\n"));
  EXPECT_THAT(read_text(folder_ / "docs/reference/configuration.md"), HasSubstr("### `[task]`\n"));
}

TEST_F(Docs, FindsPagesThatAreStaleMissingOrChanged) {
  expect_refused();  // nothing is there
  ASSERT_EQ(run_docs(""), 0) << read_text(folder_ / "said");
  EXPECT_EQ(read_text(folder_ / "docs/optimizers/a-b.md"),
            "page of a:b\n\nNext: [compare optimizers in ten minutes](../tutorials/compare.md).\n");
  EXPECT_EQ(run_docs("--check"), 0) << read_text(folder_ / "said");
  const auto page = folder_ / "docs/optimizers/c.md";
  const auto stale = folder_ / "docs/optimizers/gone.md";
  std::ofstream(page, std::ios::app) << "changed\n";
  expect_refused();
  std::filesystem::remove(page);
  expect_refused();
  ASSERT_EQ(run_docs(""), 0);
  const auto reference = folder_ / "docs/reference/problems.md";
  std::ofstream(reference, std::ios::app) << "changed\n";
  expect_refused();
  ASSERT_EQ(run_docs(""), 0);
  std::ofstream(stale) << "of an optimizer that is no more\n";
  expect_refused();
  EXPECT_TRUE(std::filesystem::exists(stale));  // --check changes nothing
  ASSERT_EQ(run_docs(""), 0);
  EXPECT_FALSE(std::filesystem::exists(stale));
  EXPECT_EQ(run_docs("--check"), 0);
}

TEST_F(Docs, LeavesEverythingAloneWithoutAProgramThatAnswers) {
  ASSERT_EQ(run_docs(""), 0);
  for (const char* program : {"/none", "/bin/false", "/bin/true"}) {
    EXPECT_NE(run_docs("", program), 0) << program;
    EXPECT_TRUE(std::filesystem::exists(folder_ / "docs/optimizers/c.md"));
  }
  EXPECT_NE(run_docs("--chek"), 0);
}

}  // namespace
}  // namespace armwright
