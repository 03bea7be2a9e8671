// Helpers for tests of cells that run on any machine: a small study in a folder, without any cell
// that has run.
#pragma once

#include <gmock/gmock.h>

#include <ctime>
#include <string>

#include "base/expect_error.hpp"
#include "study/compare/cell.hpp"
#include "study/compare/study_support.hpp"
#include "study/matrix/attempt.hpp"
#include "study/matrix/cell_attempt.hpp"
#include "study/matrix/cell_selection.hpp"

namespace armwright {

class MatrixTest : public StudyTest {
 protected:
  MatrixTest() {
    StudyRequest request = make_small_request();
    request.replicates = 2;
    request.budget = 60;
    request.optimizers = {"ga", "random"};
    request.baselines = false;
    plan_ = make_study_plan(request);
    const StudyFolder made(study_, plan_);
  }

  Cell cell(const std::string& name) const {
    return select_cells(plan_, std::vector<std::string>{name}).front();
  }
  CellAttempt attempt(const Cell& one, StopSignal& stop) {
    return attempt_cell(plan_, one, {.study = study_, .command_line = {}}, stop, observer_);
  }
  CellAttempt attempt(const Cell& one) {
    StopSignal stop;
    return attempt(one, stop);
  }
  // Runs a cell to its end in the given folder.
  void run_in(const Cell& one, const std::filesystem::path& folder) {
    StopSignal stop;
    run_cell(plan_, one, CellRequest{.folder = folder}, stop, observer_);
  }
  std::filesystem::path attempts(const Cell& one) const {
    return make_attempts_path(plan_, one, study_);
  }
  std::filesystem::path place(const Cell& one) const { return study_ / make_cell_path(plan_, one); }

  const std::filesystem::path study_ = temporary_ / "study";
  StudyPlan plan_;
};

}  // namespace armwright
