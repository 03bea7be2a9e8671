#include "sim/identification/plant_model.hpp"

#include <algorithm>
#include <cmath>

#include "sim/dynamics/joint_effort.hpp"

namespace armwright {
namespace {

using Kind = PlantParameter::Kind;

// The step of difference quotients by a counterbalance's corrections. The efforts are linear in them.
constexpr double kStep = 1.0 / 64;

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;

std::span<const double> row_of(const Eigen::MatrixXd& rows, Index sample,
                               std::vector<double>& numbers) {
  Eigen::RowVectorXd::Map(numbers.data(), rows.cols()) = rows.row(sample);
  return numbers;
}

// Returns the derivatives of the last link's numbers by the payload's mass (part 0) and centre.
LinkNumbers differentiate_payload(const RobotModel& robot, int part) {
  const Inertial body = transform(*robot.payload, robot.tip_pose);
  const Vector3d& c = body.com_m;
  Vector3d moment = c;
  Matrix3d inertia = c.squaredNorm() * Matrix3d::Identity() - c * c.transpose();
  if (part > 0) {
    const Vector3d way = robot.tip_pose.linear().col(part - 1);
    moment = body.mass_kg * way;
    inertia = body.mass_kg *
              (2 * c.dot(way) * Matrix3d::Identity() - way * c.transpose() - c * way.transpose());
  }
  LinkNumbers numbers;
  numbers << (part == 0 ? 1.0 : 0.0), moment, inertia(0, 0), inertia(0, 1), inertia(0, 2),
      inertia(1, 1), inertia(1, 2), inertia(2, 2);
  return numbers;
}

// The dry friction of a joint, one number per sample, and its derivatives.
struct DryFriction {
  Eigen::VectorXd rise, fall;  // tanh(v / v_w), tanh(v / v_s)
  Eigen::VectorXd by_stribeck_rate;
};

// Returns rates between the samples by cubics with the samples' rates and accelerations (Hermite).
Eigen::VectorXd refine(const Eigen::VectorXd& rates, const Eigen::VectorXd& accelerations,
                       double period_s) {
  constexpr Index kParts = EffortSmoothing::kParts;
  Eigen::VectorXd fine((rates.size() - 1) * kParts + 1);
  for (Index k = 0; k < fine.size(); ++k) {
    const Index from = std::min(k / kParts, rates.size() - 2);
    const double u = static_cast<double>(k - from * kParts) / kParts;
    fine[k] =
        rates[from] + u * u * (3 - 2 * u) * (rates[from + 1] - rates[from]) +
        period_s * u * (1 - u) * ((1 - u) * accelerations[from] - u * accelerations[from + 1]);
  }
  return fine;
}

DryFriction calc_dry_friction(const JointPlant& plant, const Eigen::VectorXd& rates,
                              const Eigen::VectorXd& accelerations,
                              const EffortSmoothing& smoothing) {
  const bool is_smoothed = smoothing.apply && rates.size() > 1;
  const Eigen::VectorXd fine =
      is_smoothed ? refine(rates, accelerations, smoothing.period_s) : rates;
  DryFriction friction;
  friction.rise = (fine / plant.transition_rate).array().tanh();
  friction.fall = (fine / plant.stribeck_rate).array().tanh();
  friction.by_stribeck_rate = plant.stribeck / (plant.stribeck_rate * plant.stribeck_rate) *
                              fine.cwiseProduct((1 - friction.fall.array().square()).matrix());
  for (Eigen::VectorXd* part : {&friction.rise, &friction.fall, &friction.by_stribeck_rate}) {
    if (is_smoothed) {
      const Eigen::VectorXd smooth = smoothing.apply(*part);
      *part = smooth(Eigen::seqN(0, rates.size(), EffortSmoothing::kParts));
    }
  }
  return friction;
}

bool has_breakaway(std::span<const PlantParameter> parameters, std::size_t joint) {
  for (const PlantParameter& parameter : parameters) {
    if (parameter.kind == Kind::breakaway && parameter.joint == joint) {
      return true;
    }
  }
  return false;
}

}  // namespace

PlantModel::PlantModel(const RobotModel& robot, std::vector<PlantParameter> parameters,
                       double gravity_m_per_s2, const JointMotion& motion,
                       const EffortSmoothing& smoothing)
    : robot_(robot), parameters_(std::move(parameters)), motion_(motion), smoothing_(smoothing) {
  for (Link& link : robot_.links) {
    link.visuals.clear();
  }
  const LinkRegressor regressor(robot_, gravity_m_per_s2);
  const auto n = static_cast<Index>(robot_.joint_count());
  const Index samples = motion_.positions.rows();
  regressor_.resize(samples * n, n * kLinkNumbers);
  std::vector<double> q(robot_.joint_count()), v(q), a(q);
  for (Index k = 0; k < samples; ++k) {
    regressor.calc(row_of(motion_.positions, k, q), row_of(motion_.rates, k, v),
                   row_of(motion_.accelerations, k, a), regressor_.middleRows(k * n, n));
  }
}

void PlantModel::add_links(std::span<const double> x, bool jacobian, const RobotModel& changed,
                           Efforts& efforts) const {
  const auto n = static_cast<Index>(robot_.joint_count());
  Eigen::VectorXd numbers(n * kLinkNumbers);
  for (Index i = 0; i < n; ++i) {
    numbers.segment<kLinkNumbers>(i * kLinkNumbers) =
        to_link_numbers(changed.links[static_cast<std::size_t>(i)].inertial);
  }
  efforts.link = regressor_ * numbers;
  for (std::size_t i = 0; jacobian && i < parameters_.size(); ++i) {
    const PlantParameter& parameter = parameters_[i];
    const auto column = static_cast<Index>(i);
    if (parameter.kind == Kind::payload) {
      efforts.link_jacobian.col(column) =
          regressor_.rightCols<kLinkNumbers>() * differentiate_payload(changed, parameter.part);
    } else if (parameter.kind == Kind::inertia && parameter.part == 0) {
      Eigen::Matrix<double, 10, 10> derivatives;
      calc_link_numbers(x.subspan(i).first<kLinkNumbers>(), &derivatives);
      efforts.link_jacobian.middleCols<kLinkNumbers>(column) =
          regressor_.middleCols<kLinkNumbers>(static_cast<Index>(parameter.joint) * kLinkNumbers) *
          derivatives;
    }
  }
}

void PlantModel::add_balance(const RobotModel& changed, bool jacobian, Efforts& efforts) const {
  const auto n = static_cast<Index>(robot_.joint_count());
  for (Index i = 0; i < n; ++i) {
    const Joint& joint = changed.joints[static_cast<std::size_t>(i)];
    if (joint.plant.counterbalance.efforts.empty()) {
      continue;
    }
    for (Index k = 0; k < motion_.positions.rows(); ++k) {
      efforts.link[k * n + i] -= articulated::calc_counterbalance(joint, motion_.positions(k, i));
    }
  }
  for (std::size_t i = 0; jacobian && i < parameters_.size(); ++i) {
    const PlantParameter& parameter = parameters_[i];
    if (parameter.kind != Kind::counterbalance) {
      continue;
    }
    // The efforts are linear in each of the two corrections, point by point of their grid.
    Joint slope = changed.joints[parameter.joint];
    Counterbalance& balance = slope.plant.counterbalance;
    std::vector<double> own = balance.efforts;
    const bool is_scale = parameter.part == 0;
    balance.correct(balance.scale + (is_scale ? kStep : 0), balance.slope + (is_scale ? 0 : kStep));
    for (std::size_t k = 0; k < own.size(); ++k) {
      balance.efforts[k] = (balance.efforts[k] - own[k]) / kStep;
    }
    const auto at = static_cast<Index>(parameter.joint);
    for (Index k = 0; k < motion_.positions.rows(); ++k) {
      efforts.link_jacobian(k * n + at, static_cast<Index>(i)) =
          -articulated::calc_counterbalance(slope, motion_.positions(k, at));
    }
  }
}

void PlantModel::add_motors(const RobotModel& changed, bool jacobian, Efforts& efforts) const {
  const auto n = static_cast<Index>(robot_.joint_count());
  const bool has_motors = motion_.motor_rates.size() > 0;
  const Eigen::MatrixXd& all_rates = has_motors ? motion_.motor_rates : motion_.rates;
  const Eigen::MatrixXd& all_accelerations =
      has_motors ? motion_.motor_accelerations : motion_.accelerations;
  efforts.motor = efforts.link;
  if (jacobian) {
    efforts.motor_jacobian = efforts.link_jacobian;
  }
  for (Index i = 0; i < n; ++i) {
    const auto joint = static_cast<std::size_t>(i);
    const JointPlant& plant = changed.joints[joint].plant;
    const Eigen::VectorXd rates = all_rates.col(i), accelerations = all_accelerations.col(i);
    const DryFriction friction = calc_dry_friction(plant, rates, accelerations, smoothing_);
    const auto rows = Eigen::seqN(i, rates.size(), n);
    efforts.motor(rows) += plant.armature * accelerations + plant.viscous * rates +
                           (plant.coulomb + plant.stribeck) * friction.rise -
                           plant.stribeck * friction.fall +
                           Eigen::VectorXd::Constant(rates.size(), plant.offset);
    const bool splits = has_breakaway(parameters_, joint);
    for (std::size_t p = 0; jacobian && p < parameters_.size(); ++p) {
      if (parameters_[p].joint != joint) {
        continue;
      }
      const auto column = static_cast<Index>(p);
      switch (parameters_[p].kind) {
        case Kind::viscous:
          efforts.motor_jacobian(rows, column) = rates;
          break;
        case Kind::coulomb:
          efforts.motor_jacobian(rows, column) = splits ? friction.fall : friction.rise;
          break;
        case Kind::offset:
          efforts.motor_jacobian(rows, column).setOnes();
          break;
        case Kind::breakaway:
          efforts.motor_jacobian(rows, column) = friction.rise - friction.fall;
          break;
        case Kind::stribeck_rate:
          efforts.motor_jacobian(rows, column) = friction.by_stribeck_rate;
          break;
        case Kind::armature:
          efforts.motor_jacobian(rows, column) = accelerations;
          break;
        default:
          break;
      }
    }
  }
}

PlantModel::Efforts PlantModel::calc(std::span<const double> x, bool jacobian) const {
  RobotModel changed = robot_;
  set_parameters(changed, parameters_, x);
  Efforts efforts;
  if (jacobian) {
    efforts.link_jacobian.setZero(regressor_.rows(), static_cast<Index>(parameters_.size()));
  }
  add_links(x, jacobian, changed, efforts);
  add_balance(changed, jacobian, efforts);
  add_motors(changed, jacobian, efforts);
  return efforts;
}

}  // namespace armwright
