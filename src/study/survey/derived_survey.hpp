// Checks files that were derived from a journal: whether they can be read, and whether they agree
// with the journal. All of them can be derived again. No function changes a file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "study/compare/cell.hpp"
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
std::string find_values_fault(const std::filesystem::path& file);
// Runs SQLite's own check and compares the numbers of evaluations with those of `result`.
std::string find_database_fault(const std::filesystem::path& file, const RunResult& result);

// Returns the first value of the text of result.json that reading it does not use and that differs
// from what `result`, which was read from it, gives. Such values are summaries.
std::string find_summary_difference(const std::string& text, const RunResult& result);
// Compares a cell's record with the result of its run, and with its place in a study if `name` is
// cells/PROBLEM/OPTIMIZER/rNN. Returns the first difference, or an empty text.
std::string find_cell_difference(const CellOutcome& cell, const RunResult& result,
                                 const std::filesystem::path& name);

// The files of a folder compared with its checksums (base/folder_checksums.hpp).
struct ChecksumSurvey {
  bool is_there = false;                       // SHA256SUMS exists
  std::string fault;                           // of SHA256SUMS itself
  std::map<std::string, std::string> changed;  // name -> how it differs
  std::set<std::string> missing;               // covered files that do not exist
  std::vector<std::string> uncovered;          // those of `expected` that it does not cover
  std::map<std::string, std::string> lines;    // of SHA256SUMS
};
// `expected` are the files in the folder that armwright covers.
ChecksumSurvey survey_checksums(const std::filesystem::path& folder,
                                const std::vector<std::string>& expected);

// Compares a run's result with the records of its journal.
class ResultSurvey {
 public:
  explicit ResultSurvey(RunResult result);

  const RunResult& result() const { return result_; }
  // Adds one record; to be called for every record of the journal.
  void add(const EvaluationRecord& record);
  // Returns the first difference between the result and the journal, or an empty text if they
  // agree. Winner and summary are computed again from the journal's records. To be called after all
  // records were added.
  std::string find_difference(const JournalSurvey& journal) const;
  // Returns the number of judgements that the result has and the journal lacks.
  std::size_t count_lost_judgements() const;
  // Returns the number of evaluations in the last row of convergence.csv; nothing if it is unknown.
  std::optional<std::uint64_t> calc_last_row() const;

 private:
  // Returns whether the journal has the further validation cases of a judged design.
  bool has_further(std::size_t place) const;

  RunResult result_;
  std::multimap<std::uint64_t, std::size_t> by_evaluation_;  // evaluation -> index in judged
  std::vector<char> trained_;    // per judged design: the journal has its training evaluation
  std::vector<char> judged_;     // per judged design: the journal has any validation of it
  std::vector<char> validated_;  // per judged design: the journal has its validation
  // Per judged design: failures on further validation cases, by the first and number of the cases.
  std::vector<std::map<std::pair<std::uint64_t, std::uint64_t>, std::uint64_t>> further_;
  bool is_winner_judged_ = false;  // the journal has any test of the winner
  bool tested_ = false;            // the journal has its test
  std::string test_set_;           // of that test
  // The training evaluations determine these: the first one without objectives, the smallest
  // violation, and the highest generation.
  std::optional<std::pair<std::uint64_t, std::string>> first_failure_;
  std::optional<double> least_violation_;
  std::uint64_t most_generations_ = 0;
  // Among the feasible evaluations: the last, its generation, the best (objective, index), and
  // whether any has a generation.
  std::optional<std::uint64_t> last_;
  std::uint64_t last_generation_ = 0;
  std::optional<std::pair<double, std::uint64_t>> best_;
  bool has_generations_ = false;
};

}  // namespace armwright
