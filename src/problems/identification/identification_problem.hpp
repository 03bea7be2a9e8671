// The problem of finding a robot's parameters in recorded motions. A case is a motion. With u the
// efforts that the model needs (sim/identification/plant_model.hpp) and y the recorded ones, which
// are d late, the residuals of a motion of K samples and n joints are
//   r_ki = (y_i(t_k + d) - u_i(t_k)) / (sigma_i sqrt(K n)),
// sigma_i being the standard deviation of joint i's effort over all motions that are fitted. If the
// stiffness of joints is fitted, their deflections, motor less link, give residuals as well:
//   ((p - q) - o - e_i / k_i) / (delta_i sqrt(K m)),
// delta_i being the standard deviation of the deflection and m the number of these joints. The
// objective is the sum of the squares, the mean over the motions. The error of a case is the mean over
// the joints of rms(y_i - u_i) / sigma_i.
//
// What is known of the robot beforehand counts as well: a parameter with the prior deviation d_p has
// the residual
//   sqrt(v) (x_p - x_p0) / d_p,
// x_p0 being the robot's own value and v the mean square of a residual that a fit without priors leaves,
// times the number of samples that tell as much as one. Then one effective sample and one deviation
// count the same (maximum a posteriori estimate). list_priors() has the deviations.
//
// Training and validation have the motions that are fitted, the test has those that are held back.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "problems/interface/problem.hpp"
#include "problems/logs/log_samples.hpp"
#include "sim/identification/plant_model.hpp"

namespace armwright {

struct IdentificationConfig {
  std::string name, summary;
  RobotModel robot;
  RobotModel plain;  // without the plant's file
  double gravity_m_per_s2 = 0;
  std::vector<FitGroup> groups;
  struct Log {
    std::string name;
    LogSamples samples;
  };
  std::vector<Log> fitted;  // at least one
  std::vector<Log> held_back;
  double cutoff_hz = 0;    // of the filter that the samples passed
  double prior_scale = 1;  // factor on the prior deviations; 0: nothing is known beforehand
  std::vector<std::string> notes;
};

// One motion with its model.
struct FittedMotion {
  std::string name;
  double period_s = 0;
  double cutoff_hz = 0;
  PlantModel model;
  Eigen::MatrixXd efforts;         // as recorded; one row per sample, one column per joint
  Eigen::VectorXd effort_factors;  // as MotionLog::effort_factors
  Eigen::MatrixXd deflections;     // likewise; NaN where nothing was recorded; may be empty
};

class IdentificationProblem final : public Problem {
 public:
  explicit IdentificationProblem(const IdentificationConfig& config);

  const ProblemDescription& description() const override { return description_; }
  std::vector<CaseOutcome> simulate(std::span<const CaseJob> jobs) const override;
  Evaluation aggregate(std::span<const double> x,
                       std::span<const CaseOutcome> outcomes) const override;
  std::vector<double> penalty_objectives() const override;
  // The recorded and the modelled effort of every joint.
  CaseRecord record_case(std::span<const double> x, const CaseBlock& block,
                         std::uint64_t number) const override;

  const RobotModel& robot() const { return robot_; }
  const RobotModel& plain_robot() const { return plain_; }
  double gravity_m_per_s2() const { return gravity_m_per_s2_; }
  const std::vector<PlantParameter>& parameters() const { return parameters_; }
  const std::vector<double>& own_values() const { return own_; }  // of the robot, before the fit
  const std::vector<FittedMotion>& fitted() const { return fitted_; }
  const std::vector<FittedMotion>& held_back() const { return held_back_; }
  // The motions of the test: those that are held back or, without any, those that are fitted.
  const std::vector<FittedMotion>& judged() const {
    return held_back_.empty() ? fitted_ : held_back_;
  }
  // Notes for the user say how the logs were read and filtered.
  const std::vector<std::string>& notes() const { return notes_; }
  // The prior deviations d, one per parameter; 0: nothing is known.
  const Eigen::VectorXd& priors() const { return priors_; }
  // sqrt(v).
  double prior_weight() const { return prior_weight_; }
  // sigma and delta, one number per joint; delta is 0 where deflections are not fitted.
  const Eigen::VectorXd& effort_scales() const { return sigma_; }
  const Eigen::VectorXd& deflection_scales() const { return delta_; }

  // The residuals of a motion in the order of its samples, then joints: first those of efforts, then
  // those of deflections. One row per residual in `jacobian`.
  struct Residuals {
    Eigen::VectorXd values;
    Eigen::MatrixXd jacobian;
    Eigen::VectorXd rms;  // of the efforts, one number per joint, N m or N
  };
  Residuals calc_residuals(const FittedMotion& motion, std::span<const double> x,
                           bool jacobian) const;

 private:
  RobotModel robot_, plain_;
  double gravity_m_per_s2_;
  std::vector<PlantParameter> parameters_;
  std::vector<double> own_;
  std::vector<FittedMotion> fitted_, held_back_;
  Eigen::VectorXd sigma_, delta_, priors_;
  double prior_weight_ = 0;
  std::vector<std::string> notes_;
  ProblemDescription description_;
};

// Returns the problem if it is an identification, else null.
const IdentificationProblem* find_identification(const Problem& problem);

}  // namespace armwright
