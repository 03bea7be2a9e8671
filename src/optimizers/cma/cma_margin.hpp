// The margin of CMA-ES with Margin: the least probability with which a sample of a discrete
// variable leaves the value that the mean stands for. Without it the step size shrinks with the
// real variables until no sample changes a discrete variable any more, whatever its value.
//
// A discrete coordinate is sampled as v = m + sigma a (B D z), with a scale a of its own, and the
// value whose cell contains v is evaluated. m and C are adapted with a = 1. The cell of m reaches
// from l to u. With s = a sigma sqrt(C_ii), the probability p_l = P(v <= l) and p_u = P(v > u):
//
//   both l and u finite   p'_l = max(p_l, alpha / 2), p'_u likewise, S = p'_l + p'_u + p_mid,
//                         p''_l = p'_l + (1 - S) / (S - 3 alpha / 2) (p'_l - alpha / 2),
//                         p''_u likewise, and m and a become the solution of
//                         m - l = q(p''_l) s, u - m = q(p''_u) s
//   one of them finite    if its probability is below alpha, m becomes the place at which it is
//                         alpha: at the distance q(alpha) s from it. a stays
//
// p_mid = 1 - p_l - p_u, q(p) is the number that a standard normal number exceeds with probability
// p, and alpha = 1 / (n lambda). The second line holds for the outermost values, so for both values
// of a binary variable. Source: Hamano, Saito, Nomura and Shirakawa 2022, CMA-ES with Margin:
// Lower-Bounding Marginal Probability for Mixed-Integer Black-Box Optimization (arXiv:2205.13482),
// section 4. The equation with 1 - S makes the three probabilities sum to 1 again.
#pragma once

namespace armwright {

// The cell of a value of a discrete coordinate: the values between two thresholds. The outermost
// values have an infinite one.
struct CmaCell {
  double lower = 0;
  double upper = 0;
};

// The mean of a discrete coordinate and the scale a of its samples.
struct CmaMarginal {
  double mean = 0;
  double scale = 1;
};

// Returns q(p) for p in (0, 0.5].
double calc_normal_excess(double probability);

// Returns the marginal distribution with the margin alpha, 0 < alpha <= 0.5. Returns `marginal` as
// it is if it has the margin. `deviation` is sigma sqrt(C_ii), without the scale.
CmaMarginal correct_margin(const CmaMarginal& marginal, double deviation, const CmaCell& cell,
                           double alpha);

}  // namespace armwright
