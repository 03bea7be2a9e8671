// Which variables matter in a run: Sobol indices (study/statistics/sensitivity.hpp) of its
// objective, from the evaluations in its journal, or from simulations of a design of its own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/stop_signal.hpp"
#include "problems/interface/problem.hpp"
#include "study/run/run_observer.hpp"
#include "study/statistics/sensitivity.hpp"

namespace armwright {

// Where the points lie that an analysis is about.
enum class ImportanceRegion { run, winner, design };

// How an objective enters the analysis. A few large values would decide all variances, so an
// objective with a heavy tail counts as its logarithm or, if it is not positive, by its ranks.
enum class ValueScale { plain, logarithm, ranks };

struct ImportancePart {
  ImportanceRegion region = ImportanceRegion::run;
  // The distance of the region's bounds from the winner, as a share of each variable's range
  // on its scale. Nothing for the whole run.
  std::optional<double> half_width = {};
  std::size_t points = 0;
  // For a model: the share of the variance that it explains, cross-validated, and its terms.
  std::optional<double> explained = {};
  ModelTerms terms = ModelTerms::linear;
  std::string judgement = {};                // a sentence: how far the numbers can be trusted
  std::vector<SobolIndices> variables = {};  // one per variable
};

struct Importance {
  Quantity objective;
  ValueScale scale = ValueScale::plain;
  std::size_t evaluations = 0;  // of the run that have an objective
  std::size_t left_out = 0;     // those that failed or lost a race
  std::vector<std::string> variables;
  std::vector<ImportancePart> parts;
  std::vector<std::string> notes;  // whole sentences, for example why a part is missing
};

// A model that explains less is said to explain too little.
inline constexpr double kEnoughExplained = 0.5;

// Analyses the recorded evaluations of the run in the folder, finished or not, over the whole run
// and near its winner; `problem` is the run's (load_problem_of_run). Simulates nothing. Costs up to
// two seconds for 20 variables. Throws Error{io} if the journal cannot be read, and Error{bad_data}
// if it or the result is damaged.
Importance calc_importance(const std::filesystem::path& folder, const ProblemDescription& problem);

// Adds a part that needs no model: simulates at most `simulations` test cases, on `jobs` threads,
// of a design around the winner, on the first training cases of the run. Returns false if stopped.
// Throws Error{usage} if `simulations` is too small, with the least number, and if nothing can
// simulate the problem.
bool add_simulated_importance(const std::filesystem::path& folder, const Problem& problem,
                              std::int64_t simulations, unsigned jobs, StopSignal& stop,
                              RunObserver& observer, Importance& importance);

std::string to_json(const Importance& importance);

// Return the words for texts and pages: "near the winner: within 10 % of each range",
// "ln(objective)".
std::string describe_region(const ImportancePart& part);
std::string describe_scale(const Importance& importance);

}  // namespace armwright
