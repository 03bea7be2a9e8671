// Robots: a model has finite numbers only, masses that are positive and axes that are unit vectors.
// As it is, up to the first leaf at a density where its links branch or have no mass, and with
// repairs. A file in which these are done needs none.
#include <cmath>

#include "fuzz/harness.hpp"
#include "sim/robot/robot_model.hpp"
#include "sim/robot/urdf_writer.hpp"

namespace armwright::fuzz {
namespace {

bool is_rigid(const Eigen::Isometry3d& pose) {
  return pose.matrix().allFinite() && (pose.linear() * pose.linear().transpose()).isIdentity(1e-9);
}

void check_link(const Link& link, bool moves) {
  const Inertial& body = link.inertial;
  require(std::isfinite(body.mass_kg) && body.mass_kg >= 0 && (!moves || body.mass_kg > 0),
          "a mass is " + std::to_string(body.mass_kg));
  require(body.com_m.allFinite(), "a centre of mass is not finite");
  require(body.inertia_kg_m2.allFinite(), "an inertia is not finite");
  require(body.mass_kg == 0 || body.inertia_kg_m2.diagonal().minCoeff() > 0,
          "an inertia is not positive");
  for (const VisualShape& shape : link.visuals) {
    require(is_rigid(shape.pose) && shape.size_m.allFinite() && shape.rgba.allFinite(),
            "a shape is not finite");
  }
}

void check_joint(const Joint& joint) {
  require(is_rigid(joint.origin), "a joint's pose is none");
  require(std::abs(joint.axis.norm() - 1) < 1e-9, "an axis is no unit vector");
  require(joint.lower <= joint.upper, "a joint's limits are the wrong way round");
  require(joint.speed_limit >= 0 && joint.effort_limit >= 0, "a limit is negative");
}

void check_robot(const RobotModel& robot) {
  require(!robot.joints.empty() && robot.links.size() == robot.joints.size(),
          "a chain has another number of links than of joints");
  check_link(robot.base, false);
  for (const Link& link : robot.links) {
    check_link(link, true);
  }
  for (const Joint& joint : robot.joints) {
    check_joint(joint);
  }
  require(is_rigid(robot.tip_pose), "the tip's pose is none");
  for (const std::string& note : robot.notes) {
    check_message(note);
  }
  for (const UrdfRepair& repair : robot.reading.repairs) {
    check_message(repair.what);
  }
}

// The mended text is read strictly and needs no repair.
void check_mended(std::string_view input, const RobotModel& robot, RobotOptions options) {
  constexpr std::size_t kMost_bytes = 100'000;  // so that the edits exceed no limit
  if (input.size() > kMost_bytes) {
    return;
  }
  const std::string mended = apply_repairs(input, "robot.urdf", robot.reading.repairs, "by a test");
  options.repair = false;
  RobotModel again;
  require(is_read([&] { again = parse_urdf(mended, "mended.urdf", options); }),
          "a mended robot is refused");
  require(again.reading.repairs.empty(), "a mended robot needs repairs");
  require(again.joint_count() == robot.joint_count(), "a mended robot has other joints");
}

}  // namespace

void fuzz_urdf(std::string_view input) {
  RobotOptions options;
  const bool whole = is_read([&] {
    try {
      const RobotModel robot = parse_urdf(input, "robot.urdf");
      check_robot(robot);
      is_read([&] { check_robot(add_load(scale_masses(robot, 2), 40)); });
    } catch (const RobotOptionError& error) {
      if (!error.leaves().empty()) {
        options.tip = error.leaves().front();
      }
      throw;
    }
  });
  if (!whole) {
    options.density_kg_per_m3 = 2700;
    is_read([&] { check_robot(parse_urdf(input, "robot.urdf", options)); });
    options.density_kg_per_m3 = 0;
  }
  options.repair = true;
  is_read([&] {
    const RobotModel robot = parse_urdf(input, "robot.urdf", options);
    check_robot(robot);
    check_mended(input, robot, options);
  });
}

}  // namespace armwright::fuzz
