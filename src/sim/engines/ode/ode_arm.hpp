// A serial arm in an ODE world of its own: one body a link, one hinge or slider a joint, the base
// fixed.
// Steps with dWorldStep (semi-implicit Euler in maximal coordinates). Repeatable bit for bit and
// independent of what other threads simulate.
//
// Positions, rates and efforts are in rad, rad/s and N m for a revolute joint, in m, m/s and N for
// a prismatic one.
//
// Details that are part of published results: joints are attached (child, parent) in that order,
// bodies are created in the start posture, gyroscopic mode is on, no damping, no auto-disable, no
// collisions, no joint stops.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <string>

#include "sim/robot/robot_model.hpp"
#include "sim/tracking/tracking.hpp"

namespace armwright {

class OdeArm {
 public:
  // At rest with joint positions q. The model must outlive the arm.
  OdeArm(const RobotModel& model, std::span<const double> q, const PhysicsSettings& physics);
  ~OdeArm();
  OdeArm(const OdeArm&) = delete;
  OdeArm& operator=(const OdeArm&) = delete;

  // Advances by dt_s with one effort a joint. Throws DivergenceError, naming the joint, once
  // a link is more than 1 km away, turns faster than 1e6 rad/s or has no finite state: far beyond
  // any arm that is merely out of control.
  void step(std::span<const double> effort, double dt_s);

  void read_angles(std::span<double> q) const;  // of revolute joints in [-pi, pi]
  void read_rates(std::span<double> qd) const;
  Eigen::Vector3d tip_position_m() const;
  Eigen::Vector3d tool_point_m(std::size_t point) const;  // of the model's
  Eigen::Vector3d com_position_m(std::size_t link) const;
  double calc_kinetic_energy_j() const;
  double calc_potential_energy_j() const;  // zero at z = 0

 private:
  struct World;
  std::unique_ptr<World> world_;
};

}  // namespace armwright
