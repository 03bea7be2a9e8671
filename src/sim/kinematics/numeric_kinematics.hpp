// Inverse kinematics of any serial chain by damped least squares, for arms without a closed form.
//
// With J the derivatives of the task (below) by the joints, e how far the task is from its target
// and w how the joints would like to move, every iteration solves
//   (J^T J + mu^2 1) dq = J^T e + mu^2 w,   mu^2 = |e|^2 + 1e-9 max_i (J^T J)_ii.
// The damping by the residual converges from anywhere and quadratically at the end, near
// singularities too (Sugihara 2011, Solvability-unconcerned inverse kinematics by the
// Levenberg-Marquardt method, IEEE Transactions on Robotics 27, 984-991). What the task leaves free
// follows w, which draws joints towards the middle of their ranges. A joint that would leave its
// range is held at its end and the others solve again (Flacco, De Luca and Khatib 2012, Motion
// control of redundant robots under joint constraints, ICRA).
//
// The task is the tip's position (m); if the tool is to point somewhere, L times how its axis
// differs (m); if its whole orientation counts, L times the rotation vector between both. Positions
// q are in rad or m, one a joint; revolute ones are not wrapped, so that they are continuous along
// a path.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "sim/kinematics/tool_task.hpp"
#include "sim/robot/robot_model.hpp"

namespace armwright {

class NumericKinematics {
 public:
  static constexpr int kMostJoints = 16;
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostJoints, 1>;
  using Jacobian = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, kMostJoints>;

  // `home`: where searches begin, one position a joint; empty: the middle of the ranges, 0 where
  // there are none. `within_limits`: joints stay in their ranges. Error{bad_data} for more than
  // kMostJoints, Error{usage} for a home of another length.
  NumericKinematics(const RobotModel& robot, const ToolTask& tool, std::vector<double> home,
                    bool within_limits);

  // From a posture near by to one at the target; where the task leaves joints free they move by
  // `wish`, one displacement a joint. False if that fails, q then being of no use.
  bool follow(const ToolPose& target, std::span<const double> wish, std::span<double> q) const;
  // A posture at the target from nothing: from home, or else from random postures, always the same;
  // joints that are free to are as near the middle of their ranges as they come. False if none is
  // found.
  bool find(const ToolPose& target, std::span<double> q) const;

  ToolPose calc_pose(std::span<const double> q) const;
  // How far a posture is from a target, as the task counts it (m).
  double calc_distance(const ToolPose& target, std::span<const double> q) const;
  Jacobian calc_jacobian(std::span<const double> q) const;
  // In how many directions the tool can move at a posture without singularity, as the task counts.
  int rank() const { return rank_; }
  // Whether that is enough for the task; Error{bad_data} if it is not.
  bool suits_task() const;
  void check_task(const RobotModel& robot) const;
  // The smallest singular value of J that counts over the largest, lengths counted in lengths of
  // the arm and turns in rad: 0 in a singular posture.
  double calc_dexterity(std::span<const double> q) const;
  // Which joint moves most where the tool moves least.
  std::size_t find_idle_joint(std::span<const double> q) const;
  // The middle of the joint's range; 0 if it has none.
  double get_middle(std::size_t joint) const { return chain_[joint].middle; }
  bool has_middle(std::size_t joint) const { return chain_[joint].has_middle; }
  const std::vector<double>& home() const { return home_; }
  std::size_t joint_count() const { return chain_.size(); }
  // In what range joints are drawn at random: their own, where it is finite.
  std::vector<double> draw_posture(class RandomStream& random) const;

 private:
  struct Part {
    Eigen::Matrix3d turn;
    Eigen::Vector3d place;
    Eigen::Vector3d axis;
    Eigen::Matrix3d cross, outer;  // [a]x and a a^T
    bool slides = false;
    double lower = 0, upper = 0, middle = 0;
    bool has_middle = false;
  };
  struct Posture;  // of all joints in the world

  void calc_posture(const Vector& q, Posture& posture) const;
  Eigen::Matrix<double, 6, 1> calc_error(const ToolPose& target, const Posture& posture) const;
  Jacobian calc_jacobian(const Posture& posture) const;
  // One step from q; false if it is not a number.
  bool improve(const Jacobian& jacobian, const Eigen::Matrix<double, 6, 1>& error,
               const Vector& wish, double longest_step, Vector& q) const;
  bool solve(const ToolPose& target, const Vector& wish, int iterations, double longest_step,
             Vector& q) const;
  void relax(const ToolPose& target, Vector& q) const;
  // J with rows that can be compared.
  Eigen::MatrixXd calc_even_jacobian(std::span<const double> q) const;
  void find_rank();

  ToolTask tool_;
  std::vector<Part> chain_;
  Eigen::Matrix3d tip_turn_;
  Eigen::Vector3d tip_place_;
  std::vector<double> home_;
  bool within_limits_;
  double length_m_ = 0;
  int rank_ = 0;
};

}  // namespace armwright
