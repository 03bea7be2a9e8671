// Runs one algorithm of NLopt (Johnson 2007, The NLopt nonlinear-optimization
// package) on an Evaluator. Only its .cpp file includes nlopt.h.
//
// NLopt works in SearchSpace coordinates u. It gets the box, a start, and f(u): the merit with
// penalised constraints, or, for an algorithm that takes constraints, the objective and g(u) <= 0
// separately. With linear variables and restarts = 0 it evaluates the same points as NLopt alone
// with the same settings and the seed fold_seed(seed). An algorithm that takes gradients gets finite
// differences, each point of which is an evaluation (differences.hpp).
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "optimizers/interface/differences.hpp"
#include "optimizers/interface/evaluator.hpp"

namespace armwright {

struct NloptSettings {
  std::string optimizer;           // "nlopt:cobyla", for messages
  std::string algorithm;           // NLopt's own name without its prefix: "LN_COBYLA"
  std::string local = {};          // the same of its local optimizer; empty: it has none
  bool takes_constraints = false;  // NLopt gets the constraints separately
  std::optional<DifferenceSettings> differences = {};  // NLopt gets gradients
  bool is_paced = false;        // NLopt gets the number of evaluations, to allocate its storage
  double initial_step = 0;      // share of the box; 0: NLopt chooses
  double xtol_rel = 0;          // ends when a step is smaller than this times |u|; 0: never
  double ftol_rel = 0;          // ends when a change is smaller than this times |f|; 0: never
  std::int64_t population = 0;  // 0: NLopt chooses
  std::int64_t restarts = 0;
  bool tolerances_are_local = false;  // the tolerances apply only to runs of the local optimizer
  double constraint_weight = 0;
};

// Returns why this build has no NLopt; empty if it has.
std::string explain_missing_nlopt();

// Minimises. Returns when the evaluator has stopped or NLopt has ended. Throws every exception of
// the evaluator, and OptimizerFailure if NLopt refuses the settings or fails.
void minimize_with_nlopt(const NloptSettings& settings, Evaluator& evaluator, std::uint64_t seed);

}  // namespace armwright
