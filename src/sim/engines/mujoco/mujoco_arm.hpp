// A serial arm in MuJoCo: an independent engine to check the others with. Reduced coordinates, one
// degree of freedom a joint (position q: rad, or m where it slides), semi-implicit Euler in the
// engine's own implementation:
//
//   v += h M(q)^-1 (tau - b(q, v));  q += h v
//
// M: joint-space inertia (composite rigid bodies), b: Coriolis, centrifugal and gravity efforts
// (recursive Newton-Euler), tau: efforts, h: step. Nothing else acts: no damping, armature,
// friction, joint stops or contacts.
// Source: E. Todorov, T. Erez, Y. Tassa, MuJoCo: A physics engine for model-based control, IROS
// 2012; the library is MuJoCo 2.2.2.
//
// Part of the build only with ARMWRIGHT_WITH_MUJOCO.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>

#include "sim/robot/robot_model.hpp"
#include "sim/tracking/tracking.hpp"

namespace armwright {

// A robot as MuJoCo has it, compiled once (half a millisecond) for any number of arms. Immutable:
// arms in several threads may be made of one.
class MujocoModel {
 public:
  // Error{bad_data} if MuJoCo does not take the robot. The robot must outlive the model.
  MujocoModel(const RobotModel& robot, const PhysicsSettings& physics);
  ~MujocoModel();
  MujocoModel(const MujocoModel&) = delete;
  MujocoModel& operator=(const MujocoModel&) = delete;

 private:
  friend class MujocoArm;
  struct Compiled;
  std::unique_ptr<Compiled> compiled_;
};

class MujocoArm {
 public:
  // At rest with joint positions q. The robot must outlive the arm.
  MujocoArm(const MujocoModel& model, std::span<const double> q);
  MujocoArm(const RobotModel& robot, std::span<const double> q, const PhysicsSettings& physics);
  ~MujocoArm();
  MujocoArm(const MujocoArm&) = delete;
  MujocoArm& operator=(const MujocoArm&) = delete;

  // Advances by dt_s with one effort a joint (N m, or N where it slides). Throws DivergenceError,
  // naming the joint, in the same cases as OdeArm: once a link is more than 1 km away, turns faster
  // than 1e6 rad/s or has no finite state. And where a joint moves less than 1e-15 kg m^2 (or kg),
  // which MuJoCo replaces.
  void step(std::span<const double> effort, double dt_s);

  void read_angles(std::span<double> q) const;  // in [-pi, pi], or m
  void read_rates(std::span<double> qd) const;
  Eigen::Vector3d tip_position_m() const;
  Eigen::Vector3d tool_point_m(std::size_t point) const;  // of the model's
  Eigen::Vector3d com_position_m(std::size_t link) const;
  double calc_kinetic_energy_j() const;
  double calc_potential_energy_j() const;  // zero at z = 0

 private:
  void check() const;

  struct World;
  std::unique_ptr<World> world_;
};

}  // namespace armwright
