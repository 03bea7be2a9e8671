// The classes that simulate a single arm, and what each may be off by: the physics tests run over
// every one of them. An arm has OdeArm's constructor and members.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <string>

#include "sim/engines/articulated/articulated_arm.hpp"
#include "sim/engines/ode/ode_arm.hpp"
#ifdef ARMWRIGHT_WITH_MUJOCO
#include "sim/engines/mujoco/mujoco_arm.hpp"
#endif

namespace armwright::physics_test {

#ifdef ARMWRIGHT_WITH_MUJOCO
using ArmTypes = testing::Types<OdeArm, ArticulatedArm, MujocoArm>;
#else
using ArmTypes = testing::Types<OdeArm, ArticulatedArm>;
#endif

template <class Arm>
struct ArmTraits;

// Maximal coordinates: in a step links move along tangents, the joints are pulled together again in
// the steps after it, and velocities are those that solve the equations in the posture before it.
template <>
struct ArmTraits<OdeArm> {
  static constexpr const char* kName = "OdeArm";

  // After a second of motion, in units of the error of semi-implicit Euler in joint coordinates:
  // the own error and the distance to that method. Measured: up to 3.
  static constexpr double kErrorOverEuler = 4;
  static constexpr double kDistanceToEuler = 4;

  // A large swing loses amplitude to the tangents, and so period, in proportion to the step.
  static constexpr int kPeriodOrder = 1;

  // Of the momentum along a joint that nothing else acts on, in units of momentum x turn in a step.
  static constexpr double kMomentumError = 1;

  // The posture to which the velocities after a step belong.
  static const Eigen::VectorXd& select_posture(const Eigen::VectorXd& before,
                                               const Eigen::VectorXd& after [[maybe_unused]]) {
    return before;
  }
  // Of the rates after a step in which the links turned by `turn`, relative to all of them. They
  // are measured along axes that have turned since: by the square of that. Between the two bodies
  // of a slider the lever has changed as well, by the turn itself times their distance (up to 2 m).
  static double calc_rate_error(double turn_rad, bool slides) {
    return slides ? 2 * turn_rad : turn_rad * turn_rad / 2;
  }
  // Of a centre of mass beside the straight line after a first step from rest, in which the joints
  // moved by `moved` in all (rad and m): rounding only.
  static double calc_path_error_m(double turn_rad [[maybe_unused]], double moved [[maybe_unused]]) {
    return 4e-15;
  }
  // Of the tip from where the joint positions put it: each joint is off its circle by turn^2 / 2
  // times the reach more every step, of which the share ERP is taken back.
  static double calc_gap_m(double turn_rad, double reach_m, std::size_t joints, double erp) {
    return static_cast<double>(joints) * turn_rad * turn_rad * reach_m / (2 * erp);
  }
  // A link that turns fast leaves its circle.
  static constexpr bool kMovesAlongTangents = true;
  // How far a link slides along a level rail before it is a kilometre away, in |x| + |y| + |z|.
  static constexpr double kFarthestSlide_m = 714;
  // What is said of an arm that blew up: joints are named unless the library itself gave up.
  static constexpr const char* kBlownUp =
      "joint [0-9]+ \\([a-z]+\\): its link is .* m from the base and turns at .* rad/s|"
      "ODE stopped \\(message .*";
};

// Joint coordinates: semi-implicit Euler itself, so that only rounding is left.
struct ReducedArmTraits {
  static constexpr double kErrorOverEuler = 1 + 1e-6;
  static constexpr double kDistanceToEuler = 1e-6;
  // Its symplectic map keeps the amplitude: the period is off by the square of the step.
  static constexpr int kPeriodOrder = 2;
  static constexpr double kMomentumError = 2;
  static const Eigen::VectorXd& select_posture(const Eigen::VectorXd& before [[maybe_unused]],
                                               const Eigen::VectorXd& after) {
    return after;
  }
  static double calc_rate_error(double turn_rad [[maybe_unused]], bool slides [[maybe_unused]]) {
    return 1e-12;
  }
  // Links move along circles of some metres, and along rails that turn.
  static double calc_path_error_m(double turn_rad, double moved) {
    return 4e-15 + 4 * turn_rad * moved;
  }
  static double calc_gap_m(double turn_rad [[maybe_unused]], double reach_m,
                           std::size_t joints [[maybe_unused]], double erp [[maybe_unused]]) {
    return 1e-13 * reach_m;
  }
  static constexpr bool kMovesAlongTangents = false;
  static constexpr double kFarthestSlide_m = 714;
  static constexpr const char* kBlownUp =
      "joint [0-9]+ \\([a-z]+\\): its link is .* m from the base and turns at .* rad/s";
};

// What counts is how far joints turned or slid, plus their rates: a million in all.
template <>
struct ArmTraits<ArticulatedArm> : ReducedArmTraits {
  static constexpr const char* kName = "ArticulatedArm";
  static constexpr double kFarthestSlide_m = 1e6 / 1.1;  // in a step of 10 s
  static constexpr const char* kBlownUp =
      "joint [0-9]+ \\([a-z]+\\): it is at .* (rad|m) and moves at .* (rad|m)/s";
};

#ifdef ARMWRIGHT_WITH_MUJOCO
template <>
struct ArmTraits<MujocoArm> : ReducedArmTraits {
  static constexpr const char* kName = "MujocoArm";
};
#endif

struct ArmNames {
  template <class Arm>
  static std::string GetName(int) {
    return ArmTraits<Arm>::kName;
  }
};

}  // namespace armwright::physics_test
