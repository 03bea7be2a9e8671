// The instances of functions of BBOB, the Black-Box Optimization Benchmarking functions of the COCO
// platform. Source: Hansen, Finck, Ros and Auger 2009, Real-parameter black-box optimization
// benchmarking 2009: noiseless functions definitions (INRIA RR-6829).
//
// With d = x - x_opt, i = 1..n, the orthogonal matrices R and Q, and the maps T_osz, T_asy and
// L = diag(10^((i-1)/(n-1)/2)) of the source, z is
//   f1   d                                the value is the sum `sphere` over z, plus f_opt
//   f2   T_osz(d)                         `ellipsoid`
//   f3   L T_asy(T_osz(d))                `rastrigin`
//   f8   max(1, sqrt(n)/8) d              `rosenbrock`; x_opt lies in [-3, 3]^n
//   f10  T_osz(R d)                       `ellipsoid`
//   f15  R L Q T_asy(T_osz(R d))          `rastrigin`
// x_opt, f_opt, R and Q are those of the reference code for the same instance number. The test
// Bbob.ValuesAreThoseOfTheReferenceCode compares values.
#pragma once

#include <cstddef>

#include "problems/analytic/function_instance.hpp"

namespace armwright {

// Returns instance `number` >= 1 of BBOB's function `function` (1, 2, 3, 8, 10 or 15) in 2 to 40
// dimensions.
FunctionInstance make_bbob_instance(int function, std::size_t dimension, int number);

}  // namespace armwright
