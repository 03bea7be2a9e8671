#include "optimizers/cma/cma_margin.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace armwright {
namespace {

// Returns the probability that a standard normal number exceeds x.
double calc_exceedance(double x) {
  return 0.5 * std::erfc(x / std::numbers::sqrt2);
}

}  // namespace

double calc_normal_excess(double probability) {
  assert(probability > 0 && probability <= 0.5);
  // Newton's method on the logarithm of the exceedance, which is concave. The first x is Chernoff's
  // bound, which is too large, so every step goes down and none goes too far.
  const double target = std::log(probability);
  double x = std::sqrt(std::max(0.0, -2 * std::log(2 * probability)));
  for (int i = 0; i < 50; ++i) {
    const double exceedance = calc_exceedance(x);
    const double density = std::exp(-0.5 * x * x) * std::numbers::inv_sqrtpi / std::numbers::sqrt2;
    const double step = (std::log(exceedance) - target) * exceedance / density;
    const double next = std::max(0.0, x + step);
    if (!(next < x)) {
      break;
    }
    x = next;
  }
  return x;
}

CmaMarginal correct_margin(const CmaMarginal& marginal, double deviation, const CmaCell& cell,
                           double alpha) {
  assert(alpha > 0 && alpha <= 0.5);
  const double mean = marginal.mean;
  const double s = std::max(marginal.scale * deviation, 1e-300);
  // By a rounding, the mean may lie just outside its cell.
  const double below = calc_exceedance(std::max(0.0, mean - cell.lower) / s);
  const double above = calc_exceedance(std::max(0.0, cell.upper - mean) / s);
  const bool has_lower = std::isfinite(cell.lower);
  const bool has_upper = std::isfinite(cell.upper);
  if (has_lower && has_upper) {
    const double least = alpha / 2;
    if (below >= least && above >= least) {
      return marginal;
    }
    const double raised_below = std::max(below, least);
    const double raised_above = std::max(above, least);
    const double sum = raised_below + raised_above + (1 - below - above);
    const double share = (1 - sum) / (sum - 3 * least);
    const double q_below = calc_normal_excess(raised_below + share * (raised_below - least));
    const double q_above = calc_normal_excess(raised_above + share * (raised_above - least));
    const double q_sum = q_below + q_above;
    return {.mean = (cell.lower * q_above + cell.upper * q_below) / q_sum,
            .scale = (cell.upper - cell.lower) / (q_sum * std::max(deviation, 1e-300))};
  }
  if (has_lower && below < alpha) {
    return {.mean = cell.lower + calc_normal_excess(alpha) * s, .scale = marginal.scale};
  }
  if (has_upper && above < alpha) {
    return {.mean = cell.upper - calc_normal_excess(alpha) * s, .scale = marginal.scale};
  }
  return marginal;
}

}  // namespace armwright
