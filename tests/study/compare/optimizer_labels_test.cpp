// The labels of optimizers to which a study gives none.
#include "study/compare/optimizer_labels.hpp"

#include <gmock/gmock.h>

#include "base/expect_error.hpp"
#include "optimizers/builtin/random_search.hpp"
#include "study/compare/optimizer_streams.hpp"
#include "study/compare/study_support.hpp"

namespace armwright {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

// A plugin in the file `path` that calls itself `name`, and is a random search.
OptimizerRow make_plugin(const std::string& path, const std::string& name) {
  OptimizerRow row = make_random_search_rows().front();
  row.name = path;
  row.short_name = name;
  return row;
}

StudyPlan make_plan(const std::vector<OptimizerRow>& rows) {
  StudyRequest request = make_small_request();
  request.optimizers.clear();
  for (const OptimizerRow& row : rows) {
    request.optimizers.push_back(row.name);
  }
  request.rows = rows;
  request.baselines = false;
  return make_study_plan(request);
}

std::vector<std::string> list_labels(const StudyPlan& plan) {
  std::vector<std::string> labels;
  for (const StudyOptimizer& optimizer : plan.optimizers) {
    labels.push_back(optimizer.label);
  }
  return labels;
}

const OptimizerRow kMine = make_plugin("/long/path/libmine.so", "mine");
const OptimizerRow kTwin = make_plugin("/another/libmine.so", "mine");

TEST(OptimizerLabels, APluginHasTheNameThatItGivesItself) {
  EXPECT_THAT(list_labels(make_plan({kMine})), ElementsAre("mine"));
}

TEST(OptimizerLabels, TwinsAreToldApart) {
  EXPECT_THAT(list_labels(make_plan({kMine, kTwin, make_plugin("/c/mine.so", "mine")})),
              ElementsAre("mine", "mine#2", "mine#3"));
}

TEST(OptimizerLabels, APluginThatCallsItselfLikeAShippedOptimizerKeepsItsPath) {
  EXPECT_THAT(list_labels(make_plan({make_plugin("/a/libga.so", "ga"), kMine})),
              ElementsAre("/a/libga.so", "mine"));
}

TEST(OptimizerLabels, TheSamePluginTwiceNeedsALabel) {
  EXPECT_THAT(error_of(ErrorKind::usage,
                       [] {
                         make_plan({kMine, kMine});
                       }),
              HasSubstr("two optimizers of the study are called 'mine'; give one of them another"));
}

TEST(OptimizerLabels, AReferenceMayBeThePath) {
  StudyPlan plan = make_plan({kMine});
  plan.reference = kMine.name;
  choose_labels(plan);
  EXPECT_EQ(plan.reference, "mine");
}

TEST_F(StudyTest, AnotherOrderOfPluginsKeepsTheirLabels) {
  { const StudyFolder folder(temporary_ / "study", make_plan({kMine, kTwin})); }
  StudyPlan now = make_plan({make_plugin("/c/mine.so", "mine"), kTwin, kMine});
  adopt_recorded(temporary_ / "study", now);
  EXPECT_THAT(list_labels(now), ElementsAre("mine#3", "mine#2", "mine"));
}

}  // namespace
}  // namespace armwright
