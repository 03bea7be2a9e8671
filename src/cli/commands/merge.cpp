// armwright merge: makes the tables and the verdict of cells that were run on other machines.

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "base/error.hpp"
#include "base/text.hpp"
#include "cli/commands/commands.hpp"
#include "cli/terminal/arguments.hpp"
#include "cli/terminal/format.hpp"
#include "cli/terminal/session.hpp"
#include "cli/terminal/terminal.hpp"
#include "cli/views/study_view.hpp"
#include "study/compare/cell.hpp"
#include "study/compare/study_folder.hpp"
#include "study/matrix/cell_selection.hpp"
#include "study/matrix/study_merge.hpp"

namespace armwright {
namespace {

constexpr const char* kMergeExamples = R"(Examples:
  armwright merge results/q1                          # after all jobs have ended: writes statistics, tables, verdict
  armwright merge results/q1 /mnt/a/q1 /mnt/b/q1      # first copies cells from machines without a shared folder
  armwright merge results/q1 --json

The tables are the same, byte for byte, as if all cells had run on this machine. The command lists the cells that have not
ended. It counts them as runs without a result and ends with exit code 3. Run these cells and merge again. The command
copies only cells of the same plan. If two folders hold different results of one cell, it copies nothing. See
docs/clusters.md.)";

struct MergeOptions {
  std::string study;
  std::vector<std::string> others;
  std::string jobs;
  std::string time_limit;
  bool json = false;
  bool quiet = false;
};

// Prints the first few cells that have not ended and the command that runs them. Throws
// Error{usage} if no cell has ended.
void tell_missing(const RecordedStudy& study, const std::string& program) {
  constexpr std::size_t kMostShown = 10;
  std::vector<std::string> names;
  std::size_t count = 0;
  for (const Cell& cell : list_cells(study.plan)) {
    if (!load_cell(study.plan, cell, study.folder)) {
      ++count;
      if (names.size() < kMostShown) {
        names.push_back(make_cell_name(study.plan, cell));
      }
    }
  }
  if (count == 0) {
    return;
  }
  const std::string more =
      count > names.size() ? fmt::format(" and {} more", count - names.size()) : "";
  write_message(fmt::format("{} of {} cells have not ended: {}{}. To run them on this machine:\n{}",
                            count, list_cells(study.plan).size(), join(names, ", "), more,
                            sanitize(quote_command(std::vector<std::string>{
                                program, "compare", (study.folder / "study.toml").string(), "--out",
                                study.folder.string()}))));
  if (count == list_cells(study.plan).size()) {
    throw Error(ErrorKind::usage,
                fmt::format("{}: no cell has ended, so there is nothing to merge; run the cells, "
                            "and merge again",
                            sanitize(study.folder.string())));
  }
}

int run_merge(const MergeOptions& options, Session& session) {
  const unsigned jobs = parse_jobs(options.jobs);
  apply_time_limit(options.time_limit, session.stop);
  const RecordedStudy study = load_recorded_study(options.study);
  const StudyFolder folder(study.folder, study.plan);
  catch_signals(session.stop);
  ProgressBar bar(options.quiet, {});
  const std::vector<std::filesystem::path> others(options.others.begin(), options.others.end());
  const std::size_t copied = import_cells(study.plan, study.folder, others, session.stop);
  if (!others.empty() && !options.quiet) {
    write_message(format_count(copied, "cell") + " copied");
  }
  if (session.stop.requested()) {
    return end_stopped(session, session.command_line);
  }
  tell_missing(study, session.command_line.front());
  remove_spent_attempts(study.plan, study.folder);
  return end_study(study.plan, study.folder, jobs, options.json, session, bar);
}

}  // namespace

void add_merge(CLI::App& app, Session& session) {
  auto options = std::make_shared<MergeOptions>();
  CLI::App* command = add_command(
      app, session, "merge",
      "Make the tables and the verdict of a study whose cells were run elsewhere", kMergeExamples);
  command->add_option("STUDY", options->study, "The folder of a study, or its study.toml")
      ->required();
  command->add_option("OTHER", options->others,
                      "Folders of the same study from other machines, to copy cells from");
  add_jobs_flag(*command, options->jobs);
  add_time_limit_flag(*command, options->time_limit);
  command->add_flag("--json", options->json, "Print the result as JSON")->group("Output");
  command->add_flag("--quiet,-q", options->quiet, "Show no progress")->group("Output");
  command->callback([options, &session] {
    session.action = [options, &session] { return run_merge(*options, session); };
  });
}

}  // namespace armwright
