// The classes that simulate a single arm, and the tolerances of each. The physics tests run over
// all of them. An arm has OdeArm's constructor and members.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <string>

#include "base/decompositions.hpp"
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

// Maximal coordinates: in a step, links move along tangents, and the next steps pull the joints
// together again. The velocities after a step solve the equations in the posture before it.
template <>
struct ArmTraits<OdeArm> {
  static constexpr const char* kName = "OdeArm";

  // Limits after a second of motion, in units of the error of semi-implicit Euler in joint
  // coordinates: the arm's error, and its distance from that method. Measured: up to 3.
  static constexpr double kErrorOverEuler = 4;
  static constexpr double kDistanceToEuler = 4;

  // The motion along tangents reduces a large swing's amplitude, and so its period, in proportion
  // to the step.
  static constexpr int kPeriodOrder = 1;

  // Error of the momentum along a joint on which nothing else acts, in units of momentum x turn per
  // step.
  static constexpr double kMomentumError = 1;

  // The posture to which the velocities after a step belong.
  static const Eigen::VectorXd& select_posture(const Eigen::VectorXd& before,
                                               const Eigen::VectorXd& after [[maybe_unused]]) {
    return before;
  }
  // Relative error of the rates after a step in which the links turned by `turn`. The axes along
  // which rates are measured have turned since, which gives an error of the turn's square. For a
  // slider, the lever between its two bodies has changed, too: by the turn times their distance (up
  // to 2 m).
  static double calc_rate_error(double turn_rad, bool slides) {
    return slides ? 2 * turn_rad : turn_rad * turn_rad / 2;
  }
  // Distance of a centre of mass from the straight line after a first step from rest, in which the
  // joints moved by `moved` in all (rad and m): rounding only.
  static double calc_path_error_m(double turn_rad [[maybe_unused]], double moved [[maybe_unused]]) {
    return 4e-15;
  }
  // Distance of the tip from the forward kinematics of the joint positions. In every step each
  // joint leaves its circle by another turn^2 / 2 times the reach, and the share ERP of it is
  // corrected.
  static double calc_gap_m(double turn_rad, double reach_m, std::size_t joints, double erp) {
    return static_cast<double>(joints) * turn_rad * turn_rad * reach_m / (2 * erp);
  }
  // Whether a link that turns fast leaves its circle.
  static constexpr bool kMovesAlongTangents = true;
  // The distance that a link slides along a level rail until |x| + |y| + |z| is a kilometre.
  static constexpr double kFarthestSlide_m = 714;
  // The message about an arm that diverged. It names a joint unless the library itself stopped.
  static constexpr const char* kBlownUp =
      "joint [0-9]+ \\([a-z]+\\): its link is .* m from the base and turns at .* rad/s|"
      "joint [0-9]+ \\([a-z]+\\): its position or speed is not a finite number|"
      "ODE stopped \\(message .*";
};

// Joint coordinates: semi-implicit Euler itself, so the only error is rounding.
struct ReducedArmTraits {
  static constexpr double kErrorOverEuler = 1 + 1e-6;
  static constexpr double kDistanceToEuler = 1e-6;
  // Its symplectic map keeps the amplitude, so the period's error is of second order in the step.
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
      "joint [0-9]+ \\([a-z]+\\): its link is .* m from the base and turns at .* rad/s|"
      "joint [0-9]+ \\([a-z]+\\): its position or speed is not a finite number";
};

// It diverges once the positions (rad or m) and rates of all joints add up to a million.
template <>
struct ArmTraits<ArticulatedArm> : ReducedArmTraits {
  static constexpr const char* kName = "ArticulatedArm";
  static constexpr double kFarthestSlide_m = 1e6 / 1.1;  // in a step of 10 s
  static constexpr const char* kBlownUp =
      "joint [0-9]+ \\([a-z]+\\): it is at .* (rad|m) and moves at .* (rad|m)/s|"
      "joint [0-9]+ \\([a-z]+\\): its position or speed is not a finite number";
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
