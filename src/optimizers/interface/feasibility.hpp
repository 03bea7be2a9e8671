// Comparison of designs by feasibility first. Of two designs, the one with the smaller constraint
// violation is better. If both violations are equal (often zero), the one with the smaller
// objective is better. is_fitter() needs no weight and no scale, and serves optimizers that only
// compare designs. FeasibilityOrder serves those that need numbers; it needs the problem's scale of
// violations. Source: Deb 2000, An efficient constraint handling method for genetic algorithms,
// section 3. Limitations: violations are added in the units that the problem gives them. As long as
// a design violates a constraint, its objective is ignored; so a search reaches an optimum on a
// limit from one side only. A run selects its winner in an order of its own
// (study/run/winner_selection.hpp).
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "optimizers/interface/evaluator.hpp"

namespace armwright {

struct Fitness {
  // The sum of max(0, g); infinite for a failed evaluation without constraint values.
  // FeasibilityOrder replaces infinity by a large number.
  double violation = 0;
  double objective = 0;  // calc_scalar()
};

Fitness calc_fitness(const ProblemDescription& problem, const Score& score);
bool is_fitter(const Fitness& a, const Fitness& b);

// The same order as one number per design, for optimizers that need numbers (Deb's equation 4):
//   a feasible design:  f
//   any other design:   f_max + s v
// f is the objective, v the violation, s the problem's violation_scale, and f_max the largest
// objective so far without failed evaluations. Deviation from Deb: his f_max is the largest of the
// feasible designs at hand. This f_max never falls, so that numbers of two generations can be
// compared.
class FeasibilityOrder {
 public:
  explicit FeasibilityOrder(const ProblemDescription& problem) : problem_(problem) {}

  // Returns one number per score, in the order of the scores. Smaller is better.
  std::vector<double> rate(std::span<const Score> scores);

 private:
  const ProblemDescription& problem_;
  double largest_objective_ = -std::numeric_limits<double>::infinity();
};

}  // namespace armwright
