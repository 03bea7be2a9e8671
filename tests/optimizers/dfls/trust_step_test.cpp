#include "optimizers/dfls/trust_step.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.hpp"

namespace armwright {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

struct RandomStep {
  MatrixXd jacobian;
  VectorXd residuals;
  StepBox box;
  double radius = 0;

  double calc_sum(const VectorXd& step) const {
    return (residuals + jacobian * step).squaredNorm();
  }
};

// Between 1 and 8 variables of different influence; fewer residuals than variables in some of them;
// every fourth variable stands at a bound.
RandomStep draw_step(RandomStream& random) {
  const auto n = static_cast<Index>(random.uniform(1, 9));
  const auto m = static_cast<Index>(random.uniform(1, 13));
  RandomStep one{
      MatrixXd(m, n), VectorXd(m), {VectorXd(n), VectorXd(n)}, std::exp(random.uniform(-4, 3))};
  for (Index i = 0; i < n; ++i) {
    const double influence = std::exp(random.uniform(-4, 2));
    for (Index k = 0; k < m; ++k) {
      one.jacobian(k, i) = influence * random.normal();
    }
    one.box.lower[i] = random.uniform(0, 1) < 0.25 ? 0 : -random.uniform(0, 2);
    one.box.upper[i] = random.uniform(0, 1) < 0.25 ? 0 : random.uniform(0, 2);
  }
  for (Index k = 0; k < m; ++k) {
    one.residuals[k] = random.normal();
  }
  return one;
}

bool is_allowed(const VectorXd& step, const StepBox& box, double radius) {
  return (step.array() >= box.lower.array()).all() && (step.array() <= box.upper.array()).all() &&
         step.norm() <= radius * (1 + 1e-14);
}

// There is a multiplier lambda >= 0 of the radius, 0 if the step is shorter, with which the slope
// J'(r + Js) + lambda s is 0 in variables off their bounds and points out of the box in the others.
TEST(TrustStep, MeetsTheOptimalityConditionsInRandomBoxes) {
  RandomStream random("test/trust-step", 1);
  int long_steps = 0;
  int bounded = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const RandomStep one = draw_step(random);
    const VectorXd step = solve_trust_region(one.jacobian, one.residuals, one.box, one.radius);
    ASSERT_TRUE(is_allowed(step, one.box, one.radius)) << trial;
    const VectorXd slope = one.jacobian.transpose() * (one.residuals + one.jacobian * step);
    VectorXd free_step = step;
    for (Index i = 0; i < step.size(); ++i) {
      if (step[i] == one.box.lower[i] || step[i] == one.box.upper[i]) {
        free_step[i] = 0;
        ++bounded;
      }
    }
    double lambda = 0;
    if (step.norm() > one.radius * (1 - 1e-5)) {
      ++long_steps;
      lambda =
          free_step.norm() > 0 ? std::max(0.0, -free_step.dot(slope) / free_step.squaredNorm()) : 0;
    }
    // The length is accurate to 1e-6 of the radius.
    const double tolerance =
        1e-5 * (one.jacobian.transpose() * one.residuals).norm() + 1e-5 * lambda * one.radius;
    for (Index i = 0; i < step.size(); ++i) {
      const double total = slope[i] + lambda * step[i];
      if (step[i] > one.box.lower[i]) {
        EXPECT_LE(total, tolerance) << trial << " variable " << i;
      }
      if (step[i] < one.box.upper[i]) {
        EXPECT_GE(total, -tolerance) << trial << " variable " << i;
      }
    }
  }
  EXPECT_GT(long_steps, 300);
  EXPECT_GT(bounded, 300);
}

TEST(TrustStep, NoAllowedStepIsBetter) {
  RandomStream random("test/trust-step", 2);
  for (int trial = 0; trial < 100; ++trial) {
    const RandomStep one = draw_step(random);
    const VectorXd step = solve_trust_region(one.jacobian, one.residuals, one.box, one.radius);
    const double reduction = one.calc_sum(VectorXd::Zero(step.size())) - one.calc_sum(step);
    EXPECT_GE(reduction, 0);
    for (int other = 0; other < 200; ++other) {
      VectorXd rival(step.size());
      for (Index i = 0; i < step.size(); ++i) {
        rival[i] = random.uniform(one.box.lower[i], one.box.upper[i]);
      }
      rival *= std::min(1.0, one.radius / rival.norm());
      // 1e-5: the length of the step is accurate to 1e-6, and the sum is convex in it.
      EXPECT_GE(one.calc_sum(rival), one.calc_sum(step) - 1e-5 * reduction - 1e-12) << trial;
    }
  }
}

TEST(TrustStep, StaysWhereTheModelIsFlat) {
  const StepBox box{VectorXd::Constant(3, -1), VectorXd::Constant(3, 1)};
  MatrixXd jacobian = MatrixXd::Zero(2, 3);
  EXPECT_EQ(solve_trust_region(jacobian, VectorXd::Ones(2), box, 1), VectorXd::Zero(3));
  jacobian(0, 1) = 2;
  const VectorXd step = solve_trust_region(jacobian, VectorXd::Ones(2), box, 1);
  EXPECT_EQ(step[0], 0);
  EXPECT_NEAR(step[1], -0.5, 1e-12);
  EXPECT_EQ(step[2], 0);
}

TEST(TrustStep, ExtremesOfALinearFunctionUseBoxAndRadius) {
  const StepBox box{Eigen::Vector3d(-0.1, -1, -1), Eigen::Vector3d(0.5, 1, 1)};
  // Within the radius: along the gradient, to the side where the box leaves more room.
  const VectorXd gradient = Eigen::Vector3d(1, 0, 0);
  EXPECT_NEAR((find_extreme_step(gradient, box, 2) - Eigen::Vector3d(0.5, 0, 0)).norm(), 0, 1e-9);
  EXPECT_NEAR((find_extreme_step(-gradient, box, 2) - Eigen::Vector3d(0.5, 0, 0)).norm(), 0, 1e-9);
  EXPECT_NEAR((find_extreme_step(gradient, box, 0.2) - Eigen::Vector3d(0.2, 0, 0)).norm(), 0, 1e-9);
  // The first variable meets its bound, the second one takes the rest of the radius.
  const VectorXd both = Eigen::Vector3d(1, 1, 0);
  const VectorXd step = find_extreme_step(both, box, 0.9);
  EXPECT_NEAR(step[0], 0.5, 1e-9);
  EXPECT_NEAR(step[1], std::sqrt(0.81 - 0.25), 1e-9);
}

}  // namespace
}  // namespace armwright
