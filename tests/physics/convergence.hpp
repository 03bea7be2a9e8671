// Estimates the limit of a first-order method, and the error of that estimate.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <functional>

#include "base/decompositions.hpp"

namespace armwright::physics_test {

// Richardson's extrapolation of results S(h) = S + a h^p + b h^(p+1) + ... of a method of order p
// at the steps h, h/2 and h/4: the first level, (2^p S(h/2) - S(h)) / (2^p - 1), is off by
// O(h^(p+1)), the second by O(h^(p+2)).
struct Limit {
  Eigen::VectorXd value;   // second level
  double error = 0;        // change of the first level: bounds the second level's error
  double order = 0;        // log2 |S(h) - S(h/2)| / |S(h/2) - S(h/4)|: p, up to O(h)
  Eigen::VectorXd finest;  // S(h/4)
};

// `simulate` takes the count of steps for a fixed span of time.
inline Limit extrapolate(const std::function<Eigen::VectorXd(int)>& simulate, int steps,
                         int order = 1) {
  const Eigen::VectorXd s1 = simulate(steps), s2 = simulate(2 * steps), s4 = simulate(4 * steps);
  const double first = std::exp2(order), second = std::exp2(order + 1);
  const Eigen::VectorXd coarse = (first * s2 - s1) / (first - 1);
  const Eigen::VectorXd fine = (first * s4 - s2) / (first - 1);
  Limit limit;
  limit.value = (second * fine - coarse) / (second - 1);
  limit.error = (fine - coarse).norm();
  limit.order = std::log2((s1 - s2).norm() / (s2 - s4).norm());
  limit.finest = s4;
  return limit;
}

// Tolerance of the order that is measured at finite steps. The next term of the series changes log2
// of the ratio by about b h / a, and the steps of these tests keep it below this value.
constexpr double kOrderTolerance = 0.2;

}  // namespace armwright::physics_test
