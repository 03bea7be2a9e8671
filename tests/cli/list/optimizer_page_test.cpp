#include "cli/list/optimizer_page.hpp"

#include <gmock/gmock.h>

#include <set>
#include <sstream>

#include "optimizers/table/optimizer_table.hpp"

namespace armwright {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

OptimizerRow make_row() {
  OptimizerRow row;
  row.name = "lib:demo";
  row.summary = "Demo: a|b *stars*";
  row.source = "Doe 1999, A paper; Roe 2001, Another";
  row.capabilities = {.stochastic = true};
  row.options = {
      {.name = "size", .description = "of f|g", .fallback = std::int64_t{3}, .upper = 9},
      {.name = "rate", .description = "r", .fallback = 0.5, .lower = 1e-9, .upper = 1e12},
      {.name = "way", .description = "w", .fallback = "a|b", .choices = {"a|b", "c"}},
      {.name = "on", .description = "o", .fallback = true},
      {.name = "label", .description = "l", .fallback = ""}};
  return row;
}

TEST(OptimizerPage, HoldsWhatTheRowSays) {
  const std::string page = format_optimizer_page(make_row());
  EXPECT_THAT(page, AllOf(HasSubstr("\n# `lib:demo`\n\nDemo: a\\|b \\*stars\\*.\n"),
                          HasSubstr("\n- Doe 1999, A paper.\n- Roe 2001, Another.\n"),
                          HasSubstr("\n    armwright optimize q1-complex --optimizer lib:demo\n"),
                          HasSubstr("\n| stochastic | yes | uses random numbers"),
                          HasSubstr("\n| bounds | yes |"), HasSubstr("\n| paced | no |")));
  EXPECT_THAT(page, AllOf(HasSubstr("\n| `size` | `3` | integer, 0 to 9 | of f\\|g |\n"),
                          HasSubstr("\n| `rate` | `0.5` | number, 1e-09 to 1e+12 | r |\n"),
                          HasSubstr("\n| `way` | `a\\|b` | `a\\|b`, `c` | w |\n"),
                          HasSubstr("\n| `on` | `true` | true or false | o |\n"),
                          HasSubstr("\n| `label` | (empty) | any text | l |\n")));
}

TEST(OptimizerPage, SaysWhatTheOptimizerNeeds) {
  OptimizerRow row = make_row();
  EXPECT_THAT(
      format_optimizer_page(row),
      AllOf(HasSubstr("- **Build:** part of every build."), HasSubstr("- **Problem:** any."),
            HasSubstr("- **Runs:** in armwright's own process.")));
  row.backend = "Libfoo (CMake option FOO)";
  row.requirements = {.objectives = 2, .variables = 3, .residuals = true};
  row.isolated = "with a=b";
  EXPECT_THAT(
      format_optimizer_page(row),
      AllOf(
          HasSubstr("- **Build:** needs Libfoo (CMake option FOO), which a build has by default."),
          HasSubstr("one with at least 2 objectives and at least 3 decision variables and "
                    "residuals (all robot problems have them)."),
          HasSubstr("with a=b in a process of its own"), HasSubstr("optimize q2-pareto ")));
}

TEST(OptimizerPage, SaysWhatBecomesOfConstraints) {
  OptimizerRow row = make_row();
  EXPECT_THAT(format_optimizer_page(row),
              HasSubstr("| constraints | no | does not know the constraints and ignores them |"));
  row.options.push_back({.name = "constraint_weight", .description = "c", .fallback = 1.0});
  EXPECT_THAT(format_optimizer_page(row), HasSubstr("times constraint_weight, is added"));
  row.capabilities.constraints = true;
  EXPECT_THAT(format_optimizer_page(row), HasSubstr("| constraints | yes | sees the constraints"));
}

TEST(OptimizerPage, DoesNotDependOnTheBuild) {
  OptimizerRow row = make_row();
  const std::string page = format_optimizer_page(row);
  const std::string index = format_optimizer_index({&row, 1});
  row.unavailable = "built without Libfoo";
  EXPECT_EQ(format_optimizer_page(row), page);
  EXPECT_EQ(format_optimizer_index({&row, 1}), index);
}

TEST(OptimizerPage, SaysWhyItIsNotOffered) {
  OptimizerRow row = make_row();
  row.unfit = "it loses";
  EXPECT_THAT(format_optimizer_page(row), AllOf(HasSubstr("- **Not offered:** it loses."),
                                                Not(HasSubstr("armwright optimize"))));
  EXPECT_THAT(format_optimizer_index({&row, 1}), HasSubstr("(not offered)"));
}

TEST(OptimizerPage, SaysOnWhichProblemsDefaultsWereChosen) {
  OptimizerRow row = make_row();
  EXPECT_THAT(format_optimizer_page(row), Not(HasSubstr("**Defaults:**")));
  row.tuned_on = {"sphere", "q1-complex"};
  row.tuning = "step was the best of three";
  EXPECT_THAT(format_optimizer_page(row),
              HasSubstr("- **Defaults:** some were chosen on `sphere`, `q1-complex`: step was the "
                        "best of three. The verdict"));
}

TEST(OptimizerPage, LocalOnesCanBeginAgainElsewhere) {
  OptimizerRow row = make_row();
  const std::string call = "--optimizer multistart:lib:demo\n";
  EXPECT_THAT(format_optimizer_page(row), Not(HasSubstr(call)));
  row.capabilities.local = true;
  EXPECT_THAT(format_optimizer_page(row), HasSubstr(call));
}

TEST(OptimizerIndex, LinksEveryRowInTheOrderOfTheTable) {
  const std::string index = format_optimizer_index(optimizer_table());
  std::size_t position = 0;
  std::set<std::string> pages;
  for (const OptimizerRow& row : optimizer_table()) {
    const std::string page = get_page_name(row.name);
    EXPECT_TRUE(pages.insert(page).second) << page << " is the page of two optimizers";
    position = index.find("\n| [`" + row.name + "`](" + page + ") | ", position);
    ASSERT_NE(position, index.npos) << row.name;
  }
  EXPECT_EQ(get_page_name("nlopt:direct_l"), "nlopt-direct_l.md");
}

// Every line of a table has as many cells as its head, so no text of a row ends its cell.
TEST(OptimizerPages, TablesAreWhole) {
  std::vector<std::string> pages = {format_optimizer_index(optimizer_table())};
  for (const OptimizerRow& row : optimizer_table()) {
    pages.push_back(format_optimizer_page(row));
  }
  const auto count_cells = [](const std::string& line) {
    int bars = 0;
    for (std::size_t i = 0; i < line.size(); ++i) {
      bars += line[i] == '|' && (i == 0 || line[i - 1] != '\\') ? 1 : 0;
    }
    return bars;
  };
  for (const std::string& page : pages) {
    EXPECT_THAT(page, StartsWith("<!-- "));
    std::istringstream lines(page);
    int cells = 0;
    for (std::string line; std::getline(lines, line);) {
      const int now = count_cells(line);
      if (now > 0 && cells > 0) {
        EXPECT_EQ(now, cells) << line;
      }
      cells = now;
    }
  }
}

}  // namespace
}  // namespace armwright
