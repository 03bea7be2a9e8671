// The table of capabilities: for each its name, which plugins declare and lists show, and its
// meaning for a user.
#pragma once

#include <array>

#include "optimizers/interface/optimizer.hpp"

namespace armwright {

struct CapabilityRow {
  const char* name;
  bool Capabilities::*member;
  const char* with;     // what an optimizer with this capability does
  const char* without;  // what an optimizer without it does
};

inline constexpr std::array<CapabilityRow, 14> kCapabilityTable{{
    {"bounds", &Capabilities::bounds, "keeps its points within the bounds",
     "may propose points outside the bounds: the nearest point inside is evaluated"},
    {"constraints", &Capabilities::constraints, "sees the constraints apart from the objective",
     "does not know the constraints: if it has the option constraint_weight, their violation is "
     "added to the objective, otherwise it is ignored"},
    {"multi_objective", &Capabilities::multi_objective, "looks for the front of several objectives",
     "minimises one number: several objectives count as their weighted sum"},
    {"batch", &Capabilities::batch,
     "asks for several points at a time, which are simulated in parallel",
     "asks for one point at a time: only its test cases are simulated in parallel"},
    {"noisy", &Capabilities::noisy, "copes with values that change with the training cases",
     "treats every value as exact"},
    {"residuals", &Capabilities::residuals,
     "uses the residuals: the objective is the sum of their squares",
     "uses no residuals, only the objective"},
    {"stochastic", &Capabilities::stochastic,
     "uses random numbers: another --seed gives another run",
     "uses no random numbers: --seed has no influence"},
    {"generations", &Capabilities::generations,
     "works in generations: --schedule fresh:K gives each of them new training cases",
     "needs the same training cases throughout the run: --schedule fixed:K"},
    {"local", &Capabilities::local,
     "searches locally from the start and ends by itself: multistart:NAME restarts it elsewhere",
     "is no local search that ends by itself: multistart: does not accept it"},
    {"sampling", &Capabilities::sampling,
     "learns nothing from earlier evaluations: it is a baseline for the others",
     "learns from earlier evaluations"},
    {"paced", &Capabilities::paced,
     "plans with the whole budget: a larger budget changes the run from its beginning",
     "does not plan with the budget: a larger budget only makes the run longer"},
    {"integer", &Capabilities::integer, "proposes whole numbers for integer variables",
     "treats integer variables as real ones: the run rounds its points"},
    {"categorical", &Capabilities::categorical,
     "treats the words of a category as words without an order",
     "treats a category as the numbers of its words, in their order"},
    {"growing", &Capabilities::growing,
     "takes up more training cases along the run: --schedule growing:K:FACTOR",
     "takes up more training cases only if it works in generations"},
}};

}  // namespace armwright
