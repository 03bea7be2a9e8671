// Arms in MJCF: the equations of motion of what is read are those of MuJoCo on the same file.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "mjcf_texts.hpp"
#include "sim/robot/robot_model.hpp"

namespace armwright::physics_test {
namespace {

TEST(Mjcf, IsKnownByItsRootElement) {
  EXPECT_TRUE(
      is_mjcf("\xef\xbb\xbf<?xml version=\"1.0\"?>\n<!-- <robot> -->\n<mujoco model=\"a\">"));
  EXPECT_TRUE(is_mjcf("<mujoco/>"));
  EXPECT_FALSE(is_mjcf("<mujocoinclude>"));
  EXPECT_FALSE(is_mjcf("<!-- <mujoco> --><robot>"));
  EXPECT_FALSE(is_mjcf("<mujoco"));
  EXPECT_FALSE(is_mjcf("<!-- <mujoco>"));
  EXPECT_FALSE(is_mjcf(""));
}

}  // namespace
}  // namespace armwright::physics_test

#ifdef ARMWRIGHT_WITH_MUJOCO

#include <mujoco/mujoco.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <memory>
#include <vector>

#include "base/random.hpp"
#include "base/temporary_folder.hpp"
#include "chain_oracle.hpp"

namespace armwright::physics_test {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Pair;

const std::filesystem::path kMjcfArms = ARMWRIGHT_TEST_DATA "/mjcf";

struct MjcfArm {
  std::string file;
  RobotOptions options;
};
void PrintTo(const MjcfArm& arm, std::ostream* out) {
  *out << arm.file;
}

class MjcfArmTest : public testing::TestWithParam<MjcfArm> {};
INSTANTIATE_TEST_SUITE_P(
    Files, MjcfArmTest,
    testing::Values(MjcfArm{"rail_arm", {.tip = "tool", .dynamics = true}},
                    MjcfArm{"rail_arm", {.base = "carriage", .tip = "fore", .dynamics = true}},
                    MjcfArm{"geared_arm", {.dynamics = true}},
                    MjcfArm{"classes_arm", {.tip = "tip", .dynamics = true}},
                    MjcfArm{"gripper_arm", {.tip = "pinch", .dynamics = true}},
                    MjcfArm{"spring_arm", {.dynamics = true}}));

// The library's own model of the file, with the held joints where armwright says it holds them.
class OriginalMjcf {
 public:
  explicit OriginalMjcf(const std::filesystem::path& file) {
    char message[1000] = "";
    model_.reset(mj_loadXML(file.c_str(), nullptr, message, sizeof message));
    if (model_ == nullptr) {
      throw std::runtime_error(message);
    }
    data_.reset(mj_makeData(model_.get()));
    for (int joint = 0; joint < model_->njnt; ++joint) {
      double& position = data_->qpos[model_->jnt_qposadr[joint]];
      if (model_->jnt_limited[joint] != 0 && model_->jnt_type[joint] >= mjJNT_SLIDE) {
        position =
            std::clamp(position, model_->jnt_range[2 * joint], model_->jnt_range[2 * joint + 1]);
      }
    }
  }

  const mjModel& model() const { return *model_; }
  int find(const std::string& joint) const {
    return mj_name2id(model_.get(), mjOBJ_JOINT, joint.c_str());
  }

  void move(const RobotModel& robot, const VectorXd& q) {
    for (std::size_t i = 0; i < robot.joint_count(); ++i) {
      data_->qpos[model_->jnt_qposadr[find(robot.joints[i].name)]] =
          q[static_cast<Eigen::Index>(i)];
    }
    mj_fwdPosition(model_.get(), data_.get());
    mj_fwdVelocity(model_.get(), data_.get());
  }

  // The rows and columns of the robot's joints.
  MatrixXd calc_mass_matrix(const RobotModel& robot) const {
    std::vector<double> all(static_cast<std::size_t>(model_->nv * model_->nv));
    mj_fullM(model_.get(), all.data(), data_->qM);
    const auto n = static_cast<Eigen::Index>(robot.joint_count());
    return MatrixXd::NullaryExpr(n, n, [&](Eigen::Index i, Eigen::Index k) {
      return all[static_cast<std::size_t>(find_dof(robot, i) * model_->nv + find_dof(robot, k))];
    });
  }

  VectorXd calc_gravity_efforts(const RobotModel& robot) const {
    return VectorXd::NullaryExpr(
        static_cast<Eigen::Index>(robot.joint_count()),
        [&](Eigen::Index i) { return data_->qfrc_bias[find_dof(robot, i)]; });
  }

  Vector3d find_place(const std::string& name) const {
    const int site = mj_name2id(model_.get(), mjOBJ_SITE, name.c_str());
    const int body = mj_name2id(model_.get(), mjOBJ_BODY, name.c_str());
    return Eigen::Map<const Vector3d>(site >= 0 ? data_->site_xpos + 3 * site
                                                : data_->xpos + 3 * body);
  }

 private:
  int find_dof(const RobotModel& robot, Eigen::Index i) const {
    return model_->jnt_dofadr[find(robot.joints[static_cast<std::size_t>(i)].name)];
  }

  struct Free {
    void operator()(mjModel* model) const { mj_deleteModel(model); }
    void operator()(mjData* data) const { mj_deleteData(data); }
  };
  std::unique_ptr<mjModel, Free> model_;
  std::unique_ptr<mjData, Free> data_;
};

// Tolerance: both sides round numbers of the same size some hundred times.
TEST_P(MjcfArmTest, HasTheMassMatrixAndTheGravityEffortsOfTheFile) {
  constexpr double kRelative = 1e-9;
  const std::filesystem::path file = kMjcfArms / (GetParam().file + ".xml");
  const RobotModel robot = load_urdf(file, GetParam().options);
  OriginalMjcf original(file);
  const ChainOracle oracle(robot, -original.model().opt.gravity[2]);
  RandomStream random("test/mjcf", 0);
  for (int posture = 0; posture < 5; ++posture) {
    const VectorXd q = VectorXd::NullaryExpr(static_cast<Eigen::Index>(robot.joint_count()),
                                             [&] { return random.uniform(-1.5, 1.5); });
    original.move(robot, q);
    ChainOracle::Equations found = oracle.calc(q, VectorXd::Zero(q.size()));
    for (std::size_t i = 0; i < robot.joint_count(); ++i) {
      const auto at = static_cast<Eigen::Index>(i);
      found.mass(at, at) += robot.joints[i].plant.armature;
    }
    const MatrixXd mass = original.calc_mass_matrix(robot);
    const VectorXd gravity = original.calc_gravity_efforts(robot);
    EXPECT_LT((found.mass - mass).cwiseAbs().maxCoeff(), kRelative * mass.cwiseAbs().maxCoeff());
    EXPECT_LT((found.bias - gravity).cwiseAbs().maxCoeff(),
              kRelative * gravity.cwiseAbs().maxCoeff());
    const std::string tip =
        GetParam().options.tip.empty() ? robot.links.back().name : GetParam().options.tip;
    EXPECT_LT((found.tip_m - original.find_place(tip)).norm(), kRelative);
  }
}

TEST_P(MjcfArmTest, HasTheRangesOfTheFile) {
  const std::filesystem::path file = kMjcfArms / (GetParam().file + ".xml");
  const OriginalMjcf original(file);
  for (const Joint& joint : load_urdf(file, GetParam().options).joints) {
    const int id = original.find(joint.name);
    const mjModel& m = original.model();
    const double infinity = std::numeric_limits<double>::infinity();
    EXPECT_EQ(joint.lower, m.jnt_limited[id] != 0 ? m.jnt_range[2 * id] : -infinity);
    EXPECT_EQ(joint.upper, m.jnt_limited[id] != 0 ? m.jnt_range[2 * id + 1] : infinity);
    EXPECT_EQ(joint.speed_limit, infinity);
    EXPECT_EQ(joint.kind == JointKind::prismatic, m.jnt_type[id] == mjJNT_SLIDE);
  }
}

TEST(Mjcf, HasTheEffortLimitsOfItsActuators) {
  const RobotModel arm = load_urdf(kMjcfArms / "geared_arm.xml", {.dynamics = true});
  EXPECT_DOUBLE_EQ(arm.joints[0].effort_limit, 150);  // control range times gear
  EXPECT_DOUBLE_EQ(arm.joints[1].effort_limit, 240);  // force range times |gear|
  EXPECT_DOUBLE_EQ(arm.joints[2].effort_limit, 20);   // the smaller end of a servo's force range
  EXPECT_TRUE(std::isinf(arm.joints[3].effort_limit));
  EXPECT_THAT(
      arm.notes,
      ElementsAre("the actuators of joint 'tilt' exert -30 to 20 N m: its effort limit is 20",
                  "no actuator limits the effort of 'roll': they have no limit"));
  const RobotModel gripper = load_urdf(kMjcfArms / "gripper_arm.xml", {.tip = "pinch"});
  EXPECT_DOUBLE_EQ(gripper.joints[1].effort_limit, 30);  // two motors on one joint
}

// Newer versions of MuJoCo have this limit; the library does not know it.
TEST(Mjcf, HasTheEffortLimitsOfItsJointsAlsoFromTheirClasses) {
  const RobotModel arm = parse_urdf(R"(<mujoco>
    <compiler angle="radian"/>
    <default><joint actuatorfrcrange="-12 12" actuatorgravcomp="true"/>
      <general ctrllimited="true"/></default>
    <worldbody><body name="a"><joint name="a" range="-1 1"/><geom size="0.1"/>
      <body name="b" pos="1 0 0"><joint name="b" actuatorfrcrange="-7 7"/><geom size="0.1"/></body>
    </body></worldbody>
    <actuator><position joint="b" kp="10" kv="3" inheritrange="1" forcerange="-9 9"/></actuator></mujoco>)",
                                    "arm.xml");
  EXPECT_DOUBLE_EQ(arm.joints[0].effort_limit, 12);
  EXPECT_DOUBLE_EQ(arm.joints[1].effort_limit, 7);
  EXPECT_THAT(arm.notes, IsEmpty());
}

TEST(Mjcf, HasRotorsAndFrictionOnlyWithDynamics) {
  const RobotModel arm = load_urdf(kMjcfArms / "geared_arm.xml", {.dynamics = true});
  JointPlant yaw;
  yaw.armature = 1.7;
  yaw.viscous = 1.5;
  yaw.coulomb = 0.4;
  EXPECT_EQ(arm.joints[0].plant, yaw);
  JointPlant lift = yaw;
  lift.armature = 0.2;  // of the default class
  lift.viscous = 8;
  EXPECT_EQ(arm.joints[1].plant, lift);
  const RobotModel ideal = load_urdf(kMjcfArms / "geared_arm.xml");
  EXPECT_FALSE(ideal.has_plant());
  EXPECT_THAT(ideal.notes,
              Contains("joints are simulated without the armature, damping, frictionloss and "
                       "stiffness of 'yaw', 'lift', 'tilt', 'roll'; robot.dynamics = true gives "
                       "them"));
}

TEST(Mjcf, ASpringIsACounterbalanceOverTheRange) {
  const std::filesystem::path file = kMjcfArms / "spring_arm.xml";
  const RobotModel arm = load_urdf(file, {.dynamics = true});
  OriginalMjcf original(file);
  original.move(arm, VectorXd::Constant(3, 0.1));
  const double stiffness[] = {60, 12.5, 900};
  for (std::size_t i = 0; i < 3; ++i) {
    const Joint& joint = arm.joints[i];
    const Counterbalance& spring = joint.plant.counterbalance;
    const double rest = original.model().qpos_spring[original.find(joint.name)];
    ASSERT_EQ(spring.efforts.size(), 2u);
    EXPECT_EQ(spring.lower, joint.lower);
    EXPECT_EQ(spring.upper, joint.upper);
    EXPECT_DOUBLE_EQ(spring.efforts[0], stiffness[i] * (rest - joint.lower));
    EXPECT_DOUBLE_EQ(spring.efforts[1], stiffness[i] * (rest - joint.upper));
  }
}

TEST(Mjcf, HoldsOtherJointsAndSaysSo) {
  const RobotModel arm =
      load_urdf(kMjcfArms / "gripper_arm.xml", {.tip = "pinch", .dynamics = true});
  EXPECT_THAT(arm.held_joints, ElementsAre("ball", "left", "nail", "nail_twist", "right"));
  EXPECT_THAT(
      arm.notes,
      ElementsAre(
          "no actuator limits the effort of 'three': they have no limit",
          "joint 'ball' is not between 'world' and 'pinch': held at the pose of the file, "
          "its 0.2681 kg are part of the fixed base",
          "joint 'left' is not between 'world' and 'pinch': held at 0.01 m, its 0.09 kg are "
          "part of link 'hand'",
          "joint 'nail' is not between 'world' and 'pinch': held at 0.2 rad, its 0.02 kg are "
          "part of link 'hand'",
          "joint 'nail_twist' is not between 'world' and 'pinch': held at 0.1 rad, its 0.02 "
          "kg are part of link 'hand'",
          "joint 'right' is not between 'world' and 'pinch': held at 0.002 m, its 0.11 kg "
          "are part of link 'hand'"));
}

TEST(Mjcf, ShowsBoxesCylindersSpheresAndCapsules) {
  const RobotModel arm = load_urdf(kMjcfArms / "classes_arm.xml", {.tip = "tip"});
  EXPECT_EQ(arm.name, "classes_arm");
  EXPECT_THAT(arm.mass_files,
              ElementsAre(Pair("classes_tool.xml", kMjcfArms / "classes_tool.xml")));
  ASSERT_EQ(arm.links[0].visuals.size(), 1u);
  const VisualShape& cylinder = arm.links[0].visuals[0];
  EXPECT_EQ(cylinder.kind, ShapeKind::cylinder);
  EXPECT_TRUE(cylinder.size_m.isApprox(Vector3d(0.06, 0.3, 0)));
  EXPECT_TRUE(cylinder.pose.translation().isApprox(Vector3d(0.01, 0, 0.15)));
  EXPECT_TRUE(cylinder.rgba.isApprox(Eigen::Vector4d(0.2, 0.4, 0.6, 1), 1e-6));
  ASSERT_EQ(arm.links[2].visuals.size(), 2u) << "the sphere of group 3 is for collisions";
  EXPECT_TRUE(arm.links[2].visuals[0].size_m.isApprox(Vector3d(0.1, 0.06, 0.08)));
  const RobotModel springs = load_urdf(kMjcfArms / "spring_arm.xml");
  ASSERT_EQ(springs.links[2].visuals.size(), 3u) << "a capsule";
  EXPECT_TRUE(springs.links[2].visuals[1].size_m.isApprox(Vector3d(0.01, 0, 0)));
  EXPECT_LT((springs.links[2].visuals[1].pose.translation() -
             springs.links[2].visuals[2].pose.translation())
                    .norm() -
                0.1,
            1e-12);
}

TEST(Mjcf, SaysWhichGravityActs) {
  const auto read_notes = [](const std::string& option) {
    return parse_urdf(make_hinge_arm(
                          kMjcfBar, option + "<actuator><motor joint=\"hinge\" ctrlrange=\"-1 1\"/>"
                                             "</actuator>"),
                      "arm.xml")
        .notes;
  };
  EXPECT_THAT(read_notes("<option integrator=\"implicitfast\"/>"), IsEmpty());
  EXPECT_THAT(
      read_notes("<option gravity=\"0 0 -1.62\"/>"),
      ElementsAre("the file's gravity, 0 0 -1.62 m/s2, is left out: physics.gravity_m_per_s2 "
                  "acts along -z"));
  EXPECT_THAT(
      read_notes("<option><flag gravity=\"disable\" energy=\"enable\"/></option>"),
      ElementsAre("the file's gravity, none, is left out: physics.gravity_m_per_s2 acts along "
                  "-z"));
}

TEST(Mjcf, SaysThatGravityCompensationIsLeftOut) {
  const RobotModel arm = parse_urdf(
      make_hinge_arm(kMjcfBar + "<body name=\"hand\" gravcomp=\"1\">" + kMjcfBar + "</body>"),
      "arm.xml");
  EXPECT_THAT(arm.notes, Contains("gravcomp is left out: gravity acts on 'hand'"));
}

constexpr const char* kMjcfWedge =  // closed; its centre is away from its origin
    "v 0 0 0\nv 300 0 0\nv 0 200 0\nv 0 0 400\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
TEST(Mjcf, AMeshThatOnlyGivesTheLooksMayBeMissing) {
  const RobotModel arm = parse_urdf(
      make_hinge_arm(
          "<inertial pos=\"0 0 0.1\" mass=\"2\" diaginertia=\"0.1 0.1 0.1\"/>" + kMjcfCover + "/>",
          kMjcfMesh),
      "arm.xml");
  EXPECT_EQ(arm.links[0].inertial.mass_kg, 2);
  EXPECT_THAT(arm.mass_files, IsEmpty());
  ASSERT_EQ(arm.links[0].visuals.size(), 1u);
  const VisualShape& shape = arm.links[0].visuals[0];
  EXPECT_EQ(shape.mesh_file, "parts/Cover.OBJ");
  // Tolerance: the library keeps corners of meshes as 32-bit numbers.
  EXPECT_TRUE(shape.size_m.isApprox(Vector3d(0.001, 0.002, 0.001), 1e-5));
  EXPECT_TRUE(shape.pose.translation().isApprox(Vector3d(0.1, 0.2, 0.3), 1e-5));
  EXPECT_TRUE(
      shape.pose.linear().isApprox(Eigen::Quaterniond(0.6, 0, 0.8, 0).toRotationMatrix(), 1e-5));
}

TEST(Mjcf, AMeshGivesTheMassOfItsVolume) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "parts");
  write_mjcf(folder / "parts/Cover.OBJ", kMjcfWedge);
  write_mjcf(
      folder / "arm.xml",
      make_hinge_arm(
          kMjcfCover + " density=\"2700\"/>" + kMjcfBar,
          "<compiler meshdir=\"parts\" exactmeshinertia=\"true\"/><asset><mesh file=\"Cover.OBJ\" "
          "name=\"cover\" "
          "scale=\"0.001 0.002 0.001\"/><mesh name=\"looks\" file=\"missing.stl\"/></asset>\n"));
  const RobotModel arm = load_urdf(folder / "arm.xml");
  EXPECT_THAT(arm.mass_files, ElementsAre(Pair("parts/Cover.OBJ", folder / "parts/Cover.OBJ")));
  // The volume of a tetrahedron is a sixth of that of the box; kMjcfBar has 32 l of water.
  EXPECT_NEAR(arm.links[0].inertial.mass_kg, 2700 * 0.3 * 0.4 * 0.4 / 6 + 32, 1e-5);
}

// A floating robot is simulated from a base below its free joint.
TEST(Mjcf, AFreeJointAboveTheBaseIsHeld) {
  const std::string xml =
      "<mujoco><worldbody><body name=\"trunk\" pos=\"0 0 1\"><freejoint name=\"root\"/>" +
      kMjcfBar + "<body name=\"arm\" pos=\"0 0 1\"><joint name=\"hinge\" axis=\"0 1 0\"/>" +
      kMjcfBar + "</body></body></worldbody></mujoco>";
  EXPECT_THAT(describe_mjcf_refusal(xml),
              HasSubstr("joint 'root': its type is free; between base 'world'"));
  const RobotModel arm = parse_urdf(xml, "arm.xml", {.base = "trunk"});
  EXPECT_EQ(arm.joint_count(), 1u);
  EXPECT_EQ(arm.joints[0].origin.translation(), Vector3d(0, 0, 2));
  EXPECT_THAT(arm.notes,
              Contains("joint 'root' is not between 'trunk' and 'arm': held at the pose of "
                       "the file, its 32 kg are part of the fixed base"));
}

}  // namespace
}  // namespace armwright::physics_test

#endif
