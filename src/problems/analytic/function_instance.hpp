// Instances of analytic functions: where the minimiser lies, and how the function is turned. An
// instance is a pure function of the function's name, the dimension and the instance's number.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "problems/analytic/analytic.hpp"

namespace armwright {

struct FunctionInstance {
  // Writes the z of a decision vector x. Both have n numbers and do not overlap. Thread-safe.
  std::function<void(std::span<const double> x, std::span<double> z)> calc_z;
  std::vector<double> minimiser;  // the x whose z is 0
  double f_opt = 0;               // is added to the value
};

// Returns the plain form: z = x - s (analytic.hpp).
FunctionInstance make_plain_instance(const AnalyticFunction& function, std::size_t dimension);

// Returns instance `number` >= 1 of one of our own functions: z = Q (x - s) with s uniform in
// [-4, 4]^n, rounded for integer variables. Q is a random orthogonal matrix, and the identity if the function is not rotated. s
// and Q have the same bits on every machine. Cost of one z: 2 n^2 multiplications if rotated.
FunctionInstance make_random_instance(const AnalyticFunction& function, std::size_t dimension,
                                      int number);

}  // namespace armwright
