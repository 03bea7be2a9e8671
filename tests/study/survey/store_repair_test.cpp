// The command that made a store resumes its repaired copy, and ends with the same bytes as a run
// that was never damaged.
#include "study/survey/store_repair.hpp"

#include <gmock/gmock.h>

#include <atomic>
#include <chrono>
#include <fstream>
#include <functional>
#include <thread>

#include "base/error.hpp"
#include "study/compare/study_support.hpp"
#include "study/run/run_lock.hpp"
#include "study/run/run_observer.hpp"
#include "study/survey/folder_copy.hpp"

namespace armwright {
namespace {

using testing::HasSubstr;

void change(const std::filesystem::path& file, const std::function<void(std::string&)>& how) {
  std::string bytes = read_file(file, std::size_t{1} << 28);
  how(bytes);
  std::ofstream(file, std::ios::binary) << bytes;
}

// Damages the middle of the file at several places.
void damage_journal(const std::filesystem::path& run) {
  change(run / "journal", [](std::string& bytes) {
    for (const std::size_t percent : {5, 31, 32, 60, 88}) {
      const std::size_t at = bytes.size() * percent / 100;
      bytes.replace(at, 5, "\xFF\0x\xA0\n", 5);
    }
  });
}

std::map<std::string, std::string> read_derived(const std::filesystem::path& run) {
  std::map<std::string, std::string> files;
  for (const std::string& name : derived_file_names()) {
    if (name != "results.sqlite" && std::filesystem::exists(run / name)) {
      files[name] = read_file(run / name, std::size_t{1} << 26);
    }
  }
  return files;
}

bool names(const RunSurvey& run, const std::string& file, const std::string& what) {
  return std::ranges::any_of(run.findings, [&](const Finding& finding) {
    return finding.kind != Finding::Kind::note && finding.file == file &&
           finding.what.find(what) != std::string::npos;
  });
}

class StoreRepairTest : public RunTest {
 protected:
  StopSignal stop_;
};

class StoreRepairOf : public StoreRepairTest, public testing::WithParamInterface<const char*> {};

TEST_P(StoreRepairOf, ARunGoesOnToTheSameResult) {
  const RunPlan plan = make_small_plan(GetParam(), 200);
  ASSERT_TRUE(run(plan, "whole"));
  ASSERT_TRUE(run(plan, "hurt"));
  EXPECT_FALSE(survey_store(temporary_ / "hurt").is_damaged());
  damage_journal(temporary_ / "hurt");
  const auto before = read_tree(temporary_ / "hurt");
  const StoreSurvey survey = survey_store(temporary_ / "hurt");
  ASSERT_TRUE(survey.is_damaged());
  EXPECT_GE(survey.runs[0].journal->damage.size(), 4u);
  EXPECT_GT(survey.runs[0].lost, 0u);

  const auto repaired = repair_store(temporary_ / "hurt", temporary_ / "copy", stop_);
  ASSERT_TRUE(repaired);
  ASSERT_EQ(repaired->runs.size(), 1u);
  const RunRepair& done = repaired->runs[0];
  EXPECT_GT(done.evaluations_kept, 0u);
  EXPECT_EQ(done.kept_aside, std::vector<std::string>{"journal"});
  EXPECT_EQ(read_tree(temporary_ / "hurt"), before);
  EXPECT_EQ(read_tree(temporary_ / "copy")["journal.damaged"],
            read_tree(temporary_ / "hurt")["journal"]);
  EXPECT_FALSE(survey_store(temporary_ / "copy").is_damaged());
  EXPECT_EQ(read("copy").training.size(), done.evaluations_kept);

  ASSERT_TRUE(run(plan, "copy"));
  EXPECT_EQ(observer_.last.phase, CaseRole::test);
  expect_same_evaluations(read("whole"), read("copy"));
  EXPECT_EQ(read_derived(temporary_ / "whole"), read_derived(temporary_ / "copy"));
  EXPECT_FALSE(survey_store(temporary_ / "copy").is_damaged());
}

INSTANTIATE_TEST_SUITE_P(Optimizers, StoreRepairOf,
                         testing::Values("ga", "cmaes", "random", "nlopt:cobyla"),
                         [](const auto& test) {
                           std::string name = test.param;
                           std::ranges::replace(name, ':', '_');
                           return name;
                         });

TEST_F(StoreRepairTest, DamagedDerivedFilesAreNamedAndMadeAgain) {
  const RunPlan plan = make_small_plan();
  ASSERT_TRUE(run(plan, "whole"));
  const auto wanted = read_derived(temporary_ / "whole");
  const auto cut = [](std::string& bytes) { bytes.resize(bytes.size() * 2 / 3); };
  for (const std::string name : {"result.json", "winner.toml", "convergence.csv",
                                 "winner-trajectory.csv", "results.sqlite"}) {
    SCOPED_TRACE(name);
    const auto hurt = temporary_ / "hurt";
    std::filesystem::copy(temporary_ / "whole", hurt, std::filesystem::copy_options::recursive);
    change(hurt / name, cut);
    const StoreSurvey survey = survey_store(hurt);
    EXPECT_TRUE(names(survey.runs[0], name, "")) << survey.runs[0].findings.size();
    EXPECT_EQ(survey.runs[0].lost, 0u);
    const auto repaired = repair_store(hurt, temporary_ / "copy", stop_);
    ASSERT_TRUE(repaired);
    EXPECT_FALSE(repaired->runs[0].has_new_journal);
    EXPECT_TRUE(std::filesystem::exists(temporary_ / "copy" / (name + ".damaged")));
    ASSERT_TRUE(run(plan, "copy"));
    EXPECT_EQ(read_derived(temporary_ / "copy"), wanted);
    std::filesystem::remove_all(hurt);
    std::filesystem::remove_all(temporary_ / "copy");
  }
}

TEST_F(StoreRepairTest, AResultThatIsNotTheJournalsIsNamed) {
  ASSERT_TRUE(run(make_small_plan(), "hurt"));
  const auto replace = [&](const char* file, const std::string& from, const std::string& to) {
    change(temporary_ / "hurt" / file, [&](std::string& text) {
      const auto at = text.find(from);
      ASSERT_NE(at, std::string::npos);
      text.replace(at, from.size(), to);
    });
  };
  replace("result.json", "\"evaluations\": 40", "\"evaluations\": 41");
  EXPECT_TRUE(names(survey_store(temporary_ / "hurt").runs[0], "result.json",
                    "it counts 41 evaluations, and the journal 40"));
  replace("result.json", "\"evaluations\": 41", "\"evaluations\": 40");
  EXPECT_FALSE(survey_store(temporary_ / "hurt").is_damaged());
  for (const auto& [from, to] : std::vector<std::pair<std::string, std::string>>{
           {"\"further_failures\": 0", "\"further_failures\": 1"},
           {"\"further_cases\": 27", "\"further_cases\": 30"}}) {
    replace("result.json", from, to);
    EXPECT_TRUE(names(survey_store(temporary_ / "hurt").runs[0], "result.json",
                      "further validation cases are not in the journal"));
    replace("result.json", to, from);
  }
  replace("result.json", "\"failed_cases\": 0", "\"failed_cases\": 1");
  EXPECT_TRUE(names(survey_store(temporary_ / "hurt").runs[0], "result.json",
                    "on the validation set are not in the journal"));
}

// A file that is there and cannot be read is not called missing.
TEST_F(StoreRepairTest, AnUnreadableResultIsNamedOnce) {
  ASSERT_TRUE(run(make_small_plan(), "hurt"));
  const auto result = temporary_ / "hurt" / "result.json";
  std::ofstream(result) << "{}";
  const auto unreadable = survey_store(temporary_ / "hurt").runs[0].findings;
  ASSERT_EQ(unreadable.size(), 1u);
  EXPECT_TRUE(unreadable[0].what.ends_with("(key 'format' not found)")) << unreadable[0].what;
  std::filesystem::remove(result);
  const auto missing = survey_store(temporary_ / "hurt").runs[0].findings;
  ASSERT_EQ(missing.size(), 1u);
  EXPECT_NE(missing[0].what.find("the command that began the run makes it again"),
            std::string::npos);
}

TEST_F(StoreRepairTest, AJournalThatLostItsEndIsGoneOnWith) {
  const RunPlan plan = make_small_plan();
  ASSERT_TRUE(run(plan, "whole"));
  ASSERT_TRUE(run(plan, "hurt"));
  change(temporary_ / "hurt" / "journal",
         [](std::string& bytes) { bytes.resize(bytes.size() / 2); });
  const StoreSurvey survey = survey_store(temporary_ / "hurt");
  EXPECT_TRUE(names(survey.runs[0], "journal", "its end is missing"));
  EXPECT_GT(survey.runs[0].lost, 0u);
  ASSERT_TRUE(repair_store(temporary_ / "hurt", temporary_ / "copy", stop_));
  ASSERT_TRUE(run(plan, "copy"));
  EXPECT_EQ(read_result("copy"), read_result("whole"));
}

TEST_F(StoreRepairTest, AJournalThatIsGoneIsMadeAnew) {
  const RunPlan plan = make_small_plan();
  ASSERT_TRUE(run(plan, "hurt"));
  const std::string wanted = read_result("hurt");
  std::filesystem::remove(temporary_ / "hurt" / "journal");
  EXPECT_EQ(survey_store(temporary_ / "hurt").runs[0].lost, 40u);
  ASSERT_TRUE(repair_store(temporary_ / "hurt", temporary_ / "copy", stop_));
  ASSERT_TRUE(run(plan, "copy"));
  EXPECT_EQ(read_result("copy"), wanted);
}

TEST_F(StoreRepairTest, ALostManifestIsNotRepairedAndTheAdviceWorks) {
  const RunPlan plan = make_small_plan();
  ASSERT_TRUE(run(plan, "hurt"));
  change(temporary_ / "hurt" / "manifest.json", [](std::string& text) { text.resize(100); });
  const StoreSurvey survey = survey_store(temporary_ / "hurt");
  EXPECT_TRUE(survey.is_record_lost);
  try {
    repair_store(temporary_ / "hurt", temporary_ / "copy", stop_);
    ADD_FAILURE() << "it was repaired";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::bad_data);
    EXPECT_THAT(error.what(), HasSubstr("optimize q1-complex --optimizer ga --seed 1"));
  }
  EXPECT_FALSE(std::filesystem::exists(temporary_ / "copy"));
  // Follows the advice: begin the run again, stop it, and copy the journal there.
  StopSignal stop;
  StoppingObserver stopping(stop, 8);
  ASSERT_FALSE(execute_run({plan, temporary_ / "new", 1, {}}, stop, stopping));
  std::filesystem::copy_file(temporary_ / "hurt" / "journal", temporary_ / "new" / "journal",
                             std::filesystem::copy_options::overwrite_existing);
  ASSERT_TRUE(run(plan, "new"));
  EXPECT_EQ(read_result("new"), read_result("hurt"));
}

TEST_F(StoreRepairTest, WhatIsIntactIsNotCopied) {
  const RunPlan plan = make_small_plan();
  StoppingObserver stopping(stop_, 20);
  ASSERT_FALSE(execute_run({plan, temporary_ / "begun", 1, {}}, stop_, stopping));
  change(temporary_ / "begun" / "journal",
         [](std::string& bytes) { bytes.resize(bytes.size() - 7); });  // a torn end
  StopSignal stop;
  EXPECT_FALSE(repair_store(temporary_ / "begun", temporary_ / "copy", stop));
  EXPECT_FALSE(std::filesystem::exists(temporary_ / "copy"));
}

TEST_F(StoreRepairTest, WhatIsBeingWrittenIsReadAndNotRepaired) {
  ASSERT_TRUE(run(make_small_plan(), "hurt"));
  damage_journal(temporary_ / "hurt");
  const RunLock writer{Folder(temporary_ / "hurt")};
  const StoreSurvey survey = survey_store(temporary_ / "hurt");
  EXPECT_THAT(survey.writer, HasSubstr("process"));
  EXPECT_TRUE(survey.is_damaged());
  try {
    repair_store(temporary_ / "hurt", temporary_ / "copy", stop_);
    ADD_FAILURE() << "it was repaired";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::busy);
  }
}

TEST_F(StoreRepairTest, AskingWhoWritesKeepsNobodyFromWriting) {
  ASSERT_TRUE(run(make_small_plan("ga", 8), "run"));
  std::atomic<bool> done = false;
  std::thread asking([&] {
    while (!done) {
      find_writer(temporary_ / "run");
      std::this_thread::sleep_for(std::chrono::microseconds(200));
    }
  });
  int refused = 0;
  for (int i = 0; i < 300; ++i) {
    try {
      const RunLock lock{Folder(temporary_ / "run")};
    } catch (const Error&) {
      ++refused;
    }
  }
  done = true;
  asking.join();
  // The process that tests the lock may be interrupted while it holds the lock.
  EXPECT_LE(refused, 30);
}

class StudyRepairTest : public StudyTest {};

TEST_F(StudyRepairTest, CellsGoOnToTheSameTables) {
  StudyRequest request = make_small_request();
  request.replicates = 6;
  const StudyPlan plan = make_study_plan(request);
  study(plan, "whole");
  study(plan, "hurt");
  const auto hurt = temporary_ / "hurt";
  EXPECT_FALSE(survey_store(hurt).is_damaged());
  damage_journal(hurt / "cells/sphere/ga/r02");
  damage_journal(hurt / "cells/rosenbrock/cmaes/r05");
  const auto cut = [](std::string& text) { text.resize(text.size() / 2); };
  change(hurt / "cells/sphere/cmaes/r01/cell.json", cut);
  change(hurt / "cells/sphere/cmaes/r03/manifest.json", cut);
  change(hurt / "problems/sphere.json", cut);
  change(hurt / "result.json", cut);
  change(hurt / "tables" / std::filesystem::directory_iterator(hurt / "tables")->path().filename(),
         [](std::string& text) { text.insert(text.size() / 2, "\0", 1); });

  const StoreSurvey survey = survey_store(hurt);
  EXPECT_EQ(survey.kind, StoreSurvey::Kind::study);
  EXPECT_EQ(survey.planned_cells, plan.problems.size() * plan.optimizers.size() * 6);
  EXPECT_EQ(survey.finished_cells, survey.planned_cells - 1);
  EXPECT_EQ(std::ranges::count_if(survey.runs, &RunSurvey::is_damaged), 4);
  EXPECT_EQ(survey.damaged_files.size(), 3u);

  StopSignal stop;
  const auto repaired = repair_store(hurt, temporary_ / "copy", stop);
  ASSERT_TRUE(repaired);
  EXPECT_EQ(repaired->runs.size(), 4u);
  EXPECT_FALSE(survey_store(temporary_ / "copy").is_damaged());
  study(plan, "copy");
  auto cells = read_cells("copy");
  EXPECT_EQ(cells.erase("sphere/cmaes/r03.damaged/cell.json"), 1u);
  EXPECT_EQ(cells.erase("sphere/cmaes/r03.damaged/result.json"), 1u);
  EXPECT_TRUE(cells == read_cells("whole"));
  const auto whole = read_tree(temporary_ / "whole");
  auto copy = read_tree(temporary_ / "copy");
  for (const auto& [name, text] : whole) {
    if (name.starts_with("tables/") || name == "result.json" || name == "verdict.txt") {
      EXPECT_EQ(copy[name], text) << name;
    }
  }
}

TEST_F(StudyRepairTest, APlanThatWasChangedIsLost) {
  StudyRequest request = make_small_request();
  request.problems = {"sphere"};
  request.replicates = 6;
  const StudyPlan plan = make_study_plan(request);
  study(plan, "hurt");
  change(temporary_ / "hurt" / "study.toml", [](std::string& text) { text += "# more\n"; });
  const StoreSurvey survey = survey_store(temporary_ / "hurt");
  EXPECT_TRUE(survey.is_record_lost);
  StopSignal stop;
  EXPECT_THROW(repair_store(temporary_ / "hurt", temporary_ / "copy", stop), Error);
}

TEST_F(StoreRepairTest, OtherFoldersAreRefused) {
  std::filesystem::create_directories(temporary_ / "results/run");
  std::ofstream(temporary_ / "results/run/manifest.json") << "{}";
  try {
    survey_store(temporary_ / "results");
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    EXPECT_THAT(error.what(), HasSubstr("name one of those in it: run"));
  }
  EXPECT_THROW(survey_store(temporary_ / "nowhere"), Error);
  EXPECT_TRUE(survey_store(temporary_ / "results/run").is_record_lost);
  try {
    ASSERT_TRUE(run(make_small_plan(), "one"));
    damage_journal(temporary_ / "one");
    repair_store(temporary_ / "one", temporary_ / "one/copy", stop_);
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("lies in the folder itself"));
  }
}

TEST(MakeCommand, LeadsToTheCopy) {
  StoreSurvey survey;
  survey.runs.resize(1);
  survey.runs[0].command_line = {"old/armwright", "optimize", "q1",     "--new",
                                 "--out",         "a b",      "--seed", "2"};
  EXPECT_EQ(make_command(survey, "armwright", "c"),
            (std::vector<std::string>{"armwright", "optimize", "q1", "--seed", "2", "--out", "c"}));
  survey.runs[0].command_line = {"armwright", "optimize", "--out=x"};
  EXPECT_EQ(make_command(survey, "armwright", "c").size(), 4u);
  survey.runs[0].command_line = {};
  EXPECT_TRUE(make_command(survey, "armwright", "c").empty());
}

}  // namespace
}  // namespace armwright
