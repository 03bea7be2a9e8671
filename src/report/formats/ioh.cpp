// Writes runs in the format of IOHprofiler, which IOHanalyzer and iohinspector read.

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>

#include "base/build_info.hpp"
#include "base/text.hpp"
#include "report/formats/export_files.hpp"
#include "report/formats/export_functions.hpp"
#include "report/formats/formats.hpp"

namespace armwright {
namespace {

using nlohmann::ordered_json;

// The format's version in IOHexperimenter's numbering. Readers take a number below 0.3.3 for
// another format.
constexpr const char* kVersion = "0.3.5";

// Returns whether a reader could take the name for a decision variable.
bool looks_like_variable(std::string_view name) {
  return name.size() > 1 && (name[0] == 'x' || name[0] == 'X') &&
         name.find_first_not_of("0123456789", 1) == std::string_view::npos;
}

std::string make_row(const TracedEvaluation& evaluation, const TraceNames& names) {
  std::string row = fmt::format("{} {} {} {}", evaluation.number,
                                evaluation.feasible ? format_exact(*evaluation.objective) : "inf",
                                evaluation.simulated_cases, evaluation.feasible ? 1 : 0);
  const auto append = [&](const std::vector<double>& values, std::size_t columns) {
    for (std::size_t i = 0; i < columns; ++i) {
      row += " " + (i < values.size() ? format_exact(values[i]) : "None");
    }
  };
  if (names.objectives.size() > 1) {
    append(evaluation.objectives, names.objectives.size());
  }
  append(evaluation.metrics, names.metrics.size());
  append(evaluation.x, names.variables.size());
  return row + "\n";
}

ordered_json make_run(const RunTrace& trace) {
  const auto& best = trace.evaluations.best();
  const TracedEvaluation& shown = best ? *best : trace.evaluations.first().value();
  return {{"instance", trace.run.replicate},
          {"evals", trace.evaluations.last()->number},
          {"best",
           {{"evals", shown.number},
            {"y", best ? *best->objective : std::numeric_limits<double>::max()},
            {"x", shown.x}}}};
}

// Writes the data file of one label on one problem, to `data` below `root`. Returns its scenario in
// the index.
ordered_json write_scenario(const ProblemRuns& problem, const std::string& label,
                            const std::filesystem::path& root, const std::string& data) {
  OutputFile file(root / data);
  ordered_json runs = ordered_json::array();
  for (const RunEntry& run : problem.labels.at(label)) {
    const RunTrace trace = read_trace(run);
    file.write(make_ioh_rows(trace));
    runs.push_back(make_run(trace));
  }
  file.close();
  ordered_json words = ordered_json::object();
  for (const auto& [variable, choices] : problem.names.discrete) {
    if (!choices.empty()) {
      words[variable] = choices;
    }
  }
  ordered_json scenario = {{"dimension", problem.names.variables.size()},
                           {"path", data},
                           {"problem", problem.name},
                           {"variables", problem.names.variables}};
  if (!words.empty()) {
    scenario["words"] = std::move(words);  // of categories, in the order of their numbers from 0
  }
  scenario["runs"] = std::move(runs);
  return scenario;
}

// Writes a function's files for one label, if the label has runs on it.
void write_function(const ExportFunction& function, const std::string& label,
                    const std::filesystem::path& root) {
  const std::string name = fmt::format("f{}_{}", function.id, escape_file_name(function.name));
  ordered_json scenarios = ordered_json::array();
  std::string optimizer;
  for (const ProblemRuns* problem : function.problems) {
    const auto runs = problem->labels.find(label);
    if (runs != problem->labels.end()) {
      optimizer = runs->second.front().optimizer;
      scenarios.push_back(
          write_scenario(*problem, label, root,
                         fmt::format("data_{}/IOHprofiler_f{}_DIM{}.dat", name, function.id,
                                     problem->names.variables.size())));
    }
  }
  if (scenarios.empty()) {
    return;
  }
  const ordered_json index = {
      {"version", kVersion},
      {"suite", "armwright"},
      {"function_id", function.id},
      {"function_name", function.name},
      {"maximization", false},
      {"algorithm", {{"name", label}, {"info", optimizer}}},
      {"experiment_attributes", ordered_json::array({{{"armwright", get_version()}}})},
      {"attributes", make_ioh_columns(function.problems.front()->names)},
      {"scenarios", std::move(scenarios)},
  };
  write_output_file(root / fmt::format("IOHprofiler_{}.json", name), index.dump(2) + "\n");
}

}  // namespace

std::vector<std::string> make_ioh_columns(const TraceNames& names) {
  std::vector<std::string> columns = {"evaluations", "raw_y", "simulated_cases", "feasible"};
  UniqueNames unique('_');
  for (const std::string& column : columns) {
    unique.add(column);
  }
  const auto append = [&](const std::vector<std::string>& added) {
    for (const std::string& name : added) {
      const std::string column = escape_column_name(name);
      columns.push_back(unique.add(looks_like_variable(column) ? "c_" + column : column));
    }
  };
  if (names.objectives.size() > 1) {
    append(names.objectives);
  }
  append(names.metrics);
  return columns;
}

std::string make_ioh_rows(const RunTrace& trace) {
  std::string rows = join(make_ioh_columns(trace.names), " ");
  for (std::size_t i = 0; i < trace.names.variables.size(); ++i) {
    rows += fmt::format(" x{}", i);
  }
  rows += '\n';
  double best = std::numeric_limits<double>::infinity();
  trace.evaluations.visit([&](const TracedEvaluation& evaluation) {
    const bool improves = evaluation.feasible && *evaluation.objective < best;
    if (improves) {
      best = *evaluation.objective;
    }
    const bool first = evaluation.number == trace.evaluations.first()->number;
    const bool last = evaluation.number == trace.evaluations.last()->number;
    if (first || improves || last) {
      rows += make_row(evaluation, trace.names);
    }
  });
  return rows;
}

void write_ioh(const CollectedRuns& collected, const std::filesystem::path& folder) {
  const std::vector<ExportFunction> functions = number_functions(collected);
  for (const auto& [label, root] : make_file_names(list_labels(collected))) {
    for (const ExportFunction& function : functions) {
      write_function(function, label, folder / root);
    }
  }
}

}  // namespace armwright
