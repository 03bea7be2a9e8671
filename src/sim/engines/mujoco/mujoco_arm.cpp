#ifdef ARMWRIGHT_WITH_MUJOCO

#include "sim/engines/mujoco/mujoco_arm.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "base/decompositions.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "sim/kinematics/kinematics.hpp"
#include "sim/robot/mujoco_library.hpp"
#include "sim/tracking/engine_support.hpp"

namespace armwright {
namespace {

using ModelHandle = MujocoModelHandle;
using DataHandle = MujocoDataHandle;

[[noreturn]] void throw_mujoco_message(const char* message) {
  throw DivergenceError(fmt::format("MuJoCo stopped: {}", message));
}
void ignore_warning(const char* /*message*/) {}  // each step checks the counter that matters

// Sets the handlers. Without them MuJoCo writes a log file into the current folder, and an error
// ends the process.
void prepare_mujoco() {
  [[maybe_unused]] static const bool prepared = [] {
    mju_user_error = throw_mujoco_message;
    mju_user_warning = ignore_warning;
    return true;
  }();
}

std::string format_numbers(std::initializer_list<double> numbers) {
  std::vector<std::string> texts;
  for (const double number : numbers) {
    texts.push_back(format_exact(number));
  }
  return join(texts, " ");
}
std::string format_vector(const Eigen::Vector3d& v) {
  return format_numbers({v.x(), v.y(), v.z()});
}
std::string format_rotation(const Eigen::Matrix3d& rotation) {
  const Eigen::Quaterniond q(rotation);
  return format_numbers({q.w(), q.x(), q.y(), q.z()});
}

// Principal moments and axes of inertia; the axes are right-handed.
struct PrincipalInertia {
  Eigen::Vector3d moments_kg_m2;
  Eigen::Matrix3d axes;
};
PrincipalInertia calc_principal_inertia(const Eigen::Matrix3d& inertia_kg_m2) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(inertia_kg_m2);
  Eigen::Matrix3d axes = solver.eigenvectors();
  if (axes.determinant() < 0) {
    axes.col(2) = -axes.col(2);
  }
  return {solver.eigenvalues(), axes};
}

// Returns the chain in MuJoCo's own format, without names: bodies and joints are found by their
// number. The masses are placeholders. MuJoCo's compiler rejects moments of inertia that violate
// the triangle inequality by a rounding error; the URDF reader has checked that inequality already.
std::string make_mjcf(const RobotModel& robot, const PhysicsSettings& physics) {
  std::string text = fmt::format(
      R"(<mujoco><compiler angle="radian" inertiafromgeom="false"/><size njmax="0" nconmax="0"/>)"
      R"(<option integrator="Euler" gravity="{}">)"
      R"(<flag constraint="disable" contact="disable" passive="disable"/></option><worldbody>)",
      format_numbers({0, 0, -physics.gravity_m_per_s2}));
  for (std::size_t i = 0; i < robot.joint_count(); ++i) {
    const Joint& joint = robot.joints[i];
    const Inertial& inertial = robot.links[i].inertial;
    text += fmt::format(
        R"(<body pos="{}" quat="{}">)"
        R"(<inertial pos="{}" quat="{}" mass="1" diaginertia="1 1 1"/>)"
        R"(<joint type="{}" axis="{}" limited="false" damping="0" armature="0" frictionloss="0"/>)",
        format_vector(joint.origin.translation()), format_rotation(joint.origin.linear()),
        format_vector(inertial.com_m),
        format_rotation(calc_principal_inertia(inertial.inertia_kg_m2).axes),
        joint.kind == JointKind::prismatic ? "slide" : "hinge", format_vector(joint.axis));
  }
  for (std::size_t i = 0; i < robot.joint_count(); ++i) {
    text += "</body>";
  }
  return text + "</worldbody></mujoco>";
}

ModelHandle compile(const std::string& mjcf, const std::string& robot_name) {
  constexpr const char* kFile = "arm.xml";
  std::string message;
  ModelHandle model = compile_mjcf(kFile, {{kFile, mjcf}}, message);
  if (model == nullptr) {
    throw Error(ErrorKind::bad_data, fmt::format("MuJoCo does not take the robot '{}': {}",
                                                 sanitize(robot_name), sanitize(message)));
  }
  return model;
}

}  // namespace

struct MujocoModel {
  const RobotModel* robot;
  double gravity_m_per_s2;
  ModelHandle model;
};

std::shared_ptr<const MujocoModel> compile_for_mujoco(const RobotModel& robot,
                                                      const PhysicsSettings& physics) {
  prepare_mujoco();
  auto compiled = std::make_shared<MujocoModel>(MujocoModel{
      &robot, physics.gravity_m_per_s2, compile(make_mjcf(robot, physics), robot.name)});
  mjModel* const model = compiled->model.get();
  for (std::size_t i = 0; i < robot.joint_count(); ++i) {
    const Inertial& inertial = robot.links[i].inertial;
    const std::size_t body = i + 1;  // body 0 is the world
    model->body_mass[body] = inertial.mass_kg;
    const auto moments_kg_m2 = calc_principal_inertia(inertial.inertia_kg_m2).moments_kg_m2;
    std::copy(moments_kg_m2.begin(), moments_kg_m2.end(), model->body_inertia + 3 * body);
  }
  // Computes the numbers that MuJoCo derives from masses: subtrees' masses, inertias at position 0.
  const DataHandle data(mj_makeData(model));
  mj_setConst(model, data.get());
  return compiled;
}

struct MujocoArm::World {
  const RobotModel* robot;
  double gravity_m_per_s2;
  ModelHandle model;  // each arm has its own one because it holds the step's length
  DataHandle data;

  // Computes everything that can be read from the present state. mj_step1 and mj_step2 would do the
  // same, but they reset an arm to its start if they find its state bad.
  void update() {
    mj_fwdPosition(model.get(), data.get());
    mj_fwdVelocity(model.get(), data.get());
  }

  // Returns a point of the last link's frame in the world.
  Eigen::Vector3d calc_place(const Eigen::Vector3d& in_last_link) const {
    const std::size_t body = robot->joint_count();
    using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
    return Eigen::Map<const Eigen::Vector3d>(data->xpos + 3 * body) +
           Eigen::Map<const RowMajor>(data->xmat + 9 * body) * in_last_link;
  }
};

MujocoArm::MujocoArm(const MujocoModel& model, std::span<const double> q) {
  world_ = std::make_unique<World>();
  World& w = *world_;
  w.robot = model.robot;
  w.gravity_m_per_s2 = model.gravity_m_per_s2;
  w.model.reset(mj_copyModel(nullptr, model.model.get()));
  w.data.reset(mj_makeData(w.model.get()));
  std::copy(q.begin(), q.end(), w.data->qpos);
  w.update();
}

MujocoArm::MujocoArm(const RobotModel& robot, std::span<const double> q,
                     const PhysicsSettings& physics)
    : MujocoArm(*compile_for_mujoco(robot, physics), q) {}

MujocoArm::~MujocoArm() = default;

void MujocoArm::step(std::span<const double> effort, double dt_s, std::span<const double> inertia) {
  World& w = *world_;
  for (std::size_t i = 0; i < w.robot->joint_count(); ++i) {
    if (!std::isfinite(effort[i])) {
      throw DivergenceError(
          fmt::format("joint {} ({}): its controller asks for a non-finite effort", i + 1,
                      w.robot->joints[i].name));
    }
    w.data->qfrc_applied[i] = effort[i];
  }
  w.model->opt.timestep = dt_s;
  if (!inertia.empty()) {
    std::copy(inertia.begin(), inertia.end(), w.model->dof_armature);
    mj_crb(w.model.get(), w.data.get());
    mj_factorM(w.model.get(), w.data.get());
    std::fill_n(w.model->dof_armature, inertia.size(), 0.0);  // for this step alone
  }
  mj_fwdActuation(w.model.get(), w.data.get());
  mj_fwdAcceleration(w.model.get(), w.data.get());
  mj_fwdConstraint(w.model.get(), w.data.get());
  mj_Euler(w.model.get(), w.data.get());
  w.update();
  check();
}

void MujocoArm::check() const {
  const World& w = *world_;
  const mjWarningStat& singular = w.data->warning[mjWARN_INERTIA];
  if (singular.number > 0) {  // MuJoCo went on with another inertia
    const auto joint = static_cast<std::size_t>(singular.lastinfo);
    throw DivergenceError(fmt::format("joint {} ({}): what it moves has hardly any inertia",
                                      joint + 1, w.robot->joints[joint].name));
  }
  for (std::size_t i = 0; i < w.robot->joint_count(); ++i) {
    const double* position = w.data->xipos + 3 * (i + 1);
    const double* spin = w.data->cvel + 6 * (i + 1);  // its first half
    const double distance = std::abs(position[0]) + std::abs(position[1]) + std::abs(position[2]);
    const double rate = std::abs(spin[0]) + std::abs(spin[1]) + std::abs(spin[2]);
    if (distance < kFarthestLink_m && rate < kFastestLink_rad_per_s) {  // false for NaN too
      continue;
    }
    if (!std::isfinite(distance) || !std::isfinite(rate)) {
      throw DivergenceError(
          fmt::format("joint {} ({}): {}", i + 1, w.robot->joints[i].name, kNotFinite));
    }
    throw DivergenceError(
        fmt::format("joint {} ({}): its link is {:.3g} m from the base and turns at {:.3g} rad/s",
                    i + 1, w.robot->joints[i].name, distance, rate));
  }
}

void MujocoArm::read_positions(std::span<double> q) const {
  for (std::size_t i = 0; i < world_->robot->joint_count(); ++i) {
    const double position = world_->data->qpos[i];
    q[i] = world_->robot->joints[i].kind == JointKind::prismatic ? position : wrap_angle(position);
  }
}

void MujocoArm::read_rates(std::span<double> qd) const {
  std::copy_n(world_->data->qvel, world_->robot->joint_count(), qd.begin());
}

Eigen::Vector3d MujocoArm::tip_position_m() const {
  return world_->calc_place(world_->robot->tip_pose.translation());
}

Eigen::Vector3d MujocoArm::tool_point_m(std::size_t point) const {
  return world_->calc_place(world_->robot->tool_points_m[point]);
}

Eigen::Vector3d MujocoArm::com_position_m(std::size_t link) const {
  return Eigen::Map<const Eigen::Vector3d>(world_->data->xipos + 3 * (link + 1));
}

double MujocoArm::calc_kinetic_energy_j() const {
  const World& w = *world_;
  std::vector<double> momentum(w.robot->joint_count());
  mj_mulM(w.model.get(), w.data.get(), momentum.data(), w.data->qvel);
  return 0.5 * mju_dot(momentum.data(), w.data->qvel, static_cast<int>(momentum.size()));
}

double MujocoArm::calc_potential_energy_j() const {
  double energy = 0;
  for (std::size_t i = 0; i < world_->robot->joint_count(); ++i) {
    energy +=
        world_->robot->links[i].inertial.mass_kg * world_->gravity_m_per_s2 * com_position_m(i).z();
  }
  return energy;
}

}  // namespace armwright

#endif
