// The problem of planning a motion q(t) of all joints through given points. No controller and no
// time stepping are involved: everything is computed on the motion itself, exactly from its pieces
// (motion_curve.hpp) or at even times. One evaluation is one motion.
//
// The decision vector has, in this order: the intervals of the curve (s), unless they are given, or of
// the curve `line` the share of its effort limit that each joint may use; the joint positions of each
// free point; and of each link that is a tube (tube.hpp) its length, its diameter and its wall, as far
// as they have bounds.
//
// On the curve `line`, the tip moves straight from point to point and rests there, in the least time
// within the limits on rates, accelerations and the shares of the efforts (time_optimal.hpp). These
// limits are then no constraints, because the motion keeps them at its places; jerks have no bound.
//
// Quantities of a motion, with T its duration:
//   duration      T (s)
//   jerk          the sum over the joints of the integral of q'''^2 (rad^2/s^5)
//   energy        the sum over the joints of the integral of max(0, tau q') (J), by the trapezoidal rule
//   peak_torque   the sum over the joints of max |tau| (N m)
//   rms_torque    the sum over the joints of the root mean square of tau (N m)
//   clearance     the least distance of the links from obstacles and from each other (m, signed)
//   deflection    how far the stretched arm sags (m), for arms of tubes
//   tool_speed    the largest speed of the tip (m/s)
// The efforts are tau = M(q) q'' + b(q, q') + A q'' + f(q') - s(q), with the rotors A, friction f and
// counterbalances s of joint_plant.hpp. Elastic joints count as rigid. Of joints that slide, jerks are
// in m^2/s^5 and efforts in N; sums add the numbers.
//
// A limit is a constraint g <= 0 with the joint's name: g = largest magnitude / limit - 1 for the rate,
// the acceleration, the jerk and the effort of each joint, |q - middle| / half range - 1 for its range;
// g = value / limit - 1 for tool_speed and deflection; and for the clearance g = (least - value) / the
// arm's length. Ranges, rates, accelerations and jerks are exact maxima, the others those at the
// samples.
//
// The objective is the sum of weight x quantity / scale, or the quantities themselves (a front). The
// clearance counts with a minus sign, because it shall be large.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "problems/interface/problem.hpp"
#include "problems/interface/weighted_quantity.hpp"
#include "problems/logs/motion_file.hpp"
#include "sim/dynamics/chain_model.hpp"
#include "sim/kinematics/arm_clearance.hpp"
#include "sim/kinematics/numeric_kinematics.hpp"
#include "sim/motion/motion_curve.hpp"
#include "sim/motion/time_optimal.hpp"
#include "sim/robot/tube.hpp"

namespace armwright {

enum class MotionQuantity : std::uint8_t {
  duration,
  jerk,
  energy,
  peak_torque,
  rms_torque,
  clearance,
  deflection,
  tool_speed
};
const std::vector<std::string>& motion_quantity_names();  // in the order of the enum
inline constexpr std::size_t kMotionQuantities = 8;

// A point that the motion passes: joint positions, a pose of the tool, or neither, if it is free.
struct MotionPoint {
  std::optional<Eigen::VectorXd> q;
  std::optional<ToolPose> tool;
  bool has_turn = false;  // whether the tool's orientation counts
};

struct MotionConfig {
  std::string name, summary;
  RobotModel robot;
  double gravity_m_per_s2 = 9.80665;
  CurveForm form;
  std::vector<MotionPoint> points;  // at least two; the first and the last are not free
  std::vector<double> home;         // where the inverse kinematics of tools' poses begins
  std::vector<double> intervals_s;  // empty: variables
  VariableBounds interval_s{0.02, 20};
  VariableBounds effort_share{0.1, 1};  // of the curve `line`
  JointLimits limits;                   // one number per joint, infinite where there is none
  bool limits_range = true;
  std::optional<double> tool_speed_limit_m_per_s, least_clearance_m;
  std::vector<WeightedQuantity> objective{WeightedQuantity{}};  // of MotionQuantity
  bool is_front = false;
  std::size_t samples = 201;
  std::shared_ptr<const ArmClearance> clearance;  // null: there is nothing to stay clear of
  ArmTubes tubes;
};

// A motion, and what was found of it.
struct AssessedPlan {
  MotionCurve curve;
  std::shared_ptr<const RobotModel> robot;  // with its tubes
  Eigen::VectorXd times_s;
  Eigen::MatrixXd efforts;  // one row per sample, one column per joint
  std::vector<double> quantities;
  std::vector<double> constraints;
  ArmClearance::Nearest nearest;  // and when
  double nearest_s = 0;

  double& quantity(MotionQuantity which) { return quantities[static_cast<std::size_t>(which)]; }
};

class MotionProblem final : public Problem {
 public:
  // Throws Error{bad_data} if the points' tool poses cannot be reached.
  explicit MotionProblem(MotionConfig config);

  const ProblemDescription& description() const override { return description_; }
  std::vector<CaseOutcome> simulate(std::span<const CaseJob> jobs) const override;
  Evaluation aggregate(std::span<const double> x,
                       std::span<const CaseOutcome> outcomes) const override;
  std::vector<double> penalty_objectives() const override;
  // The positions, rates, accelerations, jerks and efforts of every joint, and the motion as
  // motion.csv and trajectory.yaml (problems/logs/motion_file.hpp).
  CaseRecord record_case(std::span<const double> x, const CaseBlock& block,
                         std::uint64_t number) const override;

  const MotionConfig& config() const { return config_; }
  // Returns nothing, and the reason, if a tool's pose cannot be reached by the arm of `x`.
  std::optional<AssessedPlan> assess(std::span<const double> x, std::size_t samples,
                                     std::string& reason) const;
  // Returns the motion at the plan's times.
  MotionSamples sample(const AssessedPlan& plan) const;
  // Returns the least time (s) in which the arm can move along the path of `plan`, within the limits
  // on rates, accelerations and efforts. Nothing if none of them limits it, or if no speed suits the
  // path.
  std::optional<double> calc_bound(const AssessedPlan& plan) const;

 private:
  // Returns the arm of `x` and its tubes: the nominal one if the arm is no variable.
  std::shared_ptr<const RobotModel> make_arm(std::span<const double> x,
                                             std::vector<Tube>& tubes) const;
  bool find_points(const RobotModel& robot, std::span<const double> x, Eigen::MatrixXd& points,
                   std::string& reason) const;
  // Returns the paths of the tip's straight lines between the points. Nothing, and the reason, if the
  // arm cannot follow one.
  std::vector<std::vector<PathPlace>> trace_lines(const RobotModel& robot,
                                                  const Eigen::MatrixXd& points,
                                                  std::string& reason) const;
  // Returns the least times of the paths within the limits; nothing, and the reason, if no speed suits
  // one.
  std::vector<LeastTime> time_lines(const RobotModel& robot,
                                    std::span<const std::vector<PathPlace>> paths,
                                    const JointLimits& limits, std::string& reason) const;
  std::optional<MotionCurve> make_curve(const RobotModel& robot, const Eigen::MatrixXd& points,
                                        std::span<const double> x, std::string& reason) const;
  void measure(std::span<const Tube> tubes, AssessedPlan& plan) const;
  void make_constraints(AssessedPlan& plan) const;
  void make_variables(const Eigen::MatrixXd& start);
  std::vector<double> calc_objectives(std::span<const double> quantities) const;
  std::size_t count_intervals() const {
    return config_.form.count_intervals(config_.points.size());
  }
  bool changes_arm() const { return !config_.tubes.tubes.empty(); }
  bool is_line() const { return config_.form.kind == CurveKind::line; }
  // Returns whether evaluations have the quantity as a metric.
  bool has_metric(MotionQuantity quantity) const;

  MotionConfig config_;
  std::shared_ptr<const RobotModel> robot_;               // that of config_
  std::shared_ptr<const articulated::ChainModel> chain_;  // null if the arm is a variable
  double arm_length_m_ = 1;
  std::vector<std::vector<PathPlace>> lines_;  // of the nominal arm, unless the arm is a variable
  std::vector<double> penalty_;
  ProblemDescription description_;
};

// Returns the problem if it plans a motion; else null.
const MotionProblem* find_motion(const Problem& problem);

}  // namespace armwright
