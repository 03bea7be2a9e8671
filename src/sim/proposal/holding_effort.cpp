#include "sim/proposal/holding_effort.hpp"

#include <cmath>

#include "sim/dynamics/joint_effort.hpp"

namespace armwright {
namespace {

RobotModel make_rigid(RobotModel robot) {
  for (Joint& joint : robot.joints) {
    joint.plant.stiffness = 0;
  }
  return robot;
}

}  // namespace

HoldingEffort::HoldingEffort(const RobotModel& robot, const PhysicsSettings& physics)
    : robot_(make_rigid(robot)),
      rest_(robot.joint_count()),
      effort_(robot.joint_count()),
      arm_(robot_, rest_, physics) {}

std::span<const double> HoldingEffort::calc(std::span<const double> q) {
  arm_.set_state(q, rest_);
  const Eigen::VectorXd bias = arm_.calc_bias();
  for (std::size_t i = 0; i < effort_.size(); ++i) {
    const Joint& joint = robot_.joints[i];
    effort_[i] = bias[static_cast<Eigen::Index>(i)] + joint.plant.offset -
                 articulated::calc_counterbalance(joint, q[i]);
  }
  return effort_;
}

HoldingEffort::Hardest HoldingEffort::find_hardest(std::span<const double> q) {
  Hardest hardest;
  const std::span<const double> efforts = calc(q);
  for (std::size_t i = 0; i < efforts.size(); ++i) {
    const double share = std::abs(efforts[i]) / robot_.joints[i].effort_limit;
    if (share > hardest.share) {
      hardest = {i, share, std::abs(efforts[i])};
    }
  }
  return hardest;
}

}  // namespace armwright
