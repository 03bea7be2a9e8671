// A local optimizer, started again and again until the budget is spent: first from the problem's
// start, then from random points. Where there are many valleys this finds the deep one with
// certainty in the limit (Rinnooy Kan and Timmer 1987, Stochastic global optimization methods).
//
// The new starts are uniform in the box, shrunk towards the problem's start by the option `spread`:
// from start - spread (start - lower) to start + spread (upper - start) on each variable's own
// scale.
#pragma once

#include "optimizers/interface/optimizer.hpp"

namespace armwright {

// "multistart:INNER", with INNER's options and two of its own. Error{usage} if INNER is not local.
OptimizerRow make_multistart_row(const OptimizerRow& inner);

}  // namespace armwright
