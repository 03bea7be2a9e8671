#include "optimizers/turbo/box_descent.hpp"

#include <algorithm>
#include <cmath>
#include <deque>

namespace armwright {
namespace {

constexpr std::size_t kKeptPairs = 8;

struct Pair {
  Eigen::VectorXd step;
  Eigen::VectorXd change;  // of the gradient
  double curvature = 0;    // their product, positive
};

// Returns -H g by the two-loop recursion.
Eigen::VectorXd calc_direction(const std::deque<Pair>& pairs, Eigen::VectorXd q) {
  std::vector<double> factors(pairs.size());
  for (std::size_t k = pairs.size(); k-- > 0;) {
    factors[k] = pairs[k].step.dot(q) / pairs[k].curvature;
    q -= factors[k] * pairs[k].change;
  }
  if (!pairs.empty()) {
    q *= pairs.back().curvature / pairs.back().change.squaredNorm();
  }
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    q += (factors[k] - pairs[k].change.dot(q) / pairs[k].curvature) * pairs[k].step;
  }
  return -q;
}

}  // namespace

double descend_in_box(const SmoothFunction& function, const Box& box, int iterations,
                      Eigen::VectorXd& x) {
  constexpr double kArmijo = 1e-4;
  constexpr int kMostCuts = 20;
  Eigen::VectorXd gradient(x.size());
  double value = function(x, gradient);
  std::deque<Pair> pairs;
  for (int iteration = 0; iteration < iterations; ++iteration) {
    const auto held = ((x.array() <= box.lower.array()) && (gradient.array() > 0)) ||
                      ((x.array() >= box.upper.array()) && (gradient.array() < 0));
    const Eigen::VectorXd free = held.select(0, gradient);
    Eigen::VectorXd direction = held.select(0, calc_direction(pairs, free));
    if (!(direction.dot(free) < 0)) {
      pairs.clear();
      direction = -free;
    }
    const double longest = direction.lpNorm<Eigen::Infinity>();
    if (!(longest > 0)) {
      break;
    }
    // Without curvature the length of the gradient means nothing: begin with a tenth of the box.
    double share =
        pairs.empty() ? std::min(1.0, 0.1 * (box.upper - box.lower).maxCoeff() / longest) : 1;
    Eigen::VectorXd next;
    Eigen::VectorXd next_gradient(x.size());
    double next_value = value;
    bool is_lower = false;
    for (int cut = 0; cut < kMostCuts && !is_lower; ++cut, share *= 0.4) {
      next = (x + share * direction).cwiseMax(box.lower).cwiseMin(box.upper);
      next_value = function(next, next_gradient);
      is_lower =
          std::isfinite(next_value) && next_value <= value + kArmijo * gradient.dot(next - x);
    }
    if (!is_lower) {
      if (pairs.empty()) {
        break;
      }
      pairs.clear();
      continue;
    }
    Pair pair{.step = next - x, .change = next_gradient - gradient};
    pair.curvature = pair.step.dot(pair.change);
    if (pair.curvature > 1e-10 * pair.step.norm() * pair.change.norm()) {
      pairs.push_back(std::move(pair));
      if (pairs.size() > kKeptPairs) {
        pairs.pop_front();
      }
    }
    const double gain = value - next_value;
    x = next;
    gradient = next_gradient;
    value = next_value;
    if (gain <= std::max(1e-9 * std::abs(value), 1e-12)) {
      break;
    }
  }
  return value;
}

}  // namespace armwright
