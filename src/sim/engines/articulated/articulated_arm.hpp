// A serial arm in joint coordinates, one at a time: what the engine `articulated` computes in lanes
// (chain_dynamics.hpp), in the form in which a TrackingLoop and the tests of physics drive an arm.
// Any number of revolute and prismatic joints.
//
// Semi-implicit Euler: qd += h M^-1 (tau - b), then q += h qd.
//
// Positions, rates and efforts are in rad, rad/s and N m for a revolute joint, in m, m/s and N for
// a prismatic one.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>

#include "sim/robot/robot_model.hpp"
#include "sim/tracking/tracking.hpp"

namespace armwright {

class ArticulatedArm {
 public:
  // At rest with joint positions q. The model must outlive the arm. Of the physics only gravity
  // counts.
  ArticulatedArm(const RobotModel& model, std::span<const double> q,
                 const PhysicsSettings& physics);
  ~ArticulatedArm();
  ArticulatedArm(const ArticulatedArm&) = delete;
  ArticulatedArm& operator=(const ArticulatedArm&) = delete;

  void set_state(std::span<const double> q, std::span<const double> qd);

  // Advances by dt_s with one effort a joint. Throws DivergenceError, naming the joint, for an
  // effort that is not finite and once positions (turns counted) and rates add up to 1e6 or are not
  // finite.
  void step(std::span<const double> effort, double dt_s);

  void read_angles(std::span<double> q) const;  // of revolute joints in [-pi, pi]
  void read_rates(std::span<double> qd) const;
  Eigen::Vector3d tip_position_m() const;
  Eigen::Vector3d tool_point_m(std::size_t point) const;  // of the model's
  Eigen::Vector3d com_position_m(std::size_t link) const;
  // Sums over the bodies, independent of M.
  double calc_kinetic_energy_j() const;
  double calc_potential_energy_j() const;  // zero at z = 0

  // Of M(q) qdd + b(q, qd) = tau in the state as it is; b contains gravity.
  Eigen::MatrixXd calc_mass_matrix() const;
  Eigen::VectorXd calc_bias() const;

 private:
  struct Chain;
  std::unique_ptr<Chain> chain_;
};

}  // namespace armwright
