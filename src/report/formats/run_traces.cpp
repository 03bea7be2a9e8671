#include "report/formats/run_traces.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>
#include <tuple>

#include "base/config.hpp"
#include "base/error.hpp"
#include "base/folder.hpp"
#include "base/folder_checksums.hpp"
#include "base/json_text.hpp"
#include "base/text.hpp"
#include "study/journal/journal.hpp"
#include "study/run/json_values.hpp"
#include "study/run/run.hpp"
#include "study/run/run_folder.hpp"

namespace armwright {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

std::vector<fs::path> list_folders(const fs::path& parent) {
  std::vector<fs::path> folders;
  std::ranges::copy_if(list_folder(parent), std::back_inserter(folders), folder_exists);
  return folders;
}

RunEntry read_cell(const fs::path& folder) {
  const auto file = folder / "cell.json";
  RunEntry run;
  run.folder = folder;
  try {
    const json cell = json::parse(read_checked_json(file, kCellLimit_bytes));
    run.problem = cell.at("problem").get<std::string>();
    run.label = cell.at("label").get<std::string>();
    run.optimizer = cell.at("optimizer").get<std::string>();
    const auto replicate = whole_from_json(cell.at("replicate"));
    if (replicate < 1) {
      throw Error(ErrorKind::bad_data, fmt::format("{}: replicate is {}; they are counted from 1",
                                                   file.string(), replicate));
    }
    run.replicate = replicate;
  } catch (const json::exception& error) {
    throw Error(ErrorKind::bad_data,
                fmt::format("{}: is not a cell file that armwright wrote ({}); remove it and start "
                            "the study again, which rebuilds it",
                            file.string(), sanitize(error.what())));
  }
  return run;
}

// Returns the labels of the problems in the order of the study's plan. Without a plan, none.
std::vector<std::string> read_problem_order(const fs::path& study) {
  std::vector<std::string> labels;
  const auto file = study / "study.toml";
  if (!path_exists(file)) {
    return labels;
  }
  FolderChecksums(study).check("study.toml");
  try {
    const json plan = json::parse(ConfigTable::load(file).to_json());
    for (const json& problem : plan.at("problem")) {
      labels.push_back(problem.at("label").get<std::string>());
    }
  } catch (const json::exception& error) {
    throw Error(ErrorKind::usage, fmt::format("{}: is not a plan that armwright wrote ({})",
                                              file.string(), sanitize(error.what())));
  }
  return labels;
}

auto make_key(const RunEntry& run) {
  return std::tie(run.problem, run.label, run.replicate);
}

FoundRuns find_cells(const fs::path& folder) {
  const FolderChecksums checksums(folder);
  FoundRuns found;
  for (const fs::path& problem : list_folders(folder / "cells")) {
    for (const fs::path& label : list_folders(problem)) {
      for (const fs::path& replicate : list_folders(label)) {
        if (path_exists(replicate / "cell.json")) {
          checksums.check((replicate.lexically_relative(folder) / kChecksumFile).string());
          found.runs.push_back(read_cell(replicate));
        } else {
          ++found.unfinished;
        }
      }
    }
  }
  if (found.runs.empty()) {
    throw Error(ErrorKind::usage,
                fmt::format("{}: no cell of this study has finished, so there is nothing to "
                            "export; start the study again with the same command to continue it",
                            folder.string()));
  }
  const auto order = read_problem_order(folder);
  for (RunEntry& run : found.runs) {
    run.problem_place =
        static_cast<std::size_t>(std::ranges::find(order, run.problem) - order.begin());
  }
  std::sort(found.runs.begin(), found.runs.end(),
            [](const RunEntry& a, const RunEntry& b) { return make_key(a) < make_key(b); });
  const auto twice = std::adjacent_find(
      found.runs.begin(), found.runs.end(),
      [](const RunEntry& a, const RunEntry& b) { return make_key(a) == make_key(b); });
  if (twice != found.runs.end()) {
    throw Error(ErrorKind::bad_data,
                fmt::format("{} and {} are both replicate {} of '{}' on '{}'; remove one of them",
                            twice->folder.string(), std::next(twice)->folder.string(),
                            twice->replicate, sanitize(twice->label), sanitize(twice->problem)));
  }
  return found;
}

// Returns the cases of the winner's test. The journal says which cases were simulated; the result
// does not.
std::optional<UsedCases> find_tested(const JournalContent& journal) {
  std::optional<UsedCases> used;
  for (const EvaluationRecord& record : journal.judgements) {
    if (record.cases.role == CaseRole::test && !record.cases.numbers.empty()) {
      used.emplace(UsedCases{record.cases.set, std::ranges::max(record.cases.numbers) + 1});
    }
  }
  return used;
}

TracedEvaluation make_traced(const EvaluationRecord& record, const std::vector<double>& weights,
                             std::uint64_t simulated_cases) {
  TracedEvaluation traced;
  traced.number = record.index + 1;
  traced.simulated_cases = simulated_cases;
  traced.feasible = is_feasible(record.evaluation);
  if (!record.evaluation.objectives.empty()) {
    traced.objective = calc_scalar(weights, record.evaluation.objectives);
  }
  traced.status = record.evaluation.status;
  traced.reason = record.evaluation.reason;
  traced.objectives = record.evaluation.objectives;
  traced.constraint_values = record.evaluation.constraint_values;
  traced.metrics = record.evaluation.metrics;
  traced.x = record.x;
  traced.proposed = record.proposed;
  return traced;
}

void include_trace(ProblemRuns& problem, const RunTrace& trace) {
  trace.evaluations.visit([&](const TracedEvaluation& evaluation) {
    problem.constraints = std::max(problem.constraints, evaluation.constraint_values.size());
    if (evaluation.feasible) {
      if (!problem.best || *evaluation.objective < *problem.best) {
        problem.best = evaluation.objective;
        problem.best_run = trace.run;
      }
      problem.worst =
          std::max(problem.worst.value_or(*evaluation.objective), *evaluation.objective);
    }
  });
  if (trace.tested_on) {
    if (problem.tested_on && problem.tested_on->set != trace.tested_on->set) {
      throw Error(ErrorKind::bad_data,
                  fmt::format("{}: this run was tested on {}, but other runs on problem '{}' were "
                              "tested on {}; export them separately",
                              trace.run.folder.string(), sanitize(trace.tested_on->set),
                              sanitize(problem.name), sanitize(problem.tested_on->set)));
    }
    const std::uint64_t before = problem.tested_on ? problem.tested_on->count : 0;
    problem.tested_on = trace.tested_on;
    problem.tested_on->count = std::max(before, trace.tested_on->count);
  }
  problem.labels[trace.run.label].push_back(trace.run);
}

}  // namespace

FoundRuns find_runs(const fs::path& folder) {
  if (folder_exists(folder / "cells")) {
    return find_cells(folder);
  }
  if (!path_exists(folder / "manifest.json")) {
    throw Error(ErrorKind::usage,
                fmt::format("{}: is neither the folder of a run (it has no manifest.json) nor that "
                            "of a study (it has no folder cells)",
                            folder.string()));
  }
  const RunResult result = load_result(folder);
  RunEntry run;
  run.folder = folder;
  run.problem = result.problem;
  run.label = result.optimizer;
  run.optimizer = result.optimizer;
  return {{run}, 0};
}

TracedEvaluations::TracedEvaluations(Source source) : source_(std::move(source)) {
  visit([this](const TracedEvaluation& evaluation) {
    ++size_;
    if (!first_) {
      first_ = evaluation;
    }
    if (evaluation.feasible && (!best_ || *evaluation.objective < *best_->objective)) {
      best_ = evaluation;
    }
    last_ = evaluation;
  });
}

void TracedEvaluations::visit(const Visitor& visitor) const {
  if (source_) {
    source_(visitor);
  }
}

RunTrace read_trace(const RunEntry& run) {
  const RunResult result = load_result(run.folder);
  const JournalContent journal = read_journal(run.folder / "journal");
  RunTrace trace;
  trace.run = run;
  trace.function = read_function(run.folder, result);
  trace.seed = result.seed;
  trace.end_reason = result.end_reason;
  trace.tracking = result.tracking;
  trace.names.variables = result.variable_names;
  trace.names.metrics = result.metric_names;
  for (const DecisionVariable& variable : result.discrete_variables) {
    trace.names.discrete[variable.name] = variable.choices;
  }
  for (const Quantity& objective : result.objectives) {
    trace.names.objectives.push_back(objective.name);
  }
  trace.tested_on = find_tested(journal);
  if (result.winner) {
    trace.test = result.test;
    if (!result.test.objectives.empty()) {
      trace.test_objective = calc_target(result, result.test);
    }
    trace.winner = result.judged[*result.winner].candidate.x;
  }
  const auto visit = [file = run.folder / "journal", training = journal.training,
                      variables = trace.names.variables.size(), weights = result.objective_weights](
                         const TracedEvaluations::Visitor& visitor) {
    std::uint64_t simulated_cases = 0;
    for (const EvaluationRecord& record : training) {
      if (record.x.size() != variables) {
        throw Error(
            ErrorKind::bad_data,
            fmt::format("{}: evaluation {} has {} variables, but result.json names {}; they "
                        "belong to different runs",
                        file.string(), record.index + 1, record.x.size(), variables));
      }
      simulated_cases += record.calc_charge();
      visitor(make_traced(record, weights, simulated_cases));
    }
  };
  trace.evaluations = TracedEvaluations(visit);
  return trace;
}

CollectedRuns collect_runs(const std::vector<RunEntry>& runs) {
  CollectedRuns collected;
  for (const RunEntry& run : runs) {
    const RunTrace trace = read_trace(run);
    if (trace.evaluations.empty()) {
      ++collected.empty;
      continue;
    }
    if (collected.problems.empty() || collected.problems.back().name != run.problem) {
      ProblemRuns problem;
      problem.name = run.problem;
      problem.place = run.problem_place;
      problem.function = trace.function;
      problem.names = trace.names;
      problem.tracking = trace.tracking;
      collected.problems.push_back(std::move(problem));
    }
    ProblemRuns& problem = collected.problems.back();
    if (problem.names != trace.names) {
      throw Error(ErrorKind::bad_data,
                  fmt::format("{} and {} are both runs on '{}', but with other variables, "
                              "objectives or metrics; export them separately",
                              problem.labels.begin()->second.front().folder.string(),
                              run.folder.string(), sanitize(run.problem)));
    }
    include_trace(problem, trace);
    ++collected.runs;
    collected.evaluations += trace.evaluations.size();
  }
  if (collected.problems.empty()) {
    throw Error(ErrorKind::usage, "no run has evaluated anything, so there is nothing to export");
  }
  return collected;
}

std::vector<std::string> list_labels(const CollectedRuns& collected) {
  std::set<std::string> labels;
  for (const ProblemRuns& problem : collected.problems) {
    for (const auto& [label, runs] : problem.labels) {
      labels.insert(label);
    }
  }
  return {labels.begin(), labels.end()};
}

}  // namespace armwright
