#include "study/compare/optimizer_streams.hpp"

#include <gmock/gmock.h>

#include <fstream>

#include "base/expect_error.hpp"
#include "study/compare/study_support.hpp"

namespace armwright {
namespace {

using testing::HasSubstr;

constexpr const char* kSphereHead =
    "problems = ['sphere']\nset = ['function.dimension=3']\nbudget = 60\nreplicates = 2\n"
    "baselines = false\n";

// A study.toml that version 1.0.0 recorded for configs/studies/smoke.toml.
std::filesystem::path get_recorded_plan() {
  return std::filesystem::path(ARMWRIGHT_TEST_DATA) / "studies" / "recorded-1.0.toml";
}

TEST_F(StudyTest, AnotherLabelDoesNotChangeTheResults) {
  const auto run = [&](const std::string& label) {
    const StudyPlan plan =
        load_plan(temporary_, std::string(kSphereHead) + "[[optimizer]]\nname = 'ga'\nlabel = '" +
                                  label + "'\noptions = ['population=9']\n");
    std::vector<std::vector<double>> winners;
    for (const CellOutcome& cell : study(plan, label).cells) {
      winners.push_back(cell.x);
    }
    return winners;
  };
  EXPECT_EQ(run("one name"), run("another name"));
}

TEST(OptimizerStreams, DependOnWhatTheOptimizerIs) {
  const TemporaryFolder folder;
  const auto get_stream = [&](const std::string& entry) {
    return load_plan(folder, std::string(kSphereHead) + "[[optimizer]]\n" + entry)
        .optimizers[0]
        .stream;
  };
  const std::string plain = get_stream("name = 'ga'\n");
  EXPECT_EQ(plain, get_stream("name = 'ga'\nlabel = 'other'\n"));
  EXPECT_EQ(plain, get_stream("name = 'ga'\noptions = ['population=35']\n"));  // the default
  const std::vector<std::string> others = {
      get_stream("name = 'ga:simple'\n"), get_stream("name = 'ga'\noptions = ['population=9']\n"),
      get_stream("name = 'ga'\nschedule = 'fresh:1'\n"),
      get_stream("name = 'ga'\nschedule = 'fixed:4'\n"),
      get_stream("name = 'ga'\nschedule = 'fixed:4'\nset = ['racing.kind=halving']\n")};
  for (const std::string& other : others) {
    EXPECT_NE(plain, other);
    EXPECT_EQ(std::ranges::count(others, other), 1);
  }
}

TEST(OptimizerStreams, OfEqualEntriesDifferByTheirOccurrence) {
  const TemporaryFolder folder;
  const StudyPlan plan = load_plan(
      folder, std::string(kSphereHead) +
                  "[[optimizer]]\nname = 'ga'\n[[optimizer]]\nname = 'ga'\nlabel = 'again'\n"
                  "[[optimizer]]\nname = 'ga'\nlabel = 'and again'\n");
  EXPECT_EQ(plan.optimizers[1].stream, plan.optimizers[0].stream + "-2");
  EXPECT_EQ(plan.optimizers[2].stream, plan.optimizers[0].stream + "-3");
  EXPECT_NE(make_run_plan(plan, {0, 0, 1}).seed, make_run_plan(plan, {0, 1, 1}).seed);
  EXPECT_NE(make_run_plan(plan, {0, 1, 1}).seed, make_run_plan(plan, {0, 2, 1}).seed);
}

TEST(OptimizerStreams, OfARecordedPlanStayWhenAnEqualEntryComesBeforeTheRecordedOne) {
  const TemporaryFolder folder;
  const StudyPlan first =
      load_plan(folder, std::string(kSphereHead) + "[[optimizer]]\nname = 'ga'\n");
  StudyFolder(folder / "study", first);
  StudyPlan grown = load_plan(
      folder, std::string(kSphereHead) +
                  "[[optimizer]]\nname = 'ga'\nlabel = 'new'\n[[optimizer]]\nname = 'ga'\n");
  adopt_recorded(folder / "study", grown);
  EXPECT_EQ(grown.optimizers[1].stream, first.optimizers[0].stream);
  EXPECT_EQ(grown.optimizers[0].stream, first.optimizers[0].stream + "-2");
  EXPECT_NO_THROW(StudyFolder(folder / "study", grown));
  EXPECT_EQ(to_toml(load_study_plan(folder / "study")), to_toml(grown));
}

TEST(OptimizerStreams, ThatTwoEntriesShareAreRefused) {
  const TemporaryFolder folder;
  EXPECT_THAT(usage_error_of([&] {
                load_plan(folder,
                          std::string(kSphereHead) +
                              "[[optimizer]]\nname = 'ga'\nstream = 's'\n[[optimizer]]\nname = "
                              "'ga'\nlabel = 'again'\nstream = 's'\n");
              }),
              HasSubstr("the optimizers 'ga' and 'again' have the same stream 's'"));
}

TEST(OptimizerStreams, AStudyOfVersion1IsRefusedInOneSentence) {
  const std::string file = get_recorded_plan().string();
  EXPECT_THAT(usage_error_of([&] {
                StudyRequest request;
                request.file = file;
                make_study_plan(request);
              }),
              HasSubstr(file + ": version 1.0 of armwright recorded this plan"));
}

}  // namespace
}  // namespace armwright
