// armwright compare: optimizers on the same footing, resumable and extendable.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <limits>
#include <utility>

#include "base/error.hpp"
#include "base/text.hpp"
#include "cli/commands/executor.hpp"
#include "cli/commands/team.hpp"
#include "cli/terminal/arguments.hpp"
#include "cli/terminal/progress_bar.hpp"
#include "cli/terminal/session.hpp"
#include "cli/terminal/signals.hpp"
#include "cli/terminal/terminal.hpp"
#include "cli/views/study_end.hpp"
#include "cli/views/study_view.hpp"
#include "problems/config/path_survey.hpp"
#include "study/compare/study_plan.hpp"
#include "study/compare/study_runner.hpp"
#include "study/matrix/cell_attempt.hpp"
#include "study/matrix/chunks.hpp"
#include "study/run/locked_observer.hpp"

namespace armwright {
namespace {

constexpr const char* kCompareExamples = R"(Examples:
  armwright compare --preset smoke                 # a small one, in seconds
  armwright compare configs/studies/q1.toml        # what the file says; resumes where it was
  armwright compare q1 --dry-run                   # a shipped study: plan, cost and expected time
  armwright compare --problems q1-complex,q2-e6 --optimizers ga,cmaes --replicates 20 --budget 5000 \
      --engine articulated
  armwright compare q1 --replicates 30             # more replicates: only what is new is run
  armwright compare q1 --executor slurm            # the same on a cluster (docs/clusters.md)

Terms: a case is one path of the moving target; a cell is one run, of an optimizer on a problem in a replicate.
Every optimizer gets the same budget of simulated training cases, and in replicate r the same training cases and the
same start as all others. Each run's winner is chosen on a validation set and judged on a test set that is the same
for all. Random search and a local search take part as baselines. The verdict follows from the statistics: see
docs/comparing.md. The folder (default: results/NAME, NAME as the study's file, or study-PROBLEMS) holds the plan
(study.toml), every run with its journal (cells/), tables, result.json and verdict.txt. The same command goes on where it
was; replicates, problems and optimizers can be added to it. What would not compare with what is there, another budget
say, is refused; --new begins another folder.)";

struct CompareOptions {
  std::string file;
  std::string preset;
  std::vector<std::string> problems;
  std::vector<std::string> optimizers;
  std::string replicates;
  std::string budget;
  std::string schedule;
  std::string seed;
  bool no_baselines = false;
  OverrideOptions overrides;
  JobsOption jobs;
  TimeLimitOption time_limit;
  FolderOptions folder;
  ExecutorOptions executor;
  bool dry_run = false;
  bool json = false;
  bool quiet = false;
};

StudyRequest make_request(const CompareOptions& options) {
  StudyRequest request;
  if (!options.file.empty() && !options.preset.empty()) {
    throw Error(ErrorKind::usage, "a study file and --preset are given; choose one of them");
  }
  request.file = options.preset.empty() ? options.file : options.preset;
  request.problems = options.problems;
  request.optimizers = options.optimizers;
  request.settings = options.overrides.get();
  if (!options.replicates.empty()) {
    request.replicates =
        static_cast<int>(parse_count("--replicates", options.replicates, 1, 10'000));
  }
  if (!options.budget.empty()) {
    request.budget = parse_count("--budget", options.budget, 1, 1'000'000'000'000);
  }
  if (!options.schedule.empty()) {
    request.schedule = parse_schedule(options.schedule);
  }
  if (!options.seed.empty()) {
    request.seed = static_cast<std::uint64_t>(
        parse_count("--seed", options.seed, 0, std::numeric_limits<std::int64_t>::max()));
  }
  request.baselines = !options.no_baselines;
  return request;
}

// How long one process takes for the whole plan.
double measure_duration_s(const StudyPlan& plan) {
  double total_s = 0;
  for (const double cell_s : measure_cell_durations_s(plan)) {
    total_s += cell_s * static_cast<double>(plan.optimizers.size()) * plan.replicates;
  }
  return total_s;
}

void announce(const CompareOptions& options, const StudyPlan& plan, unsigned jobs,
              const std::filesystem::path& folder) {
  std::string text = fmt::format("{}: {}\n", plan.name, plan.title) + describe_plan(plan) +
                     describe_cost(plan, measure_duration_s(plan) / jobs, jobs) +
                     fmt::format("plan {}", calc_plan_hash(plan).substr(0, 16));
  if (is_study_folder(folder)) {
    const auto cells = list_cells(plan);
    const auto there = std::ranges::count_if(
        cells, [&](const Cell& cell) { return load_cell(plan, cell, folder).has_value(); });
    text += fmt::format("\n{} of {} cells are there already", there, cells.size());
  }
  if (!options.dry_run) {
    text +=
        fmt::format("\nfolder {} ({})", folder.string(), is_study_folder(folder) ? "found" : "new");
  }
  for (const std::string& line : split(text, '\n')) {
    write_message(line);
  }
}

int run_compare(const CompareOptions& options, Session& session) {
  if (options.file.empty() && options.preset.empty() && options.problems.empty()) {
    throw Error(ErrorKind::usage,
                "compare what? Give a study file, --preset NAME, or --problems "
                "and --optimizers. See 'armwright compare --help'");
  }
  const bool is_elsewhere = options.executor.is_elsewhere();
  if (is_elsewhere && (options.json || !options.time_limit.text.empty())) {
    throw Error(ErrorKind::usage,
                "--json and --time-limit are not for --executor slurm and script; give --json to "
                "'armwright merge', and a job's time to the batch system");
  }
  Team team(session);
  const unsigned jobs = is_elsewhere ? options.jobs.get_or(1) : options.jobs.get();
  StudyPlan plan;
  if (team.is_worker()) {
    team.serve(
        [&] {
          plan = make_study_plan(make_request(options));
          adopt_recorded(options.folder.choose(escape_name(plan.name)), plan);
          return list_problems(plan);
        },
        jobs);
  }
  options.time_limit.apply(session.stop);
  plan = make_study_plan(make_request(options));
  const auto path = options.folder.choose(escape_name(plan.name));
  adopt_recorded(path, plan);
  std::vector<std::string> notes;
  for (const LoadedProblem* problem : list_problems(plan)) {
    for (const std::string& note : check_paths(*problem)) {
      notes.push_back(fmt::format("{}: {}", problem->name, note));
    }
  }
  if (!options.quiet || options.dry_run) {
    announce(options, plan, jobs, path);
    std::ranges::for_each(notes, write_message);
  }
  if (is_elsewhere) {
    return hand_over(options.executor, plan,
                     {.folder = path, .jobs = jobs, .dry_run = options.dry_run}, session);
  }
  if (options.dry_run) {
    write_stdout(to_toml(plan));
    return exit_code::kDone;
  }
  const StudyFolder folder(path, plan);
  for (const std::string& addition : folder.additions()) {
    write_message("new in the plan: " + addition);
  }
  catch_signals(session.stop);
  ProgressBar bar(options.quiet, {});
  LockedObserver observer(bar);
  adopt_attempts(plan, path, observer);
  auto coordinator = team.lead(list_problems(plan), jobs, observer);
  const CellsResult cells = run_cells(plan, path, jobs, session.stop, observer, coordinator.get());
  team.dismiss(std::move(coordinator));
  if (cells.stopped) {
    bar.clear();
    return end_stopped(session, session.command_line);
  }
  return end_study(plan, {.folder = path, .jobs = jobs, .json = options.json}, session, bar);
}

}  // namespace

void add_compare(CLI::App& app, Session& session) {
  auto options = std::make_shared<CompareOptions>();
  CLI::App* command =
      add_command(app, session, "compare",
                  "Settle which optimizer to use: runs on the same footing, statistics, a verdict",
                  kCompareExamples);
  command->add_option("STUDY", options->file,
                      "A study file, or the name of a shipped one (armwright list studies)");
  command->add_option("--preset", options->preset, "A shipped study by its name: smoke, q1, ...")
      ->type_name("NAME");
  command
      ->add_option("--problems,-p", options->problems,
                   "Problems to compare on, instead of the file's")
      ->type_name("A,B,...")
      ->delimiter(',')
      ->allow_extra_args(false);
  command
      ->add_option("--optimizers,-o", options->optimizers,
                   "Optimizers to compare, instead of the file's")
      ->type_name("A,B,...")
      ->delimiter(',')
      ->allow_extra_args(false);
  command
      ->add_option("--replicates", options->replicates,
                   "Runs of every optimizer on every problem (default: 15)")
      ->type_name("N");
  command
      ->add_option("--budget", options->budget,
                   "Training cases to simulate in every run, the same for all (default: the\n"
                   "file's; required without one)")
      ->type_name("CASES");
  command
      ->add_option("--schedule", options->schedule,
                   "Which training cases: fixed:K; fresh:K or coevolution:K where all\n"
                   "optimizers have generations (default: fixed, K as the problem has it)")
      ->type_name("KIND:K");
  command
      ->add_option("--seed", options->seed,
                   "Of the study: draws starts, training cases and the optimizers'\n"
                   "streams (default: 1)")
      ->type_name("N");
  command->add_flag("--no-baselines", options->no_baselines,
                    "Leave out random search and the local search that always take part; the\n"
                    "verdict says so");
  options->overrides.add_to(*command, true);
  options->jobs.add_to(*command);
  options->time_limit.add_to(*command);
  options->executor.add_to(*command);
  command->add_flag("--dry-run", options->dry_run,
                    "Print the resolved plan and what it costs, or with another executor its\n"
                    "chunks and how they are submitted, and run nothing");
  options->folder.add_to(*command, "study", "results/NAME");
  command->add_flag("--json", options->json, "Print the result as JSON")->group("Output");
  command->add_flag("--quiet,-q", options->quiet, "No plan and no progress")->group("Output");
  command->callback([options, &session] {
    session.shares_work = true;
    session.action = [options, &session] { return run_compare(*options, session); };
  });
}

}  // namespace armwright
