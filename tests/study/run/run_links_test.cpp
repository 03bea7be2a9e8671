// Tests that a run overwrites nothing through links that somebody has put into its folder.
#include <gmock/gmock.h>

#include <atomic>
#include <filesystem>
#include <thread>

#include "base/expect_error.hpp"
#include "base/file.hpp"
#include "study/run/run.hpp"
#include "study/run_support.hpp"

namespace armwright {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::StartsWith;

class RunLinks : public RunTest {
 protected:
  RunLinks() { write_file_atomically(victim_, "precious"); }
  void expect_unharmed() const { EXPECT_EQ(read_file(victim_, 100), "precious"); }
  // Begins a run and stops it at once.
  void begin(const std::string& folder) {
    StopSignal stop;
    stop.request(StopReason::interrupted);
    ASSERT_FALSE(execute_run({make_small_plan(), temporary_ / folder, 2, {}}, stop, observer_));
  }
  const fs::path victim_ = temporary_ / "victim";
};

TEST_F(RunLinks, PlantedForNewFilesAreReplaced) {
  run(make_small_plan(), "plain");
  begin("a");
  for (const char* name : {"result.json", "winner.toml", "winner-trajectory.csv", "convergence.csv",
                           "results.sqlite"}) {
    fs::create_symlink(victim_, temporary_ / "a" / (std::string(name) + ".new"));
  }
  fs::remove(temporary_ / "a/manifest.json");
  fs::remove(temporary_ / "a/journal");
  for (const auto& entry : fs::directory_iterator(temporary_ / "a")) {
    if (!entry.is_symlink() && entry.path().filename() != "lock") {
      fs::remove(entry.path());
    }
  }
  // A run's folder may hold nothing else without a manifest, so the manifest is written first.
  fs::create_directory(temporary_ / "b");
  fs::create_symlink(victim_, temporary_ / "b/manifest.json.new");
  ASSERT_TRUE(run(make_small_plan(), "b"));
  fs::copy_file(temporary_ / "b/manifest.json", temporary_ / "a/manifest.json");
  ASSERT_TRUE(run(make_small_plan(), "a"));
  for (const auto& entry : fs::directory_iterator(temporary_ / "a")) {
    EXPECT_FALSE(entry.is_symlink()) << entry.path();
    EXPECT_NE(entry.path().extension(), ".new") << entry.path();
  }
  EXPECT_EQ(read_result("a"), read_result("plain"));
  EXPECT_EQ(read_result("b"), read_result("plain"));
  EXPECT_EQ(read_file(temporary_ / "a/results.sqlite", 1 << 24),
            read_file(temporary_ / "plain/results.sqlite", 1 << 24));
  expect_unharmed();
}

TEST_F(RunLinks, InPlaceOfFilesThatAreKeptAreRefusedByName) {
  for (const char* name : {"lock", "journal"}) {
    for (const bool is_hard : {false, true}) {
      const std::string folder = std::string(name) + (is_hard ? "-hard" : "-symbolic");
      begin(folder);
      const auto file = temporary_ / folder / name;
      fs::remove(file);
      is_hard ? fs::create_hard_link(victim_, file) : fs::create_symlink(victim_, file);
      EXPECT_THAT(error_of(ErrorKind::bad_data, [&] { run(make_small_plan(), folder); }),
                  StartsWith(file.string() +
                             (is_hard ? ": has 2 names (hard links)" : ": is a symbolic link")));
      expect_unharmed();
      fs::remove(file);
    }
  }
}

TEST_F(RunLinks, OnTheWayFromTheStudyToTheRunAreRefused) {
  const auto study = temporary_ / "study";
  fs::create_directory(temporary_ / "elsewhere");
  fs::create_directory(study);
  fs::create_directory_symlink(temporary_ / "elsewhere", study / "cells");
  StopSignal stop;
  RunRequest request{make_small_plan(), study / "cells/p/ga/r01", 2, {}};
  request.root = study;
  EXPECT_THAT(error_of(ErrorKind::bad_data, [&] { execute_run(request, stop, observer_); }),
              StartsWith((study / "cells").string() + ": is a symbolic link"));
  EXPECT_TRUE(fs::is_empty(temporary_ / "elsewhere"));
  // The user's own links to the study are followed.
  fs::remove(study / "cells");
  fs::create_directory_symlink(study, temporary_ / "link");
  request.root = temporary_ / "link";
  request.folder = request.root / "cells/p/ga/r01";
  EXPECT_TRUE(execute_run(request, stop, observer_));
  EXPECT_TRUE(fs::exists(study / "cells/p/ga/r01/results.sqlite"));
}

// Another thread plants links while the run writes. The run ends well or names a file in its
// folder. The folder has its manifest before: without one, a link makes it a folder of something
// else, which every run refuses.
TEST_F(RunLinks, PlantedDuringTheRunAreNotFollowed) {
  begin("a");
  std::atomic<bool> ends = false;
  std::thread planter([&] {
    while (!ends) {
      for (const char* name : {"result.json", "winner.toml", "winner-trajectory.csv",
                               "convergence.csv", "results.sqlite"}) {
        std::error_code ignored;
        const auto file = temporary_ / "a" / (std::string(name) + ".new");
        fs::remove(file, ignored);
        fs::create_symlink(victim_, file, ignored);
      }
    }
  });
  constexpr int kRuns = 10;
  for (int i = 0; i < kRuns; ++i) {
    try {
      begin("a");
      run(make_small_plan(), "a");
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), StartsWith((temporary_ / "a").string()));
    }
    fs::remove(temporary_ / "a/result.json");
  }
  ends = true;
  planter.join();
  expect_unharmed();
  EXPECT_TRUE(run(make_small_plan(), "a"));
}

}  // namespace
}  // namespace armwright
