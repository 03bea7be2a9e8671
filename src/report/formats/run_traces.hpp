// What the exports read: the runs in a run's folder or a study's, and of each run every evaluation
// of its training, from its journal.
//
// A study's folder holds cells/PROBLEM/LABEL/REPLICATE, each the folder of a run and, once the cell
// has finished, with a file cell.json that tells the cell's true names; those of the folders are
// escaped.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "problems/interface/problem.hpp"

namespace armwright {

struct RunEntry {
  std::filesystem::path folder;
  std::string problem;
  std::string label;      // of the optimizer with its options; of a single run the optimizer
  std::string optimizer;  // "ga"
  std::uint64_t replicate = 1;
};

struct FoundRuns {
  std::vector<RunEntry> runs;  // by problem, label and replicate
  std::size_t unfinished = 0;  // cells without cell.json
};

// Error{usage} if the folder is neither a run's nor a study's or nothing in it has finished;
// Error{bad_data} for a cell.json that cannot be used, or two that say the same.
FoundRuns find_runs(const std::filesystem::path& folder);

struct TracedEvaluation {
  std::uint64_t number = 0;           // from 1
  std::uint64_t simulated_cases = 0;  // of the budget, this one's included
  EvaluationStatus status = EvaluationStatus::ok;
  std::string reason;
  bool feasible = false;
  std::optional<double> objective;  // several as their weighted sum; nothing if there is none
  std::vector<double> objectives;
  std::vector<double> constraint_values;
  std::vector<double> metrics;
  std::vector<double> x;
};

// A run's evaluations in their order. They are read from its journal one by one whenever somebody
// goes over them: there may be more of them than fit into the memory.
class TracedEvaluations {
 public:
  using Visitor = std::function<void(const TracedEvaluation&)>;
  using Source = std::function<void(const Visitor&)>;  // calls the visitor with each

  TracedEvaluations() = default;              // none
  explicit TracedEvaluations(Source source);  // goes over them once

  void visit(const Visitor& visitor) const;
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  // Nothing if there is none.
  const std::optional<TracedEvaluation>& first() const { return first_; }
  const std::optional<TracedEvaluation>& last() const { return last_; }
  const std::optional<TracedEvaluation>& best() const { return best_; }  // feasible, the earliest

 private:
  Source source_;
  std::size_t size_ = 0;
  std::optional<TracedEvaluation> first_;
  std::optional<TracedEvaluation> last_;
  std::optional<TracedEvaluation> best_;
};

struct TraceNames {
  std::vector<std::string> variables;
  std::vector<std::string> objectives;
  std::vector<std::string> metrics;
  bool operator==(const TraceNames&) const = default;
};

// The first N cases of a set.
struct UsedCases {
  std::string set;
  std::uint64_t count = 0;
};

struct RunTrace {
  RunEntry run;
  std::uint64_t seed = 0;
  std::string end_reason;
  bool tracking = false;
  TraceNames names;
  TracedEvaluations evaluations;
  std::optional<UsedCases> tested_on;    // what the winner was tested on, if there is one
  std::optional<double> test_objective;  // its objective there, if it has one
  std::optional<Evaluation> test;        // and how it did there
  std::vector<double> winner;            // empty if there is none
};

RunTrace read_trace(const RunEntry& run);

struct LabelRuns {
  std::string label;
  std::vector<RunEntry> runs;
};

// All runs on one problem, with what is known only when all have been read.
struct ProblemRuns {
  std::string name;
  TraceNames names;
  bool tracking = false;
  std::size_t constraints = 0;         // how many an evaluation has
  std::optional<double> best;          // of all feasible evaluations
  std::optional<double> worst;         // likewise
  std::optional<UsedCases> tested_on;  // the most that a run used of the set
  std::vector<LabelRuns> labels;
};

struct Survey {
  std::vector<ProblemRuns> problems;  // by name
  std::size_t runs = 0;
  std::size_t evaluations = 0;
  std::size_t empty = 0;  // runs without any evaluation, which are left out
};

// Reads all runs once. Error{bad_data} if two runs on one problem have other variables, objectives
// or metrics, or were tested on other sets; Error{usage} if no run has an evaluation.
Survey survey_runs(const std::vector<RunEntry>& runs);

// Of all problems, sorted.
std::vector<std::string> list_labels(const Survey& survey);

}  // namespace armwright
