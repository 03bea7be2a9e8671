// A serial arm in MuJoCo: an independent engine to check the others with. It has reduced
// coordinates, one degree of freedom per joint (position q in rad, or in m for a prismatic joint),
// and MuJoCo's own semi-implicit Euler:
//
//   v += h M(q)^-1 (tau - b(q, v));  q += h v
//
// M: joint-space inertia (composite rigid bodies), b: Coriolis, centrifugal and gravity efforts
// (recursive Newton-Euler), tau: efforts, h: step. Nothing else acts: no damping, armature,
// friction, joint stops or contacts.
// Source: E. Todorov, T. Erez, Y. Tassa, MuJoCo: A physics engine for model-based control, IROS
// 2012; the library is MuJoCo 2.2.2.
//
// Compiled only with ARMWRIGHT_WITH_MUJOCO.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>

#include "sim/robot/robot_model.hpp"
#include "sim/tracking/task.hpp"

namespace armwright {

// A robot in MuJoCo's form, compiled once (half a millisecond) for any number of arms. Immutable,
// so several threads may make arms from one object.
struct MujocoModel;

// The robot must outlive the model. Throws Error{bad_data} if MuJoCo rejects the robot.
std::shared_ptr<const MujocoModel> compile_for_mujoco(const RobotModel& robot,
                                                      const PhysicsSettings& physics);

class MujocoArm {
 public:
  // Starts at rest with joint positions q. The robot must outlive the arm.
  MujocoArm(const MujocoModel& model, std::span<const double> q);
  MujocoArm(const RobotModel& robot, std::span<const double> q, const PhysicsSettings& physics);
  ~MujocoArm();
  MujocoArm(const MujocoArm&) = delete;
  MujocoArm& operator=(const MujocoArm&) = delete;

  // Advances by dt_s with one effort per joint (N m or N), and one added inertia (kg m^2 or kg) per
  // joint or none. Throws DivergenceError, naming the joint, in the same cases as OdeArm. It also
  // throws if a joint moves less than 1e-15 kg m^2 (or
  // kg), which MuJoCo replaces by another inertia.
  void step(std::span<const double> effort, double dt_s, std::span<const double> inertia = {});

  void read_positions(std::span<double> q) const;  // rad in [-pi, pi], or m
  void read_rates(std::span<double> qd) const;
  Eigen::Vector3d tip_position_m() const;
  Eigen::Vector3d tool_point_m(std::size_t point) const;  // of RobotModel::tool_points_m
  Eigen::Vector3d com_position_m(std::size_t link) const;
  double calc_kinetic_energy_j() const;
  double calc_potential_energy_j() const;  // zero at z = 0

 private:
  void check() const;

  struct World;
  std::unique_ptr<World> world_;
};

}  // namespace armwright
