// Checks whether an arm solves given equations of motion: it is driven for a second and compared
// with their solution.
#pragma once

#include <gtest/gtest.h>

#include <cmath>

#include "arm_types.hpp"
#include "chain_oracle.hpp"
#include "convergence.hpp"
#include "test_arms.hpp"

namespace armwright::physics_test {

// Returns smooth driving efforts, different in every joint.
inline VectorXd calc_drive(const VectorXd& amplitude, double t_s) {
  VectorXd tau(amplitude.size());
  for (Eigen::Index i = 0; i < tau.size(); ++i) {
    const double k = static_cast<double>(i);
    tau[i] = amplitude[i] * std::sin((3 + k) * t_s + 0.5 + k);
  }
  return tau;
}

// Returns positions (with whole turns) and rates after a second of driving.
template <class Arm>
VectorXd simulate(const RobotModel& model, const VectorXd& start, const VectorXd& amplitude,
                  int steps) {
  const double h_s = 1.0 / steps;
  const auto joints = static_cast<std::size_t>(start.size());
  Arm arm = make_arm<Arm>(model, start);
  VectorXd q = start;
  for (int k = 0; k < steps; ++k) {
    step(arm, calc_drive(amplitude, k * h_s), h_s);
    q += calc_motion(model, q, read_positions(arm, joints));
  }
  VectorXd state(2 * start.size());
  state << q, read_rates(arm, joints);
  return state;
}

inline VectorXd flatten(const State& s) {
  VectorXd state(2 * s.q.size());
  state << s.q, s.qd;
  return state;
}

constexpr int kTruthSteps = 4000;  // RK4's error is then below 1e-9, four orders below the others

// For h -> 0 the engine converges to the solution of the equations. Its error is of first order,
// like that of semi-implicit Euler in joint coordinates, but with its own constant.
template <class Arm>
void expect_solves(const RobotModel& model, const Acceleration& f, const VectorXd& start,
                   const VectorXd& amplitude) {
  using Traits = ArmTraits<Arm>;
  const State rest{start, VectorXd::Zero(start.size())};
  const VectorXd truth = flatten(integrate_rk4(f, rest, kTruthSteps, 1.0 / kTruthSteps));
  ASSERT_LT((flatten(integrate_rk4(f, rest, kTruthSteps / 2, 2.0 / kTruthSteps)) - truth).norm(),
            1e-8);
  ASSERT_GT((truth.head(start.size()) - start).cwiseAbs().minCoeff(), 0.2) << "hardly moves";

  const Limit engine =
      extrapolate([&](int steps) { return simulate<Arm>(model, start, amplitude, steps); }, 800);
  EXPECT_NEAR(engine.order, 1, kOrderTolerance);
  EXPECT_LT(engine.error, 1e-3 * truth.norm());  // or the next check is weak
  EXPECT_LT((engine.value - truth).norm(), engine.error);

  for (const int steps : {200, 1000, 3200}) {
    const VectorXd euler = flatten(integrate_semi_implicit_euler(f, rest, steps, 1.0 / steps));
    const VectorXd found = simulate<Arm>(model, start, amplitude, steps);
    const double unit = (euler - truth).norm();
    EXPECT_LT((found - truth).norm(), Traits::kErrorOverEuler * unit) << steps << " steps";
    EXPECT_LT((found - euler).norm(), Traits::kDistanceToEuler * unit) << steps << " steps";
  }
}

// The equations of motion of a driven chain.
inline Acceleration make_driven_acceleration(const ChainOracle& oracle, const VectorXd& amplitude) {
  return [&oracle, amplitude](double t_s, const VectorXd& q, const VectorXd& qd) {
    return oracle.calc_acceleration(q, qd, calc_drive(amplitude, t_s));
  };
}

// The first step from rest is exact. Every centre of mass moves by h^2 times its acceleration, up
// to rounding of positions of some metres and of the solution. Rates are h qdd, up to the arm's
// error of rates and the effect of rounded positions, some 1e-15 / h.
template <class Arm>
void expect_first_step(const RobotModel& model, const VectorXd& start, const VectorXd& tau,
                       double h_s) {
  using Traits = ArmTraits<Arm>;
  const ChainOracle oracle(model, kGravity_m_per_s2);
  const ChainOracle::Equations equations = oracle.calc(start, VectorXd::Zero(start.size()));
  const VectorXd acceleration = equations.mass.ldlt().solve(tau - equations.bias);
  Arm arm = make_arm<Arm>(model, start);
  step(arm, tau, h_s);
  const double turn_rad = calc_turn_rad(model, h_s * acceleration, h_s);
  const double rate_error = Traits::calc_rate_error(turn_rad, has_slider(model));
  EXPECT_LT((read_rates(arm, model.joint_count()) / h_s - acceleration).norm(),
            rate_error * acceleration.norm() + 4e-15 / (h_s * h_s));
  const double moved_in_all = h_s * h_s * acceleration.cwiseAbs().sum();
  for (std::size_t i = 0; i < model.joint_count(); ++i) {
    const Vector3d moved = arm.com_position_m(i) - equations.com_m[i];
    const Vector3d expected = h_s * h_s * equations.com_jacobian[i] * acceleration;
    EXPECT_LT((moved - expected).norm(),
              Traits::calc_path_error_m(turn_rad, moved_in_all) + 1e-12 * expected.norm())
        << "link " << i;
  }
}

}  // namespace armwright::physics_test
