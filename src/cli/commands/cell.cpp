// armwright cell: runs some cells of a study. The jobs of a cluster call it.

#include "study/compare/cell.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <ctime>
#include <thread>

#include "base/error.hpp"
#include "base/text.hpp"
#include "cli/commands/commands.hpp"
#include "cli/terminal/arguments.hpp"
#include "cli/terminal/format.hpp"
#include "cli/terminal/progress_bar.hpp"
#include "cli/terminal/session.hpp"
#include "cli/terminal/terminal.hpp"
#include "study/matrix/attempt.hpp"
#include "study/matrix/cell_attempt.hpp"
#include "study/matrix/cell_selection.hpp"
#include "study/run/run_lock.hpp"

namespace armwright {
namespace {

constexpr const char* kCellExamples = R"(Examples:
  armwright cell results/q1 0-9                       # the first ten cells, one after the other
  armwright cell results/q1 q1-complex/ga/r03         # one cell by its name, which stays valid when the study grows
  armwright cell results/q1 12 17 --jobs 4            # two cells, each with four threads

A cell is one run of a study: a method on a problem in a replicate. 'armwright compare --executor slurm' and 'script'
call this command on a cluster. Any number of such processes may run at once, on all machines that see the folder. Cells
that have ended are skipped; others are resumed. If two processes run the same cell, the later one keeps it; the earlier
one notices this and ends with exit code 5. 'armwright status' shows the state of all cells, and 'armwright merge' makes
the tables and the verdict. See docs/clusters.md.)";

struct CellOptions {
  std::string plan;
  std::vector<std::string> cells;
  std::string jobs;
  std::string time_limit;
  bool trust = false;
  bool quiet = false;
};

// Waits up to 3 s for a command that holds the study only briefly, as merge does. Throws
// Error{busy} after that.
void wait_for_study(const std::filesystem::path& folder, StopSignal& stop) {
  constexpr std::chrono::milliseconds kPause{100};
  constexpr int kTries = 30;
  for (int tries = 1; !stop.requested(); ++tries) {
    const std::string writer = find_writer(folder);
    if (writer.empty()) {
      return;
    }
    if (tries == kTries) {
      throw Error(
          ErrorKind::busy,
          fmt::format("{} is in use by {}, which runs its cells itself; wait until it ends, "
                      "or stop it",
                      sanitize(folder.string()), writer));
    }
    std::this_thread::sleep_for(kPause);
  }
}

// Returns the number of attempts whose process died.
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
        study_(load_recorded_study(options.plan, make_asker(options.trust))),
        jobs_(parse_jobs_or_one(options.jobs)) {}

  int run() {
    std::vector<Cell> cells = select_cells(study_.plan, options_.cells);
    catch_signals(session_.stop);
    wait_for_study(study_.folder, session_.stop);
    // Cells whose processes died more than once come last, so that they do not delay the others.
    // One death changes nothing: a restarted job shall first resume the cell that it left.
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

  // A full disk or a locked folder would stop every other cell, too, so these errors end the
  // command.
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
      add_command(app, session, "cell", "Run some cells of a study, as the jobs of a cluster do",
                  kCellExamples);
  command->add_option("PLAN", options->plan, "The folder of a study, or its study.toml")
      ->required();
  command
      ->add_option("CELL", options->cells,
                   "The cells: a number from 0, a range 3-9, or PROBLEM/OPTIMIZER/rNN")
      ->required();
  add_jobs_flag(*command, options->jobs, "1");
  add_time_limit_flag(*command, options->time_limit);
  add_trust_flag(*command, options->trust);
  command->add_flag("--quiet,-q", options->quiet, "Show no progress")->group("Output");
  command->callback([options, &session] {
    session.action = [options, &session] {
      apply_time_limit(options->time_limit, session.stop);
      return CellCommand(*options, session).run();
    };
  });
}

}  // namespace armwright
