// Swinging arms with plants of any shape, and how far two results lie apart, for comparisons of
// engines.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "sim/engines/articulated/articulated_arm.hpp"
#include "sim/tracking/tracking_loop.hpp"
#include "test_arms.hpp"
#include "tracking_arms.hpp"

namespace armwright::physics_test {

// An arm with its plant, stepped as a TrackingLoop does.
template <class Arm>
class DrivenArm {
 public:
  DrivenArm(RobotModel robot, const VectorXd& q, double step_s, const PhysicsSettings& physics = {})
      : robot_(std::move(robot)),
        step_s_(step_s),
        q_(q),
        arm_(make_arm<Arm>(robot_, q, physics)),
        plant_(robot_, nullptr, {q_.data(), joints()}, step_s) {}

  void step(const VectorXd& effort) {
    const VectorXd rates = read_rates(arm_, joints());
    plant_.act({effort.data(), joints()}, {q_.data(), joints()}, {rates.data(), joints()});
    arm_.step(plant_.effort(), step_s_, plant_.inertia());
    q_ = read_positions(arm_, joints());
    plant_.remember({q_.data(), joints()});
  }
  void step(double effort) { step(VectorXd::Constant(1, effort)); }
  double rate() const { return read_rates(arm_, joints())[0]; }
  const VectorXd& q() const { return q_; }
  double pushed(std::size_t joint) const {
    return plant_.get_pushed(joint, q_[static_cast<Eigen::Index>(joint)]);
  }
  double measured() { return plant_.measure()[0]; }
  const Arm& arm() const { return arm_; }
  const RobotModel& robot() const { return robot_; }
  std::size_t joints() const { return robot_.joint_count(); }

 private:
  RobotModel robot_;
  double step_s_;
  VectorXd q_;
  Arm arm_;
  ArmPlant plant_;
};

inline double calc_largest_gap_m(const TrackingResult& a, const TrackingResult& b) {
  EXPECT_EQ(a.tips_m.size(), b.tips_m.size());
  EXPECT_GT(a.tips_m.size(), 100U);
  double gap_m = 0;
  for (std::size_t k = 0; k < std::min(a.tips_m.size(), b.tips_m.size()); ++k) {
    gap_m = std::max(gap_m, (a.tips_m[k] - b.tips_m[k]).norm());
  }
  return gap_m;
}

// Returns targets on which every joint swings by 0.3 rad or m.
inline TargetTable make_swing(const RobotModel& robot, int steps) {
  TargetTable table;
  table.joints = robot.joint_count();
  table.steps = steps;
  for (std::size_t i = 0; i < table.joints; ++i) {
    table.start_positions.push_back(0.2 * static_cast<double>(i) - 0.5);
  }
  for (int step = 0; step < steps; ++step) {
    for (std::size_t i = 0; i < table.joints; ++i) {
      const double phase = 0.05 * (step + 1) * (1 + 0.1 * static_cast<double>(i));
      table.joint_positions.push_back(table.start_positions[i] + 0.15 * (1 - std::cos(phase)));
    }
  }
  Segment segment;
  segment.steps = steps;
  segment.window_start = steps - 1;
  segment.duration_s = 0.01 * steps;
  segment.from_m = segment.to_m = Vector3d::Zero();
  table.segments = {segment};
  return table;
}

// Returns the robot with a full plant whose size follows from the inertia that each joint moves, and
// slow controllers for it.
inline std::pair<RobotModel, ArmDesign> make_plant_of_size(RobotModel robot,
                                                           const TargetTable& targets) {
  const VectorXd start = Eigen::Map<const VectorXd>(targets.start_positions.data(),
                                                    static_cast<Eigen::Index>(robot.joint_count()));
  const MatrixXd mass = make_arm<ArticulatedArm>(robot, start).calc_mass_matrix();
  ArmDesign design;
  for (std::size_t i = 0; i < robot.joint_count(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    JointPlant& plant = robot.joints[i].plant;
    const double m = mass(at, at);
    plant.armature = 0.6 * m;
    plant.viscous = 0.3 * m;
    plant.coulomb = 0.4 * m;
    plant.stribeck = 0.2 * m;
    plant.offset = 0.05 * m;
    plant.counterbalance = {-2, 2, {-m, 2 * m, m}};
    design.joints.push_back({{100 * m, 200 * m, 20 * m}, {-1e4, 1e4}});
  }
  JointPlant& spring = robot.joints.front().plant;
  spring.stiffness = 100 * 100 * spring.armature;
  return {robot, design};
}

}  // namespace armwright::physics_test
