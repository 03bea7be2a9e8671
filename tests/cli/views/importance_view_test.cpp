#include "cli/views/importance_view.hpp"

#include <gmock/gmock.h>

namespace armwright {
namespace {

using testing::HasSubstr;
using testing::Not;

Importance make_importance() {
  ImportancePart part{.region = ImportanceRegion::winner,
                      .half_width = 0.1,
                      .points = 1,
                      .explained = 0.3,
                      .judgement = "A model explains only 30 % of the differences: too little."};
  part.variables.resize(3);
  part.variables[1] = {
      .first = 0.25, .total = 0.5, .first_interval = {0.1, 0.3}, .total_interval = {0.4, 0.6}};
  part.variables[2] = {
      .first = 0.7, .total = 0.75, .first_interval = {0.6, 0.8}, .total_interval = {0.7, 0.8}};
  Importance importance;
  importance.objective = {"mean error", "m"};
  importance.scale = ValueScale::logarithm;
  importance.left_out = 1;
  importance.variables = {"a", "b", "c"};
  importance.parts = {part};
  importance.notes = {"A note."};
  return importance;
}

TEST(ImportanceView, SaysFirstHowFarToTrustItAndSortsTheVariables) {
  const std::string text = describe_importance(make_importance(), Style(false));
  EXPECT_THAT(text, HasSubstr("Variables that matter near the winner, within 10 % of each "
                              "variable's range (1 evaluation)\n  A model explains only 30 %"));
  EXPECT_LT(text.find("\n  c "), text.find("\n  b "));
  EXPECT_THAT(text, HasSubstr("0.70 (0.60 to 0.80)"));
  EXPECT_THAT(text, HasSubstr("0.75 (0.70 to 0.80)"));
  EXPECT_THAT(text, Not(HasSubstr("\n  a ")));
  EXPECT_THAT(text, HasSubstr("and 1 variable below 0.01"));
  EXPECT_THAT(text, HasSubstr("of the logarithm of mean error"));
  EXPECT_THAT(text, HasSubstr("1 evaluation is left out, which failed or lost a race.\nA note.\n"));
}

TEST(ImportanceView, WithoutPartsItHasTheNotesAlone) {
  Importance importance = make_importance();
  importance.parts.clear();
  importance.left_out = 0;
  EXPECT_EQ(describe_importance(importance, Style(false)), "A note.\n");
}

}  // namespace
}  // namespace armwright
