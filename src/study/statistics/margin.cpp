#include "study/statistics/margin.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace armwright {
namespace {

// Returns the number before the logarithm. A finite value stays finite.
double remove_logarithm(const Margin& margin, double value) {
  const bool is_plain = !margin.logarithm || !std::isfinite(value);
  return is_plain ? value : std::min(std::exp(value), std::numeric_limits<double>::max());
}

}  // namespace

bool Margin::is_equal(double a, double b) const {
  return a == b || std::abs(remove_logarithm(*this, a) - remove_logarithm(*this, b)) <= resolution;
}

double Margin::round(double value) const {
  const double plain = remove_logarithm(*this, value);
  const double origin = optimum ? remove_logarithm(*this, *optimum) : 0;
  const double above = plain - origin;
  if (optimum && std::abs(above) <= resolution) {
    return origin;
  }
  // From 2^52 resolutions on, the spacing of numbers is at least one resolution.
  if (resolution == 0 || !(std::abs(above) < std::ldexp(resolution, 52))) {
    return plain;
  }
  return origin + std::round(above / resolution) * resolution;
}

bool Margin::is_success(double value) const {
  return std::isfinite(value) && (!optimum || remove_logarithm(*this, value) <=
                                                  remove_logarithm(*this, *optimum) + resolution);
}

}  // namespace armwright
