#include "study/compare/optimizer_streams.hpp"

#include <gmock/gmock.h>

#include <fstream>

#include "base/expect_error.hpp"
#include "study/compare/study_support.hpp"

namespace armwright {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr const char* kSphereHead =
    "problems = ['sphere']\nset = ['function.dimension=3']\nbudget = 60\nreplicates = 2\n"
    "baselines = false\n";

// A study.toml that version 1.0.0 recorded for configs/studies/smoke.toml.
std::filesystem::path get_recorded_plan() {
  return std::filesystem::path(ARMWRIGHT_TEST_DATA) / "studies" / "recorded-1.0.toml";
}

// The seeds that the manifests of that study's cells record.
struct RecordedSeed {
  Cell cell;
  std::uint64_t seed;
};
constexpr RecordedSeed kRecordedSeeds[] = {{{0, 0, 1}, 8095379324219983495U},
                                           {{0, 1, 8}, 1928005585354093957U},
                                           {{1, 2, 3}, 3448320594011298925U},
                                           {{1, 3, 5}, 6203262118055551983U}};

void expect_recorded_seeds(const StudyPlan& plan) {
  for (const auto& [cell, seed] : kRecordedSeeds) {
    EXPECT_EQ(make_run_plan(plan, cell).seed, seed) << make_cell_path(plan, cell);
  }
}

StudyPlan load(const std::filesystem::path& file) {
  StudyRequest request;
  request.file = file.string();
  return make_study_plan(request);
}

// Makes a plan like the recorded one, with ga once more.
StudyPlan make_grown_plan() {
  StudyRequest request;
  request.problems = {"sphere", "rosenbrock"};
  request.optimizers = {"ga", "cmaes", "random", "nlopt:neldermead"};
  request.baselines = false;  // those of 1.0 lack the start
  request.replicates = 8;
  request.budget = 600;
  StudyPlan plan = make_study_plan(request);
  plan.start_spread = 1;
  plan.optimizers.push_back(plan.optimizers.front());
  plan.optimizers.back().label = "ga again";
  plan.optimizers.back().has_given_label = true;
  plan.optimizers.back().stream.clear();
  name_streams(plan);
  return plan;
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

TEST(OptimizerStreams, OfAPlanThatVersion1RecordedAreItsLabels) {
  const StudyPlan plan = load(get_recorded_plan());
  expect_recorded_seeds(plan);
  EXPECT_EQ(to_toml(plan), read_file(get_recorded_plan(), 1 << 20));
}

TEST(OptimizerStreams, OfAStudyThatVersion1RecordedStayWhenItGrows) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "study");
  std::filesystem::copy_file(get_recorded_plan(), folder / "study" / "study.toml");
  StudyPlan plan = make_grown_plan();
  EXPECT_NE(make_run_plan(plan, kRecordedSeeds[0].cell).seed, kRecordedSeeds[0].seed);
  adopt_recorded(folder / "study", plan);
  expect_recorded_seeds(plan);
  EXPECT_NO_THROW(StudyFolder(folder / "study", plan));
  const std::string recorded = read_file(folder / "study" / "study.toml", 1 << 20);
  EXPECT_THAT(recorded, testing::AllOf(HasSubstr("ga again"), Not(HasSubstr("stream = "))));
  expect_recorded_seeds(load_study_plan(folder / "study"));
}

// Without the line plan_sha256 the file is a user's own study.
TEST(OptimizerStreams, OfAUsersOwnStudyAreNotItsLabels) {
  const TemporaryFolder folder;
  std::string text = read_file(get_recorded_plan(), 1 << 20);
  text.erase(0, text.find('\n') + 1);
  EXPECT_NE(make_run_plan(load_plan(folder, text), kRecordedSeeds[0].cell).seed,
            kRecordedSeeds[0].seed);
}

}  // namespace
}  // namespace armwright
