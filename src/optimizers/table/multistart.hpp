// A local optimizer that is started again until the budget is spent: first from the problem's
// start, then from random points. On a function with many minima, the probability to find the
// global one approaches 1 with the number of starts (Rinnooy Kan and Timmer 1987, Stochastic global
// optimization methods).
//
// The new starts are uniform in a box around the problem's start, on each variable's own scale. The
// option `spread` sets its size: it reaches from start - spread (start - lower) to start + spread
// (upper - start).
#pragma once

#include "optimizers/interface/optimizer.hpp"

namespace armwright {

// Returns the row "multistart:INNER" with the options of INNER and two more. Throws Error{usage} if
// INNER is not local.
OptimizerRow make_multistart_row(const OptimizerRow& inner);

}  // namespace armwright
