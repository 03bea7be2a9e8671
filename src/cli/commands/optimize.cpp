// armwright optimize: runs one optimizer on one problem. It can be resumed.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iterator>
#include <utility>

#include "base/error.hpp"
#include "base/folder.hpp"
#include "base/text.hpp"
#include "cli/commands/commands.hpp"
#include "cli/commands/mpi_job.hpp"
#include "cli/commands/plan_options.hpp"
#include "cli/terminal/arguments.hpp"
#include "cli/terminal/format.hpp"
#include "cli/terminal/progress_bar.hpp"
#include "cli/terminal/session.hpp"
#include "cli/terminal/terminal.hpp"
#include "cli/views/result_view.hpp"
#include "problems/config/path_survey.hpp"
#include "report/evidence/health.hpp"
#include "study/run/run.hpp"
#include "study/run/run_folder.hpp"
#include "study/run/run_observer.hpp"
#include "study/verification/winner_check.hpp"

namespace armwright {
namespace {

constexpr const char* kOptimizeExamples = R"(Examples:
  armwright optimize q1-complex                    # the optimizer auto chooses one; seed 1
  armwright optimize q2-e6 --optimizer ga --opt population=50 --seed 7 --budget 20000
  armwright optimize q1-complex --schedule fixed:10 --time-limit 10m --out results/robust
  armwright optimize my.toml --set task.load_kg=20 --set sets.test_cases=100 --json
  armwright optimize --robot my.urdf --base base_link --tip tool0   # an arm of your own

If Ctrl-C, a time limit or a crash interrupts the run, the same command resumes it. If the run is complete, the command
shows its result and does not run again. With a larger --budget it continues the run (docs/journal.md). If the command
differs otherwise from the one recorded in the folder, it is refused with a list of the differences; --new begins another
folder. The name of the default folder shows what was set. The folder holds the winner (winner.toml), all numbers
(result.json, results.sqlite, convergence.csv) and the journal of every evaluation.

Terms: a design is the gains and effort limits of all joints. A case is one path of the moving target. The budget
counts simulated training cases (one design on one case is 1). The schedule chooses the training cases: fresh:K takes
the next K cases of the training set for every generation, fixed:K always takes the first K, coevolution:K breeds K
cases that are hard for the designs, and growing:K:FACTOR begins with the first K and takes FACTOR times as many
whenever progress is within the noise between cases. Racing spends fewer cases on bad designs (docs/racing.md): halving:4:2 gives all
designs of a generation 4 cases, the better half of the designs gets 8, and so on; abandonment:1:4 checks every 4 cases
and abandons a design that is certain to be worse than 1 times the best. At the end, the best designs are judged on the
validation set and the winner on the test set; the budget does not count these cases. Then a short check simulates the
winner of an arm under other conditions: another engine, more physics steps, other masses, friction and a sensor
(docs/verify.md). The seed determines the optimizer's random numbers; the same seed gives the same result on any number
of threads.)";

struct OptimizeOptions : PlanOptions {
  std::string jobs;
  std::string time_limit;
  FolderOptions folder;
  bool json = false;
  bool quiet = false;
};

// Makes the plan of the run and chooses its folder.
void make_request(OptimizeOptions& options, RunRequest& request) {
  request.plan = options.make_plan();
  request.folder = options.folder.choose(make_folder_name(request.plan, options.get_overrides()));
}

// Returns the command that resumes this run. It is the typed command without --new, and with --out
// and --seed where the typed command would choose another folder or seed the next time.
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
  const bool known = path_exists(request.folder / "manifest.json");
  write_message(fmt::format("{}: {}", plan.problem.name, plan.problem.title));
  write_message(fmt::format(
      "optimizer {}, seed {}, budget {}, schedule {}{}, {}{}", plan.optimizer.name, plan.seed,
      format_count(static_cast<unsigned long long>(plan.budget), "case"), to_text(plan.schedule),
      plan.racing.kind == Racing::Kind::none ? "" : ", racing " + to_text(plan.racing),
      format_count(request.jobs, "thread"), ranks.empty() ? "" : " on each of " + ranks));
  if (plan.problem.schedule.changes_cases() && !plan.schedule.changes_cases()) {
    write_message(
        fmt::format("the problem's own schedule is {}, with other cases for every "
                    "generation; this run always trains on the same cases",
                    to_text(plan.problem.schedule)));
  }
  const std::string no_race = explain_no_race(plan.optimizer, plan.racing, plan.schedule);
  if (!no_race.empty()) {
    write_message(fmt::format("racing {} has no effect: {}", to_text(plan.racing), no_race));
  }
  write_message(fmt::format("folder {} ({})", request.folder.string(), known ? "found" : "new"));
}

// Returns the file with the optimizer's output, or an empty text if there is none.
std::string find_log(const RunRequest& request) {
  const auto& values = request.plan.options.values();
  const auto option = values.find("log");
  std::filesystem::path log = option == values.end() ? "" : std::get<std::string>(option->second);
  if (log.empty()) {
    log = request.folder / "optimizer.log";
  }
  return path_exists(log) ? log.string() : "";
}

// Returns what the user can do about an optimizer that has failed.
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
      "{} is marked as failed; its evaluations are kept and judged.{}\nTo look for the fault:\n"
      "{}\nThe same command tries again from there{}. With a changed optimizer, begin a new "
      "run:\n{}",
      request.folder.string(), log.empty() ? "" : " The output of the optimizer: " + log,
      quote_command(check), is_watched ? " (silence_s, memory_mib and log may change)" : "",
      quote_command(anew));
}

// Returns what the user can do with the evaluations that the optimizer left unused.
std::string describe_rest(const OptimizeOptions& options, const RunRequest& request,
                          const RunResult& result) {
  const std::string name =
      options.optimizer.empty() ? request.plan.problem.optimizer : options.optimizer;
  const std::string way =
      request.plan.optimizer.capabilities.local
          ? fmt::format("To spend the whole budget on further starts: --optimizer {}",
                        quote_command(std::vector<std::string>{"multistart:" + name}))
          : "Its options may let it search on: " +
                quote_command(std::vector<std::string>{request.command_line.front(), "list",
                                                       "optimizers", name});
  return "note: " + describe_unused(result) + ". " + way;
}

// Returns a note on the variables of the winner that lie at a bound of the box, at most three by
// name; empty if there are none.
std::string describe_reached_bounds(const RunResult& result,
                                    const std::vector<DecisionVariable>& variables) {
  constexpr std::size_t kMostNamed = 3;
  if (!result.winner) {
    return "";
  }
  const std::vector<double>& x = result.judged[*result.winner].candidate.x;
  std::vector<VariablePlace> places = list_bound_places(variables, x);
  std::erase_if(places, [](const VariablePlace& one) { return one.to.distance > kNearBound; });
  if (places.empty()) {
    return "";
  }
  std::vector<std::string> named;
  std::vector<std::string> ways;
  for (const auto& [index, to] : places) {
    const DecisionVariable& variable = variables[index];
    const std::string way = to.is_upper ? variable.upper_widening : variable.lower_widening;
    if (!way.empty() && std::ranges::find(ways, way) == ways.end()) {
      ways.push_back(way);
    }
    if (named.size() < kMostNamed) {
      const double bound = to.is_upper ? variable.upper : variable.lower;
      named.push_back(fmt::format("{} lies {} its {} bound ({}{}{})", sanitize(variable.name),
                                  to.distance > 0 ? "near" : "at", to.is_upper ? "upper" : "lower",
                                  format_significant(bound), variable.unit.empty() ? "" : " ",
                                  sanitize(variable.unit)));
    }
  }
  const std::size_t more = places.size() - named.size();
  return fmt::format("note: {}{}{}", join(named, ", "),
                     more == 0 ? "" : fmt::format(", and {} more at theirs", more),
                     ways.empty()
                         ? ""
                         : fmt::format("; if the bound is not physical, widen the box with {}",
                                       join(ways, " or ")));
}

// Returns commands to try next.
std::string describe_next(const OptimizeOptions& options, const RunRequest& request,
                          const Session& session, const Style& style) {
  const std::filesystem::path& folder = request.folder;
  std::string text = describe_reading(folder, session, style);
  if (const auto winner = folder / "winner.toml"; path_exists(winner)) {
    std::vector<std::string> words = {"evaluate", winner.string(), "--problem",
                                      options.get_problem()};
    for (const std::string& change : options.overrides.get()) {
      words.insert(words.end(), {"--set", change});
    }
    std::vector<std::string> verify = words;
    if (!request.plan.problem.problem->description().has_single_case) {
      words.insert(words.end(), {"--test-set", "3"});
    }
    text += fmt::format("  {}\n", quote_own_command(session, words));
    if (path_exists(folder / kCheckFile)) {
      verify.front() = "verify";
      text += fmt::format("  {}\n", quote_own_command(session, verify));
    }
  }
  return text;
}

int run_optimize(OptimizeOptions options, Session& session) {
  MpiJob job(session);
  RunRequest request;
  request.jobs = parse_jobs(options.jobs);
  if (job.is_worker()) {
    job.serve(
        [&]() -> MpiJob::Problems {
          make_request(options, request);
          return {&request.plan.problem};
        },
        request.jobs);
  }
  apply_time_limit(options.time_limit, session.stop);
  make_request(options, request);
  const std::vector<std::string> notes = check_paths(request.plan.problem);
  request.command_line = make_command(options, session, request.folder);
  if (!options.quiet) {
    announce(request, job.describe());
    std::ranges::for_each(notes, write_message);
  }

  catch_signals(session.stop);
  ProgressBar bar(options.quiet,
                  get_scalar_quantity(request.plan.problem.problem->description().objectives));
  LockedObserver observer(bar);
  auto coordinator = job.make_coordinator({&request.plan.problem}, request.jobs, observer);
  request.executor = coordinator.get();
  const auto result = execute_run(request, session.stop, observer);
  job.end_workers(std::move(coordinator));
  const ProblemLoader load = [&](const std::vector<std::string>& changes) {
    return load_problem(options.get_problem(), replace_overrides(options.get_overrides(), changes));
  };
  const bool is_checked = !result || check_winner(request, *result, load, session.stop, observer);

  bar.clear();
  if (result && !result->failure.empty()) {
    write_message(describe_way_out(options, request));
  }
  if (result && result->unused_evaluations > 0) {
    write_message(describe_rest(options, request, *result));
  }
  if (!result) {
    return end_stopped(session, request.command_line);
  }
  if (const std::string note =
          describe_reached_bounds(*result, request.plan.problem.problem->description().variables);
      !options.quiet && !note.empty()) {
    write_message(note);
  }
  if (options.json) {
    write_stdout(make_result_json(*result, request.folder));
  } else {
    const Style style = make_style(Stream::out, session.color);
    write_stdout(describe_result(*result, request.folder, style) +
                 describe_next(options, request, session, style));
  }
  if (!is_checked) {
    write_message(
        fmt::format("{}; the run is complete, and its winner is not checked under other "
                    "conditions. The same command checks it",
                    describe_stop(session.stop.reason())));
    return get_stop_code(session.stop.reason());
  }
  return get_result_code(*result);
}

}  // namespace

void add_optimize(CLI::App& app, Session& session) {
  auto options = std::make_shared<OptimizeOptions>();
  CLI::App* command =
      add_command(app, session, "optimize",
                  "Run an optimizer on a problem; resumes an interrupted run", kOptimizeExamples);
  command->add_option(
      "PROBLEM", options->problem,
      "A problem file, or the name of a shipped problem (armwright list problems); not\n"
      "needed with --robot");
  options->add_to(*command);
  command
      ->add_option("--schedule", options->schedule,
                   "Schedule of the training cases: fresh:K, fixed:K, coevolution:K or\n"
                   "growing:K:FACTOR (default: the problem's; fixed if the optimizer has no\n"
                   "generations)")
      ->type_name("KIND:K");
  command
      ->add_option("--racing", options->racing,
                   "Spend fewer cases on bad designs: none, halving:FIRST_CASES:ETA or\n"
                   "abandonment:MARGIN:CHUNK_CASES (default: the problem's)")
      ->type_name("KIND");
  options->overrides.add_to(*command, true);
  command
      ->add_option("--validation-cases", options->validation_cases,
                   "Number of validation cases, which choose the winner (default: the\n"
                   "problem's)")
      ->type_name("N");
  add_jobs_flag(*command, options->jobs);
  add_time_limit_flag(*command, options->time_limit);
  options->folder.add_to(*command, "run", "results/PROBLEM-OPTIMIZER-seedN and what was set");
  command->add_flag("--json", options->json, "Print the result as JSON")->group("Output");
  command->add_flag("--quiet,-q", options->quiet, "Show no progress")->group("Output");
  command->callback([options, &session] {
    session.shares_work = true;
    session.action = [options, &session] { return run_optimize(*options, session); };
  });
}

}  // namespace armwright
