// Makes a RobotModel of a compiled MJCF file: joins bodies that do not move, and places joints,
// masses and shapes.

#include <fmt/format.h>

#include "base/decompositions.hpp"
#include "base/error.hpp"
#include "sim/robot/mjcf.hpp"

#ifdef ARMWRIGHT_WITH_MUJOCO

#include <algorithm>
#include <cmath>

#include "base/text.hpp"
#include "sim/robot/mjcf_parts.hpp"

namespace armwright {
namespace {

Eigen::Isometry3d make_body_pose(const mjtNum* position, const Eigen::Matrix3d& rotation) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = Eigen::Vector3d(position[0], position[1], position[2]);
  pose.linear() = rotation;
  return pose;
}

Eigen::Matrix3d make_rotation_of(const mjtNum* quaternion) {  // w, x, y, z
  return Eigen::Quaterniond(quaternion[0], quaternion[1], quaternion[2], quaternion[3])
      .normalized()
      .toRotationMatrix();
}

class MjcfBuilder {
 public:
  MjcfBuilder(const CompiledMjcf& mjcf, const MjcfChain& chain, const RobotOptions& options)
      : mjcf_(mjcf), m_(*mjcf.model), chain_(chain), options_(options) {}

  RobotModel build() {
    robot_.name = sanitize(m_.names);  // the model's name comes first
    robot_.base.name = mjcf_.body_name(0);
    robot_.reading.packages = options_.packages;
    add_choice(chain_.choice, robot_);
    place_bodies();
    for (std::size_t i = 0; i < chain_.joints.size(); ++i) {
      add_joint(i);
    }
    for (int body = 1; body < m_.nbody; ++body) {
      lump(body);
    }
    add_shapes(robot_, mjcf_, chain_, in_links_);
    const int site = chain_.site;
    robot_.tip_pose = in_links_[to_size(chain_.tip)];
    if (site >= 0) {
      robot_.tip_pose = robot_.tip_pose * make_body_pose(m_.site_pos + 3 * site,
                                                         make_rotation_of(m_.site_quat + 4 * site));
    }
    check_masses();
    robot_.notes = mjcf_.text.notes;
    note_gravity();
    note_plants();
    note_held();
    return std::move(robot_);
  }

 private:
  bool is_held(int joint) const {
    return std::ranges::find(chain_.joints, joint) == chain_.joints.end();
  }
  bool slides(int joint) const { return m_.jnt_type[joint] == mjJNT_SLIDE; }

  // Returns the position at which a hinge or slide joint outside the chain is held: that in which
  // the file shows the robot (ref), or the nearest end of its range.
  double held_position(int joint) const {
    const double reference = m_.qpos0[m_.jnt_qposadr[joint]];
    return m_.jnt_limited[joint] != 0
               ? std::clamp(reference, m_.jnt_range[2 * joint], m_.jnt_range[2 * joint + 1])
               : reference;
  }

  // Computes the pose of each body in the frame of the link that carries it. The joints of the
  // chain are at the positions in which the file shows the robot.
  void place_bodies() {
    const MujocoDataHandle data(mj_makeData(&m_));
    if (data == nullptr) {
      throw std::bad_alloc();
    }
    for (int joint = 0; joint < m_.njnt; ++joint) {
      if (is_held(joint) && (slides(joint) || m_.jnt_type[joint] == mjJNT_HINGE)) {
        data->qpos[m_.jnt_qposadr[joint]] = held_position(joint);
      }
    }
    mj_kinematics(&m_, data.get());
    std::vector<Eigen::Isometry3d> poses;  // of the bodies in the world
    for (int body = 0; body < m_.nbody; ++body) {
      poses.push_back(
          make_body_pose(data->xpos + 3 * body, make_rotation_of(data->xquat + 4 * body)));
    }
    // A link's frame has the axes of its body, and its origin is on the joint's axis.
    links_.assign(chain_.joints.size() + 1, Eigen::Isometry3d::Identity());
    for (std::size_t i = 0; i < chain_.joints.size(); ++i) {
      const int joint = chain_.joints[i];
      links_[i + 1] = poses[to_size(m_.jnt_bodyid[joint])] *
                      make_body_pose(m_.jnt_pos + 3 * joint, Eigen::Matrix3d::Identity());
    }
    for (int body = 0; body < m_.nbody; ++body) {
      in_links_.push_back(links_[chain_.carriers[to_size(body)]].inverse() * poses[to_size(body)]);
    }
  }

  void add_joint(std::size_t number) {
    const int id = chain_.joints[number];
    Joint joint;
    joint.name = mjcf_.joint_name(id);
    joint.kind = slides(id) ? JointKind::prismatic : JointKind::revolute;
    joint.axis = Eigen::Map<const Eigen::Vector3d>(m_.jnt_axis + 3 * id).normalized();
    // The file shows the robot with this joint at its reference; the origin is for position 0.
    const double reference = m_.qpos0[m_.jnt_qposadr[id]];
    joint.origin = links_[number].inverse() * links_[number + 1];
    if (slides(id)) {
      joint.origin.translate(-reference * joint.axis);
    } else {
      joint.origin.rotate(Eigen::AngleAxisd(-reference, joint.axis));
    }
    joint.lower = -kNoMjcfLimit;
    joint.upper = kNoMjcfLimit;
    joint.speed_limit = kNoMjcfLimit;  // MJCF has none
    if (m_.jnt_limited[id] != 0) {
      joint.lower = m_.jnt_range[2 * id];
      joint.upper = m_.jnt_range[2 * id + 1];
      if (!std::isfinite(joint.lower) || !std::isfinite(joint.upper) || joint.lower > joint.upper) {
        mjcf_.fail_joint(id, fmt::format("has the range {} to {}; it must be finite, with the "
                                         "smaller end first",
                                         joint.lower, joint.upper));
      }
    } else if (slides(id)) {
      mjcf_.fail_joint(id, "slides and has no range; give it one, in m");
    }
    joint.effort_limit = find_effort_limit(mjcf_, id, effort_notes_);
    if (options_.dynamics) {
      joint.plant = read_plant(mjcf_, id, joint);
    } else if (!is_ideal(id)) {
      without_plant_.push_back(fmt::format("'{}'", joint.name));
    }
    robot_.joints.push_back(std::move(joint));
    robot_.links.emplace_back().name = mjcf_.body_name(m_.jnt_bodyid[id]);
  }

  bool is_ideal(int joint) const {
    const int dof = m_.jnt_dofadr[joint];
    return m_.dof_armature[dof] == 0 && m_.dof_damping[dof] == 0 && m_.dof_frictionloss[dof] == 0 &&
           m_.jnt_stiffness[joint] == 0;
  }

  // Adds a body's mass to the link that carries it.
  void lump(int body) {
    Inertial inertial;
    inertial.mass_kg = m_.body_mass[body];
    if (inertial.mass_kg == 0) {
      return;
    }
    const Eigen::Matrix3d axes = make_rotation_of(m_.body_iquat + 4 * body);
    inertial.com_m = Eigen::Map<const Eigen::Vector3d>(m_.body_ipos + 3 * body);
    inertial.inertia_kg_m2 =
        axes * Eigen::Map<const Eigen::Vector3d>(m_.body_inertia + 3 * body).asDiagonal() *
        axes.transpose();
    const std::size_t carrier = chain_.carriers[to_size(body)];
    Inertial& sum = (carrier == 0 ? robot_.base : robot_.links[carrier - 1]).inertial;
    inertial = transform(inertial, in_links_[to_size(body)]);
    sum = sum.mass_kg == 0 ? inertial : combine(sum, inertial);
  }

  void check_masses() const {
    for (std::size_t i = 0; i < robot_.links.size(); ++i) {
      const Inertial& inertial = robot_.links[i].inertial;
      const Joint& joint = robot_.joints[i];
      if (!joint.origin.matrix().allFinite() || !inertial.com_m.allFinite() ||
          !inertial.inertia_kg_m2.allFinite() || !std::isfinite(inertial.mass_kg)) {
        mjcf_.fail_joint(chain_.joints[i], "its place or mass is not a finite number");
      }
      const Eigen::Vector3d moments = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(
                                          inertial.inertia_kg_m2, Eigen::EigenvaluesOnly)
                                          .eigenvalues();
      if (!(inertial.mass_kg > 0) || !(moments[0] > 0)) {
        mjcf_.fail_joint(
            chain_.joints[i],
            fmt::format("moves body '{}', which has {:.4g} kg and the smallest principal moment "
                        "{:.4g} kg m2; both must be > 0: give the body an <inertial>",
                        robot_.links[i].name, inertial.mass_kg, moments[0]));
      }
    }
  }

  void note_gravity() {
    const mjtNum* g = m_.opt.gravity;
    const bool is_off = (m_.opt.disableflags & mjDSBL_GRAVITY) != 0;
    if (is_off || g[0] != 0 || g[1] != 0 || g[2] != -9.81) {
      robot_.notes.push_back(
          fmt::format("the file's gravity, {}, is left out: physics.gravity_m_per_s2 acts along -z",
                      is_off ? "none" : fmt::format("{:g} {:g} {:g} m/s2", g[0], g[1], g[2])));
    }
  }

  void note_plants() {
    if (!without_plant_.empty()) {
      robot_.notes.push_back(
          fmt::format("joints are simulated without the armature, damping, frictionloss and "
                      "stiffness of {}; robot.dynamics = true gives them",
                      join(without_plant_, ", ")));
    }
    robot_.notes.insert(robot_.notes.end(), effort_notes_.begin(), effort_notes_.end());
    std::vector<std::string> free;
    for (const Joint& joint : robot_.joints) {
      if (std::isinf(joint.effort_limit)) {
        free.push_back(fmt::format("'{}'", joint.name));
      }
    }
    if (!free.empty()) {
      robot_.notes.push_back(
          fmt::format("no actuator limits the effort of {}: they have no limit", join(free, ", ")));
    }
  }

  // Names the joints outside the chain, with the mass of the bodies up to the next such joint.
  void note_held() {
    std::vector<int> holders(to_size(m_.nbody), -1);  // the body with the held joint above
    std::vector<double> masses_kg(to_size(m_.nbody), 0);
    for (int body = 1; body < m_.nbody; ++body) {
      const int joint = m_.body_jntadr[body];
      int& holder = holders[to_size(body)];
      holder = m_.body_jntnum[body] == 0 ? holders[to_size(m_.body_parentid[body])]
               : is_held(joint)          ? body
                                         : -1;
      if (holder >= 0) {
        masses_kg[to_size(holder)] += m_.body_mass[body];
      }
    }
    for (int joint = 0; joint < m_.njnt; ++joint) {
      if (!is_held(joint)) {
        continue;
      }
      const std::size_t body = to_size(m_.jnt_bodyid[joint]);
      const std::size_t carrier = chain_.carriers[body];
      const bool is_simple = slides(joint) || m_.jnt_type[joint] == mjJNT_HINGE;
      robot_.held_joints.push_back(mjcf_.joint_name(joint));
      const std::string held_at =
          is_simple ? fmt::format("{:.6g} {}", held_position(joint), slides(joint) ? "m" : "rad")
                    : "the pose of the file";
      robot_.notes.push_back(
          describe_held(robot_, mjcf_.joint_name(joint), held_at, masses_kg[body], carrier));
    }
  }

  const CompiledMjcf& mjcf_;
  const mjModel& m_;
  const MjcfChain& chain_;
  const RobotOptions& options_;
  RobotModel robot_;
  std::vector<Eigen::Isometry3d> links_;     // frame 0 is the world, i + 1 that of joint i
  std::vector<Eigen::Isometry3d> in_links_;  // poses of bodies in their carriers' frames
  std::vector<std::string> without_plant_, effort_notes_;
};

}  // namespace

RobotModel parse_mjcf(std::string_view xml, const std::string& name, const RobotOptions& options) {
  if (options.density_kg_per_m3 > 0) {
    throw RobotOptionError("density_kg_per_m3",
                           fmt::format("{}: is MJCF, which gives every geom a density; leave the "
                                       "setting out",
                                       name));
  }
  CompiledMjcf mjcf = compile_prepared(prepare_mjcf(xml, name), name);
  const MjcfChain chain = choose_mjcf_chain(mjcf, options);
  auto mass_files = load_mesh_masses(mjcf, options.packages,
                                     [&](int body) { return chain.carriers[to_size(body)] > 0; });
  mass_files.insert(mjcf.text.included.begin(), mjcf.text.included.end());
  RobotModel robot = MjcfBuilder(mjcf, chain, options).build();
  robot.mass_files = std::move(mass_files);
  return robot;
}

}  // namespace armwright

#else

namespace armwright {

RobotModel parse_mjcf(std::string_view xml, const std::string& name, const RobotOptions&) {
  prepare_mjcf(xml, name);
  throw Error(ErrorKind::bad_data,
              fmt::format("{}: is MJCF, which needs the library MuJoCo: install libmujoco-dev and "
                          "build with -DARMWRIGHT_WITH_MUJOCO=ON, or use a URDF",
                          name));
}

}  // namespace armwright

#endif
