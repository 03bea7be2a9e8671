// A single serial arm in joint coordinates, with any number of revolute and prismatic joints. It
// has the dynamics that the engine `articulated` computes in lanes (chain_dynamics.hpp), and the
// interface with which a TrackingLoop and the physics tests drive an arm.
//
// Semi-implicit Euler: qd += h (M + E)^-1 (tau - b), then q += h qd. E is the diagonal inertia that
// the caller adds.
//
// Positions, rates and efforts are in rad, rad/s and N m for a revolute joint, in m, m/s and N for
// a prismatic one.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>

#include "sim/robot/robot_model.hpp"
#include "sim/tracking/task.hpp"

namespace armwright {

class ArticulatedArm {
 public:
  // Starts at rest with joint positions q. The model must outlive the arm. From `physics` only the
  // gravity is used.
  ArticulatedArm(const RobotModel& model, std::span<const double> q,
                 const PhysicsSettings& physics);
  ~ArticulatedArm();
  ArticulatedArm(const ArticulatedArm&) = delete;
  ArticulatedArm& operator=(const ArticulatedArm&) = delete;

  void set_state(std::span<const double> q, std::span<const double> qd);

  // Advances by dt_s with one effort per joint, and one added inertia (kg m^2 or kg) per joint or
  // none. Throws DivergenceError, naming the joint, for an
  // effort that is not finite, and as soon as the sum of all positions (whole turns included) and
  // rates reaches 1e6 or is not finite.
  void step(std::span<const double> effort, double dt_s, std::span<const double> inertia = {});

  void read_positions(std::span<double> q) const;  // revolute joints in [-pi, pi]
  void read_rates(std::span<double> qd) const;
  Eigen::Vector3d tip_position_m() const;
  Eigen::Vector3d tool_point_m(std::size_t point) const;  // of RobotModel::tool_points_m
  Eigen::Vector3d com_position_m(std::size_t link) const;
  // Sum over the bodies; they do not use M.
  double calc_kinetic_energy_j() const;
  double calc_potential_energy_j() const;  // zero at z = 0

  // Compute the terms of M(q) qdd + b(q, qd) = tau in the present state; b contains gravity. M
  // contains the rotor inertia of rigid joints.
  Eigen::MatrixXd calc_mass_matrix() const;
  Eigen::VectorXd calc_bias() const;

 private:
  struct Chain;
  std::unique_ptr<Chain> chain_;
};

}  // namespace armwright
