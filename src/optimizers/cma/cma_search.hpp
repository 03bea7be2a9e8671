// The optimizer cmaes: the covariance matrix adaptation evolution strategy with active update,
// bounds, restarts and, on request, handling of noise (Hansen 2016, The CMA Evolution Strategy: A
// Tutorial). Each generation samples cma_distribution.hpp in the box of cma_box.hpp. Discrete
// variables get values of their type, and cma_margin.hpp keeps them from freezing. When
// cma_termination.hpp reports convergence, the strategy starts again: with larger populations
// (Auger and Hansen 2005), or with larger and smaller ones alternately (Hansen 2009). With a
// surrogate (cma_surrogate.hpp), only a few points of a generation are evaluated, and the first
// point of each generation is the minimum of the model.
#pragma once

#include <cstdint>
#include <vector>

#include "optimizers/cma/cma_distribution.hpp"
#include "optimizers/cma/cma_termination.hpp"
#include "optimizers/interface/evaluator.hpp"
#include "optimizers/interface/optimizer.hpp"

namespace armwright {

// Returns the row cmaes.
std::vector<OptimizerRow> make_cmaes_rows();

enum class CmaRestarts { none, ipop, bipop };

struct CmaSearchSettings {
  CmaSettings cma;
  std::size_t batch_multiple = 1;  // populations are rounded up to a multiple of it
  double sigma = 0;                // initial standard deviation, share of the box
  double restart_sigma = 0;        // the same for restarts
  CmaRestarts restarts = CmaRestarts::none;
  bool uncertainty_handling = false;  // cma_uncertainty.hpp
  CmaTolerances tolerances;
  bool surrogate = false;  // cma_surrogate.hpp
  bool feasibility_first =
      false;  // rank by feasibility.hpp; otherwise by calc_merit() with the weight
  double constraint_weight = 0;
};

// Minimises. Returns when the evaluator has stopped or the last restart has converged. Throws
// Error{usage} if mu exceeds the population.
void search_with_cma(const CmaSearchSettings& settings, Evaluator& evaluator, std::uint64_t seed);

}  // namespace armwright
