// Helpers for tests of comparisons: small studies on functions, in a temporary folder.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "base/file.hpp"
#include "base/temporary_folder.hpp"
#include "study/analysis/study_tables.hpp"
#include "study/compare/study_folder.hpp"
#include "study/compare/study_runner.hpp"
#include "study/run_support.hpp"

namespace armwright {

inline StudyRequest make_small_request() {
  StudyRequest request;
  request.problems = {"sphere", "rosenbrock"};
  request.optimizers = {"ga", "cmaes"};
  request.settings = {"function.dimension=3"};
  request.replicates = 6;
  request.budget = 120;
  return request;
}

// Loads the plan with this text, which is stored as mine.toml.
inline StudyPlan load_plan(const TemporaryFolder& folder, const std::string& toml) {
  const auto file = folder / "mine.toml";
  std::ofstream(file) << toml;
  StudyRequest request;
  request.file = file.string();
  return make_study_plan(request);
}

// Returns the content of all files below a folder, by relative path.
inline std::map<std::string, std::string> read_tree(const std::filesystem::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) {
      files[std::filesystem::relative(entry.path(), folder).string()] =
          read_file(entry.path(), std::size_t{1} << 26);
    }
  }
  return files;
}

class StudyTest : public testing::Test {
 protected:
  // Returns how many cells did not end.
  std::optional<std::size_t> run_all(const StudyPlan& plan, const std::string& name,
                                     unsigned jobs) {
    const auto path = temporary_ / name;
    StudyFolder folder(path, plan);
    StopSignal stop;
    return run_cells(plan, path, jobs, stop, observer_);
  }
  // Runs and analyzes the plan, and writes the tables.
  StudyResult study(const StudyPlan& plan, const std::string& name, unsigned jobs = 2) {
    EXPECT_EQ(run_all(plan, name, jobs), 0U);
    StudyResult result = analyze_study(plan, temporary_ / name);
    write_study_tables(plan, result, temporary_ / name);
    return result;
  }
  std::map<std::string, std::string> read_cells(const std::string& name) {
    std::map<std::string, std::string> cells;
    for (const auto& [path, text] : read_tree(temporary_ / name / "cells")) {
      if (path.ends_with("cell.json") || path.ends_with("result.json")) {
        cells[path] = text;
      }
    }
    return cells;
  }
  TemporaryFolder temporary_;
  SilentObserver observer_;
};

}  // namespace armwright
