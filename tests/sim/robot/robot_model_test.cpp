#include "sim/robot/robot_model.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <string>

#include "base/error.hpp"
#include "sim/support.hpp"

namespace armwright {
namespace {

using ::testing::HasSubstr;

RobotModel load_two_joints() {
  return load_urdf(std::filesystem::path(ARMWRIGHT_TEST_DATA) / "urdf/two_joints.urdf");
}

Eigen::Matrix3d make_tensor(double xx, double yy, double zz, double xy, double xz, double yz) {
  Eigen::Matrix3d tensor;
  tensor << xx, xy, xz, xy, yy, yz, xz, yz, zz;
  return tensor;
}

void expect_body(const Inertial& body, double mass_kg, const Eigen::Vector3d& com_m,
                 const Eigen::Matrix3d& inertia) {
  EXPECT_EQ(body.mass_kg, mass_kg);
  EXPECT_EQ(body.com_m, com_m);
  EXPECT_EQ(body.inertia_kg_m2, inertia);
}

// Equal to the last bit: the file has the table's decimals, and no link is joined or rotated.
TEST(Irb4600, HasTheMassesAndInertiaOfTheTable) {
  const RobotModel arm = load_irb4600();
  ASSERT_EQ(arm.links.size(), 4u);
  expect_body(arm.base.inertial, 229.6, {-0.09141, 0.00036, 0.08247},
              make_tensor(3.20368, 6.50802, 8.78618, 0.02969, 0.43936, 0.00056));
  expect_body(arm.links[0].inertial, 112.9, {0.07699, 0.02477, -0.09470},
              make_tensor(2.95545, 3.85235, 3.08350, -0.25886, -0.79436, -0.27584));
  expect_body(arm.links[1].inertial, 266.3, {0.00006, -0.17005, 0.48764},
              make_tensor(28.97769, 29.72073, 1.53769, -0.00023, 0.00388, 0.83698));
  expect_body(arm.links[2].inertial, 545.6, {0.22749, 0.03845, 0.13050},
              make_tensor(10.47457, 93.35723, 91.40268, 4.77888, -5.22324, 0.13297));
  expect_body(arm.links[3].inertial, 13.8, {0.01617, -0.00296, 0.00037},
              make_tensor(0.02650, 0.04977, 0.05132, -0.00064, -0.00008, -0.00006));
}

TEST(Irb4600, HasTheRangesAndSpeedsOfTheDataSheet) {
  const RobotModel arm = load_irb4600();
  const double lower_deg[] = {-180, -90, -180, -125};
  const double upper_deg[] = {180, 150, 75, 120};
  const double speed_deg_per_s[] = {175, 175, 175, 250};
  ASSERT_EQ(arm.joint_count(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(arm.joints[i].name, "joint_" + std::to_string(i + 1));
    // Tolerance: one rounding of the decimal in the file and one of the product here.
    EXPECT_DOUBLE_EQ(arm.joints[i].lower, lower_deg[i] * kPi / 180);
    EXPECT_DOUBLE_EQ(arm.joints[i].upper, upper_deg[i] * kPi / 180);
    EXPECT_DOUBLE_EQ(arm.joints[i].speed_limit, speed_deg_per_s[i] * kPi / 180);
    EXPECT_GE(arm.joints[i].effort_limit, 20000);
    EXPECT_EQ(arm.joints[i].axis, i == 0 ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitY());
    EXPECT_EQ(arm.joints[i].origin.linear(), Eigen::Matrix3d::Identity());
  }
  EXPECT_EQ(arm.base.name, "base");
  EXPECT_EQ(arm.links[3].name, "link_3");
  EXPECT_EQ(arm.tip_pose.translation(), Eigen::Vector3d(0.135, 0, 0));
}

TEST(Irb4600, EveryLinkCanBeDrawn) {
  const RobotModel arm = load_irb4600();
  EXPECT_GE(arm.base.visuals.size(), 3u);
  for (const Link& link : arm.links) {
    EXPECT_GE(link.visuals.size(), 3u) << link.name;
    for (const VisualShape& shape : link.visuals) {
      EXPECT_NE(shape.kind, ShapeKind::mesh);
      EXPECT_NE(shape.rgba, Eigen::Vector4d(0.7, 0.7, 0.7, 1.0))
          << link.name << ": a shape without material";
    }
  }
  EXPECT_EQ(arm.base.visuals[0].size_m, Eigen::Vector3d(0.62, 0.56, 0.04));
  EXPECT_EQ(arm.base.visuals[0].rgba,
            Eigen::Vector4d(Eigen::Vector4f(0.20f, 0.21f, 0.23f, 1.0f).cast<double>()));
}

TEST(LoadUrdf, ReadsJointsFramesAndVisuals) {
  const RobotModel robot = load_two_joints();
  EXPECT_EQ(robot.name, "two_joints");
  EXPECT_EQ(robot.base.name, "world");
  EXPECT_EQ(robot.base.inertial.mass_kg, 7);  // of the link on a fixed joint,
  EXPECT_EQ(robot.base.inertial.com_m, Eigen::Vector3d(0, 0, 0.5));  // in the root's frame
  ASSERT_EQ(robot.joint_count(), 2u);
  EXPECT_EQ(robot.joints[0].axis, Eigen::Vector3d::UnitZ()) << "0 0 2, normalised";
  EXPECT_EQ(robot.joints[0].lower, -1);
  EXPECT_EQ(robot.joints[0].upper, 2);
  EXPECT_EQ(robot.joints[0].speed_limit, 3);
  EXPECT_EQ(robot.joints[0].effort_limit, 40);
  EXPECT_EQ(robot.joints[0].origin.translation(), Eigen::Vector3d(0.1, 0.2, 0.8));
  // URDF: fixed-axis roll, pitch, yaw, hence Rz(yaw) Ry(pitch) Rx(roll). Tolerance: a few roundings
  // of numbers of size 1.
  const Eigen::Matrix3d expected = (Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ()) *
                                    Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitY()) *
                                    Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitX()))
                                       .toRotationMatrix();
  EXPECT_LT((robot.joints[0].origin.linear() - expected).norm(), 1e-15);

  EXPECT_EQ(robot.joints[1].lower, -kInfinity);
  EXPECT_EQ(robot.joints[1].upper, kInfinity);
  EXPECT_EQ(robot.joints[1].speed_limit, kInfinity);
  EXPECT_EQ(robot.tip_pose.translation(), Eigen::Vector3d(0, 0, 0.25));

  ASSERT_EQ(robot.links[0].visuals.size(), 1u);
  EXPECT_EQ(robot.links[0].visuals[0].kind, ShapeKind::box);
  EXPECT_EQ(robot.links[0].visuals[0].size_m, Eigen::Vector3d(0.6, 0.1, 0.1));
  EXPECT_EQ(robot.links[0].visuals[0].rgba, Eigen::Vector4d(1, 0, 0, 1));
}

TEST(LoadUrdf, ReadsPrismaticJoints) {
  const RobotModel robot =
      load_urdf(std::filesystem::path(ARMWRIGHT_TEST_DATA) / "urdf/rail_and_pole.urdf");
  ASSERT_EQ(robot.joint_count(), 2u);
  const Joint& rail = robot.joints[0];
  EXPECT_EQ(rail.kind, JointKind::prismatic);
  EXPECT_EQ(rail.axis, Eigen::Vector3d::UnitY()) << "0 2 0, normalised";
  EXPECT_EQ(rail.origin.translation(), Eigen::Vector3d(0.1, 0.2, 0.3));
  EXPECT_EQ(rail.lower, -0.4);
  EXPECT_EQ(rail.upper, 1.5);
  EXPECT_EQ(rail.speed_limit, 2);
  EXPECT_EQ(rail.effort_limit, 300);
  EXPECT_EQ(robot.joints[1].kind, JointKind::revolute) << "a continuous joint turns";
  for (const Joint& joint : load_two_joints().joints) {
    EXPECT_EQ(joint.kind, JointKind::revolute) << joint.name;
  }
}

// A rail whose range ends at 0 is valid; lower and upper default to 0 in URDF.
TEST(LoadUrdf, TakesUrdfsDefaultsForTheEndsOfARail) {
  const RobotModel robot = parse_urdf(
      R"(<robot name="r"><link name="base"/><joint name="rail" type="prismatic">
      <parent link="base"/><child link="cart"/><limit upper="0.7" velocity="1" effort="1"/></joint>
      <link name="cart"><inertial><mass value="2"/><inertia ixx="0.2" iyy="0.3" izz="0.4" ixy="0"
      ixz="0" iyz="0"/></inertial></link></robot>)",
      "rail.urdf");
  EXPECT_EQ(robot.joints[0].lower, 0);
  EXPECT_EQ(robot.joints[0].upper, 0.7);
}

constexpr const char* kPendulum = R"(<robot name="pendulum">
  <link name="base"/>
  <joint name="pivot" type="revolute">
    <parent link="base"/><child link="rod"/><limit lower="-1" upper="1" velocity="1" effort="1"/>
  </joint>
  <link name="rod">
    <inertial><origin xyz="0 0 -1" rpy="0.3 -0.2 0.7"/><mass value="2"/>
      <inertia ixx="0.2" iyy="0.3" izz="0.4" ixy="0.01" ixz="0.02" iyz="0.03"/></inertial>
    <visual><geometry><cylinder radius="0.1" length="2"/></geometry></visual>
    <visual><geometry><sphere radius="0.25"/></geometry><material name=""><color rgba="0 1 0 0.5"/></material></visual>
    <visual><geometry><mesh filename="rod &amp; co.stl" scale="1 2 3"/></geometry>
      <material name=""><color rgba="0 0 1 1"/></material></visual>
  </link>
  %s
</robot>)";

std::string make_pendulum(const std::string& more = "") {
  const std::string xml = kPendulum;
  const std::size_t at = xml.find("%s");
  return xml.substr(0, at) + more + xml.substr(at + 2);
}

TEST(LoadUrdf, TheTipIsTheOriginOfALastLinkThatMoves) {
  const RobotModel robot = parse_urdf(make_pendulum(), "pendulum.urdf");
  EXPECT_TRUE(robot.tip_pose.isApprox(Eigen::Isometry3d::Identity(), 0));
  EXPECT_EQ(robot.joints[0].axis, Eigen::Vector3d::UnitX()) << "URDF's default";
}

TEST(LoadUrdf, ReadsEveryKindOfShape) {
  const RobotModel robot = parse_urdf(make_pendulum(), "pendulum.urdf");
  const auto& visuals = robot.links[0].visuals;
  ASSERT_EQ(visuals.size(), 3u);
  EXPECT_EQ(visuals[0].kind, ShapeKind::cylinder);
  EXPECT_EQ(visuals[0].size_m, Eigen::Vector3d(0.1, 2, 0));
  EXPECT_EQ(visuals[0].rgba, Eigen::Vector4d(0.7, 0.7, 0.7, 1.0)) << "the default";
  EXPECT_EQ(visuals[1].kind, ShapeKind::sphere);
  EXPECT_EQ(visuals[1].size_m, Eigen::Vector3d(0.25, 0, 0));
  EXPECT_EQ(visuals[1].rgba, Eigen::Vector4d(0, 1, 0, 0.5));
  EXPECT_EQ(visuals[2].kind, ShapeKind::mesh);
  EXPECT_EQ(visuals[2].mesh_file, "rod & co.stl");
  EXPECT_EQ(visuals[2].size_m, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(visuals[2].rgba, Eigen::Vector4d(0, 0, 1, 1))
      << "materials of the same name keep their own colours";
}

// The rotation of an inertial's origin turns the tensor into the link's axes: R I R^T with explicit
// products.
TEST(LoadUrdf, TurnsTheTensorIntoTheLinksAxes) {
  const RobotModel robot = parse_urdf(make_pendulum(), "pendulum.urdf");
  const double roll = 0.3, pitch = -0.2, yaw = 0.7;
  Eigen::Matrix3d rx, ry, rz;
  rx << 1, 0, 0, 0, std::cos(roll), -std::sin(roll), 0, std::sin(roll), std::cos(roll);
  ry << std::cos(pitch), 0, std::sin(pitch), 0, 1, 0, -std::sin(pitch), 0, std::cos(pitch);
  rz << std::cos(yaw), -std::sin(yaw), 0, std::sin(yaw), std::cos(yaw), 0, 0, 0, 1;
  const Eigen::Matrix3d r = rz * ry * rx;
  const Eigen::Matrix3d expected = r * make_tensor(0.2, 0.3, 0.4, 0.01, 0.02, 0.03) * r.transpose();
  EXPECT_LT((robot.links[0].inertial.inertia_kg_m2 - expected).norm(),
            1e-15);  // roundings of numbers below 1
  EXPECT_EQ(robot.links[0].inertial.com_m, Eigen::Vector3d(0, 0, -1));
}

// Returns the inertia about a fixed point from the definition. Two point masses along each
// principal axis reproduce a body, so this sum needs none of the theorems under test.
struct PointMasses {
  double mass = 0;
  Eigen::Vector3d first = Eigen::Vector3d::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();  // sum of m r r^T

  void add_box(double box_mass, const Eigen::Vector3d& edges, const Eigen::Vector3d& centre,
               const Eigen::Matrix3d& axes) {
    // Six points at +-d on the axes, each a sixth of the mass: sum m r r^T is 2 (m/6) d^2 = m L^2 /
    // 12, as a box has.
    for (int axis = 0; axis < 3; ++axis) {
      for (const double sign : {1.0, -1.0}) {
        const Eigen::Vector3d r = centre + axes.col(axis) * (sign * edges[axis] / 2);
        mass += box_mass / 6;
        first += box_mass / 6 * r;
        second += box_mass / 6 * (r * r.transpose());
      }
    }
  }
  Inertial body() const {
    const Eigen::Vector3d com = first / mass;
    const Eigen::Matrix3d about_com = second - mass * (com * com.transpose());
    return {mass, com, about_com.trace() * Eigen::Matrix3d::Identity() - about_com};
  }
};

Eigen::Matrix3d make_rotation(double angle, double x, double y, double z) {
  return Eigen::AngleAxisd(angle, Eigen::Vector3d(x, y, z).normalized()).toRotationMatrix();
}

Inertial make_box(double mass, const Eigen::Vector3d& e) {
  return {mass, Eigen::Vector3d::Zero(),
          Eigen::Vector3d(e.y() * e.y() + e.z() * e.z(), e.x() * e.x() + e.z() * e.z(),
                          e.x() * e.x() + e.y() * e.y())
                  .asDiagonal() *
              Eigen::Matrix3d::Identity() * (mass / 12)};
}

void expect_near(const Inertial& found, const Inertial& expected) {
  // Some ten roundings of sums below 100 kg m2.
  EXPECT_NEAR(found.mass_kg, expected.mass_kg, 1e-13);
  EXPECT_LT((found.com_m - expected.com_m).norm(), 1e-14);
  EXPECT_LT((found.inertia_kg_m2 - expected.inertia_kg_m2).norm(), 1e-12);
}

TEST(Inertial, TwoTurnedBoxesJoinedAgreeWithPointMasses) {
  const Eigen::Vector3d edges_a(0.4, 0.7, 1.1), edges_b(0.3, 0.25, 0.9);
  Eigen::Isometry3d pose_a = Eigen::Isometry3d::Identity(), pose_b = pose_a;
  pose_a.linear() = make_rotation(0.8, 1, -2, 0.5);
  pose_a.translation() << 0.3, -0.2, 0.7;
  pose_b.linear() = make_rotation(-2.1, 0.2, 0.9, -0.4);
  pose_b.translation() << -0.6, 1.2, 0.15;

  PointMasses points;
  points.add_box(3.7, edges_a, pose_a.translation(), pose_a.linear());
  points.add_box(1.3, edges_b, pose_b.translation(), pose_b.linear());
  expect_near(
      combine(transform(make_box(3.7, edges_a), pose_a), transform(make_box(1.3, edges_b), pose_b)),
      points.body());
}

// Two boxes of 1 m by 1 m by 1 m and 6 kg side by side make one of 2 m by 1 m by 1 m and 12 kg.
TEST(Inertial, TwoCubesMakeABar) {
  Inertial left = make_box(6, {1, 1, 1}), right = left;
  left.com_m.x() = -0.5;
  right.com_m.x() = 0.5;
  const Inertial bar = combine(left, right);
  EXPECT_EQ(bar.mass_kg, 12);
  EXPECT_LT(bar.com_m.norm(), 1e-15);
  EXPECT_LT((bar.inertia_kg_m2 - make_tensor(2, 5, 5, 0, 0, 0)).norm(), 1e-14);
}

TEST(Inertial, NothingAddedChangesNothing) {
  const RobotModel arm = load_irb4600();
  const Inertial& body = arm.links[2].inertial;
  expect_body(combine(body, Inertial{}), body.mass_kg, body.com_m, body.inertia_kg_m2);
  expect_body(combine(Inertial{}, body), body.mass_kg, body.com_m, body.inertia_kg_m2);
}

// Tests the whole way from the file to the joined link: a gripper in two parts on rotated fixed
// joints.
TEST(LoadUrdf, LumpsAChainOfFixedLinks) {
  const RobotModel robot = parse_urdf(make_pendulum(R"(
    <joint name="f1" type="fixed"><parent link="rod"/><child link="plate"/>
      <origin xyz="0.1 0.2 -2" rpy="0.4 0.5 -0.6"/></joint>
    <link name="plate">
      <inertial><mass value="3.7"/><inertia ixx="0.5" iyy="0.6" izz="0.7" ixy="0.01" ixz="0.02" iyz="0.03"/></inertial>
      <visual><origin xyz="0 0 1"/><geometry><sphere radius="0.5"/></geometry></visual></link>
    <joint name="f2" type="fixed"><parent link="plate"/><child link="finger"/>
      <origin xyz="-0.3 0.1 0.4" rpy="-0.7 0.1 0.9"/></joint>
    <link name="finger"><inertial><origin xyz="0.5 0.6 0.7" rpy="0 0.3 0"/><mass value="1.1"/>
      <inertia ixx="0.05" iyy="0.06" izz="0.07" ixy="0" ixz="0" iyz="0"/></inertial></link>
    <joint name="f3" type="fixed"><parent link="finger"/><child link="tool"/><origin xyz="0 0 0.5"/></joint>
    <link name="tool"/>)"),
                                      "gripper.urdf");
  const auto make_pose = [](double x, double y, double z, double roll, double pitch, double yaw) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translation() << x, y, z;
    pose.linear() =
        make_rotation(yaw, 0, 0, 1) * make_rotation(pitch, 0, 1, 0) * make_rotation(roll, 1, 0, 0);
    return pose;
  };
  const Eigen::Isometry3d plate = make_pose(0.1, 0.2, -2, 0.4, 0.5, -0.6);
  const Eigen::Isometry3d finger = plate * make_pose(-0.3, 0.1, 0.4, -0.7, 0.1, 0.9);
  const Eigen::Isometry3d finger_body = finger * make_pose(0.5, 0.6, 0.7, 0, 0.3, 0);

  // Sums of first and second moments about the rod's frame, from which the lumped body follows.
  const auto rod_only = parse_urdf(make_pendulum(), "rod.urdf").links[0].inertial;
  PointMasses sum;
  const auto add = [&](double mass, const Eigen::Vector3d& centre, const Eigen::Matrix3d& inertia) {
    sum.mass += mass;
    sum.first += mass * centre;
    sum.second += inertia.trace() / 2 * Eigen::Matrix3d::Identity() - inertia +
                  mass * (centre * centre.transpose());
  };
  add(rod_only.mass_kg, rod_only.com_m, rod_only.inertia_kg_m2);
  add(3.7, plate.translation(),
      plate.linear() * make_tensor(0.5, 0.6, 0.7, 0.01, 0.02, 0.03) * plate.linear().transpose());
  add(1.1, finger_body.translation(),
      finger_body.linear() * make_tensor(0.05, 0.06, 0.07, 0, 0, 0) *
          finger_body.linear().transpose());

  ASSERT_EQ(robot.links.size(), 1u);
  EXPECT_EQ(robot.links[0].name, "rod");
  expect_near(robot.links[0].inertial, sum.body());
  EXPECT_LT((robot.tip_pose.translation() - finger * Eigen::Vector3d(0, 0, 0.5)).norm(), 1e-15);
  EXPECT_LT((robot.tip_pose.linear() - finger.linear()).norm(), 1e-15);
  ASSERT_EQ(robot.links[0].visuals.size(), 4u);
  EXPECT_LT(
      (robot.links[0].visuals[3].pose.translation() - plate * Eigen::Vector3d(0, 0, 1)).norm(),
      1e-15);
}

// The thesis's block: 20 kg, 168.25 x 168.25 x 90 mm, by hand about the last joint. Along link 3
// (x): m/12 2 L^2; across: m/12 (L^2 + s^2); its centre at 0.135 + 0.045 = 0.18 m.
TEST(AddLoad, PutsTheBlockBeyondTheTip) {
  const RobotModel arm = load_irb4600();
  const RobotModel loaded = add_load(arm, 20);
  const Inertial& before = arm.links[3].inertial;
  const Inertial& after = loaded.links[3].inertial;

  const double total = 13.8 + 20;
  EXPECT_DOUBLE_EQ(after.mass_kg, total);
  const Eigen::Vector3d com = (13.8 * before.com_m + 20 * Eigen::Vector3d(0.18, 0, 0)) / total;
  EXPECT_LT((after.com_m - com).norm(), 1e-15);
  const double l2 = 0.16825 * 0.16825, s2 = 0.09 * 0.09;
  const Eigen::Vector3d apart = before.com_m - Eigen::Vector3d(0.18, 0, 0);
  const double reduced_mass = 13.8 * 20 / total;  // two bodies about their common centre of mass
  const Eigen::Matrix3d expected =
      before.inertia_kg_m2 +
      make_tensor(20 * 2 * l2 / 12, 20 * (l2 + s2) / 12, 20 * (l2 + s2) / 12, 0, 0, 0) +
      reduced_mass *
          (apart.squaredNorm() * Eigen::Matrix3d::Identity() - apart * apart.transpose());
  EXPECT_LT((after.inertia_kg_m2 - expected).norm(), 1e-14);

  EXPECT_EQ(loaded.links[2].inertial.mass_kg, 545.6);
  EXPECT_EQ(loaded.tip_pose.translation(), arm.tip_pose.translation());
  ASSERT_EQ(loaded.links[3].visuals.size(), arm.links[3].visuals.size() + 1);
  const VisualShape& block = loaded.links[3].visuals.back();
  EXPECT_EQ(block.size_m, Eigen::Vector3d(0.16825, 0.16825, 0.09));
  EXPECT_LT((block.pose * Eigen::Vector3d(0, 0, 0.045) - Eigen::Vector3d(0.225, 0, 0)).norm(),
            1e-15)
      << "the block's short side points along the link";
}

TEST(AddLoad, RefusesWhatIsNoMass) {
  const RobotModel arm = load_irb4600();
  for (const double mass :
       {-1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    try {
      add_load(arm, mass);
      FAIL() << mass;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::usage);
      EXPECT_THAT(error.what(), HasSubstr("kg; it must be finite and >= 0"));
    }
  }
  EXPECT_EQ(add_load(arm, 0).links[3].visuals.size(), arm.links[3].visuals.size());
}

// A steel block on a flange at the origin of its link, by hand: along the axis of the last joint.
TEST(AddLoad, PutsTheBlockOnTheLastAxisIfTheTipIsItsLinksOrigin) {
  const RobotModel before = parse_urdf(make_pendulum(), "pendulum.urdf");
  ASSERT_EQ(before.tip_pose.translation().norm(), 0);
  const Link& rod = before.links.back();
  const Link after = add_load(before, 5).links.back();
  const Eigen::Vector3d axis = before.joints.back().axis;
  EXPECT_DOUBLE_EQ(after.inertial.mass_kg, rod.inertial.mass_kg + 5);
  const Eigen::Vector3d com =
      (rod.inertial.mass_kg * rod.inertial.com_m + 5 * 0.045 * axis) / after.inertial.mass_kg;
  EXPECT_LT((after.inertial.com_m - com).norm(), 1e-15);
  EXPECT_LT((after.visuals.back().pose * Eigen::Vector3d(0, 0, 0.045) - 0.09 * axis).norm(), 1e-15);
}

// A body of the user's own in the frame of a tip that is turned by 90 degrees about z.
TEST(AddLoad, PutsABodyWhereItIsInTheTipsFrame) {
  RobotModel arm = load_irb4600();
  arm.tip_pose.linear() = Eigen::AngleAxisd(kPi / 2, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  LoadBody body;
  body.com_m = Eigen::Vector3d(0.1, 0.02, -0.3);
  body.inertia_m2 = make_tensor(0.01, 0.02, 0.025, 0.001, 0.002, 0.003);
  const RobotModel loaded = add_load(arm, 8, body);
  const Inertial& last = arm.links[3].inertial;
  Inertial turned{8, Eigen::Vector3d(0.135 - 0.02, 0.1, -0.3),
                  8 * make_tensor(0.02, 0.01, 0.025, -0.001, -0.003, 0.002)};
  const Inertial expected = combine(last, turned);
  EXPECT_DOUBLE_EQ(loaded.links[3].inertial.mass_kg, expected.mass_kg);
  // Sums of a few numbers of the order of 1, with rounding errors of some 1e-16 each.
  EXPECT_LT((loaded.links[3].inertial.com_m - expected.com_m).norm(), 1e-15);
  EXPECT_LT((loaded.links[3].inertial.inertia_kg_m2 - expected.inertia_kg_m2).norm(), 1e-14);
  EXPECT_EQ(loaded.links[3].visuals.back().kind, ShapeKind::sphere);
}

// Two equal rods in one plane, each 1 kg and 0.5 m long, the second one turned by its joint's middle
// of 90 degrees: I = m l^2 / 3 about its end, and for the first joint by hand.
TEST(ScalePlants, AddsArmaturesInProportionToWhatAJointMoves) {
  RobotModel arm;
  Joint joint;
  joint.axis = Eigen::Vector3d::UnitY();
  joint.lower = -1;
  joint.upper = 1;
  Link rod;
  rod.inertial = {1, Eigen::Vector3d(0.25, 0, 0), make_tensor(0, 0.25 / 12, 0.25 / 12, 0, 0, 0)};
  arm.joints = {joint, joint};
  arm.joints[1].origin.translation() = Eigen::Vector3d(0.5, 0, 0);
  arm.joints[1].lower = 0;
  arm.joints[1].upper = kPi;
  arm.links = {rod, rod};
  const RobotModel changed = scale_plants(arm, {.armature_share = 0.5, .elastic_hz = 15});
  const double second = 0.25 / 3;
  const double first = 0.25 / 3 + 0.25 / 12 + 0.5 * 0.5 + 0.25 * 0.25;
  EXPECT_NEAR(changed.joints[0].plant.armature, first / 2, 1e-15);
  EXPECT_NEAR(changed.joints[1].plant.armature, second / 2, 1e-15);
  EXPECT_NEAR(changed.joints[1].plant.stiffness, std::pow(2 * kPi * 15, 2) * second / 2, 1e-10);
}

JointPlant make_rubbing() {
  JointPlant plant;
  plant.armature = 2;
  plant.viscous = 3;
  plant.coulomb = 5;
  plant.stribeck = -1;
  return plant;
}

TEST(ScalePlants, MultipliesWhatIsThere) {
  RobotModel arm = load_irb4600();
  arm.joints[1].plant = make_rubbing();
  arm.joints[2].plant.armature = 4;
  arm.joints[2].plant.stiffness = 100;
  const RobotModel changed =
      scale_plants(arm, {.friction = 2, .armature = 1.5, .stiffness = 0.5, .armature_share = 0});
  EXPECT_EQ(changed.joints[1].plant.armature, 3);
  EXPECT_EQ(changed.joints[1].plant.viscous, 6);
  EXPECT_EQ(changed.joints[1].plant.coulomb, 10);
  EXPECT_EQ(changed.joints[1].plant.stribeck, -2);
  EXPECT_EQ(changed.joints[2].plant.stiffness, 50);
  EXPECT_TRUE(changed.joints[0].plant.is_ideal());
}

// A rotor that is made lighter keeps its spring: the factors are powers of two, so they are exact.
TEST(ScalePlants, FactorsActOnWhatTheShareAndTheFrequencyAdd) {
  const RobotModel arm = load_irb4600();
  const PlantScales added{.armature_share = 0.5, .elastic_hz = 15};
  const RobotModel own = scale_plants(arm, added);
  PlantScales changes = added;
  changes.armature = 0.5;
  changes.stiffness = 0.25;
  const RobotModel changed = scale_plants(arm, changes);
  for (std::size_t i = 0; i < arm.joint_count(); ++i) {
    const JointPlant& before = own.joints[i].plant;
    const JointPlant& after = changed.joints[i].plant;
    EXPECT_GT(before.armature, 0);
    EXPECT_EQ(after.armature, 0.5 * before.armature);
    EXPECT_EQ(after.stiffness, 0.25 * before.stiffness);
    EXPECT_EQ(after.damping, 0.25 * before.damping);
  }
}

TEST(ScaleMasses, ScalesWhatMovesAndNothingElse) {
  const RobotModel arm = load_irb4600();
  const RobotModel heavy = scale_masses(arm, 1.25);
  for (std::size_t i = 0; i < arm.joint_count(); ++i) {
    const Inertial& before = arm.links[i].inertial;
    const Inertial& after = heavy.links[i].inertial;
    EXPECT_EQ(after.mass_kg, 1.25 * before.mass_kg);
    EXPECT_EQ(after.inertia_kg_m2, 1.25 * before.inertia_kg_m2);
    EXPECT_EQ(after.com_m, before.com_m);
  }
  EXPECT_EQ(heavy.base.inertial.mass_kg, arm.base.inertial.mass_kg);
  EXPECT_EQ(scale_masses(arm, 1).links[2].inertial.inertia_kg_m2,
            arm.links[2].inertial.inertia_kg_m2);
}

TEST(ScaleMasses, RefusesWhatIsNoFactor) {
  for (const double factor : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(),
                              std::numeric_limits<double>::infinity()}) {
    try {
      scale_masses(load_irb4600(), factor);
      FAIL() << factor;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::usage);
      EXPECT_THAT(error.what(), HasSubstr("it must be finite and > 0"));
    }
  }
}

}  // namespace
}  // namespace armwright
