// The margin within which two values count as equal. Without it, rounding noise of 1e-16 decides
// comparisons between optimizers that have all solved the problem.
#pragma once

#include <optional>

namespace armwright {

// The equality of the values of one problem. Values are to be minimised; +infinity is a run without
// a value and equals only itself.
struct Margin {
  // Two values whose difference is at most this count as equal. In the unit of the values, or, if
  // they are logarithms, of the numbers before the logarithm. 0 if every difference counts.
  double resolution = 0;
  bool logarithm = false;              // values are natural logarithms
  std::optional<double> optimum = {};  // the smallest value there is, if it is known

  // Returns true if the difference of a and b is at most the resolution. This relation is not
  // transitive, so it suits pairs only.
  bool is_equal(double a, double b) const;
  // Returns the value, without its logarithm, rounded to a multiple of the resolution. Multiples are
  // counted from the optimum, or from 0 if it is not known. Values within one resolution of the
  // optimum become the optimum. Equality of the results is transitive, as ranks need it.
  double round(double value) const;
  // Returns true if the value is finite and, if the optimum is known, at most one resolution above
  // it.
  bool is_success(double value) const;
};

}  // namespace armwright
