// The problem of finding a motion that tells a robot's parameters well. With w = 2 pi / T and H
// harmonics, the position of each joint is
//   q(t) = o + c(t) sum_k (a_k sin(k w t) + b_k cos(k w t)),   k = 1 .. H
// (Swevers, Ganseman, Tukel, De Schutter and Van Brussel 1997, Optimal robot excitation and
// identification, IEEE Transactions on Robotics and Automation 13, 730-740). The source repeats a
// period; here the motion begins and ends at rest at o: c rises from 0 to 1 in the first blend_s and
// falls in the last, as 10 u^3 - 15 u^4 + 6 u^5 with u from 0 to 1. Rates and accelerations are exact
// derivatives and 0 at both ends. The variables are o, a_k and b_k of each joint.
//
// The objective is a criterion of A, the derivatives of the motor efforts by the parameters
// (plant_model.hpp) at the robot's own values. A row is divided by its joint's effort limit, as drives
// are noisy in proportion to their size, and by the root of the number of rows. A column is divided by
// its root mean square over random states within the limits of positions and rates. Unlike columns of
// length 1, columns so divided are short if the motion hardly moves a parameter's efforts.
//   condition  log10 of the ratio of A's largest to its smallest singular value
//   d_optimal  -log(det(A^T A)) / n, n being the number of columns
// Combinations of parameters that no motion can tell (Gautier and Khalil 1990) are left out: A is
// multiplied by a basis of the others, found with the same random states.
//
// Constraints keep each joint within shares of its range, speed and effort limit, and the arm above a
// floor and clear of obstacles: g = share / limit - 1, for a floor depth / the arm's length, for
// obstacles -gap / the arm's length. Training samples the motion
// coarsely and demands kReserve more than is asked for. Elastic joints count as rigid.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "problems/interface/problem.hpp"
#include "sim/identification/plant_model.hpp"
#include "sim/kinematics/arm_clearance.hpp"
#include "sim/kinematics/floor_clearance.hpp"

namespace armwright {

enum class ExcitationCriterion : std::uint8_t { condition, d_optimal };
const std::vector<std::string>& excitation_criterion_names();  // in the order of the enum

struct ExcitationConfig {
  std::string name, summary;
  RobotModel robot;  // its speed and effort limits must be finite, its ranges wider than 0
  double gravity_m_per_s2 = 0;
  std::vector<FitGroup> groups;
  ExcitationCriterion criterion = ExcitationCriterion::d_optimal;
  double duration_s = 20;
  double period_s = 10;  // T
  double blend_s = 1;    // at most duration_s / 2
  int harmonics = 5;
  double position_share = 0.9;  // of half the range, from its middle
  double speed_share = 0.8, effort_share = 0.8;
  std::vector<double> acceleration_limits;  // rad/s^2 or m/s^2, one per joint; empty: none
  std::optional<double> floor_m;
  std::shared_ptr<const ArmClearance> clearance;  // null: there is nothing to stay clear of
};

// A motion, sampled evenly from its beginning to its end.
struct AssessedMotion {
  Eigen::VectorXd times_s;
  JointMotion motion;
  Eigen::MatrixXd efforts;  // of the motors, one row per sample and one column per joint
  // The largest share of each limit over the motion, one number per joint. `accelerations` is empty
  // without limits.
  Eigen::VectorXd positions, speeds, accelerations, efforts_share;
  double depth_m = 0;        // of the arm's lowest place below the floor; negative: it clears it
  double gap_m = 0;          // the least distance of links from obstacles, if there are some
  Eigen::MatrixXd jacobian;  // of the efforts, not divided; one row per effort
  double condition = 0;
  double log_det = 0;  // log(det(A^T A)) / n
};

class ExcitationProblem final : public Problem {
 public:
  // The shares that training allows are lower by this factor than those of the configuration, for
  // what happens between its samples.
  static constexpr double kReserve = 0.98;
  static constexpr Eigen::Index kTrainingSamples = 161;
  // Samples per period of the highest harmonic with which a motion is checked in the end.
  static constexpr double kFineSamples = 100;

  // Throws Error{bad_data} if no parameter can be told, or if no posture is allowed.
  explicit ExcitationProblem(ExcitationConfig config);

  const ProblemDescription& description() const override { return description_; }
  std::vector<CaseOutcome> simulate(std::span<const CaseJob> jobs) const override;
  Evaluation aggregate(std::span<const double> x,
                       std::span<const CaseOutcome> outcomes) const override;
  std::vector<double> penalty_objectives() const override;
  // The positions, rates and efforts of every joint.
  CaseRecord record_case(std::span<const double> x, const CaseBlock& block,
                         std::uint64_t number) const override;

  const ExcitationConfig& config() const { return config_; }
  const std::vector<PlantParameter>& parameters() const { return parameters_; }
  const std::vector<double>& own_values() const { return own_; }
  // Returns the number of combinations of parameters that motions can tell.
  Eigen::Index rank() const { return basis_.cols(); }
  // Returns whether some motion tells the parameter by itself.
  bool can_tell(std::size_t parameter) const;

  AssessedMotion assess(std::span<const double> x, Eigen::Index samples) const;
  AssessedMotion assess_finely(std::span<const double> x) const;
  // Returns whether the motion keeps all limits, without reserve.
  bool is_within_limits(const AssessedMotion& motion) const;
  // Multiplies the amplitudes of x by the largest of 1, 0.99, ... with which the fine check is passed.
  // Returns the factor; 0 if there is none.
  double shrink_to_limits(std::vector<double>& x) const;
  // Returns the standard error of each parameter if a recording has `noise` per joint (N m or N, one
  // standard deviation, independent in each of the motion's samples).
  Eigen::VectorXd calc_standard_errors(const AssessedMotion& motion,
                                       const Eigen::VectorXd& noise) const;

 private:
  struct Shape {  // of all joints: the sums' values and derivatives are these matrices times a, b
    Eigen::MatrixXd values, rates, accelerations;
  };
  Shape make_shape(const Eigen::VectorXd& times_s) const;
  Eigen::VectorXd make_times(Eigen::Index samples) const;
  AssessedMotion assess(std::span<const double> x, const Shape& shape,
                        const Eigen::VectorXd& times_s) const;
  std::vector<double> calc_constraints(const AssessedMotion& motion, double reserve) const;
  // The middle of the positions that a joint may have, and half of their range.
  double get_middle(std::size_t joint) const;
  double get_half(std::size_t joint) const;
  double get_slowest_limit(std::size_t joint, int harmonic) const;
  void find_basis();
  void make_variables();
  void set_start();

  ExcitationConfig config_;
  std::vector<PlantParameter> parameters_;
  std::vector<double> own_;
  Eigen::VectorXd lengths_;  // of the columns, 1 for those that are 0
  Eigen::MatrixXd basis_;
  Eigen::VectorXd training_times_s_;
  Shape training_shape_;
  double arm_length_m_ = 1;
  std::unique_ptr<NumericKinematics> kinematics_;  // these two if there is a floor
  std::unique_ptr<FloorClearance> floor_;
  ProblemDescription description_;
};

}  // namespace armwright
