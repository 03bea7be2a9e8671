// The plan of a run: everything that determines its result, namely problem, optimizer with its
// options, seed, budget, schedule, racing, and the selection of candidates for the winner.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "optimizers/interface/optimizer.hpp"
#include "problems/config/problem_loader.hpp"

namespace armwright {

// The candidates that are judged on the validation set. The best of them there is the winner, and
// is evaluated on the test set.
struct Selection {
  int last = 40;  // the last N different incumbents and recommendations; with training cases that
                  // change, the last N bests of generations and recommendations
  int best = 5;   // the N with the best training objective besides
  // The places of the pool: at most this many candidates are judged, recommendations included. If
  // there are more, the oldest of the last ones lose their places.
  int most = 45;
  // Whether recommended decision vectors that were never evaluated are not judged. This holds for
  // ask and tell, where a person or another system makes each evaluation.
  bool evaluated_only = false;

  bool operator==(const Selection&) const = default;
};

struct RunPlan {
  LoadedProblem problem;
  OptimizerRow optimizer;
  Options options;
  std::uint64_t seed = 1;
  std::int64_t budget = 0;  // simulated training cases
  Schedule schedule;
  Racing racing;
  Selection selection;
};

// Returns whether an optimizer can work on the training cases of a schedule. Cases that change need
// generations; those that grow need these or the capability `growing`.
bool takes_schedule(const OptimizerRow& optimizer, const Schedule& schedule);

// Returns the problem's own schedule. If the optimizer cannot take that, returns the schedule
// of the first `fixed_cases` cases for every candidate.
Schedule choose_schedule(const LoadedProblem& problem, const OptimizerRow& optimizer);

// Returns whether the optimizer gets residuals. For others they are neither made nor recorded.
bool wants_residuals(const OptimizerRow& optimizer);

// Returns whether candidates can race under an optimizer. Optimizers that use residuals need all
// cases. Halving also needs batches that are generations or samples: the points of a difference
// quotient do not compete.
bool can_race(const OptimizerRow& optimizer, Racing::Kind kind);
// Returns why racing has no effect; empty if it has one or if the racing kind is none.
std::string explain_no_race(const OptimizerRow& optimizer, const Racing& racing,
                            const Schedule& schedule);

// Returns why a larger budget does not continue a run of this plan: its evaluations would not be the
// first ones of a run that had the larger budget from the beginning. Returns an empty text if it
// continues the run.
std::string explain_no_continuation(const RunPlan& plan);

// Checks that optimizer, schedule, racing, problem and budget fit together. Throws Error{usage}.
void check_plan(const RunPlan& plan);

// Returns the plan as JSON text with sorted keys. Equal texts give bit-identical runs on the same
// machine with the same version.
std::string to_json(const RunPlan& plan);
// Reads run.schedule of that text. Throws nlohmann::json::exception.
Schedule read_recorded_schedule(const nlohmann::json& schedule);

// Returns the name of the run: "q1-complex-ga-seed1".
std::string make_run_name(const RunPlan& plan);
// Returns the name of the run's default folder: the name of the run and, if the user has set anything
// that changes the result, a suffix that differs for different settings. It has their keys and values,
// "q1-complex-ga-seed1-engine_ode-population50-fixed10", or eight hexadecimal digits of their SHA-256
// if that would be long or ambiguous. `settings` are the KEY=VALUE texts that override the problem's.
// Seed and budget have no part in the suffix.
std::string make_folder_name(const RunPlan& plan, std::span<const std::string> settings);

}  // namespace armwright
