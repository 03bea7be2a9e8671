// The probe of `auto`: a few evaluations along straight lines through the box, which tell a smooth
// objective from a rugged one. A sum of squares of smooth residuals has one or two minima along a
// line, a rugged function has many.
#pragma once

#include <cstdint>

#include "optimizers/interface/evaluator.hpp"

namespace armwright {

// Returns whether the probe has found more minima along a line than smooth functions have. It
// evaluates one batch of at most 5 % of the `planned` evaluations: two lines between random points of
// the box, each with at most 25 points at equal distances. With too few evaluations for 10 points
// per line, it evaluates nothing and returns false. Failed evaluations count as the largest values.
bool is_rugged(Evaluator& evaluator, std::uint64_t seed, std::int64_t planned);

}  // namespace armwright
