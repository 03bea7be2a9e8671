// The defaults of version 1.0: what an option means that a recorded configuration leaves out.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <string>

#include "optimizers/table/optimizer_table.hpp"

namespace armwright {
namespace {

// A recorded configuration without an option has the default of 1.0. So a default may change only
// together with a rule that gives such configurations the old one.
TEST(OptimizerTable, HasTheDefaultsOfVersion1) {
  std::ifstream file(ARMWRIGHT_TEST_DATA "/optimizers/defaults-1.0.txt");
  int options = 0;
  for (std::string name, assignment; file >> name && std::getline(file >> std::ws, assignment);
       ++options) {
    const auto row = std::ranges::find(optimizer_table(), name, &OptimizerRow::name);
    ASSERT_NE(row, optimizer_table().end()) << name;
    const std::string key = assignment.substr(0, assignment.find('='));
    const auto option = std::ranges::find(row->options, key, &OptionSpec::name);
    ASSERT_NE(option, row->options.end()) << name << ' ' << key;
    EXPECT_EQ(key + '=' + to_text(option->fallback), assignment) << name;
  }
  EXPECT_EQ(options, 288);
}

TEST(OptimizerTable, SaysHowDefaultsWereChosenWhereItNamesTheProblems) {
  for (const OptimizerRow& row : optimizer_table()) {
    EXPECT_EQ(row.tuned_on.empty(), row.tuning.empty()) << row.name;
  }
}

}  // namespace
}  // namespace armwright
