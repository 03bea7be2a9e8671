#include "cli/views/study_end.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/text.hpp"
#include "cli/terminal/terminal.hpp"
#include "cli/views/study_view.hpp"
#include "study/analysis/final_check.hpp"
#include "study/analysis/study_tables.hpp"

namespace armwright {

int end_study(const StudyPlan& plan, const StudyEndRequest& request, Session& session,
              ProgressBar& bar) {
  StudyResult result = analyze_study(plan, request.folder);
  if (!add_final_checks(plan, request.folder, request.jobs, session.stop, bar, result)) {
    bar.clear();
    return end_stopped(session, session.command_line);
  }
  bar.clear();
  write_study_tables(plan, result, request.folder);
  if (request.json) {
    write_stdout(to_json(plan, result));
  } else {
    write_stdout(
        describe_study(plan, result, request.folder, make_style(Stream::out, session.color)));
  }
  const bool failed = std::ranges::any_of(
      result.cells, [](const CellOutcome& cell) { return !cell.failure.empty(); });
  return failed || !result.missing.empty() ? exit_code::kFailed : exit_code::kDone;
}

}  // namespace armwright
