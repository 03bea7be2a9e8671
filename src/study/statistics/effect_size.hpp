// How large a difference is, whatever its significance.
#pragma once

#include <span>

namespace armwright {

// The probability that a value of a is smaller, and so better, than one of b, ties counting half:
// 1/2 is no difference, 1 all of a better than all of b. Source: Vargha, A. and Delaney, H. D.
// 2000, A critique and improvement of the CL common language effect size statistics of McGraw and
// Wong, Journal of Educational and Behavioral Statistics 25(2); theirs is of being larger. They
// call 0.56, 0.64 and 0.71 small, medium and large. Two infinities tie. Throws
// std::invalid_argument for no values, NaN and -infinity.
double calc_a12(std::span<const double> a, std::span<const double> b);

struct WinTieLoss {
  int wins = 0;  // pairs in which a is smaller
  int ties = 0;  // equal, two infinities included
  int losses = 0;
};

// a[i] and b[i] are a pair. Throws std::invalid_argument for unequal lengths, NaN and -infinity.
WinTieLoss count_wins(std::span<const double> a, std::span<const double> b);

}  // namespace armwright
