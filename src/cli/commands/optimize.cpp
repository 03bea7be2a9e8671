// armwright optimize: one optimizer on one problem, resumable.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <limits>
#include <utility>

#include "base/error.hpp"
#include "base/text.hpp"
#include "cli/commands/team.hpp"
#include "cli/terminal/arguments.hpp"
#include "cli/terminal/format.hpp"
#include "cli/terminal/progress_bar.hpp"
#include "cli/terminal/session.hpp"
#include "cli/terminal/signals.hpp"
#include "cli/terminal/terminal.hpp"
#include "cli/views/result_view.hpp"
#include "optimizers/table/optimizer_table.hpp"
#include "problems/config/path_survey.hpp"
#include "study/run/run.hpp"
#include "study/run/run_folder.hpp"
#include "study/run/run_observer.hpp"

namespace armwright {
namespace {

constexpr const char* kOptimizeExamples = R"(Examples:
  armwright optimize q1-complex                    # as in the thesis: its genetic algorithm, seed 1
  armwright optimize q2-e6 --optimizer ga --opt population=50 --seed 7 --budget 20000
  armwright optimize q1-complex --schedule fixed:10 --time-limit 10m --out results/robust
  armwright optimize my.toml --set task.load_kg=20 --set sets.test_cases=100 --json
  armwright optimize --robot my.urdf --base base_link --tip tool0   # an arm of your own

Interrupted by Ctrl-C, a time limit or a crash, the same command goes on where it was; a run that is complete is
shown and not made again. A command that would change what is recorded in the folder is refused, and says what
differs; --new begins another folder. The folder holds the winner (winner.toml), all numbers (result.json,
results.sqlite, convergence.csv) and the journal of every evaluation.

Terms: a design is the gains and effort limits of all joints; a case is one path of the moving target. The budget
counts simulated training cases (one design on one case is 1). The schedule says on which cases a design is trained:
fresh:K takes the next K of the training set for every generation, fixed:K always the first K, coevolution:K breeds
K that are hard for the designs. Racing spends fewer cases on designs that do badly (docs/racing.md): halving:4:2
gives all designs of a generation 4 cases, the better half of them twice as many, and so on; abandonment:1:4 gives a
design up when it is certain to be worse than 1 times the best, and looks every 4 cases. At the end the best designs
are judged on the validation set, and the winner on the test set, neither charged to the budget. The seed feeds the
optimizer's random choices; the same seed gives the same result on any number of threads.)";

struct OptimizeOptions {
  std::string problem;
  std::string optimizer;
  std::vector<std::string> opt;
  std::string seed = "1";
  std::string budget;
  std::string schedule;
  std::string racing;
  OverrideOptions overrides;
  std::string validation_cases;
  JobsOption jobs;
  TimeLimitOption time_limit;
  FolderOptions folder;
  bool json = false;
  bool quiet = false;

  std::vector<std::string> get_overrides() const;
  std::string get_problem() const;
};

std::string OptimizeOptions::get_problem() const {
  const std::string chosen = overrides.choose_problem(problem);
  if (chosen.empty()) {
    throw Error(ErrorKind::usage,
                "PROBLEM is required: name one (armwright list problems), or an arm of your own "
                "with --robot FILE; 'armwright optimize --help' has examples");
  }
  return chosen;
}

std::vector<std::string> OptimizeOptions::get_overrides() const {
  std::vector<std::string> all = overrides.get();
  if (!validation_cases.empty()) {
    all.push_back(fmt::format("sets.validation_cases={}",
                              parse_count("--validation-cases", validation_cases, 1, kMostCases)));
  }
  return all;
}

RunPlan make_plan(const OptimizeOptions& options) {
  RunPlan plan;
  plan.seed = static_cast<std::uint64_t>(parse_count("--seed (ARMWRIGHT_SEED)", options.seed, 0,
                                                     std::numeric_limits<std::int64_t>::max()));
  plan.problem = load_problem(options.get_problem(), options.get_overrides());
  plan.optimizer =
      load_optimizer(options.optimizer.empty() ? plan.problem.optimizer : options.optimizer);
  plan.options = Options::parse(plan.optimizer.name, plan.optimizer.options, options.opt);
  plan.budget = options.budget.empty()
                    ? plan.problem.budget
                    : parse_count("--budget", options.budget, 0, 1'000'000'000'000);
  plan.schedule = options.schedule.empty() ? choose_schedule(plan.problem, plan.optimizer)
                                           : parse_schedule(options.schedule);
  plan.racing = options.racing.empty() ? plan.problem.racing : parse_racing(options.racing);
  check_plan(plan);
  return plan;
}

// The words that make or resume this run: as typed, but for what would lead to another folder or
// seed the next time.
std::vector<std::string> make_command(const OptimizeOptions& options, const Session& session,
                                      const std::filesystem::path& folder) {
  std::vector<std::string> words;
  bool seed_typed = false;
  const auto& typed = session.command_line;
  for (std::size_t i = 0; i < typed.size(); ++i) {
    if (options.folder.another && (typed[i] == "--new" || typed[i].starts_with("--out="))) {
      continue;
    }
    if (options.folder.another && typed[i] == "--out") {
      ++i;
      continue;
    }
    seed_typed = seed_typed || typed[i] == "--seed" || typed[i].starts_with("--seed=");
    words.push_back(typed[i]);
  }
  if (!seed_typed && options.seed != "1") {  // from the environment
    words.insert(words.end(), {"--seed", options.seed});
  }
  if (options.folder.another) {
    words.insert(words.end(), {"--out", folder.string()});
  }
  return words;
}

void announce(const RunRequest& request, const std::string& ranks) {
  const RunPlan& plan = request.plan;
  const bool known = std::filesystem::exists(request.folder / "manifest.json");
  write_message(fmt::format("{}: {}", plan.problem.name, plan.problem.title));
  write_message(fmt::format(
      "optimizer {}, seed {}, budget {}, schedule {}{}, {}{}", plan.optimizer.name, plan.seed,
      format_count(static_cast<unsigned long long>(plan.budget), "case"), to_text(plan.schedule),
      plan.racing.kind == Racing::Kind::none ? "" : ", racing " + to_text(plan.racing),
      format_count(request.jobs, "thread"), ranks.empty() ? "" : " on each of " + ranks));
  if (plan.problem.schedule.changes_cases() && !plan.schedule.changes_cases()) {
    write_message(
        fmt::format("the problem's own schedule is {}, other cases for every "
                    "generation; this run trains on the same cases throughout",
                    to_text(plan.problem.schedule)));
  }
  const std::string no_race = explain_no_race(plan.optimizer, plan.racing, plan.schedule);
  if (!no_race.empty()) {
    write_message(fmt::format("racing {} has no effect: {}", to_text(plan.racing), no_race));
  }
  write_message(fmt::format("folder {} ({})", request.folder.string(), known ? "found" : "new"));
}

// Where what the optimizer printed went; empty if nothing is there.
std::string find_log(const RunRequest& request) {
  const auto& values = request.plan.options.values();
  const auto option = values.find("log");
  std::filesystem::path log = option == values.end() ? "" : std::get<std::string>(option->second);
  if (log.empty()) {
    log = request.folder / "optimizer.log";
  }
  return std::filesystem::exists(log) ? log.string() : "";
}

// What to do about an optimizer that has failed.
std::string describe_way_out(const OptimizeOptions& options, const RunRequest& request) {
  std::vector<std::string> check = {
      request.command_line.front(), "check-plugin",
      options.optimizer.empty() ? request.plan.problem.optimizer : options.optimizer};
  for (const std::string& assignment : options.opt) {
    check.insert(check.end(), {"--opt", assignment});
  }
  auto anew = request.command_line;
  anew.emplace_back("--new");
  const std::string log = find_log(request);
  const bool is_watched = request.plan.options.values().contains("silence_s");
  return fmt::format(
      "{} is marked as failed; what was evaluated is kept and judged.{}\nTo look for the fault:\n"
      "{}\nThe same command tries again from there{}; with a changed optimizer begin anew:\n{}",
      request.folder.string(), log.empty() ? "" : " What the optimizer printed: " + log,
      quote_command(check), is_watched ? " (silence_s, memory_mib and log may be others)" : "",
      quote_command(anew));
}

// Commands to try next, with the program named as the user named it.
std::string describe_next(const OptimizeOptions& options, const std::string& program,
                          const std::filesystem::path& folder, const Style& style) {
  const auto winner = folder / "winner.toml";
  std::string text = "\n" + style.bold("Next") + "\n";
  if (std::filesystem::exists(winner)) {
    std::vector<std::string> words = {program, "evaluate", winner.string(), "--problem",
                                      options.get_problem()};
    for (const std::string& change : options.overrides.get()) {
      words.insert(words.end(), {"--set", change});
    }
    words.insert(words.end(), {"--test-set", "3"});
    text += fmt::format("  {}\n", sanitize(quote_command(words)));
  }
  const std::vector<std::string> show = {program, "show", folder.string()};
  return text + fmt::format("  {}\n", sanitize(quote_command(show)));
}

int run_optimize(const OptimizeOptions& options, Session& session) {
  Team team(session);
  RunRequest request;
  request.jobs = options.jobs.get();
  if (team.is_worker()) {
    team.serve(
        [&]() -> Team::Problems {
          request.plan = make_plan(options);
          return {&request.plan.problem};
        },
        request.jobs);
  }
  options.time_limit.apply(session.stop);
  request.plan = make_plan(options);
  const std::vector<std::string> notes = check_paths(request.plan.problem);
  request.folder = options.folder.choose(make_run_name(request.plan));
  request.command_line = make_command(options, session, request.folder);
  if (!options.quiet) {
    announce(request, team.describe());
    std::ranges::for_each(notes, write_message);
  }

  catch_signals(session.stop);
  ProgressBar bar(options.quiet,
                  get_scalar_quantity(request.plan.problem.problem->description().objectives));
  LockedObserver observer(bar);
  auto coordinator = team.lead({&request.plan.problem}, request.jobs, observer);
  request.executor = coordinator.get();
  const auto result = execute_run(request, session.stop, observer);
  team.dismiss(std::move(coordinator));

  bar.clear();
  if (result && !result->failure.empty()) {
    write_message(describe_way_out(options, request));
  }
  if (!result) {
    return end_stopped(session, request.command_line);
  }
  if (options.json) {
    write_stdout(to_json(*result));
  } else {
    const Style style = make_style(Stream::out, session.color);
    write_stdout(describe_result(*result, request.folder, style) +
                 describe_next(options, session.command_line.front(), request.folder, style));
  }
  return get_result_code(*result);
}

}  // namespace

void add_optimize(CLI::App& app, Session& session) {
  auto options = std::make_shared<OptimizeOptions>();
  CLI::App* command =
      add_command(app, session, "optimize",
                  "Let an optimizer loose on a problem; resumes where it was", kOptimizeExamples);
  command->add_option(
      "PROBLEM", options->problem,
      "A problem file, or the name of a shipped one (armwright list problems); not\n"
      "needed with --robot");
  command
      ->add_option("--optimizer,-o", options->optimizer,
                   "Who optimizes (armwright list optimizers; default: the problem's)")
      ->type_name("NAME");
  command
      ->add_option("--opt", options->opt,
                   "An option of the optimizer, as in population=50; repeatable\n"
                   "(armwright list optimizers NAME)")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  command->add_option("--seed", options->seed, "Seed of the optimizer (default: 1)")
      ->type_name("N")
      ->envname("ARMWRIGHT_SEED");
  command
      ->add_option("--budget", options->budget,
                   "Training cases to simulate (default: the problem's)")
      ->type_name("CASES");
  command
      ->add_option("--schedule", options->schedule,
                   "Which training cases: fresh:K, fixed:K or coevolution:K (default: the\n"
                   "problem's; fixed where an optimizer has no generations)")
      ->type_name("KIND:K");
  command
      ->add_option("--racing", options->racing,
                   "Fewer cases for designs that do badly: none, halving:FIRST_CASES:ETA or\n"
                   "abandonment:MARGIN:CHUNK_CASES (default: the problem's)")
      ->type_name("KIND");
  options->overrides.add_to(*command, true);
  command
      ->add_option("--validation-cases", options->validation_cases,
                   "Cases on which the candidates for the win are judged (default: the\n"
                   "problem's)")
      ->type_name("N");
  options->jobs.add_to(*command);
  options->time_limit.add_to(*command);
  options->folder.add_to(*command, "run", "results/PROBLEM-OPTIMIZER-seedN");
  command->add_flag("--json", options->json, "Print the result as JSON")->group("Output");
  command->add_flag("--quiet,-q", options->quiet, "No progress")->group("Output");
  command->callback([options, &session] {
    session.shares_work = true;
    session.action = [options, &session] { return run_optimize(*options, session); };
  });
}

}  // namespace armwright
