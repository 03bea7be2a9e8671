#include "sim/engines/articulated/articulated_arm.hpp"

#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "sim/dynamics/chain_dynamics.hpp"
#include "sim/dynamics/chain_model.hpp"
#include "sim/kinematics/kinematics.hpp"
#include "sim/tracking/engine_support.hpp"

namespace armwright {
namespace {

using namespace articulated;
using Eigen::Vector3d;

constexpr double kFarthest = 1e6;  // as in the engine's kernels (lane_kernel.hpp)

struct ArmLevel;  // tags the code that this file instantiates
using ArmNumber = lanes::Single<double, ArmLevel>;
using ArmShape = ChainShape<0, kAnyShape, true>;
using Dynamics = ChainDynamics<ArmNumber, ArmShape>;

}  // namespace

struct ArticulatedArm::Chain {
  Chain(const RobotModel& robot, double gravity)
      : model(robot), gravity_m_per_s2(gravity), chain(robot, gravity) {
    for (const double number : chain.numbers()) {
      numbers.emplace_back(number);
    }
    q.assign(joints(), ArmNumber(0));
    rate = acceleration = effort = q;
    scratch.assign(static_cast<std::size_t>(calc_dynamics_packs(chain.joints())), ArmNumber(0));
  }

  std::size_t joints() const { return model.joint_count(); }
  bool turns(std::size_t i) const { return model.joints[i].kind == JointKind::revolute; }

  // Returns the dynamics in the posture q. Their memory is the scratch.
  Dynamics make_dynamics() {
    ArmNumber* memory = scratch.data();
    Dynamics dynamics(ArmShape(chain.joints(), chain.flags().data(), chain.tilted_gravity()),
                      numbers.data(), memory);
    dynamics.set_posture(q.data(), true);
    return dynamics;
  }

  std::vector<Eigen::Isometry3d> calc_poses() const {
    std::vector<double> positions;
    for (const ArmNumber& number : q) {
      positions.push_back(number.v);
    }
    return calc_link_poses(model, positions);
  }

  void check() const {
    double sum = 0, farthest = -1;
    std::size_t worst = 0;
    for (std::size_t i = 0; i < joints(); ++i) {
      const double out = std::abs(q[i].v) + std::abs(rate[i].v);
      sum += out;
      if (std::isnan(farthest) || out <= farthest) {
        continue;
      }
      farthest = out;
      worst = i;
    }
    if (sum < kFarthest) {  // false for NaN too
      return;
    }
    if (!std::isfinite(q[worst].v) || !std::isfinite(rate[worst].v)) {
      throw DivergenceError(
          fmt::format("joint {} ({}): {}", worst + 1, model.joints[worst].name, kNotFinite));
    }
    throw DivergenceError(fmt::format("joint {} ({}): it is at {:.3g} {} and moves at {:.3g} {}",
                                      worst + 1, model.joints[worst].name, q[worst].v,
                                      turns(worst) ? "rad" : "m", rate[worst].v,
                                      turns(worst) ? "rad/s" : "m/s"));
  }

  const RobotModel& model;
  double gravity_m_per_s2;
  ChainModel chain;
  std::vector<ArmNumber> numbers, q, rate, acceleration, effort, scratch;
};

ArticulatedArm::ArticulatedArm(const RobotModel& model, std::span<const double> q,
                               const PhysicsSettings& physics)
    : chain_(std::make_unique<Chain>(model, physics.gravity_m_per_s2)) {
  for (std::size_t i = 0; i < chain_->joints(); ++i) {
    chain_->q[i] = q[i];
  }
}

ArticulatedArm::~ArticulatedArm() = default;

void ArticulatedArm::set_state(std::span<const double> q, std::span<const double> qd) {
  for (std::size_t i = 0; i < chain_->joints(); ++i) {
    chain_->q[i] = q[i];
    chain_->rate[i] = qd[i];
  }
}

void ArticulatedArm::step(std::span<const double> effort, double dt_s,
                          std::span<const double> inertia) {
  Chain& c = *chain_;
  for (std::size_t i = 0; i < c.joints(); ++i) {
    if (!std::isfinite(effort[i])) {
      throw DivergenceError(
          fmt::format("joint {} ({}): its controller asks for a non-finite effort", i + 1,
                      c.model.joints[i].name));
    }
    c.effort[i] = effort[i];
  }
  Dynamics dynamics = c.make_dynamics();
  dynamics.calc_equations(c.q.data(), c.rate.data());
  for (std::size_t i = 0; i < inertia.size(); ++i) {
    dynamics.add_inertia(static_cast<int>(i), inertia[i]);
  }
  dynamics.solve(c.effort.data(), c.acceleration.data());
  for (std::size_t i = 0; i < c.joints(); ++i) {
    c.rate[i].v += dt_s * c.acceleration[i].v;
    c.q[i].v += dt_s * c.rate[i].v;
  }
  c.check();
}

void ArticulatedArm::read_positions(std::span<double> q) const {
  for (std::size_t i = 0; i < chain_->joints(); ++i) {
    q[i] = chain_->turns(i) ? wrap_angle(chain_->q[i].v) : chain_->q[i].v;
  }
}

void ArticulatedArm::read_rates(std::span<double> qd) const {
  for (std::size_t i = 0; i < chain_->joints(); ++i) {
    qd[i] = chain_->rate[i].v;
  }
}

Vector3d ArticulatedArm::tip_position_m() const {
  const Vec3<ArmNumber> tip = chain_->make_dynamics().calc_tip(chain_->q.data());
  return chain_->chain.base_pose() * Vector3d(tip.x.v, tip.y.v, tip.z.v);
}

Vector3d ArticulatedArm::tool_point_m(std::size_t point) const {
  const Vec3<ArmNumber> place =
      chain_->make_dynamics().calc_tool_point(chain_->q.data(), static_cast<int>(point));
  return chain_->chain.base_pose() * Vector3d(place.x.v, place.y.v, place.z.v);
}

Vector3d ArticulatedArm::com_position_m(std::size_t link) const {
  return chain_->calc_poses()[link] * chain_->model.links[link].inertial.com_m;
}

double ArticulatedArm::calc_kinetic_energy_j() const {
  const RobotModel& model = chain_->model;
  const auto poses = chain_->calc_poses();
  Vector3d spin = Vector3d::Zero(), speed = Vector3d::Zero();  // of the link's origin
  Vector3d before = Vector3d::Zero();                          // the origin of the link before
  double energy_j = 0;
  for (std::size_t i = 0; i < model.joint_count(); ++i) {
    const Vector3d axis = poses[i].linear() * model.joints[i].axis;
    speed += spin.cross(poses[i].translation() - before);
    before = poses[i].translation();
    (chain_->turns(i) ? spin : speed) += chain_->rate[i].v * axis;
    const Inertial& body = model.links[i].inertial;
    const Vector3d local = poses[i].linear().transpose() * spin;
    const Vector3d com_speed = speed + spin.cross(poses[i].linear() * body.com_m);
    energy_j +=
        0.5 * body.mass_kg * com_speed.squaredNorm() + 0.5 * local.dot(body.inertia_kg_m2 * local);
  }
  return energy_j;
}

double ArticulatedArm::calc_potential_energy_j() const {
  const auto poses = chain_->calc_poses();
  double energy_j = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Inertial& body = chain_->model.links[i].inertial;
    energy_j += body.mass_kg * chain_->gravity_m_per_s2 * (poses[i] * body.com_m).z();
  }
  return energy_j;
}

Eigen::MatrixXd ArticulatedArm::calc_mass_matrix() const {
  Dynamics dynamics = chain_->make_dynamics();
  dynamics.calc_equations(chain_->q.data(), chain_->rate.data());
  const int n = chain_->chain.joints();
  Eigen::MatrixXd mass(n, n);
  for (int row = 0; row < n; ++row) {
    for (int column = 0; column <= row; ++column) {
      mass(row, column) = mass(column, row) = dynamics.mass(row, column).v;
    }
    const JointPlant& plant = chain_->model.joints[static_cast<std::size_t>(row)].plant;
    mass(row, row) += plant.is_elastic() ? 0 : plant.armature;
  }
  return mass;
}

Eigen::VectorXd ArticulatedArm::calc_bias() const {
  Dynamics dynamics = chain_->make_dynamics();
  dynamics.calc_equations(chain_->q.data(), chain_->rate.data());
  Eigen::VectorXd bias(chain_->chain.joints());
  for (int row = 0; row < bias.size(); ++row) {
    bias[row] = dynamics.bias(row).v;
  }
  return bias;
}

}  // namespace armwright
