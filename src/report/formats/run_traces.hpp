// Reads what the exports write: the runs in the folder of a run or of a study, and every training
// evaluation of each run from its journal.
//
// A study's folder holds cells/PROBLEM/LABEL/REPLICATE. Each of these is the folder of a run. A
// finished cell has a file cell.json with the cell's true names; the names of the folders are
// escaped.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "problems/interface/problem.hpp"
#include "report/formats/recorded_function.hpp"

namespace armwright {

// A run that can be exported.
struct RunEntry {
  std::filesystem::path folder;
  std::string problem;
  std::string label;      // of the optimizer with its options; the optimizer's name for one run
  std::string optimizer;  // "ga"
  std::uint64_t replicate = 1;
  std::size_t problem_place = 0;  // of the problem in the study's plan, from 0; 0 without a plan
};

// The runs of a folder.
struct FoundRuns {
  std::vector<RunEntry> runs;  // sorted by problem, label and replicate
  std::size_t unfinished = 0;  // cells without cell.json
};

// Throws Error{usage} if the folder is neither a run's nor a study's, or holds no finished run, or
// if its study.toml cannot be used; Error{bad_data} if a cell.json cannot be used or two of them
// name the same cell.
FoundRuns find_runs(const std::filesystem::path& folder);

// A training evaluation, with its place in the run.
struct TracedEvaluation {
  std::uint64_t number = 0;           // from 1
  std::uint64_t simulated_cases = 0;  // of the budget, up to and including this evaluation
  EvaluationStatus status = EvaluationStatus::ok;
  std::string reason;
  bool feasible = false;
  std::optional<double> objective;  // the weighted sum if there are several; empty if there is none
  std::vector<double> objectives;
  std::vector<double> constraint_values;
  std::vector<double> metrics;
  std::vector<double> x;
  std::vector<double> proposed;  // EvaluationRecord::proposed
};

// The evaluations of a run, in their order. Each visit reads them from the journal again, one at a
// time, because they may not all fit into the memory.
class TracedEvaluations {
 public:
  using Visitor = std::function<void(const TracedEvaluation&)>;
  using Source = std::function<void(const Visitor&)>;  // calls the visitor for every evaluation

  TracedEvaluations() = default;              // no evaluations
  explicit TracedEvaluations(Source source);  // calls the source once

  void visit(const Visitor& visitor) const;
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  // These three are empty if there is no such evaluation. best() is the earliest of the feasible
  // evaluations with the least objective.
  const std::optional<TracedEvaluation>& first() const { return first_; }
  const std::optional<TracedEvaluation>& last() const { return last_; }
  const std::optional<TracedEvaluation>& best() const { return best_; }

 private:
  Source source_;
  std::size_t size_ = 0;
  std::optional<TracedEvaluation> first_;
  std::optional<TracedEvaluation> last_;
  std::optional<TracedEvaluation> best_;
};

// The names of an evaluation's numbers.
struct TraceNames {
  std::vector<std::string> variables;
  std::vector<std::string> objectives;
  std::vector<std::string> metrics;
  // The discrete variables with the words of a category, or with none for an integer.
  std::map<std::string, std::vector<std::string>> discrete = {};
  bool operator==(const TraceNames&) const = default;
};

// The first `count` cases of a set.
struct UsedCases {
  std::string set;
  std::uint64_t count = 0;
};

// Everything that an export says about one run.
struct RunTrace {
  RunEntry run;
  RecordedFunction function;
  std::uint64_t seed = 0;
  std::string end_reason;
  bool tracking = false;
  TraceNames names;
  TracedEvaluations evaluations;
  // These four are empty if the run has no winner.
  std::optional<UsedCases> tested_on;    // the winner's test cases
  std::optional<double> test_objective;  // also empty if the test gave no objective
  std::optional<Evaluation> test;
  std::vector<double> winner;  // the decision vector
};

// Throws what load_result(), read_function() and read_journal() throw. Visiting the evaluations throws
// Error{bad_data} if the journal and result.json belong to different runs.
RunTrace read_trace(const RunEntry& run);

// All runs on one problem, and the numbers that need all of them.
struct ProblemRuns {
  std::string name;
  std::size_t place = 0;      // RunEntry::problem_place
  RecordedFunction function;  // of the first run
  TraceNames names;
  bool tracking = false;
  std::size_t constraints = 0;         // per evaluation
  std::optional<double> best;          // the least objective of all feasible evaluations
  RunEntry best_run;                   // the first run that found it
  std::optional<double> worst;         // the largest
  std::optional<UsedCases> tested_on;  // the largest part of the set that a run used
  std::map<std::string, std::vector<RunEntry>> labels;  // the runs of each label
};

// The runs that an export writes.
struct CollectedRuns {
  std::vector<ProblemRuns> problems;  // sorted by name
  std::size_t runs = 0;
  std::size_t evaluations = 0;
  std::size_t empty = 0;  // runs without any evaluation, which are left out
};

// Reads each of the runs once; they are sorted as find_runs() sorts them. Throws Error{bad_data} if
// two runs on one problem have different variables, objectives or metrics, or were tested on
// different sets; Error{usage} if no run has an evaluation.
CollectedRuns collect_runs(const std::vector<RunEntry>& runs);

// Returns the labels of all problems, sorted.
std::vector<std::string> list_labels(const CollectedRuns& runs);

}  // namespace armwright
