// How every command ends that has a study's cells: statistics, tables and verdict, or a word on how
// to go on.
#pragma once

#include <filesystem>

#include "cli/progress_bar.hpp"
#include "cli/session.hpp"
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

// Of a command that was stopped and can be gone on with. The exit code.
int end_stopped(Session& session, ProgressBar& bar);

}  // namespace armwright
