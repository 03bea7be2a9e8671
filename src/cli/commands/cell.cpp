// armwright cell: some cells of a study, on whatever machine this is. What a cluster's jobs call.

#include "study/compare/cell.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <ctime>
#include <thread>

#include "base/error.hpp"
#include "base/text.hpp"
#include "cli/terminal/arguments.hpp"
#include "cli/terminal/format.hpp"
#include "cli/terminal/progress_bar.hpp"
#include "cli/terminal/session.hpp"
#include "cli/terminal/signals.hpp"
#include "cli/terminal/terminal.hpp"
#include "study/matrix/attempt.hpp"
#include "study/matrix/cell_attempt.hpp"
#include "study/matrix/cell_selection.hpp"
#include "study/run/run_lock.hpp"

namespace armwright {
namespace {

constexpr const char* kCellExamples = R"(Examples:
  armwright cell results/q1 0-9                       # the first ten cells, one after the other
  armwright cell results/q1 q1-complex/ga/r03         # one, by its name, which stays right when the plan grows
  armwright cell results/q1 12 17 --jobs 4            # two, four threads each

What 'armwright compare --executor slurm' and 'script' call on a cluster; any number of these may run at once, on any
machines that see the folder. Cells that are done are skipped, others go on where they were. Whoever begins a cell last
has it: an earlier process at the same cell, forgotten by its batch system perhaps, notices and ends with exit code 5.
'armwright status' shows how far all are, 'armwright merge' makes tables and verdict of them. See docs/clusters.md.)";

struct CellOptions {
  std::string plan;
  std::vector<std::string> cells;
  JobsOption jobs;
  TimeLimitOption time_limit;
  bool quiet = false;
};

// A command that holds the study for a moment only, as merge does, is waited for.
void wait_for_study(const std::filesystem::path& folder, StopSignal& stop) {
  constexpr std::chrono::milliseconds kPause{100};
  constexpr int kTries = 30;
  for (int tries = 1; !stop.requested(); ++tries) {
    const std::string writer = find_writer(folder);
    if (writer.empty()) {
      return;
    }
    if (tries == kTries) {
      throw Error(ErrorKind::busy,
                  fmt::format("{} is in use by {}, which runs its cells itself; wait for it, or "
                              "stop it",
                              sanitize(folder.string()), writer));
    }
    std::this_thread::sleep_for(kPause);
  }
}

// Attempts that did not end in order.
std::size_t count_deaths(const std::filesystem::path& attempts) {
  std::size_t deaths = 0;
  for (const int token : list_tokens(attempts)) {
    deaths += read_attempt(attempts, token).silence_s ? 1 : 0;
  }
  return deaths;
}

class CellCommand {
 public:
  CellCommand(const CellOptions& options, Session& session)
      : options_(options),
        session_(session),
        study_(load_recorded_study(options.plan)),
        jobs_(options.jobs.get_or(1)) {}

  int run() {
    std::vector<Cell> cells = select_cells(study_.plan, options_.cells);
    catch_signals(session_.stop);
    wait_for_study(study_.folder, session_.stop);
    // What has taken processes with it comes last, so that it costs no others. After one death all
    // stay in order: a job that is begun again meets what is left of its earlier life at once.
    constexpr std::size_t kMostDeaths = 1;
    std::ranges::stable_partition(cells, [&](const Cell& cell) {
      return count_deaths(make_attempts_path(study_.plan, cell, study_.folder)) <= kMostDeaths;
    });
    for (const Cell& cell : cells) {
      if (session_.stop.requested()) {
        return end_stopped(session_, session_.command_line);
      }
      if (is_done(cell)) {
        continue;
      }
      const CellAttempt attempt = attempt_one(cell);
      if (attempt.end == CellAttempt::End::superseded) {
        write_message(make_cell_name(study_.plan, cell) + ": " + attempt.successor);
        return exit_code::kBusy;
      }
      if (attempt.end == CellAttempt::End::stopped) {
        return end_stopped(session_, session_.command_line);
      }
    }
    tell(fmt::format("{} done, {} before; {} failed", format_count(done_, "cell"), done_before_,
                     failed_));
    return failed_ > 0 ? exit_code::kFailed : exit_code::kDone;
  }

 private:
  bool is_done(const Cell& cell) {
    try {
      const bool done = load_cell(study_.plan, cell, study_.folder).has_value();
      done_before_ += done ? 1 : 0;
      return done;
    } catch (const Error& error) {
      note_broken(cell, error);
      return true;
    }
  }

  CellAttempt attempt_one(const Cell& cell) {
    const auto& description = study_.plan.problems[cell.problem].loaded.problem->description();
    ProgressBar bar(options_.quiet || !is_terminal(Stream::error),
                    get_scalar_quantity(description.objectives));
    const std::string name = make_cell_name(study_.plan, cell);
    tell(name);
    try {
      const CellAttempt attempt = attempt_cell(
          study_.plan, cell,
          {.study = study_.folder,
           .jobs = jobs_,
           .command_line = {session_.command_line.front(), "cell", options_.plan, name},
           .process_begun_s = begun_s_},
          session_.stop, bar);
      done_ += attempt.end == CellAttempt::End::done ? 1 : 0;
      failed_ += attempt.optimizer_failed ? 1 : 0;
      return attempt;
    } catch (const Error& error) {
      bar.clear();
      note_broken(cell, error);
      return {};
    }
  }

  // What fills one cell's disk fills all, and whoever holds a cell holds them all.
  void note_broken(const Cell& cell, const Error& error) {
    if (error.kind() == ErrorKind::io || error.kind() == ErrorKind::busy) {
      throw error;
    }
    write_message(fmt::format("{}: error: {}", make_cell_name(study_.plan, cell), error.what()));
    ++failed_;
  }

  void tell(const std::string& message) const {
    if (!options_.quiet) {
      write_message(message);
    }
  }

  const CellOptions& options_;
  Session& session_;
  const RecordedStudy study_;
  const unsigned jobs_;
  const std::int64_t begun_s_ = std::time(nullptr);
  int done_ = 0;
  int done_before_ = 0;
  int failed_ = 0;
};

}  // namespace

void add_cell(CLI::App& app, Session& session) {
  auto options = std::make_shared<CellOptions>();
  CLI::App* command =
      add_command(app, session, "cell",
                  "Run some cells of a comparison, as the jobs of a cluster do", kCellExamples);
  command->add_option("PLAN", options->plan, "The folder of a study, or its study.toml")
      ->required();
  command
      ->add_option("CELL", options->cells,
                   "Which: a number from 0, a range 3-9, or PROBLEM/OPTIMIZER/rNN")
      ->required();
  options->jobs.add_to(*command, "1");
  options->time_limit.add_to(*command);
  command->add_flag("--quiet,-q", options->quiet, "No progress")->group("Output");
  command->callback([options, &session] {
    session.action = [options, &session] {
      options->time_limit.apply(session.stop);
      return CellCommand(*options, session).run();
    };
  });
}

}  // namespace armwright
