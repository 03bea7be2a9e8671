#include "study/run/run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/folder_checksums.hpp"
#include "base/text.hpp"
#include "problems/identification/identification_problem.hpp"
#include "problems/user/user_problem.hpp"
#include "process/output_log.hpp"
#include "process/stop_scope.hpp"
#include "study/journal/journal_format.hpp"
#include "study/run/design_evaluation.hpp"
#include "study/run/run_evaluator.hpp"
#include "study/run/run_folder.hpp"
#include "study/run/run_times.hpp"
#include "study/run/warning_observer.hpp"
#include "study/run/winner_selection.hpp"

namespace armwright {
namespace {

// SQLite cannot open a file whose absolute path is longer. Without this check that would only be
// noticed at the end of the run.
void check_path(const std::filesystem::path& folder) {
  constexpr std::size_t kLongestPath_bytes = 480;
  std::error_code error;  // without links, as SQLite resolves them
  const std::size_t size = std::filesystem::weakly_canonical(folder, error).native().size();
  if (size > kLongestPath_bytes) {
    throw Error(ErrorKind::usage,
                fmt::format("{}... is too long a path for a run: {} bytes, and {} are possible; "
                            "choose another folder with --out",
                            sanitize(folder.string().substr(0, 60)), size, kLongestPath_bytes));
  }
}

RunResult make_result(const RunPlan& plan) {
  RunResult result;
  const ProblemDescription& description = plan.problem.problem->description();
  result.problem = plan.problem.name;
  result.optimizer = plan.optimizer.name;
  result.seed = plan.seed;
  for (const DecisionVariable& variable : description.variables) {
    result.variable_names.push_back(variable.name);
    if (variable.type != VariableType::real) {
      result.discrete_variables.push_back(variable);
    }
  }
  for (const Quantity& metric : description.metrics) {
    result.metric_names.push_back(metric.name);
  }
  result.objectives = description.objectives;
  result.objective_weights = description.objective_weights;
  result.constraints = description.constraints;
  result.limits = description.limits;
  result.requirements = description.requirements;
  result.test_set = plan.problem.sets.test;
  result.tracking = plan.problem.tracking() != nullptr;
  result.published = plan.problem.published;
  return result;
}

// The build matters for simulations. A run whose evaluations are told has none.
void describe_start(const RunFolder& folder, bool is_told, const JournalContent& journal,
                    RunObserver& observer) {
  for (const std::string& warning : folder.warnings()) {
    if (!is_told) {
      observer.on_message("warning: " + warning +
                          "; if the results differ, resuming stops with an error");
    }
  }
  if (journal.torn_bytes > 0) {
    observer.on_message(
        fmt::format("warning: {}: cut {} bytes of an unfinished record off the end (kept beside "
                    "it); what it held "
                    "is evaluated again",
                    folder.journal().string(), journal.torn_bytes));
  }
  if (!journal.training.empty()) {
    observer.on_message(fmt::format("resuming: {} evaluations and {} judgements are recorded",
                                    journal.training.size(), journal.judgements.size()));
  }
}

// Warns if the journal of a complete run is missing or has no records. Reads only its size.
void warn_of_lost_journal(const RunFolder& folder, const RunResult& result, RunObserver& observer) {
  std::error_code error;
  const auto bytes = std::filesystem::file_size(folder.journal(), error);
  if (result.counts.evaluations > 0 && (error || bytes <= journal_format::kMagic.size())) {
    const std::vector<std::string> check = {"armwright", "doctor", folder.path().string()};
    observer.on_message(
        fmt::format("warning: the journal holds 0 of the {} evaluations of "
                    "result.json; '{}' says more",
                    result.counts.evaluations, quote_command(check)));
  }
}

// Sets why and how early the run ended.
void describe_end(const RunEvaluator& evaluator, RunResult& result) {
  result.end_reason = evaluator.budget_spent() ? "budget" : "optimizer finished";
  if (!evaluator.budget_spent()) {
    result.unused_evaluations = std::max<std::int64_t>(0, evaluator.remaining());
    result.end_detail = evaluator.end_detail();
  }
}

// Throws OptimizerFailure if the optimizer has returned at once.
void check_not_idle(const RunPlan& plan, const RunEvaluator& evaluator) {
  const bool is_idle =
      evaluator.counts().evaluations == 0 && !evaluator.stopped() && evaluator.remaining() > 0;
  if (is_idle) {
    const std::string& detail = evaluator.end_detail();
    throw OptimizerFailure(
        fmt::format("optimizer '{}' returned without evaluating a point, although the budget pays "
                    "for {}{}",
                    sanitize(plan.optimizer.name), evaluator.remaining(),
                    detail.empty() ? "" : "; its reason: " + detail));
  }
}

// Returns whether the start is judged beside the winner, and the winner confirmed. Nobody asked for a comparison's cell, the
// cases of a told run cost the caller, and an identification starts with a fit of its own.
bool judges_start(const RunRequest& request, const RunPlan& plan) {
  return request.derived == DerivedFiles::all && !plan.selection.evaluated_only &&
         find_identification(*plan.problem.problem) == nullptr;
}

// Measures what the winner of an arm does beside its errors at rest, on the cases of its test.
// Returns false if stopped. A comparison's cells and told runs are not simulated again.
bool measure_winner(const RunRequest& request, const RunPlan& plan, StopSignal& stop,
                    RunObserver& observer, RunResult& result) {
  const TrackingProblem* const arm = plan.problem.tracking();
  if (arm == nullptr || !result.winner) {
    return true;
  }
  const ArmDesign design = arm->make_design(result.judged[*result.winner].candidate.x);
  const EffortTotals efforts = calc_effort_totals(design, arm->config().robot);
  if (efforts.force_n) {
    result.sliding_efforts = efforts;
  }
  if (request.derived != DerivedFiles::all || plan.selection.evaluated_only) {
    return true;
  }
  const CaseSets& sets = plan.problem.sets;
  const ChosenCases cases{.set = arm->get_set(sets.test),
                          .count = static_cast<std::uint64_t>(sets.test_cases),
                          .motion = true};
  Progress progress;
  progress.total = cases.count;
  const auto evaluation =
      evaluate_with_progress(*arm, design, cases, request.jobs, stop, observer, progress);
  if (!evaluation) {
    return false;
  }
  result.test_motion = evaluation->motion;
  return true;
}

void warn_of_fewer_threads(std::size_t granted, std::size_t wanted, RunObserver& observer) {
  if (granted < wanted) {
    observer.on_message(
        fmt::format("warning: the system grants {} of {} threads; the result is "
                    "the same, but takes longer",
                    granted, wanted));
  }
}

}  // namespace

std::optional<RunResult> execute_run(const RunRequest& request, StopSignal& stop,
                                     RunObserver& outer) {
  const RunClock clock;
  RunPlan plan = request.plan;
  WarningObserver observer(*plan.problem.problem, outer);
  check_plan(plan);
  if (!request.ask && plan.problem.program.empty()) {
    require_server(*plan.problem.problem);  // before a folder is made
  }
  if (request.derived == DerivedFiles::all) {
    check_path(request.folder);
  }
  keep_pace(request.folder, plan);
  const auto optimizer = plan.optimizer.make(plan.options);
  optimizer->check_problem(plan.problem.problem->description());
  plan.optimizer.input_hashes.merge(optimizer->list_inputs());
  const RunFolder folder(request.folder, request.root, plan, request.command_line);
  const bool continues = folder.continued_budget() > 0;
  if (!continues && are_derived_files_there(folder, plan, request.derived)) {
    RunResult result = load_result(folder.path());
    if (request.derived == DerivedFiles::all) {  // a comparison's user did not ask for this cell
      observer.on_message(fmt::format(
          "{}: this run is complete; use --new for another one{}", folder.path().string(),
          explain_no_continuation(plan).empty() ? ", or continue it with a larger --budget" : ""));
      warn_of_lost_journal(folder, result, observer);
    }
    return result;
  }

  folder.check_writable();
  const auto add_time = [&] {
    if (request.derived == DerivedFiles::all) {  // a comparison measures its cells itself
      clock.add_to(folder.folder(), request.executor == nullptr);
    }
  };
  JournalContent recorded;
  Journal journal(folder.folder(), folder.journal().filename().string(), recorded);
  describe_start(folder, request.ask != nullptr, recorded, observer);
  bool has_begun = !continues;
  const auto begin = [&] {
    folder.record_larger_budget(journal, recorded.training.size());
    has_begun = true;
  };
  if (continues) {  // an end and late recommendations of the smaller budget are not those of this run
    recorded.ended = false;
    recorded.late.reset();
    observer.on_message(fmt::format("continuing with a budget of {} in place of {}", plan.budget,
                                    folder.continued_budget()));
  }
  std::optional<ThreadExecutor> threads;
  if (request.executor == nullptr) {
    threads.emplace(request.jobs);
    warn_of_fewer_threads(threads->pool().size(), request.jobs, observer);
  }
  CaseExecutor& executor = request.executor != nullptr ? *request.executor : *threads;
  RunEvaluator evaluator(plan, executor, stop, journal, recorded, observer);
  if (continues) {
    evaluator.begin_with(begin);
  }
  if (request.ask) {
    evaluator.ask_instead([&](std::span<const EvaluationRecord* const> missing) {
      request.ask(folder.folder(), missing);
    });
  }
  RunResult result = make_result(plan);
  optimizer->log_to(folder.log());
  try {
    optimizer->minimize(evaluator, plan.seed);
    check_not_idle(plan, evaluator);
  } catch (const OptimizerFailure& failure) {
    result.failure = failure.what();
    observer.on_message("error: " + result.failure + describe_printed(failure.printed()));
  }
  if (stop.requested()) {
    journal.close();
    add_time();
    return std::nullopt;
  }
  if (!result.failure.empty() && !has_begun) {
    throw Error(ErrorKind::bad_data,
                fmt::format("{}: the optimizer failed before it asked for anything new, so the run "
                            "stays as it was with a budget of {}",
                            folder.path().string(), folder.continued_budget()));
  }
  if (!result.failure.empty()) {
    evaluator.take_remaining_recorded();
    result.end_reason = "optimizer failed";
  } else {
    evaluator.check_replay_complete();
    if (!has_begun) {
      begin();
    }
    describe_end(evaluator, result);
  }
  evaluator.take_late_recommendations();
  result.choice = evaluator.choice();
  result.counts = evaluator.counts();
  result.first_failure = evaluator.first_failure();
  result.least_violation = evaluator.least_violation();
  RecordedEvaluations training;
  if (plan.problem.problem->description().has_single_case) {
    journal.flush();
    training = read_journal(folder.journal()).training;
  }
  // In a comparison every method has the same few places.
  const bool is_single = judges_start(request, plan);
  if (!select_winner(plan, evaluator.select_candidates(),
                     is_single ? evaluator.select_earlier_candidates() : std::vector<Candidate>{},
                     recorded, training, executor, stop, journal, observer, is_single, result)) {
    journal.close();
    add_time();
    return std::nullopt;
  }
  // A failed run gets no end record, so that it goes on from the failure when it is started again.
  if (!recorded.ended && result.failure.empty()) {
    journal.append(EndRecord{result.end_reason, result.counts.evaluations});
  }
  journal.close();
  try {
    const StopScope scope(&stop);
    if (!measure_winner(request, plan, stop, observer, result)) {
      add_time();
      return std::nullopt;
    }
    write_derived_files(folder, plan, result, read_journal(folder.journal()), request.derived,
                        add_time);
  } catch (const WorkStopped&) {  // while a user's problem recorded the winner
    add_time();
    return std::nullopt;
  }
  return result;
}

RunResult load_result(const std::filesystem::path& folder) {
  const auto file = folder / "result.json";
  const auto manifest = folder / "manifest.json";
  if (!path_exists(manifest)) {
    throw Error(
        ErrorKind::usage,
        fmt::format("{}: is not the folder of a run (it has no manifest.json)", folder.string()));
  }
  const auto recorded =
      nlohmann::json::parse(read_file(manifest, kManifestLimit_bytes), nullptr, false);
  if (is_of_version_1(recorded)) {
    throw Error(ErrorKind::bad_data, fmt::format("{}: {}", manifest.string(), kIsOfVersion1));
  }
  if (!path_exists(file)) {
    throw Error(
        ErrorKind::usage,
        fmt::format("{}: this run has not come to its end; start it again with the same command "
                    "to resume it",
                    folder.string()));
  }
  return parse_result(read_checked_file(file, kResultLimit_bytes), file);
}

}  // namespace armwright
