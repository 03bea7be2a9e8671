#include "optimizers/dfls/trust_step.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/decompositions.hpp"

namespace armwright {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Minimises |r + J s|^2 + lambda |s|^2 over a box. Keeps the active set between calls, since that
// of a slightly different lambda is almost the same.
class BoxedLeastSquares {
 public:
  BoxedLeastSquares(const MatrixXd& jacobian, const VectorXd& residuals, const StepBox& box)
      : jacobian_(jacobian),
        residuals_(residuals),
        box_(box),
        is_free_(static_cast<std::size_t>(jacobian.cols()), true),
        step_(VectorXd::Zero(jacobian.cols())) {}

  const VectorXd& solve(double lambda) {
    const Index n = jacobian_.cols();
    // The sum falls with every change of the active set, so no set returns. The limit protects
    // against rounding.
    for (Index change = 0; change < 20 * n + 100; ++change) {
      const VectorXd target = solve_free(lambda);
      const Index blocking = move_towards(target);
      if (blocking >= 0) {
        is_free_[static_cast<std::size_t>(blocking)] = false;
        continue;
      }
      const Index released = find_releasable(lambda);
      if (released < 0) {
        break;
      }
      is_free_[static_cast<std::size_t>(released)] = true;
    }
    return step_;
  }

  // Returns s' (J'J + lambda)^-1 s in the free variables, for the last lambda: minus the slope of
  // |s|^2 / 2 over lambda.
  double calc_decline() const {
    const Index count = std::ssize(free_);
    if (count == 0) {
      return 0;
    }
    VectorXd part(count);
    for (Index k = 0; k < count; ++k) {
      part[k] = step_[free_[static_cast<std::size_t>(k)]];
    }
    const auto triangle = factor_.matrixQR().topRows(count).triangularView<Eigen::Upper>();
    return triangle.transpose().solve(part).squaredNorm();
  }

 private:
  // Returns the step whose free coordinates minimise, the others staying as they are.
  VectorXd solve_free(double lambda) {
    const Index n = jacobian_.cols();
    const Index rows = jacobian_.rows();
    free_.clear();
    VectorXd right = VectorXd::Zero(rows + n);
    right.head(rows) = -residuals_;
    for (Index i = 0; i < n; ++i) {
      if (is_free_[static_cast<std::size_t>(i)]) {
        free_.push_back(i);
      } else {
        right.head(rows) -= jacobian_.col(i) * step_[i];
      }
    }
    const Index count = std::ssize(free_);
    VectorXd target = step_;
    if (count == 0) {
      return target;
    }
    MatrixXd left = MatrixXd::Zero(rows + count, count);
    for (Index k = 0; k < count; ++k) {
      left.col(k).head(rows) = jacobian_.col(free_[static_cast<std::size_t>(k)]);
      left(rows + k, k) = std::sqrt(lambda);
    }
    factor_.compute(left);
    const VectorXd solution = factor_.solve(right.head(rows + count));
    for (Index k = 0; k < count; ++k) {
      target[free_[static_cast<std::size_t>(k)]] = solution[k];
    }
    return target;
  }

  // Moves the step to `target`, or until it meets a bound. Returns the variable of that bound, or
  // -1.
  Index move_towards(const VectorXd& target) {
    double share = 1;
    Index blocking = -1;
    for (const Index i : free_) {
      const double bound = target[i] < box_.lower[i]   ? box_.lower[i]
                           : target[i] > box_.upper[i] ? box_.upper[i]
                                                       : target[i];
      if (bound == target[i]) {
        continue;
      }
      const double reached = (bound - step_[i]) / (target[i] - step_[i]);
      if (blocking < 0 || reached < share) {
        share = std::max(0.0, reached);
        blocking = i;
      }
    }
    if (blocking < 0) {
      step_ = target;
      return -1;
    }
    for (const Index i : free_) {
      step_[i] =
          std::clamp(step_[i] + share * (target[i] - step_[i]), box_.lower[i], box_.upper[i]);
    }
    step_[blocking] =
        target[blocking] < step_[blocking] ? box_.lower[blocking] : box_.upper[blocking];
    return blocking;
  }

  // Returns the variable at a bound whose move into the box lowers the sum most, or -1.
  Index find_releasable(double lambda) const {
    const VectorXd slope =
        jacobian_.transpose() * (residuals_ + jacobian_ * step_) + lambda * step_;
    Index released = -1;
    double steepest = 1e-12 * slope.cwiseAbs().maxCoeff();
    for (Index i = 0; i < slope.size(); ++i) {
      if (is_free_[static_cast<std::size_t>(i)] || box_.lower[i] == box_.upper[i]) {
        continue;
      }
      const double gain = step_[i] == box_.lower[i] ? -slope[i] : slope[i];
      if (gain > steepest) {
        steepest = gain;
        released = i;
      }
    }
    return released;
  }

  const MatrixXd& jacobian_;
  const VectorXd& residuals_;
  const StepBox& box_;
  std::vector<bool> is_free_;
  std::vector<Index> free_;
  VectorXd step_;
  Eigen::HouseholderQR<MatrixXd> factor_;
};

// Shortens a step that rounding has made longer than the radius.
VectorXd shorten(const VectorXd& step, double radius) {
  const double length = step.norm();
  return length > radius ? VectorXd(step * (radius / length)) : step;
}

VectorXd clip(const VectorXd& step, const StepBox& box) {
  return step.cwiseMax(box.lower).cwiseMin(box.upper);
}

// Returns the step that makes gradient' s largest: clip(scale * gradient) of the largest scale that
// the radius allows.
VectorXd climb(const VectorXd& gradient, const StepBox& box, double radius) {
  const double steepness = gradient.cwiseAbs().maxCoeff();
  if (!(steepness > 0)) {
    return VectorXd::Zero(gradient.size());
  }
  const VectorXd direction = gradient / steepness;
  double low = 0;
  double high = radius;
  // Beyond this scale, coordinates with a slope of 1e-12 of the steepest one are still free.
  while (high < 1e12 * radius && clip(high * direction, box).norm() < radius) {
    low = high;
    high *= 2;
  }
  for (int halving = 0; halving < 60; ++halving) {
    const double middle = (low + high) / 2;
    (clip(middle * direction, box).norm() < radius ? low : high) = middle;
  }
  return shorten(clip(high * direction, box), radius);
}

}  // namespace

VectorXd solve_trust_region(const MatrixXd& jacobian, const VectorXd& residuals, const StepBox& box,
                            double radius) {
  const Index n = jacobian.cols();
  // A square triangle has the same sum of squares, but for a constant.
  MatrixXd triangle = jacobian;
  VectorXd right = residuals;
  if (jacobian.rows() > n) {
    const Eigen::HouseholderQR<MatrixXd> factor(jacobian);
    triangle = factor.matrixQR().topRows(n).triangularView<Eigen::Upper>();
    right = (factor.householderQ().adjoint() * residuals).head(n);
  }
  const double slope = (triangle.transpose() * right).norm();
  if (!(slope > 0)) {
    return VectorXd::Zero(n);
  }
  BoxedLeastSquares model(triangle, right, box);
  constexpr double kFlat = 1e-12;  // of the largest column: rounding errors of the Jacobian
  const double steepest = triangle.colwise().norm().maxCoeff();
  double low = (kFlat * steepest) * (kFlat * steepest);
  VectorXd step = model.solve(low);
  if (step.norm() <= radius) {
    return step;
  }
  double high = 2 * slope / radius;  // |s(lambda)| <= 2 |J'r| / lambda, since the box contains 0
  double lambda = low;
  // The length ends within this share below the radius. A longer step would have to be shortened,
  // which takes it off its bounds.
  constexpr double kAccuracy = 1e-6;
  const double aim = (1 - kAccuracy / 2) * radius;
  for (int iteration = 0; iteration < 100; ++iteration) {
    const double length = step.norm();
    if (std::abs(length - aim) <= radius - aim) {
      break;
    }
    (length > aim ? low : high) = lambda;
    const double decline = model.calc_decline();
    lambda += (length - aim) / aim * length * length / decline;
    if (!(lambda > low && lambda < high)) {
      lambda = std::sqrt(low * high);
    }
    step = model.solve(lambda);
  }
  return shorten(step, radius);
}

VectorXd find_extreme_step(const VectorXd& gradient, const StepBox& box, double radius) {
  const VectorXd up = climb(gradient, box, radius);
  const VectorXd down = climb(-gradient, box, radius);
  return gradient.dot(up) >= -gradient.dot(down) ? up : down;
}

}  // namespace armwright
