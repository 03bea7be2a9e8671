// Writes runs as CSV files.

#include <fmt/format.h>

#include <algorithm>

#include "base/folder_checksums.hpp"
#include "base/text.hpp"
#include "report/formats/export_files.hpp"
#include "report/formats/formats.hpp"

namespace armwright {
namespace {

std::string format_optional(const std::optional<double>& value) {
  return value ? format_exact(*value) : "";
}

// Appends one field per column; a missing value gives an empty field.
void append_numbers(std::string& row, const std::vector<double>& values, std::size_t columns) {
  for (std::size_t i = 0; i < columns; ++i) {
    row += ',';
    row += i < values.size() ? format_exact(values[i]) : "";
  }
}

std::string make_run_fields(const RunEntry& run) {
  return fmt::format("{},{},{},{}", quote_csv(run.problem), quote_csv(run.label),
                     quote_csv(run.optimizer), run.replicate);
}

std::string make_header(const ProblemRuns& problem) {
  std::string header =
      "problem,label,optimizer,replicate,evaluation,simulated_cases,status,feasible,objective";
  const auto append = [&](const char* kind, const std::vector<std::string>& names) {
    for (const std::string& name : names) {
      header += "," + quote_csv(kind + name);
    }
  };
  append("objective.", problem.names.objectives);
  for (std::size_t i = 1; i <= problem.constraints; ++i) {
    header += fmt::format(",constraint.{}", i);
  }
  append("metric.", problem.names.metrics);
  append("x.", problem.names.variables);
  if (!problem.names.discrete.empty()) {
    append("proposed.", problem.names.variables);
  }
  return header + "\n";
}

void write_evaluations(OutputFile& file, const ProblemRuns& problem, const RunTrace& trace) {
  const std::string run = make_run_fields(trace.run);
  trace.evaluations.visit([&](const TracedEvaluation& evaluation) {
    std::string row =
        fmt::format("{},{},{},{},{},{}", run, evaluation.number, evaluation.simulated_cases,
                    to_string(evaluation.status), evaluation.feasible ? 1 : 0,
                    format_optional(evaluation.objective));
    append_numbers(row, evaluation.objectives, problem.names.objectives.size());
    append_numbers(row, evaluation.constraint_values, problem.constraints);
    append_numbers(row, evaluation.metrics, problem.names.metrics.size());
    append_numbers(row, evaluation.x, problem.names.variables.size());
    if (!problem.names.discrete.empty()) {
      append_numbers(row, evaluation.proposed, problem.names.variables.size());
    }
    file.write(row + "\n");
  });
}

std::string make_run_row(const RunTrace& trace, const std::string& design) {
  const TracedEvaluation& last = trace.evaluations.last().value();
  const auto& best = trace.evaluations.best();
  return fmt::format(
      "{},{},{},{},{},{},{},{},{},{},{}\n", make_run_fields(trace.run), trace.seed, last.number,
      last.simulated_cases, quote_csv(trace.end_reason),
      best ? fmt::format("{}", best->number) : "", best ? format_exact(*best->objective) : "",
      trace.tested_on ? quote_csv(trace.tested_on->set) : "", format_optional(trace.test_objective),
      trace.test ? fmt::format("{}", trace.test->failed_cases) : "", quote_csv(design));
}

}  // namespace

void write_csv(const CollectedRuns& collected, const std::filesystem::path& folder) {
  constexpr std::size_t kDesignLimit_bytes = std::size_t{1} << 20;
  OutputFile runs(folder / kRunsCsv);
  runs.write(
      "problem,label,optimizer,replicate,seed,evaluations,simulated_cases,end_reason,"
      "best_evaluation,best_objective,test_set,test_objective,test_failed_cases,design\n");
  UniqueNames files;
  UniqueNames designs;
  for (const ProblemRuns& problem : collected.problems) {
    OutputFile evaluations(folder / kEvaluationsFolder /
                           (files.add(escape_file_name(problem.name)) + ".csv"));
    evaluations.write(make_header(problem));
    for (const auto& [label, entries] : problem.labels) {
      for (const RunEntry& run : entries) {
        const RunTrace trace = read_trace(run);
        write_evaluations(evaluations, problem, trace);
        std::string design;
        if (path_exists(run.folder / "winner.toml")) {
          design =
              fmt::format("designs/{}.toml",
                          designs.add(fmt::format("{}-{}-{}", escape_file_name(run.problem),
                                                  escape_file_name(run.label), run.replicate)));
          write_output_file(folder / design,
                            read_checked_file(run.folder / "winner.toml", kDesignLimit_bytes));
        }
        runs.write(make_run_row(trace, design));
      }
    }
    evaluations.close();
  }
  runs.close();
  write_test_cases(collected, folder);
}

}  // namespace armwright
