// An arm at rest in any posture: the efforts with which its motors hold it, and its mass matrix with
// the rotors. Elastic joints count as rigid.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "sim/dynamics/arm_equations.hpp"
#include "sim/robot/robot_model.hpp"
#include "sim/tracking/task.hpp"

namespace armwright {

class RestingArm {
 public:
  // Keeps a copy of the robot, which must already carry its load.
  RestingArm(const RobotModel& robot, const PhysicsSettings& physics);
  // Returns one effort (N m or N) per joint for the posture q (rad or m)
  // (ArmEquations::calc_holding_efforts()).
  std::vector<double> calc_holding_efforts(std::span<const double> q);

  // The joint that needs the largest share of its effort limit, and that share. 0 if no joint has a
  // limit.
  struct Hardest {
    std::size_t joint = 0;
    double share = 0;
    double effort = 0;  // N m or N
  };
  Hardest find_hardest(std::span<const double> q);

  Eigen::MatrixXd calc_mass_matrix(std::span<const double> q);
  // Returns how strongly driving a joint moves the others: the largest M_ii (M^-1)_ii, 1 if it moves
  // none.
  double calc_coupling(std::span<const double> q);

 private:
  RobotModel robot_;
  articulated::ChainModel chain_;
  articulated::ArmEquations equations_;
};

}  // namespace armwright
