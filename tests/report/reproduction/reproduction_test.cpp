// Checks a reproduction's folder: how it continues, how it grows, and what it refuses. Also checks
// the shipped plan of the thesis.

#include "report/reproduction/reproduction.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/expect_error.hpp"
#include "base/file.hpp"
#include "base/remove_checksums.hpp"
#include "report/reproduction/small_reproduction.hpp"
#include "study/run/run_observer.hpp"

namespace armwright {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::size_t kLimit_bytes = std::size_t{1} << 24;

// Requests a stop when it hears of a phase for the `at`-th time.
class Interrupter final : public RunObserver {
 public:
  Interrupter(StopSignal& stop, int at) : stop_(stop), at_(at) {}
  void on_progress(const Progress& progress) override {
    heard_training_ = heard_training_ || progress.phase == CaseRole::training;
    if (++calls_ == at_) {
      stop_.request(StopReason::interrupted);
    }
  }
  void on_message(const std::string& /*message*/) override {}
  int calls() const { return calls_; }
  bool heard_training() const { return heard_training_; }

 private:
  StopSignal& stop_;
  int at_;
  int calls_ = 0;
  bool heard_training_ = false;
};

std::optional<std::vector<PartResult>> reproduce(const ReproductionRequest& request,
                                                 const std::filesystem::path& path,
                                                 StopSignal& stop, RunObserver& observer) {
  ReproductionPlan plan = plan_reproduction(request);
  ReproductionFolder folder(path, plan);
  return execute_reproduction(plan, &folder, "armwright", 1, stop, observer);
}

std::string read(const std::filesystem::path& file) {
  return read_file(file, kLimit_bytes);
}

void expect_all(const std::string& text, const std::vector<std::string>& parts) {
  for (const std::string& part : parts) {
    EXPECT_THAT(text, HasSubstr(part));
  }
}

std::vector<std::string> get_labels(const ReproductionPlan& plan) {
  std::vector<std::string> labels;
  for (const PlannedPart& part : plan.parts) {
    labels.push_back(part.part.label);
  }
  return labels;
}

TEST(Reproduction, AnInterruptedOneEndsWithTheBytesOfAnUninterruptedOne) {
  const SmallReproduction small;
  const auto whole = small.path() / "whole";
  const auto resumed = small.path() / "resumed";
  StopSignal never;
  Interrupter silent(never, -1);
  const auto results = reproduce(small.request(), whole, never, silent);
  ASSERT_TRUE(results);
  EXPECT_TRUE(silent.heard_training());
  int interruptions = 0;
  bool cut_training = false;
  for (bool done = false; !done; ++interruptions) {
    ASSERT_LT(interruptions, 1000);
    StopSignal stop;
    // Each stop comes later. Otherwise every attempt would end at the same place.
    Interrupter interrupter(stop, 2 + interruptions);
    done = reproduce(small.request(), resumed, stop, interrupter).has_value();
    cut_training = cut_training || (!done && interrupter.heard_training());
  }
  EXPECT_GT(interruptions, 3);
  EXPECT_TRUE(cut_training);
  EXPECT_EQ(read(whole / "reproduction.json"), read(resumed / "reproduction.json"));
  for (const char* file : {"result.json", "winner.toml"}) {
    EXPECT_EQ(read(whole / "runs" / "tiny" / file), read(resumed / "runs" / "tiny" / file)) << file;
  }
}

TEST(Reproduction, WhatIsThereIsNotComputedAgain) {
  const SmallReproduction small;
  const auto folder = small.path() / "reproduction";
  StopSignal stop;
  Interrupter first(stop, -1);
  const auto made = reproduce(small.request(), folder, stop, first);
  Interrupter second(stop, -1);
  const auto found = reproduce(small.request(), folder, stop, second);
  ASSERT_TRUE(made && found);
  EXPECT_GT(first.calls(), 0);
  EXPECT_EQ(second.calls(), 0);
  ASSERT_EQ(made->size(), found->size());
  for (std::size_t i = 0; i < made->size(); ++i) {
    EXPECT_EQ((*made)[i].part.label, (*found)[i].part.label);
    EXPECT_EQ((*made)[i].case_errors, (*found)[i].case_errors);
    EXPECT_EQ((*made)[i].points.mean_m, (*found)[i].points.mean_m);
  }
}

TEST(Reproduction, TablesRestrictItAndLaterItGrows) {
  const SmallReproduction small;
  ReproductionRequest request = small.request();
  request.tables = {"A.8"};
  const ReproductionPlan plan = plan_reproduction(request);
  EXPECT_THAT(get_labels(plan), ElementsAre("A.8"));  // the sweep needs A.10
  EXPECT_THAT(plan.runs, IsEmpty());
  const auto path = small.path() / "reproduction";
  StopSignal stop;
  Interrupter observer(stop, -1);
  ASSERT_TRUE(reproduce(request, path, stop, observer));
  const std::string before = read(path / "reproduction.json");
  request.tables = {"A.7", "table-a8"};
  ASSERT_TRUE(reproduce(request, path, stop, observer));
  const ReproductionRecord record = load_reproduction(path);
  EXPECT_THAT(record.planned, ElementsAre("A.7", "A.8"));
  EXPECT_EQ(record.results.size(), 2);
  // Every order gives the same bytes.
  const auto at_once = small.path() / "at-once";
  ASSERT_TRUE(reproduce(request, at_once, stop, observer));
  EXPECT_EQ(read(at_once / "reproduction.json"), read(path / "reproduction.json"));
  EXPECT_NE(before, read(path / "reproduction.json"));
}

TEST(Reproduction, ForeignAndDamagedFoldersAreRefused) {
  const SmallReproduction small;
  ReproductionRequest request = small.request();
  request.tables = {"A.8"};
  const ReproductionPlan plan = plan_reproduction(request);
  const auto open = [&](const std::filesystem::path& path) {
    return [&plan, path] { const ReproductionFolder folder(path, plan); };
  };
  const auto put = [&](const std::string& name, const std::string& file, const std::string& text) {
    make_folder(small.path() / name);
    write_file_atomically(small.path() / name / file, text);
    return small.path() / name;
  };
  expect_all(error_of(ErrorKind::usage, open(put("run", "manifest.json", "{}"))),
             {"'manifest.json' but no reproduction.json", "--out, or --new"});
  expect_all(error_of(ErrorKind::usage, open(put("study", "study.toml", ""))),
             {"'study.toml' but no reproduction.json"});
  for (const char* damaged : {"{\"format\": 1, \"par", "[]", "{}", "{\"format\": 2}", ""}) {
    expect_all(error_of(ErrorKind::bad_data, open(put("damaged", "reproduction.json", damaged))),
               {"reproduction.json: is not what armwright wrote", "--new"});
  }
  expect_all(error_of(ErrorKind::usage, [&] { load_reproduction(small.path() / "run"); }),
             {"is not the folder of a reproduction"});
}

TEST(Reproduction, OtherSettingsAreNotMixedIn) {
  const SmallReproduction small;
  ReproductionRequest request = small.request();
  request.tables = {"A.8"};
  const auto path = small.path() / "reproduction";
  StopSignal stop;
  Interrupter observer(stop, -1);
  ASSERT_TRUE(reproduce(request, path, stop, observer));
  const std::string before = read(path / "reproduction.json");
  const auto open = [&] { const ReproductionFolder folder(path, plan_reproduction(request)); };
  request.cases = 3;
  expect_all(error_of(ErrorKind::usage, open), {"other settings", "--cases 2", "now --cases 3"});
  request.cases = 2;
  request.overrides = {"physics.engine=articulated"};
  expect_all(error_of(ErrorKind::usage, open), {"other settings", "physics.engine=articulated"});
  request.overrides.clear();
  std::string other = before;
  remove_checksums(path);
  const std::string key = "\"inputs_sha256\": \"";
  other.replace(other.find(key) + key.size(), 4, "zzzz");
  write_file_atomically(path / "reproduction.json", other);
  expect_all(error_of(ErrorKind::usage, open), {"'A.8'", "another problem, design or SIMD level"});
  write_file_atomically(path / "reproduction.json", before);
  EXPECT_NO_THROW(open());
}

TEST(Reproduction, WhatTheThesisShowsIsInThePlan) {
  ReproductionRequest request;
  request.whole = true;
  const ReproductionPlan plan = plan_reproduction(request);
  const auto labels = get_labels(plan);
  const ReproductionConfig config = load_reproduction_config("thesis");
  for (const ResponseFigureConfig& figure : config.figures) {
    for (const auto& [name, of] : figure.series) {
      EXPECT_THAT(labels, testing::Contains(of)) << figure.id;
    }
  }
  for (const ReplayConfig& replay : config.replays) {
    EXPECT_THAT(labels, testing::Contains(replay.of)) << replay.id;
  }
  ASSERT_EQ(plan.runs.size(), 8);
  for (const RunPlan& run : plan.runs) {
    EXPECT_EQ(run.optimizer.name, "ga");
    EXPECT_EQ(to_text(run.schedule), "fresh:1") << run.problem.name;
    EXPECT_EQ(run.budget, run.problem.budget);
  }
}

TEST(Reproduction, AReasonOfNoResultIsRefused) {
  const SmallReproduction small;
  const std::filesystem::path config = small.path() / "small.toml";
  write_file_atomically(config, read_file(config, kLimit_bytes) +
                                    "[[difference]]\nparts = [\"A.99\"]\nreason = \"None.\"\n");
  EXPECT_THAT(usage_error_of([&] { plan_reproduction(small.request()); }),
              AllOf(HasSubstr("small.toml: difference.parts"), HasSubstr("unknown result 'A.99'"),
                    HasSubstr("A.9")));
}

TEST(Reproduction, PublishedTorquesAreThoseOfThePublishedDesigns) {
  ReproductionRequest request;
  request.whole = true;
  int compared = 0;
  for (const PlannedPart& part : plan_reproduction(request).parts) {
    if (!part.part.design.empty() && part.part.published_torque_n_m) {
      // The thesis prints six digits of the limits and rounds their sum to 1 N m.
      EXPECT_NEAR(calc_total_effort(part.design), *part.part.published_torque_n_m, 1)
          << part.part.label;
      ++compared;
    }
  }
  EXPECT_GE(compared, 4);  // A.1, A.5, A.10, A.11
}

}  // namespace
}  // namespace armwright
