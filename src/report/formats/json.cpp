// Writes runs as one JSON file.

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "base/build_info.hpp"
#include "base/text.hpp"
#include "report/formats/export_files.hpp"
#include "report/formats/formats.hpp"

namespace armwright {
namespace {

using nlohmann::ordered_json;

constexpr int kExportFormat = 1;

// JSON is UTF-8, but a plugin's text may hold any bytes; those that are not UTF-8 are replaced.
std::string dump(const ordered_json& value) {
  return value.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

ordered_json to_json(const TracedEvaluation& evaluation) {
  ordered_json j = {{"evaluation", evaluation.number},
                    {"simulated_cases", evaluation.simulated_cases},
                    {"status", to_string(evaluation.status)},
                    {"feasible", evaluation.feasible},
                    {"objective", evaluation.objective ? ordered_json(*evaluation.objective)
                                                       : ordered_json(nullptr)},
                    {"objectives", evaluation.objectives},
                    {"constraints", evaluation.constraint_values},
                    {"metrics", evaluation.metrics},
                    {"x", evaluation.x}};
  if (!evaluation.proposed.empty()) {
    j["proposed"] = evaluation.proposed;
  }
  if (!evaluation.reason.empty()) {
    j["reason"] = sanitize(evaluation.reason);
  }
  return j;
}

ordered_json make_winner(const RunTrace& trace) {
  if (!trace.test) {
    return nullptr;
  }
  ordered_json errors = ordered_json::array();
  for (const double error : trace.test->case_errors) {
    errors.push_back(std::isnan(error) ? ordered_json(nullptr) : ordered_json(error));
  }
  return {
      {"x", trace.winner},
      {"test_set", trace.tested_on ? ordered_json(trace.tested_on->set) : ordered_json(nullptr)},
      {"status", to_string(trace.test->status)},
      {"objectives", trace.test->objectives},
      {"constraints", trace.test->constraint_values},
      {"metrics", trace.test->metrics},
      {"failed_cases", trace.test->failed_cases},
      {"case_errors", errors}};
}

// Returns the run as JSON with its closing brace, without the evaluations.
std::string make_run_head(const RunTrace& trace) {
  const auto& best = trace.evaluations.best();
  const ordered_json run = {
      {"label", trace.run.label},         {"optimizer", trace.run.optimizer},
      {"replicate", trace.run.replicate}, {"seed", trace.seed},
      {"end_reason", trace.end_reason},   {"best", best ? to_json(*best) : ordered_json(nullptr)},
      {"winner", make_winner(trace)}};
  return dump(run);
}

void write_run(OutputFile& file, const RunTrace& trace) {
  std::string head = make_run_head(trace);
  head.pop_back();
  file.write(head + ",\"evaluations\":[");
  const char* separator = "\n";
  trace.evaluations.visit([&](const TracedEvaluation& evaluation) {
    file.write(separator + dump(to_json(evaluation)));
    separator = ",\n";
  });
  file.write("]}");
}

void write_problem(OutputFile& file, const ProblemRuns& problem) {
  ordered_json names = {{"name", problem.name},
                        {"variables", problem.names.variables},
                        {"objectives", problem.names.objectives},
                        {"constraints", problem.constraints},
                        {"metrics", problem.names.metrics}};
  if (!problem.names.discrete.empty()) {
    names["discrete_variables"] = problem.names.discrete;
  }
  std::string head = dump(names);
  head.pop_back();
  file.write(head + ",\"runs\":[");
  const char* separator = "\n";
  for (const auto& [label, runs] : problem.labels) {
    for (const RunEntry& run : runs) {
      file.write(separator);
      write_run(file, read_trace(run));
      separator = ",\n";
    }
  }
  file.write("]}");
}

}  // namespace

void write_json(const CollectedRuns& collected, const std::filesystem::path& folder) {
  OutputFile file(folder / kRunsJson);
  file.write(fmt::format("{{\"format\":{},\"armwright\":{},\"problems\":[", kExportFormat,
                         dump(ordered_json(get_version()))));
  const char* separator = "\n";
  for (const ProblemRuns& problem : collected.problems) {
    file.write(separator);
    write_problem(file, problem);
    separator = ",\n";
  }
  file.write("]}\n");
  file.close();
  write_test_cases(collected, folder);
}

}  // namespace armwright
