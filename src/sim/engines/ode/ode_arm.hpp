// A serial arm in an ODE world of its own: one body per link, one hinge or slider per joint, the
// base fixed. It steps with dWorldStep (semi-implicit Euler in maximal coordinates). Results are
// the same bit for bit in every run, and do not depend on the simulations of other threads.
//
// Positions, rates and efforts are in rad, rad/s and N m for a revolute joint, in m, m/s and N for
// a prismatic one.
//
// The published results depend on these details: joints are attached (child, parent) in that order,
// bodies are created in the start posture, gyroscopic mode is on. There is no damping, no
// auto-disable, no collision and no joint stop.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <string>

#include "sim/robot/robot_model.hpp"
#include "sim/tracking/task.hpp"

namespace armwright {

class OdeArm {
 public:
  // Starts at rest with joint positions q. The model must outlive the arm.
  OdeArm(const RobotModel& model, std::span<const double> q, const PhysicsSettings& physics);
  ~OdeArm();
  OdeArm(const OdeArm&) = delete;
  OdeArm& operator=(const OdeArm&) = delete;

  // Advances by dt_s with one effort per joint, and one added inertia (kg m^2 or kg) per joint or
  // none. Throws DivergenceError, naming the joint, for an effort that is not finite, and as soon as
  // a link is more than 1 km away, turns faster than 1e6 rad/s or has no finite state. No arm that
  // is only out of control comes near these limits.
  void step(std::span<const double> effort, double dt_s, std::span<const double> inertia = {});

  void read_positions(std::span<double> q) const;  // revolute joints in [-pi, pi]
  void read_rates(std::span<double> qd) const;
  Eigen::Vector3d tip_position_m() const;
  Eigen::Vector3d tool_point_m(std::size_t point) const;  // of RobotModel::tool_points_m
  Eigen::Vector3d com_position_m(std::size_t link) const;
  double calc_kinetic_energy_j() const;
  double calc_potential_energy_j() const;  // zero at z = 0

 private:
  void add_inertia(std::span<const double> inertia, double dt_s);

  struct World;
  std::unique_ptr<World> world_;
};

}  // namespace armwright
