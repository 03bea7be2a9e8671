// Reads the runs of an export folder, in any of the formats that armwright can import.

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <tuple>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/json_text.hpp"
#include "base/text.hpp"
#include "process/csv_reader.hpp"
#include "report/exchange/import.hpp"
#include "report/formats/formats.hpp"
#include "study/run/json_values.hpp"

namespace armwright {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

constexpr std::size_t kLimit_bytes = std::size_t{4} << 30;

[[noreturn]] void refuse(const fs::path& file, std::string_view why) {
  throw Error(ErrorKind::bad_data,
              fmt::format("{}: is not what armwright exported: {}", file.string(), why));
}

void check(const ImportedRun& run, const fs::path& file) {
  if (run.feasible && run.x.size() != run.variables.size()) {
    refuse(file, fmt::format("a point has {} values for {} variables", run.x.size(),
                             run.variables.size()));
  }
}

// The places of the columns in evaluations/PROBLEM.csv.
class EvaluationColumns {
 public:
  explicit EvaluationColumns(const std::vector<std::string>& header) : header_(header) {
    constexpr std::string_view kPrefix = "x.";
    for (std::size_t i = 0; i < header.size(); ++i) {
      if (header[i].starts_with(kPrefix)) {
        variables_.push_back(header[i].substr(kPrefix.size()));
        x_.push_back(i);
      }
    }
    for (const char* name :
         {"problem", "label", "replicate", "evaluation", "feasible", "objective"}) {
      const auto found = std::ranges::find(header, name);
      if (found == header.end()) {
        throw Error(ErrorKind::bad_data, fmt::format("it has no column '{}'", name));
      }
      places_[name] = static_cast<std::size_t>(found - header.begin());
    }
  }

  std::size_t count() const { return header_.size(); }

  const std::string& get(const std::vector<std::string>& row, const char* column) const {
    return row[places_.at(column)];
  }
  std::uint64_t get_count(const std::vector<std::string>& row, const char* column) const {
    const auto value = parse_integer(get(row, column));
    if (!value || *value < 1) {
      throw Error(ErrorKind::bad_data, fmt::format("'{}' is no {}", get(row, column), column));
    }
    return static_cast<std::uint64_t>(*value);
  }
  double get_number(const std::string& text) const {
    const auto value = parse_finite(text);
    if (!value) {
      throw Error(ErrorKind::bad_data, fmt::format("'{}' is no number", text));
    }
    return *value;
  }

  void read_best(const std::vector<std::string>& row, ImportedRun& run) const {
    run.evaluation = get_count(row, "evaluation");
    run.objective = get_number(get(row, "objective"));
    run.variables = variables_;
    run.x.clear();
    for (const std::size_t place : x_) {
      run.x.push_back(get_number(row[place]));
    }
  }

 private:
  std::vector<std::string> header_;
  std::map<std::string, std::size_t> places_;
  std::vector<std::string> variables_;
  std::vector<std::size_t> x_;
};

void read_csv(const fs::path& file, std::vector<ImportedRun>& runs) {
  const std::string text = read_file(file, kLimit_bytes);
  CsvReader reader(text);
  try {
    std::vector<std::string> row;
    reader.read_row(row);
    const EvaluationColumns columns(row);
    std::map<std::tuple<std::string, std::string, std::uint64_t>, ImportedRun> found;
    while (reader.read_row(row)) {
      if (row.size() != columns.count()) {
        throw Error(ErrorKind::bad_data,
                    fmt::format("it has {} fields instead of {}", row.size(), columns.count()));
      }
      const std::string& problem = columns.get(row, "problem");
      const std::string& label = columns.get(row, "label");
      const std::uint64_t replicate = columns.get_count(row, "replicate");
      ImportedRun& run = found[{problem, label, replicate}];
      run.problem = problem;
      run.label = label;
      run.replicate = replicate;
      if (columns.get(row, "feasible") == "1" &&
          (!run.feasible || columns.get_number(columns.get(row, "objective")) < run.objective)) {
        run.feasible = true;
        columns.read_best(row, run);
      }
    }
    for (auto& [key, run] : found) {
      runs.push_back(std::move(run));
    }
  } catch (const Error& error) {
    refuse(file, fmt::format("row {}: {}", reader.row(), sanitize(error.what())));
  }
}

void read_csv_folder(const fs::path& folder, std::vector<ImportedRun>& runs) {
  std::vector<fs::path> files;
  for (const auto& entry : list_folder(folder / kEvaluationsFolder)) {
    if (entry.extension() == ".csv") {
      files.push_back(entry);
    }
  }
  for (const fs::path& file : files) {
    read_csv(file, runs);
  }
}

void read_json(const fs::path& file, std::vector<ImportedRun>& runs) {
  // The best evaluation of each run has its own entry. The list of evaluations, which is by far the
  // largest part of the file, is not needed.
  const auto skip_evaluations = [](int /*depth*/, json::parse_event_t event, json& parsed) {
    return event != json::parse_event_t::key || parsed != "evaluations";
  };
  try {
    const json root = json::parse(read_json_file(file, kLimit_bytes), skip_evaluations);
    for (const json& problem : root.at("problems")) {
      for (const json& run : problem.at("runs")) {
        ImportedRun imported;
        imported.problem = problem.at("name");
        imported.label = run.at("label");
        imported.replicate = whole_from_json(run.at("replicate"));
        imported.variables = problem.at("variables").get<std::vector<std::string>>();
        const json& best = run.at("best");
        if (!best.is_null()) {
          imported.feasible = true;
          imported.evaluation = whole_from_json(best.at("evaluation"));
          imported.objective = best.at("objective");
          imported.x = best.at("x").get<std::vector<double>>();
        }
        check(imported, file);
        runs.push_back(std::move(imported));
      }
    }
  } catch (const json::exception& error) {
    refuse(file, sanitize(error.what()));
  }
}

void read_ioh(const fs::path& file, std::vector<ImportedRun>& runs) {
  try {
    const json root = json::parse(read_json_file(file, kLimit_bytes));
    for (const json& scenario : root.at("scenarios")) {
      const auto variables = scenario.at("variables").get<std::vector<std::string>>();
      const std::string problem = scenario.at("problem");
      for (const json& run : scenario.at("runs")) {
        ImportedRun imported;
        imported.problem = problem;
        imported.label = root.at("algorithm").at("name");
        imported.replicate = whole_from_json(run.at("instance"));
        imported.variables = variables;
        const json& best = run.at("best");
        imported.objective = best.at("y");
        imported.feasible = imported.objective < std::numeric_limits<double>::max();
        imported.evaluation = whole_from_json(best.at("evals"));
        imported.x = best.at("x").get<std::vector<double>>();
        check(imported, file);
        runs.push_back(std::move(imported));
      }
    }
  } catch (const json::exception& error) {
    refuse(file, sanitize(error.what()));
  }
}

// Returns the index files in the folder of one label or in the folders of all labels.
std::vector<fs::path> find_ioh_files(const fs::path& folder) {
  std::vector<fs::path> files;
  const auto is_index = [](const fs::path& file) {
    return file.extension() == ".json" && file.filename().string().starts_with("IOHprofiler_f");
  };
  for (const fs::path& entry : list_folder(folder)) {
    for (const fs::path& file : folder_exists(entry) ? list_folder(entry) : std::vector{entry}) {
      if (is_index(file)) {
        files.push_back(file);
      }
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

std::vector<ImportedRun> read_export(const fs::path& folder) {
  std::vector<ImportedRun> runs;
  if (!folder_exists(folder)) {
    throw Error(ErrorKind::usage,
                fmt::format("{}: is not a folder; name the folder that armwright export wrote",
                            folder.string()));
  }
  if (path_exists(folder / kRunsCsv)) {
    read_csv_folder(folder, runs);
  } else if (path_exists(folder / kRunsJson)) {
    read_json(folder / kRunsJson, runs);
  } else {
    const auto files = find_ioh_files(folder);
    if (files.empty()) {
      throw Error(ErrorKind::usage,
                  fmt::format("{}: holds no export as csv, json or ioh (the format coco has "
                              "rounded numbers and cannot be imported)",
                              folder.string()));
    }
    for (const fs::path& file : files) {
      read_ioh(file, runs);
    }
  }
  return runs;
}

}  // namespace armwright
