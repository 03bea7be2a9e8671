// Runs one gradient-free algorithm of NLopt (Johnson 2007, The NLopt nonlinear-optimization
// package) on an Evaluator. The only place that knows nlopt.h.
//
// NLopt works in SearchSpace coordinates u and is told f(u) (the merit with penalised constraints,
// or the objective and g(u) <= 0 apart where the algorithm takes constraints), the box and a start.
// For linear variables and restarts = 0 it asks for the very points that the bare library asks for
// with the same settings, seeded with fold_seed(seed) (seed.hpp).
#pragma once

#include <cstdint>
#include <string>

#include "optimizers/interface/evaluator.hpp"

namespace armwright {

struct NloptSettings {
  std::string optimizer;           // "nlopt:cobyla", for messages
  std::string algorithm;           // NLopt's own name without its prefix: "LN_COBYLA"
  std::string local = {};          // likewise, of the local optimizer inside; empty: has none
  bool takes_constraints = false;  // NLopt is told the constraints apart
  bool is_paced = false;           // storage is by the number of evaluations: tell NLopt how many
  double initial_step = 0;         // share of the box; 0: what NLopt finds by itself
  double xtol_rel = 0;             // ends when a step is smaller than this times |u|; 0: never
  double ftol_rel = 0;             // ends when a change is smaller than this times |f|; 0: never
  std::int64_t population = 0;     // 0: NLopt's own
  std::int64_t restarts = 0;
  bool tolerances_are_local = false;  // the tolerances end the local optimizer's runs only
  double constraint_weight = 0;
};

// Empty, or why there is no NLopt here.
std::string explain_missing_nlopt();

// Returns when the evaluator has stopped or NLopt has nothing more to try. Throws what the
// evaluator throws, and OptimizerFailure when NLopt refuses or fails.
void minimize_with_nlopt(const NloptSettings& settings, Evaluator& evaluator, std::uint64_t seed);

}  // namespace armwright
