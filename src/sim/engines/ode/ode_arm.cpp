#include "sim/engines/ode/ode_arm.hpp"

#include <fmt/format.h>
#include <ode/ode.h>

#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <mutex>
#include <vector>

#include "sim/tracking/engine_support.hpp"

namespace armwright {
namespace {

// ODE reports errors through process-wide handlers and then aborts the process. These handlers
// throw instead, and the owner discards the world that was being stepped.
[[noreturn]] void throw_ode_message(int number, const char* format, va_list arguments) {
  char text[512];
  std::vsnprintf(text, sizeof text, format, arguments);
  throw DivergenceError(fmt::format("ODE stopped (message {}): {}", number, text));
}

// Owns the library's global state. The only object is made before the first world and destroyed at
// the end of the process.
class OdeLibrary {
 public:
  OdeLibrary() {
    dInitODE2(dInitFlagManualThreadCleanup);
    dSetErrorHandler(throw_ode_message);
    dSetDebugHandler(throw_ode_message);
  }
  ~OdeLibrary() { dCloseODE(); }
  OdeLibrary(const OdeLibrary&) = delete;
  OdeLibrary& operator=(const OdeLibrary&) = delete;
};

// Owns the data that ODE keeps per thread, until the thread ends.
class OdeThread {
 public:
  OdeThread() { dAllocateODEDataForThread(dAllocateMaskAll); }
  ~OdeThread() { dCleanupODEAllDataForThread(); }
  OdeThread(const OdeThread&) = delete;
  OdeThread& operator=(const OdeThread&) = delete;
};

void prepare_ode_on_this_thread() {
  static const OdeLibrary library;
  thread_local const OdeThread thread;
}

// Frees an object of ODE with the function that ODE has for it.
template <auto kFree>
struct OdeDeleter {
  void operator()(auto* object) const { kFree(object); }
};
// All worlds share one default threading implementation without locks, and stepping two worlds in
// two threads would corrupt its job list. Therefore each world gets a single-threaded one of its
// own, which must outlive the world.
using OdeThreading =
    std::unique_ptr<dxThreadingImplementation, OdeDeleter<dThreadingFreeImplementation>>;
// A step that ODE abandons leaves its jobs in the list of its threading implementation. Freeing the
// implementation would fail an assertion, which throws in a destructor; using it again would run
// the old jobs. So this function keeps it (some hundred bytes) until the process ends.
void abandon(dxThreadingImplementation* threading) {
  static std::mutex mutex;
  static auto* const abandoned = new std::vector<dxThreadingImplementation*>;
  const std::lock_guard lock(mutex);
  abandoned->push_back(threading);
}

Eigen::Vector3d to_eigen(const dReal* v) {
  return {v[0], v[1], v[2]};
}

// The child comes first, so that positions, rates and efforts have the sign of the child's motion.
dJointID make_joint(dWorldID world, JointKind kind, dBodyID child, dBodyID parent,
                    const Eigen::Vector3d& anchor, const Eigen::Vector3d& axis) {
  if (kind == JointKind::prismatic) {
    const dJointID slider = dJointCreateSlider(world, nullptr);
    dJointAttach(slider, child, parent);
    dJointSetSliderAxis(slider, axis.x(), axis.y(), axis.z());
    return slider;
  }
  const dJointID hinge = dJointCreateHinge(world, nullptr);
  dJointAttach(hinge, child, parent);
  dJointSetHingeAnchor(hinge, anchor.x(), anchor.y(), anchor.z());
  dJointSetHingeAxis(hinge, axis.x(), axis.y(), axis.z());
  return hinge;
}

}  // namespace

struct OdeArm::World {
  const RobotModel* model;
  double gravity;
  OdeThreading threading;
  std::unique_ptr<dxWorld, OdeDeleter<dWorldDestroy>> world;  // destroys its bodies and joints too
  std::vector<dBodyID> bodies;
  std::vector<dJointID> joints;
  std::vector<double> start;  // joint positions

  // Returns a point of the last link's frame in the world.
  Eigen::Vector3d calc_place(const Eigen::Vector3d& in_last_link) const {
    const Eigen::Vector3d in_body = in_last_link - model->links.back().inertial.com_m;
    const dReal* p = dBodyGetPosition(bodies.back());
    const dReal* r = dBodyGetRotation(bodies.back());
    Eigen::Vector3d place;
    for (int row = 0; row < 3; ++row) {
      place[row] = p[row] + r[4 * row] * in_body.x() + r[4 * row + 1] * in_body.y() +
                   r[4 * row + 2] * in_body.z();
    }
    return place;
  }
  bool is_prismatic(std::size_t i) const { return model->joints[i].kind == JointKind::prismatic; }

  // Returns the speed of the slider's child along the axis, seen from the turning parent:
  //   a . (v_c - v_p - w_p x (p_c - p_p)).
  // dJointGetSliderPositionRate() leaves out the last term (ODE 0.16). That term is not zero if the
  // bodies' centres do not lie on one line along the axis.
  double calc_slide_rate(std::size_t i) const {
    dVector3 axis;
    dJointGetSliderAxis(joints[i], axis);
    Eigen::Vector3d velocity = to_eigen(dBodyGetLinearVel(bodies[i]));
    if (i > 0) {
      const dBodyID parent = bodies[i - 1];
      const Eigen::Vector3d apart =
          to_eigen(dBodyGetPosition(bodies[i])) - to_eigen(dBodyGetPosition(parent));
      velocity -=
          to_eigen(dBodyGetLinearVel(parent)) + to_eigen(dBodyGetAngularVel(parent)).cross(apart);
    }
    return to_eigen(axis).dot(velocity);
  }

  void check() const {
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const dReal* position = dBodyGetPosition(bodies[i]);
      const dReal* spin = dBodyGetAngularVel(bodies[i]);
      const double distance = std::abs(position[0]) + std::abs(position[1]) + std::abs(position[2]);
      const double rate = std::abs(spin[0]) + std::abs(spin[1]) + std::abs(spin[2]);
      if (distance < kFarthestLink_m && rate < kFastestLink_rad_per_s) {  // false for NaN too
        continue;
      }
      if (!std::isfinite(distance) || !std::isfinite(rate)) {
        throw DivergenceError(
            fmt::format("joint {} ({}): {}", i + 1, model->joints[i].name, kNotFinite));
      }
      throw DivergenceError(
          fmt::format("joint {} ({}): its link is {:.3g} m from the base and turns at {:.3g} rad/s",
                      i + 1, model->joints[i].name, distance, rate));
    }
  }
};

OdeArm::OdeArm(const RobotModel& model, std::span<const double> q, const PhysicsSettings& physics)
    : world_(std::make_unique<World>()) {
  prepare_ode_on_this_thread();
  World& w = *world_;
  w.model = &model;
  w.gravity = physics.gravity_m_per_s2;
  w.threading.reset(dThreadingAllocateSelfThreadedImplementation());
  w.world.reset(dWorldCreate());
  dWorldSetStepThreadingImplementation(
      w.world.get(), dThreadingImplementationGetFunctions(w.threading.get()), w.threading.get());
  dWorldSetGravity(w.world.get(), 0, 0, -physics.gravity_m_per_s2);
  dWorldSetERP(w.world.get(), physics.erp);
  dWorldSetCFM(w.world.get(), physics.cfm);
  dWorldSetAutoDisableFlag(w.world.get(), 0);
  w.start.assign(q.begin(), q.end());

  const auto poses = calc_link_poses(model, q);
  for (std::size_t i = 0; i < model.joint_count(); ++i) {
    const Inertial& inertial = model.links[i].inertial;
    const Eigen::Vector3d com = poses[i] * inertial.com_m;
    const Eigen::Matrix3d rotation = poses[i].linear();
    const Eigen::Matrix3d& inertia = inertial.inertia_kg_m2;

    const dBodyID body = dBodyCreate(w.world.get());
    dMass mass;
    dMassSetParameters(&mass, inertial.mass_kg, 0, 0, 0, inertia(0, 0), inertia(1, 1),
                       inertia(2, 2), inertia(0, 1), inertia(0, 2), inertia(1, 2));
    dBodySetMass(body, &mass);
    dBodySetPosition(body, com.x(), com.y(), com.z());
    dMatrix3 r = {};
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) {
        r[4 * row + column] = rotation(row, column);
      }
    }
    dBodySetRotation(body, r);
    dBodySetGyroscopicMode(body, 1);

    const dBodyID parent = i == 0 ? nullptr : w.bodies.back();
    w.joints.push_back(make_joint(w.world.get(), model.joints[i].kind, body, parent,
                                  poses[i].translation(), rotation * model.joints[i].axis));
    w.bodies.push_back(body);
  }
}

OdeArm::~OdeArm() = default;

// Lets a motor without a largest effort hold the joint's rate v_n softly. ODE adds the row
// v = v_n - CFM lambda, with lambda the motor's effort. With CFM = h / E, the effort is that of an
// added inertia, lambda = -E (v - v_n) / h.
void OdeArm::add_inertia(std::span<const double> inertia, double dt_s) {
  World& w = *world_;
  for (std::size_t i = 0; i < inertia.size(); ++i) {
    const bool slides = w.is_prismatic(i);
    const auto set = [&](int parameter, double value) {
      (slides ? dJointSetSliderParam : dJointSetHingeParam)(w.joints[i], parameter, value);
    };
    if (inertia[i] > 0) {
      set(dParamVel, slides ? w.calc_slide_rate(i) : dJointGetHingeAngleRate(w.joints[i]));
      set(dParamCFM, dt_s / inertia[i]);
    }
    set(dParamFMax, inertia[i] > 0 ? dInfinity : 0);
  }
}

void OdeArm::step(std::span<const double> effort, double dt_s, std::span<const double> inertia) {
  World& w = *world_;
  add_inertia(inertia, dt_s);
  for (std::size_t i = 0; i < w.joints.size(); ++i) {
    if (!std::isfinite(effort[i])) {
      throw DivergenceError(
          fmt::format("joint {} ({}): its controller asks for a non-finite effort", i + 1,
                      w.model->joints[i].name));
    }
    if (w.is_prismatic(i)) {
      dJointAddSliderForce(w.joints[i], effort[i]);
    } else {
      dJointAddHingeTorque(w.joints[i], effort[i]);
    }
  }
  try {
    dWorldStep(w.world.get(), dt_s);
  } catch (const DivergenceError&) {
    abandon(w.threading.release());
    throw;
  }
  w.check();
}

void OdeArm::read_positions(std::span<double> q) const {
  const World& w = *world_;
  for (std::size_t i = 0; i < w.joints.size(); ++i) {
    // ODE counts from the posture in which the joint was attached.
    q[i] = w.is_prismatic(i) ? w.start[i] + dJointGetSliderPosition(w.joints[i])
                             : wrap_angle(w.start[i] + dJointGetHingeAngle(w.joints[i]));
  }
}

void OdeArm::read_rates(std::span<double> qd) const {
  const World& w = *world_;
  for (std::size_t i = 0; i < w.joints.size(); ++i) {
    qd[i] = w.is_prismatic(i) ? w.calc_slide_rate(i) : dJointGetHingeAngleRate(w.joints[i]);
  }
}

Eigen::Vector3d OdeArm::tip_position_m() const {
  return world_->calc_place(world_->model->tip_pose.translation());
}

Eigen::Vector3d OdeArm::tool_point_m(std::size_t point) const {
  return world_->calc_place(world_->model->tool_points_m[point]);
}

Eigen::Vector3d OdeArm::com_position_m(std::size_t link) const {
  return to_eigen(dBodyGetPosition(world_->bodies[link]));
}

double OdeArm::calc_kinetic_energy_j() const {
  double energy = 0;
  for (std::size_t i = 0; i < world_->bodies.size(); ++i) {
    const Inertial& inertial = world_->model->links[i].inertial;
    const dReal* omega = dBodyGetAngularVel(world_->bodies[i]);
    dVector3 local;
    dBodyVectorFromWorld(world_->bodies[i], omega[0], omega[1], omega[2], local);
    const Eigen::Vector3d spin = to_eigen(local);
    const Eigen::Vector3d speed = to_eigen(dBodyGetLinearVel(world_->bodies[i]));
    energy += 0.5 * inertial.mass_kg * speed.squaredNorm() +
              0.5 * spin.dot(inertial.inertia_kg_m2 * spin);
  }
  return energy;
}

double OdeArm::calc_potential_energy_j() const {
  double energy = 0;
  for (std::size_t i = 0; i < world_->bodies.size(); ++i) {
    energy += world_->model->links[i].inertial.mass_kg * world_->gravity * com_position_m(i).z();
  }
  return energy;
}

}  // namespace armwright
