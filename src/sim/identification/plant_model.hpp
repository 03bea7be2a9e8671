// The efforts that a recorded motion needs, as a function of the robot's parameters
// (plant_parameters.hpp): inverse dynamics and its derivatives. With the laws of
// sim/robot/joint_plant.hpp,
//   link   e = M(q) a + b(q, v) - s(q)
//   motor  u = e + A a_m + f(v_m);
// v_m = v and a_m = a unless the motor's side of the gear was recorded as well.
// Y(q, v, a) (link_regressor.hpp) is computed once per sample, so an evaluation costs one product
// of matrices.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <span>
#include <vector>

#include "sim/identification/plant_parameters.hpp"

namespace armwright {

// Matrices have one row per sample and one column per joint (rad or m, and their derivatives).
struct JointMotion {
  Eigen::MatrixXd positions, rates, accelerations;             // of the links
  Eigen::MatrixXd motor_rates = {}, motor_accelerations = {};  // empty: those of the links
};

// The filter that recorded efforts have passed. `apply` returns a signal as the filter leaves it, with
// kParts numbers per sample: dry friction steps where a joint turns round, and a filter at the
// samples' own period would take what is above half of their rate for slow changes.
struct EffortSmoothing {
  static constexpr Eigen::Index kParts = 8;
  double period_s = 0;                                                // of the samples
  std::function<Eigen::VectorXd(const Eigen::VectorXd&)> apply = {};  // empty: there is no filter
};

class PlantModel {
 public:
  // Parameters that are not in the list keep the robot's values. Dry friction passes the filter
  // `smoothing`. Everything else is smooth, since positions passed it before they were differentiated.
  PlantModel(const RobotModel& robot, std::vector<PlantParameter> parameters,
             double gravity_m_per_s2, const JointMotion& motion,
             const EffortSmoothing& smoothing = {});

  // Efforts in N m or N, in the order of samples and, within a sample, of joints.
  struct Efforts {
    Eigen::VectorXd link, motor;
    // The derivatives of `link` and `motor`, one column per parameter.
    Eigen::MatrixXd link_jacobian, motor_jacobian;
  };
  // `x` has one value per parameter. Leaves the derivatives empty unless `jacobian`.
  Efforts calc(std::span<const double> x, bool jacobian) const;

  const JointMotion& motion() const { return motion_; }
  // Returns the columns of Y that belong to the last link, one row per effort.
  auto last_link() const { return regressor_.rightCols<kLinkNumbers>(); }

 private:
  void add_links(std::span<const double> x, bool jacobian, const RobotModel& changed,
                 Efforts& efforts) const;
  void add_balance(const RobotModel& changed, bool jacobian, Efforts& efforts) const;
  void add_motors(const RobotModel& changed, bool jacobian, Efforts& efforts) const;

  RobotModel robot_;  // without visuals
  std::vector<PlantParameter> parameters_;
  JointMotion motion_;
  EffortSmoothing smoothing_;
  Eigen::MatrixXd regressor_;  // Y of all samples, one below the other
};

}  // namespace armwright
