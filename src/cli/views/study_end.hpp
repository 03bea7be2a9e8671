// How every command ends that has all of a study's cells: statistics, tables and verdict.
#pragma once

#include <filesystem>

#include "cli/terminal/progress_bar.hpp"
#include "cli/terminal/session.hpp"
#include "study/compare/study_plan.hpp"

namespace armwright {

struct StudyEndRequest {
  std::filesystem::path folder;
  unsigned jobs = 1;  // for the final checks
  bool json = false;
};

// Of what cells there are; the folder's lock is the caller's. The exit code.
int end_study(const StudyPlan& plan, const StudyEndRequest& request, Session& session,
              ProgressBar& bar);

}  // namespace armwright
