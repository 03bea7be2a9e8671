// Checks files that were derived from a journal: whether they can be read, and whether they agree
// with the journal. All of them can be derived again. No function changes a file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "study/run/run_result.hpp"
#include "study/survey/journal_survey.hpp"

namespace armwright {

// Each of the following functions returns the fault of the file, or an empty text if it has none.
// They throw Error{io} if the operating system refuses to read the file.

// Checks a comma-separated file: a line of titles, all rows as long as the titles, and a complete
// last row. If `last` is given, the last row must begin with it.
std::string find_csv_fault(const std::filesystem::path& file,
                           std::optional<std::uint64_t> last = std::nullopt);
std::string find_json_fault(const std::filesystem::path& file);
std::string find_toml_fault(const std::filesystem::path& file);
std::string find_design_fault(const std::filesystem::path& file);
// Runs SQLite's own check and compares the numbers of evaluations with those of `result`.
std::string find_database_fault(const std::filesystem::path& file, const RunResult& result);

// Compares a run's result with the records of its journal.
class ResultSurvey {
 public:
  explicit ResultSurvey(RunResult result);

  const RunResult& result() const { return result_; }
  // Adds one record; to be called for every record of the journal.
  void add(const EvaluationRecord& record);
  // Returns the first difference between the result and the journal, or an empty text if they
  // agree. To be called after all records were added.
  std::string find_difference(const JournalSurvey& journal) const;
  // Returns the number of evaluations in the last row of convergence.csv; nothing if it is unknown.
  std::optional<std::uint64_t> calc_last_row() const;

 private:
  RunResult result_;
  std::multimap<std::uint64_t, std::size_t> by_evaluation_;  // evaluation -> index in judged
  std::vector<char> trained_;    // per judged design: the journal has its training evaluation
  std::vector<char> validated_;  // per judged design: the journal has its validation
  bool tested_ = false;
  // Among the feasible evaluations: the last, its generation, the best (objective, index), and
  // whether any has a generation.
  std::optional<std::uint64_t> last_;
  std::uint64_t last_generation_ = 0;
  std::optional<std::pair<double, std::uint64_t>> best_;
  bool has_generations_ = false;
};

}  // namespace armwright
