// Decides when a run of CMA-ES cannot improve any more and the next one may begin. Source: Hansen
// 2016 (the tutorial, arXiv:1604.00772), appendix B.3. The limit on generations, 100 + 150 (n +
// 3)^2 / sqrt(lambda), is pycma's (Hansen, option maxiter).
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "optimizers/cma/cma_distribution.hpp"

namespace armwright {

struct CmaTolerances {
  double function = 1e-12;  // TolFun: range of the best values of the last generations
  double step = 1e-12;      // TolX: share of the initial sigma
};

// The criteria, as the tutorial names them.
enum class CmaEnd {
  none,
  tol_hist_fun,
  equal_values,
  tol_x,
  tol_x_up,
  condition_cov,
  no_effect_axis,
  no_effect_coord,
  stagnation,
  generations
};

// Returns the criterion in a few words.
const char* describe(CmaEnd end);

class CmaTermination {
 public:
  // `discrete` has one entry per coordinate; without entries all are real. A discrete coordinate
  // does not end the run by the size of its steps, which the margin keeps large enough.
  CmaTermination(const CmaParameters& parameters, const CmaTolerances& tolerances, double sigma,
                 std::vector<bool> discrete = {});

  // Call this once after every update. `sorted_values` are the values of the generation, the best
  // first. Returns the criterion that ends the run, or none.
  CmaEnd check(const CmaDistribution& distribution, std::span<const double> sorted_values);

 private:
  CmaEnd check_values(std::span<const double> sorted_values) const;
  CmaEnd check_distribution(const CmaDistribution& distribution) const;
  bool is_stagnating() const;

  CmaTolerances tolerances_;
  double initial_sigma_;
  std::vector<bool> discrete_;
  std::size_t short_history_;
  std::size_t long_history_;
  std::int64_t generation_limit_;
  std::vector<double> best_;
  std::vector<double> median_;
};

}  // namespace armwright
