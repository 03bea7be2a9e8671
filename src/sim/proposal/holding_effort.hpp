// The efforts with which an arm's motors hold it at rest: tau = b(q, 0) + o - s(q), with gravity b,
// the offset o of friction and the counterbalance s of each joint (joint_plant.hpp). Friction itself
// helps to hold, so it does not count here. Elastic joints count as rigid.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "sim/engines/articulated/articulated_arm.hpp"
#include "sim/tracking/task.hpp"

namespace armwright {

class HoldingEffort {
 public:
  // Keeps a copy of the robot, which must already carry its load.
  HoldingEffort(const RobotModel& robot, const PhysicsSettings& physics);
  // Returns one effort (N m or N) per joint for the posture q (rad or m). It is valid until the next
  // call.
  std::span<const double> calc(std::span<const double> q);

  // The joint that needs the largest share of its effort limit, and that share. 0 if no joint has a
  // limit.
  struct Hardest {
    std::size_t joint = 0;
    double share = 0;
    double effort = 0;  // N m or N
  };
  Hardest find_hardest(std::span<const double> q);

  // The joints' speeds are 0 until the caller sets a state of its own.
  ArticulatedArm& arm() { return arm_; }
  const RobotModel& robot() const { return robot_; }

 private:
  RobotModel robot_;
  std::vector<double> rest_, effort_;
  ArticulatedArm arm_;
};

}  // namespace armwright
