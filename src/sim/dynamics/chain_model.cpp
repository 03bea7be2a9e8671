#include "sim/dynamics/chain_model.hpp"

#include <cmath>

namespace armwright::articulated {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Directions that differ by less are treated as equal; rotations in the file are rounded.
constexpr double kSameDirection = 1e-12;
// The least sine of the angle between two axes for which sliding origins along them is well
// conditioned.
constexpr double kWellApart = 0.1;

Vector3d make_perpendicular(const Vector3d& axis) {
  const Vector3d other =
      std::abs(axis.x()) < 0.9 ? Vector3d(Vector3d::UnitX()) : Vector3d(Vector3d::UnitY());
  return (other - other.dot(axis) * axis).normalized();
}

double calc_angle_about(const Vector3d& axis, const Vector3d& from, const Vector3d& to) {
  return std::atan2(from.cross(to).dot(axis), from.dot(to));
}

double snap(double value) {
  return std::abs(value) < kSameDirection ? 0 : value;
}

}  // namespace

// A link while the model is built. Before connect(), x, z and origin are given in the world with
// all joints at zero. connect() computes the parameters of the frames' transforms from them.
struct ChainModel::Link {
  bool prismatic = false;
  bool same_axis = false;
  Vector3d x, z, origin;
  double angle = 0;
  double twist_cos = 1, twist_sin = 0;
  Vector3d offset = Vector3d::Zero();  // in the frame of the link before
  // Mass and moments about the frame's origin, in the frame's axes.
  double mass = 0;
  Vector3d first = Vector3d::Zero();
  Matrix3d second = Matrix3d::Zero();
};

ChainModel::ChainModel(const RobotModel& robot, double gravity_m_per_s2) {
  std::vector<Link> links(robot.joint_count());
  place_frames(robot, links, gravity_m_per_s2);
  connect(links);
  reduce(links);

  const std::size_t n = links.size();
  numbers_.assign(static_cast<std::size_t>(calc_model_packs(joints())), 0);
  for (std::size_t i = 0; i < n; ++i) {
    const Link& link = links[i];
    const auto set = [&](ModelField field, double value) { numbers_[field * n + i] = value; };
    set(kAngle, link.angle);
    set(kTwistCos, link.twist_cos);
    set(kTwistSin, link.twist_sin);
    set(kOffsetX, link.offset.x());
    set(kOffsetY, link.offset.y());
    set(kOffsetZ, link.offset.z());
    set(kMomentX, link.first.x());
    set(kMomentY, link.first.y());
    set(kSecondXX, link.second(0, 0));
    set(kSecondXY, link.second(0, 1));
    set(kSecondXZ, link.second(0, 2));
    set(kSecondYY, link.second(1, 1));
    set(kSecondYZ, link.second(1, 2));
    set(kMass, link.mass);
    set(kMomentZ, link.first.z());
  }
  double* singles = numbers_.data() + kModelFields * n;
  const Vector3d up = base_pose_.linear().transpose() * Vector3d(0, 0, gravity_m_per_s2);
  singles[kGravityX] = tilted_gravity_ ? up.x() : 0;
  singles[kGravityZ] = up.z();

  Eigen::Isometry3d last =
      Eigen::Isometry3d::Identity();  // the last link's pose in URDF, all joints at zero
  for (const Joint& joint : robot.joints) {
    last = last * joint.origin;
  }
  const Vector3d y = links.back().z.cross(links.back().x);
  const auto set_point = [&](double* out, const Vector3d& in_last_link) {
    const Vector3d point = last * in_last_link - links.back().origin;
    out[0] = point.dot(links.back().x);
    out[1] = snap(point.dot(y));
    out[2] = point.dot(links.back().z);
  };
  set_point(singles + kTipX, robot.tip_pose.translation());
  for (std::size_t k = 0; k < robot.tool_points_m.size(); ++k) {
    set_point(singles + kToolX + 3 * k, robot.tool_points_m[k]);
  }
}

void ChainModel::place_frames(const RobotModel& robot, std::vector<Link>& links,
                              double gravity_m_per_s2) {
  const std::size_t n = links.size();
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (std::size_t i = 0; i < n; ++i) {
    pose = pose * robot.joints[i].origin;
    links[i].z = (pose.linear() * robot.joints[i].axis).normalized();
    links[i].origin = pose.translation();
    links[i].prismatic = robot.joints[i].kind == JointKind::prismatic;
    prismatic_ |= links[i].prismatic;
    if (i > 0) {
      links[i].same_axis = (links[i].z - links[i - 1].z).norm() < kSameDirection;
    }
  }
  // Moves all origins of a group to the same height along the group's axis.
  for (std::size_t i = 1; i < n; ++i) {
    if (links[i].same_axis) {
      links[i].origin -= links[i].z.dot(links[i].origin - links[i - 1].origin) * links[i].z;
    }
  }
  // Chooses the x axes: perpendicular to the next group's axis, or towards the next joint of the
  // group.
  for (std::size_t i = 0; i < n; ++i) {
    links[i].x = make_perpendicular(links[i].z);
    if (i + 1 == n) {
      break;
    }
    const Vector3d way = links[i + 1].origin - links[i].origin;
    const Vector3d x = links[i + 1].same_axis ? way : Vector3d(links[i].z.cross(links[i + 1].z));
    if (x.norm() > kSameDirection) {
      links[i].x = x.normalized();
    }
  }
  // Slides the groups' origins along their axes to remove components of offsets.
  const auto slide = [&](std::size_t first, double way_m) {
    for (std::size_t i = first; i < n && (i == first || links[i].same_axis); ++i) {
      links[i].origin += way_m * links[first].z;
    }
  };
  bool first_transition = true;
  for (std::size_t i = 1; i < n; ++i) {
    if (links[i].same_axis) {
      continue;
    }
    const Link& before = links[i - 1];
    const double sine = before.z.cross(links[i].z).norm();
    if (sine > kWellApart) {
      // In the frame before, the new group's z axis is (0, -sine, cosine). The slide makes the
      // offset's y component 0.
      const Vector3d y = before.z.cross(before.x);
      slide(i, y.dot(links[i].origin - before.origin) / sine);
    }
    if (first_transition) {
      slide(0, before.z.dot(links[i].origin - before.origin));
      first_transition = false;
    }
  }

  // Turns the base's frame so that gravity lies in its x-z plane.
  const Vector3d up(0, 0, 1);
  const Vector3d across = up - up.dot(links[0].z) * links[0].z;
  tilted_gravity_ = gravity_m_per_s2 != 0 && across.norm() > kSameDirection;
  const Vector3d x = tilted_gravity_ ? across.normalized() : make_perpendicular(links[0].z);
  base_pose_.linear().col(0) = x;
  base_pose_.linear().col(1) = links[0].z.cross(x);
  base_pose_.linear().col(2) = links[0].z;
  base_pose_.translation() = links[0].origin;

  // Computes the moments of mass about the new origins.
  pose = Eigen::Isometry3d::Identity();
  for (std::size_t i = 0; i < n; ++i) {
    pose = pose * robot.joints[i].origin;
    Link& link = links[i];
    Matrix3d axes;
    axes << link.x, link.z.cross(link.x), link.z;
    const Inertial& body = robot.links[i].inertial;
    const Matrix3d turn = axes.transpose() * pose.linear();
    const Vector3d com = axes.transpose() * (pose * body.com_m - link.origin);
    const Matrix3d inertia = turn * body.inertia_kg_m2 * turn.transpose();
    link.mass = body.mass_kg;
    link.first = body.mass_kg * com;
    link.second = 0.5 * inertia.trace() * Matrix3d::Identity() - inertia +
                  body.mass_kg * com * com.transpose();
  }
}

void ChainModel::connect(std::vector<Link>& links) {
  for (std::size_t i = 0; i < links.size(); ++i) {
    Link& link = links[i];
    const Vector3d from = i == 0 ? Vector3d(base_pose_.linear().col(0)) : links[i - 1].x;
    link.angle = calc_angle_about(link.z, from, link.x);
    if (i > 0) {
      const Link& before = links[i - 1];
      const Vector3d way = link.origin - before.origin;
      link.offset = {way.dot(before.x), way.dot(before.z.cross(before.x)), way.dot(before.z)};
      if (!link.same_axis) {
        // For a small twist the cosine rounds to 1 before the sine becomes 0. The cosine is set to
        // exactly +-1 only if the sine is 0.
        link.twist_cos = snap(before.z.dot(link.z));
        link.twist_sin = link.twist_cos == 0 ? 1 : snap(before.z.cross(link.z).norm());
        if (link.twist_sin == 0) {
          link.twist_cos = std::copysign(1.0, link.twist_cos);
        }
      }
    }
    // Lengths below 1e-12 m are rounding errors.
    for (double* component : {&link.offset.y(), &link.offset.z()}) {
      *component = std::abs(*component) < kSameDirection ? 0 : *component;
    }
    int flags = link.prismatic ? kPrismatic : 0;
    flags |= link.same_axis ? kSameAxis : 0;
    flags |= !link.same_axis && link.twist_cos == 0 ? kRightAngle : 0;
    flags |= link.offset.y() == 0 && link.offset.z() == 0 ? kAlongX : 0;
    flags_.push_back(static_cast<std::uint8_t>(flags));
  }
}

void ChainModel::reduce(std::vector<Link>& links) {
  for (std::size_t i = links.size(); i-- > 0;) {
    Link& link = links[i];
    Matrix3d twist;
    twist << 1, 0, 0, 0, link.twist_cos, -link.twist_sin, 0, link.twist_sin, link.twist_cos;
    Link nowhere;  // takes the mass that moves to the fixed base; it has no effect
    Link& before = i > 0 ? links[i - 1] : nowhere;
    if (link.prismatic) {
      const Matrix3d turn =
          twist * Eigen::AngleAxisd(link.angle, Vector3d::UnitZ()).toRotationMatrix();
      before.second += turn * link.second * turn.transpose();
      link.second.setZero();
      continue;
    }
    const Vector3d axis = twist.col(2);
    const double along = link.first.z();
    before.mass += link.mass;
    before.first += link.mass * link.offset + along * axis;
    before.second += link.mass * link.offset * link.offset.transpose() +
                     along * (link.offset * axis.transpose() + axis * link.offset.transpose()) +
                     link.second(2, 2) * axis * axis.transpose();
    link.mass = 0;
    link.first.z() = 0;
    link.second(2, 2) = 0;
  }
}

}  // namespace armwright::articulated
