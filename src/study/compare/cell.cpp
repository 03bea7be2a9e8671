#include "study/compare/cell.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/folder_checksums.hpp"
#include "base/text.hpp"
#include "study/compare/choices.hpp"
#include "study/compare/incumbents.hpp"
#include "study/run/run_folder.hpp"
#include "study/run/run_times.hpp"
#include "study/run/warning_observer.hpp"
#include "study/statistics/values.hpp"

namespace armwright {
namespace {

bool needs_choices(const StudyPlan& plan) {
  return plan.judge_along || !plan.targets.empty();
}

void set_winner(const LoadedProblem& loaded, const JudgedCandidate& winner, const Evaluation& test,
                double tolerance, CellOutcome& outcome) {
  const ProblemDescription& problem = loaded.problem->description();
  outcome.x = winner.candidate.x;
  outcome.validation_value = calc_test_value(problem, winner.validation, tolerance);
  outcome.value = calc_test_value(problem, test, tolerance);
  outcome.violation = calc_violation(test.constraint_values);
  outcome.errors = summarize_errors(loaded, test);
  outcome.objectives = test.objectives;
  outcome.metrics = test.metrics;
}

// Makes the point of a design on the test set; `evaluation` is null if there is no design.
CurvePoint make_point(const RunPlan& run, std::int64_t budget, const Evaluation* evaluation,
                      double tolerance) {
  if (evaluation == nullptr) {
    return {budget, kInfinity, static_cast<std::uint64_t>(run.problem.sets.test_cases)};
  }
  return {budget, calc_test_value(run.problem.problem->description(), *evaluation, tolerance),
          summarize_errors(run.problem, *evaluation).failures};
}

// Evaluates the designs along the run on the test set. Returns false if stopped.
bool test_progress(const StudyPlan& plan, const Cell& cell, const RunPlan& run,
                   const RunResult& result, const CellRequest& where, StopSignal& stop,
                   CellOutcome& outcome) {
  std::optional<ThreadExecutor> threads;
  CaseExecutor& executor =
      where.executor != nullptr ? *where.executor : threads.emplace(where.jobs);
  const ProblemDescription& problem = run.problem.problem->description();
  const auto journal = read_journal(where.folder / "journal");
  const auto incumbents = find_incumbents(problem, journal.training, run.schedule);
  const auto checkpoints = list_checkpoints(plan, cell.problem);
  const bool is_function = run.problem.tracking() == nullptr;
  const auto traced = is_function ? thin_incumbents(find_incumbents(problem, journal.training, {}),
                                                    kMostTracedOnFunctions, {})
                                  : thin_incumbents(incumbents, kMostTraced, checkpoints);
  const auto find_incumbent = [&](std::int64_t budget) {
    const auto after = std::ranges::upper_bound(incumbents, budget, {}, &Incumbent::cases);
    return after == incumbents.begin() ? nullptr : &*std::prev(after);
  };
  const auto find_design = [&](const Incumbent& incumbent) {
    return journal.training.find(incumbent.evaluation).value().x;
  };
  std::vector<std::vector<double>> designs = {list_starts(problem.variables)};
  for (const std::int64_t budget : checkpoints) {
    if (const Incumbent* incumbent = find_incumbent(budget)) {
      designs.push_back(find_design(*incumbent));
    }
  }
  for (std::size_t i = 0; !is_function && i < traced.size(); ++i) {
    designs.push_back(find_design(traced[i]));
  }
  const bool has_front = problem.objectives.size() > 1;
  for (std::size_t i = 0; has_front && i < result.judged.size(); ++i) {
    designs.push_back(result.judged[i].candidate.x);
  }
  std::vector<std::optional<JudgedCandidate>> choices;
  if (needs_choices(plan)) {
    auto made = make_choices(run, journal.training, result, checkpoints, executor, stop);
    if (!made) {
      return false;
    }
    choices = std::move(*made);
  }
  for (const auto& choice : choices) {
    if (choice) {
      designs.push_back(choice->candidate.x);
    }
  }
  DesignBench bench(run.problem, CaseRole::test, executor, stop);
  if (!bench.add(designs)) {
    return false;
  }
  const double tolerance = plan.constraint_tolerance;
  const Evaluation& start = bench.get(designs.front());
  outcome.start_value = calc_test_value(problem, start, tolerance);
  outcome.start_failures = summarize_errors(run.problem, start).failures;
  for (const std::int64_t budget : checkpoints) {
    const Incumbent* incumbent = find_incumbent(budget);
    outcome.curve.push_back(make_point(
        run, budget, incumbent == nullptr ? nullptr : &bench.get(find_design(*incumbent)),
        tolerance));
  }
  for (const Incumbent& incumbent : traced) {
    outcome.trace.push_back(
        is_function
            ? CurvePoint{incumbent.cases, incumbent.objective, 0}
            : make_point(run, incumbent.cases, &bench.get(find_design(incumbent)), tolerance));
  }
  for (std::size_t i = 0; i < choices.size(); ++i) {
    const Evaluation* evaluation = choices[i] ? &bench.get(choices[i]->candidate.x) : nullptr;
    outcome.choices.push_back(make_point(run, checkpoints[i], evaluation, tolerance));
  }
  if (plan.judge_along && !choices.empty() && choices.back()) {
    const JudgedCandidate& winner = *choices.back();
    set_winner(run.problem, winner, bench.get(winner.candidate.x), tolerance, outcome);
  }
  for (std::size_t i = 0; has_front && i < result.judged.size(); ++i) {
    const Evaluation& evaluation = bench.get(result.judged[i].candidate.x);
    if (std::isfinite(calc_test_value(problem, evaluation, plan.constraint_tolerance))) {
      outcome.front.push_back(evaluation.objectives);
    }
  }
  return true;
}

// Returns whether the recorded outcome has every value that the plan asks for.
bool answers(const StudyPlan& plan, const CellOutcome& outcome) {
  const bool has_failures = outcome.start_failures.has_value();
  return (!needs_choices(plan) || !outcome.choices.empty()) &&
         (plan.value != StudyValue::failures || has_failures);
}

}  // namespace

double calc_test_value(const ProblemDescription& problem, const Evaluation& evaluation,
                       double tolerance) {
  const bool violated =
      std::ranges::any_of(evaluation.constraint_values, [&](double g) { return g > tolerance; });
  return evaluation.objectives.empty() || evaluation.failed_cases > 0 || violated
             ? kInfinity
             : calc_scalar(problem, evaluation.objectives);
}

std::optional<std::uint64_t> count_judged(const std::filesystem::path& folder) {
  const auto file = folder / "result.json";
  if (!path_exists(file)) {
    return std::nullopt;
  }
  return parse_result(read_checked_file(file, kResultLimit_bytes), file).judged.size();
}

std::optional<CellOutcome> run_cell(const StudyPlan& plan, const Cell& cell,
                                    const std::filesystem::path& study, StopSignal& stop,
                                    RunObserver& observer) {
  const CellRequest where{.folder = study / make_cell_path(plan, cell), .root = study};
  return run_cell(plan, cell, where, stop, observer);
}

std::optional<CellOutcome> run_cell(const StudyPlan& plan, const Cell& cell,
                                    const CellRequest& where, StopSignal& stop,
                                    RunObserver& outer) {
  const RunClock clock;
  RunRequest request;
  request.plan = make_run_plan(plan, cell);
  WarningObserver observer(*request.plan.problem.problem, outer);  // the test set is included
  request.folder = where.folder;
  request.root = where.root;
  request.jobs = where.jobs;
  request.executor = where.executor;
  request.command_line = where.command_line;
  request.derived = DerivedFiles::winner;
  const auto result = execute_run(request, stop, observer);
  const Folder folder = Folder::make(where.folder, where.root);
  const bool simulates = where.executor == nullptr;
  if (!result) {
    clock.add_to(folder, simulates);
    return std::nullopt;
  }
  CellOutcome outcome;
  outcome.problem = plan.problems[cell.problem].label;
  outcome.optimizer = plan.optimizers[cell.optimizer].label;
  outcome.optimizer_name = plan.optimizers[cell.optimizer].row.name;
  outcome.replicate = cell.replicate;
  outcome.configuration_sha256 = calc_configuration_hash(get_problem(plan, cell));
  outcome.end_reason = result->end_reason;
  outcome.failure = result->failure;
  outcome.evaluations = result->counts.evaluations;
  outcome.cases = result->counts.cases;
  outcome.clipped = result->counts.clipped;
  outcome.failed_evaluations = result->counts.failed;
  outcome.value = outcome.validation_value = kInfinity;
  if (result->winner) {
    set_winner(request.plan.problem, result->judged[*result->winner], result->test,
               plan.constraint_tolerance, outcome);
  }
  if (!test_progress(plan, cell, request.plan, *result, where, stop, outcome)) {
    clock.add_to(folder, simulates);
    return std::nullopt;
  }
  clock.add_to(folder, simulates);
  const std::string name = "cell.json";
  FolderChecksums(folder).drop({&name, 1});
  write_file_atomically(folder, name, to_json(outcome));
  cover_run(folder, outcome.failure.empty());
  // One process may run cells of many problems; each problem would keep its cases in memory.
  request.plan.problem.problem->forget_cases();
  return outcome;
}

std::optional<CellOutcome> load_cell(const StudyPlan& plan, const Cell& cell,
                                     const std::filesystem::path& study) {
  const auto file = study / make_cell_path(plan, cell) / "cell.json";
  if (!path_exists(file)) {
    return std::nullopt;
  }
  std::string text;
  try {
    text = read_checked_file(file, kCellLimit_bytes);
  } catch (const Error&) {
    // A process that publishes the same cell may have moved this one aside, and back, since.
    if (!path_exists(file)) {
      return std::nullopt;
    }
    text = read_checked_file(file, kCellLimit_bytes);
  }
  CellOutcome outcome = parse_cell(text, file);
  const StudyProblem& problem = plan.problems[cell.problem];
  if (outcome.problem != problem.label ||
      outcome.optimizer != plan.optimizers[cell.optimizer].label ||
      outcome.replicate != cell.replicate ||
      outcome.configuration_sha256 != calc_configuration_hash(get_problem(plan, cell))) {
    throw Error(ErrorKind::bad_data,
                fmt::format("{}: is of another cell ({} on {}, replicate {}, or of another "
                            "configuration); remove it, and the same command makes the right one",
                            file.string(), sanitize(outcome.optimizer), sanitize(outcome.problem),
                            outcome.replicate));
  }
  return answers(plan, outcome) ? std::optional(std::move(outcome)) : std::nullopt;
}

}  // namespace armwright
