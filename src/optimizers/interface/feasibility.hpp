// Feasibility first: of two designs the one that violates the constraints less is the better one,
// and where both violate them alike, in particular not at all, the one with the smaller objective.
// It needs no weight and no scale, but only serves optimizers that compare and never subtract.
// Source: Deb 2000, An efficient constraint handling method for genetic algorithms, section 3.
// Limits: violations are added up as they are, in whatever units the problem gives them. Nothing
// is learned of a design's objective as long as it violates a constraint, so that a search comes to
// an optimum on the limit from one side only.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "optimizers/interface/evaluator.hpp"

namespace armwright {

struct Fitness {
  double violation =
      0;  // sum of max(0, g); infinite where a failed evaluation tells no constraint values
  double objective = 0;  // calc_scalar()
};

Fitness calc_fitness(const ProblemDescription& problem, const Score& score);
bool is_fitter(const Fitness& a, const Fitness& b);

// The same order as one number, for optimizers that take numbers (Deb's equation 4): the objective
// f of a design that meets the constraints; of any other f_max + s v, with v its violation, s the
// problem's violation_scale, and f_max the largest objective seen so far, failed evaluations left
// out. Deviation: Deb's f_max is that of the designs at hand which meet the constraints; this one
// never falls, so that numbers of one generation can be held against those of the next.
class FeasibilityOrder {
 public:
  explicit FeasibilityOrder(const ProblemDescription& problem) : problem_(problem) {}

  std::vector<double> rate(std::span<const Score> scores);

 private:
  const ProblemDescription& problem_;
  double largest_objective_ = -std::numeric_limits<double>::infinity();
};

}  // namespace armwright
