// armwright compare: a study of optimizers under equal conditions. It can be resumed and extended.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <limits>
#include <utility>

#include "base/error.hpp"
#include "base/text.hpp"
#include "cli/commands/commands.hpp"
#include "cli/commands/executor_options.hpp"
#include "cli/commands/mpi_job.hpp"
#include "cli/terminal/arguments.hpp"
#include "cli/terminal/progress_bar.hpp"
#include "cli/terminal/session.hpp"
#include "cli/terminal/terminal.hpp"
#include "cli/views/study_view.hpp"
#include "problems/config/path_survey.hpp"
#include "study/compare/plugin_consent.hpp"
#include "study/compare/study_plan.hpp"
#include "study/compare/study_runner.hpp"
#include "study/matrix/cell_attempt.hpp"
#include "study/matrix/chunks.hpp"
#include "study/run/run_observer.hpp"

namespace armwright {
namespace {

constexpr const char* kCompareExamples = R"(Examples:
  armwright compare --preset smoke                 # a small study that takes seconds
  armwright compare configs/studies/q1.toml        # the study in this file; resumes if interrupted
  armwright compare q1 --dry-run                   # plan, cost and expected time of a shipped study
  armwright compare --problems q1-complex,q2-e6 --optimizers ga,cmaes --replicates 20 --budget 5000
  armwright compare q1 --replicates 30             # more replicates; only the new cells are run
  armwright compare q1 --executor slurm            # the same on a cluster (docs/clusters.md)

Terms: a case is one path of the moving target. A cell is one run: an optimizer on a problem in a replicate.
Every optimizer gets the same budget of simulated training cases. In replicate r all optimizers have the same training
cases and the same start. The winner of each run is chosen on a validation set and judged on a test set, which is the
same for all. The start, random search and a local search take part as baselines. The verdict follows from the
statistics: see docs/comparing.md. The folder (default: results/NAME, with the NAME of the study's file, or study-PROBLEMS) holds the
plan (study.toml), every run with its journal (cells/), tables, result.json and verdict.txt. The same command resumes
the study; replicates, problems and optimizers can be added to it. A change that would make the cells incomparable, for
example another budget, is refused; --new begins another folder.)";

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
  std::string jobs;
  std::string time_limit;
  FolderOptions folder;
  ExecutorOptions executor;
  bool trust = false;
  bool dry_run = false;
  bool json = false;
  bool quiet = false;
};

StudyRequest make_request(const CompareOptions& options, PluginUse plugins) {
  StudyRequest request;
  request.plugins = plugins;
  request.ask = make_asker(options.trust);
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
    request.schedule = read_study_schedule(options.schedule);
    if (!request.schedule) {
      throw Error(ErrorKind::usage,
                  fmt::format("--schedule is '{}'; it must be {}", sanitize(options.schedule),
                              describe_study_schedules()));
    }
  }
  if (!options.seed.empty()) {
    request.seed = static_cast<std::uint64_t>(
        parse_count("--seed", options.seed, 0, std::numeric_limits<std::int64_t>::max()));
  }
  request.baselines = !options.no_baselines;
  return request;
}

// Returns the expected time of one process for the whole plan.
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
                     describe_power(plan) +
                     describe_cost(plan, measure_duration_s(plan) / jobs, jobs) +
                     fmt::format("plan {}", calc_plan_hash(plan).substr(0, 16));
  if (is_study_folder(folder)) {
    const auto cells = list_cells(plan);
    const auto there = std::ranges::count_if(
        cells, [&](const Cell& cell) { return load_cell(plan, cell, folder).has_value(); });
    text += fmt::format("\n{} of {} cells have ended already", there, cells.size());
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
                "no study is named; give a study file, --preset NAME, or --problems "
                "and --optimizers. See 'armwright compare --help'");
  }
  const bool is_elsewhere = options.executor.is_elsewhere();
  if (is_elsewhere && (options.json || !options.time_limit.empty())) {
    throw Error(ErrorKind::usage,
                "--json and --time-limit cannot be used with --executor slurm or script; give "
                "--json to 'armwright merge', and set the time of a job in the batch system");
  }
  MpiJob job(session);
  const unsigned jobs = is_elsewhere ? parse_jobs_or_one(options.jobs) : parse_jobs(options.jobs);
  StudyPlan plan;
  if (job.is_worker()) {
    job.serve(
        [&] {
          // Only rank 0 runs plugins, once the user has agreed.
          StudyRequest request = make_request(options, PluginUse::read);
          request.is_rank = true;
          plan = make_study_plan(request);
          adopt_recorded(options.folder.choose(escape_name(plan.name)), plan);
          return list_problems(plan);
        },
        jobs);
  }
  apply_time_limit(options.time_limit, session.stop);
  plan =
      make_study_plan(make_request(options, options.dry_run ? PluginUse::preview : PluginUse::run));
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
    return hand_over_cells(options.executor, plan, path, jobs, options.dry_run, session);
  }
  if (options.dry_run) {
    write_stdout(to_toml(plan));
    return exit_code::kDone;
  }
  const StudyFolder folder(path, plan);
  remember_study(path, plan.problems);
  for (const std::string& addition : folder.additions()) {
    write_message("new in the plan: " + addition);
  }
  catch_signals(session.stop);
  ProgressBar bar(options.quiet, {});
  LockedObserver observer(bar);
  adopt_attempts(plan, path, observer);
  auto coordinator = job.make_coordinator(list_problems(plan), jobs, observer);
  const auto broken = run_cells(plan, path, jobs, session.stop, observer, coordinator.get());
  job.end_workers(std::move(coordinator));
  if (!broken) {
    bar.clear();
    return end_stopped(session, session.command_line);
  }
  return end_study(plan, path, jobs, options.json, session, bar);
}

}  // namespace

void add_compare(CLI::App& app, Session& session) {
  auto options = std::make_shared<CompareOptions>();
  CLI::App* command = add_command(
      app, session, "compare",
      "Compare optimizers in a study: runs under equal conditions, statistics, a verdict",
      kCompareExamples);
  command->add_option("STUDY", options->file,
                      "A study file, or the name of a shipped study (armwright list studies)");
  command->add_option("--preset", options->preset, "A shipped study by its name: smoke, q1, ...")
      ->type_name("NAME");
  command
      ->add_option("--problems,-p", options->problems,
                   "Problems of the study, instead of those in the file")
      ->type_name("A,B,...")
      ->delimiter(',')
      ->allow_extra_args(false);
  command
      ->add_option("--optimizers,-o", options->optimizers,
                   "Optimizers to compare, instead of those in the file")
      ->type_name("A,B,...")
      ->delimiter(',')
      ->allow_extra_args(false);
  command
      ->add_option("--replicates", options->replicates,
                   "Runs of each optimizer on each problem (default: 15)")
      ->type_name("N");
  command
      ->add_option("--budget", options->budget,
                   "Training cases to simulate in each run, the same for all, as 5000, 1e5 or\n"
                   "20k (default: that of the file; required without a file)")
      ->type_name("CASES");
  command
      ->add_option("--schedule", options->schedule,
                   "Schedule of the training cases: fixed:K, or, if all optimizers have\n"
                   "generations, fresh:K, coevolution:K or growing:K:FACTOR, or own: fresh:1 for\n"
                   "optimizers with generations, fixed:5 for the others (default: fixed, K of\n"
                   "the problem)")
      ->type_name("KIND:K");
  command
      ->add_option("--seed", options->seed,
                   "Seed of the study, for starts, training cases and the optimizers' random\n"
                   "numbers (default: 1)")
      ->type_name("N");
  command->add_flag("--no-baselines", options->no_baselines,
                    "Leave out the baselines: the start, random search and a local search; the\n"
                    "verdict mentions this");
  options->overrides.add_to(*command, true);
  add_jobs_flag(*command, options->jobs);
  add_time_limit_flag(*command, options->time_limit);
  options->executor.add_to(*command);
  add_trust_flag(*command, options->trust);
  command->add_flag("--dry-run", options->dry_run,
                    "Run nothing; print the plan and its cost. With --executor slurm or script,\n"
                    "print the chunks and the command that submits them");
  options->folder.add_to(*command, "study", "results/NAME");
  command->add_flag("--json", options->json, "Print the result as JSON")->group("Output");
  command->add_flag("--quiet,-q", options->quiet, "Show no plan and no progress")->group("Output");
  command->callback([options, &session] {
    session.shares_work = true;
    session.action = [options, &session] { return run_compare(*options, session); };
  });
}

}  // namespace armwright
