// CMA-ES from beginning to end (Hansen 2016, The CMA Evolution Strategy: A Tutorial): generation
// after generation of cma_distribution.hpp in the box of cma_box.hpp, begun again with larger
// populations (Auger and Hansen 2005) or larger and smaller ones in turn (Hansen 2009) when
// cma_termination.hpp says that it has converged.
#pragma once

#include <cstdint>

#include "optimizers/cma/cma_distribution.hpp"
#include "optimizers/cma/cma_termination.hpp"
#include "optimizers/interface/evaluator.hpp"

namespace armwright {

enum class CmaRestarts { none, ipop, bipop };

struct CmaSearchSettings {
  CmaSettings cma;
  std::size_t batch_multiple = 1;  // populations are rounded up to a multiple of it
  double sigma = 0;                // initial standard deviation, share of the box
  double restart_sigma = 0;        // likewise, of restarts
  CmaRestarts restarts = CmaRestarts::none;
  bool uncertainty_handling = false;  // cma_uncertainty.hpp
  CmaTolerances tolerances;
  bool feasibility_first = false;  // feasibility.hpp; otherwise calc_merit() with the weight
  double constraint_weight = 0;
};

// Returns when the evaluator has stopped or the strategy has converged for the last time.
// Error{usage} if there are to be more points of positive weight than points.
void search_with_cma(const CmaSearchSettings& settings, Evaluator& evaluator, std::uint64_t seed);

}  // namespace armwright
