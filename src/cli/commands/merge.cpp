// armwright merge: tables and verdict of cells that were run anywhere.

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "base/error.hpp"
#include "base/text.hpp"
#include "cli/terminal/arguments.hpp"
#include "cli/terminal/format.hpp"
#include "cli/terminal/session.hpp"
#include "cli/terminal/signals.hpp"
#include "cli/terminal/terminal.hpp"
#include "cli/views/study_end.hpp"
#include "study/compare/cell.hpp"
#include "study/compare/study_folder.hpp"
#include "study/matrix/cell_selection.hpp"
#include "study/matrix/study_merge.hpp"

namespace armwright {
namespace {

constexpr const char* kMergeExamples = R"(Examples:
  armwright merge results/q1                          # when all jobs have ended: statistics, tables, verdict
  armwright merge results/q1 /mnt/a/q1 /mnt/b/q1      # cells of machines that share no folder are copied in first
  armwright merge results/q1 --json

The same tables, byte for byte, as of a comparison that ran here alone. Cells that have not ended are named and count as
if they had found nothing (exit code 3); run them, and merge again. Only cells of the same plan are copied; where two
folders hold different results of one cell, nothing is. See docs/clusters.md.)";

struct MergeOptions {
  std::string study;
  std::vector<std::string> others;
  JobsOption jobs;
  TimeLimitOption time_limit;
  bool json = false;
  bool quiet = false;
};

// The first few by name, and the command that runs them.
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
  write_message(fmt::format("{} of {} cells have not ended: {}{}. To run them here:\n{}", count,
                            list_cells(study.plan).size(), join(names, ", "), more,
                            sanitize(quote_command(std::vector<std::string>{
                                program, "compare", (study.folder / "study.toml").string(), "--out",
                                study.folder.string()}))));
  if (count == list_cells(study.plan).size()) {
    throw Error(ErrorKind::usage, fmt::format("{}: no cell has ended, so there is nothing to merge",
                                              sanitize(study.folder.string())));
  }
}

int run_merge(const MergeOptions& options, Session& session) {
  const unsigned jobs = options.jobs.get();
  options.time_limit.apply(session.stop);
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
  return end_study(study.plan, {.folder = study.folder, .jobs = jobs, .json = options.json},
                   session, bar);
}

}  // namespace

void add_merge(CLI::App& app, Session& session) {
  auto options = std::make_shared<MergeOptions>();
  CLI::App* command = add_command(
      app, session, "merge", "Tables and verdict of a comparison whose cells were run elsewhere",
      kMergeExamples);
  command->add_option("STUDY", options->study, "The folder of a study, or its study.toml")
      ->required();
  command->add_option("OTHER", options->others,
                      "Folders of the same study on other machines, to copy cells from");
  options->jobs.add_to(*command);
  options->time_limit.add_to(*command);
  command->add_flag("--json", options->json, "Print the result as JSON")->group("Output");
  command->add_flag("--quiet,-q", options->quiet, "No progress")->group("Output");
  command->callback([options, &session] {
    session.action = [options, &session] { return run_merge(*options, session); };
  });
}

}  // namespace armwright
