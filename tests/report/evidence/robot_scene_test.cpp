#include "report/evidence/robot_scene.hpp"

#include <gmock/gmock.h>

#include <bit>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "base/random.hpp"
#include "base/temporary_folder.hpp"
#include "sim/kinematics/kinematics.hpp"

namespace armwright {
namespace {

using nlohmann::json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const std::filesystem::path kRobots = std::filesystem::path(ARMWRIGHT_CONFIGS) / "robots";

RobotModel load_arm() {
  return load_urdf(kRobots / "irb4600_40_255.urdf");
}

TrackingTask carry(double load_kg) {
  TrackingTask task;
  task.load_kg = load_kg;
  return task;
}

void write_text(const std::filesystem::path& file, const std::string& content) {
  std::filesystem::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << content;
}

// A revolute joint with a slanted axis and a prismatic joint, both with an offset to their parents.
RobotModel make_arm(const std::string& base_visual, const std::string& tool_visual) {
  return parse_urdf(R"(<robot name="bench">
<link name="base">)" + base_visual +
                        R"(</link>
<joint name="turn" type="continuous"><parent link="base"/><child link="disc"/>
  <origin xyz="0.1 -0.2 0.5" rpy="0.3 -0.7 1.9"/><axis xyz="1 2 -0.5"/></joint>
<link name="disc"><inertial><mass value="2"/>
  <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="slide" type="prismatic"><parent link="disc"/><child link="tool"/>
  <origin xyz="0.4 0 0.2" rpy="-1.1 0.2 0.6"/><axis xyz="0 -1 1"/>
  <limit lower="-0.3" upper="0.8" velocity="1" effort="10"/></joint>
<link name="tool">)" + tool_visual +
                        R"(<inertial><mass value="1"/>
  <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="end" type="fixed"><parent link="tool"/><child link="tip"/>
  <origin xyz="0.05 0.1 0.3" rpy="0.5 0 0.1"/></joint>
<link name="tip"/></robot>)",
                    "bench.urdf");
}

std::string make_mesh_visual(const std::string& file) {
  return "<visual><geometry><mesh filename=\"" + file +
         "\" scale=\"0.5 0.5 2\"/></geometry></visual>";
}

Eigen::Vector3d read_vector(const json& numbers) {
  return {numbers[0].get<double>(), numbers[1].get<double>(), numbers[2].get<double>()};
}

Eigen::Isometry3d read_pose(const json& pose) {
  const json& q = pose["quaternion"];
  Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
  result.linear() = Eigen::Quaterniond(q[3].get<double>(), q[0].get<double>(), q[1].get<double>(),
                                       q[2].get<double>())
                        .toRotationMatrix();
  result.translation() = read_vector(pose["position"]);
  return result;
}

// Computes the poses as the page does.
std::vector<Eigen::Isometry3d> follow_chain(const json& robot, const std::vector<double>& q) {
  std::vector<Eigen::Isometry3d> poses;
  Eigen::Isometry3d here = Eigen::Isometry3d::Identity();
  for (std::size_t i = 0; i < q.size(); ++i) {
    const json& joint = robot["joints"][i];
    const Eigen::Vector3d axis = read_vector(joint["axis"]);
    here = here * read_pose(joint["origin"]);
    if (joint["kind"] == "revolute") {
      here.rotate(Eigen::AngleAxisd(q[i], axis));
    } else {
      here.translate(q[i] * axis);
    }
    poses.push_back(here);
  }
  return poses;
}

std::string decode_base64(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char letter : text) {
    if (letter == '=') {
      break;
    }
    bits = bits << 6 | static_cast<std::uint32_t>(digits.find(letter));
    count += 6;
    if (count >= 8) {
      count -= 8;
      bytes.push_back(static_cast<char>(bits >> count & 0xff));
    }
  }
  return bytes;
}

std::vector<std::uint32_t> unpack(const json& packed, const char* key) {
  const std::string bytes = decode_base64(packed[key]);
  std::vector<std::uint32_t> words;
  for (std::size_t i = 0; i + 4 <= bytes.size(); i += 4) {
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      word |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[i + k])) << 8 * k;
    }
    words.push_back(word);
  }
  return words;
}

// Returns the triangles' corners in the order of the mesh's indices.
std::vector<Eigen::Vector3f> read_corners(const json& mesh) {
  std::vector<float> positions;
  for (const std::uint32_t word : unpack(mesh["positions"], "f32")) {
    positions.push_back(std::bit_cast<float>(word));
  }
  std::vector<Eigen::Vector3f> corners;
  for (const std::uint32_t index : unpack(mesh["indices"], "u32")) {
    corners.emplace_back(positions.at(3 * index), positions.at(3 * index + 1),
                         positions.at(3 * index + 2));
  }
  return corners;
}

void expect_chain_of(const RobotModel& model, const json& robot) {
  RandomStream random("postures");
  for (int posture = 0; posture < 50; ++posture) {
    std::vector<double> q;
    for (std::size_t i = 0; i < model.joint_count(); ++i) {
      q.push_back(random.uniform(-3, 3));
    }
    const std::vector<Eigen::Isometry3d> expected = calc_link_poses(model, q);
    const std::vector<Eigen::Isometry3d> poses = follow_chain(robot, q);
    for (std::size_t i = 0; i < q.size(); ++i) {
      EXPECT_LT((poses[i].matrix() - expected[i].matrix()).cwiseAbs().maxCoeff(), 1e-14) << i;
    }
    const Eigen::Vector3d tip = (poses.back() * read_pose(robot["tip"])).translation();
    EXPECT_LT((tip - calc_tip_position(model, q)).norm(), 1e-14);
  }
}

TEST(RobotScene, MovesAsTheSimulatedArm) {
  std::vector<std::string> notes;
  expect_chain_of(load_arm(), make_robot(load_arm(), carry(20), kRobots, notes));
  const RobotModel bench = make_arm("", "");
  expect_chain_of(bench, make_robot(bench, {}, kRobots, notes));
}

TEST(RobotScene, HasTheShapesAndLimitsOfTheDescription) {
  std::vector<std::string> notes;
  const RobotModel arm = load_arm();
  const json robot = make_robot(arm, {}, kRobots, notes);
  EXPECT_THAT(notes, IsEmpty());
  EXPECT_EQ(robot["name"], "irb4600_40_255");
  ASSERT_EQ(robot["bodies"].size(), 5u);
  EXPECT_EQ(robot["bodies"][0]["name"], "base");
  EXPECT_EQ(robot["bodies"][4]["name"], "link_3");
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(robot["bodies"][i]["shapes"].size(),
              (i == 0 ? arm.base : arm.links[i - 1]).visuals.size());
  }
  const json& foot = robot["bodies"][0]["shapes"][0];
  EXPECT_EQ(foot["kind"], "box");
  EXPECT_EQ(foot["size"], json({0.62, 0.56, 0.04}));
  EXPECT_EQ(foot["pose"]["position"], json({-0.02, 0, 0.02}));
  EXPECT_EQ(foot["rgba"], json({0.20, 0.21, 0.23, 1}));
  EXPECT_TRUE(foot["mesh"].is_null());
  EXPECT_EQ(robot["joints"][1]["upper"], 2.6179938779914944);

  const json bench = make_robot(make_arm("", ""), {}, kRobots, notes);
  EXPECT_TRUE(bench["joints"][0]["upper"].is_null()) << "a continuous joint";
  EXPECT_EQ(bench["joints"][1]["kind"], "prismatic");
  EXPECT_EQ(bench["joints"][1]["lower"], -0.3);
}

TEST(RobotScene, CarriesTheLoadAsItIsSimulated) {
  std::vector<std::string> notes;
  const RobotModel arm = load_arm();
  const VisualShape block = add_load(arm, 20).links.back().visuals.back();
  const json robot = make_robot(arm, carry(20), kRobots, notes);
  const json& shapes = robot["bodies"][4]["shapes"];
  ASSERT_EQ(shapes.size(), arm.links[3].visuals.size() + 1);
  const json& load = shapes.back();
  EXPECT_EQ(load["kind"], "box");
  EXPECT_EQ(load["size"], json({0.16825, 0.16825, 0.09}));
  const Eigen::Isometry3d pose = read_pose(load["pose"]);
  EXPECT_LT((pose.matrix() - block.pose.matrix()).cwiseAbs().maxCoeff(), 1e-15);
  EXPECT_LT((pose.translation() - Eigen::Vector3d(0.135 + 0.045, 0, 0)).norm(), 1e-15);
  EXPECT_LT((pose.linear().col(2) - Eigen::Vector3d::UnitX()).norm(), 1e-15);
  for (std::size_t i = 0; i + 1 < shapes.size(); ++i) {
    EXPECT_NE(shapes[i]["rgba"], load["rgba"]);
  }
  EXPECT_EQ(make_robot(arm, carry(60), kRobots, notes)["bodies"], robot["bodies"]);
}

TEST(RobotScene, DrawsPlainShapesWhereTheDescriptionHasNone) {
  std::vector<std::string> notes;
  const RobotModel arm = make_arm("", "");
  const json robot = make_robot(arm, {}, kRobots, notes);
  ASSERT_THAT(notes, ElementsAre(HasSubstr("robot bench has no visual shapes")));
  // The tube of the base ends at the first joint.
  const json& tube = robot["bodies"][0]["shapes"][1];
  ASSERT_EQ(tube["kind"], "cylinder");
  const Eigen::Isometry3d pose = read_pose(tube["pose"]);
  const double length = tube["size"][1];
  const Eigen::Vector3d end = pose * Eigen::Vector3d(0, 0, length / 2);
  EXPECT_LT((end - arm.joints[0].origin.translation()).norm(), 1e-15);
  EXPECT_LT((pose * Eigen::Vector3d(0, 0, -length / 2)).norm(), 1e-15);
  for (const json& body : robot["bodies"]) {
    EXPECT_FALSE(body["shapes"].empty());
    for (const json& shape : body["shapes"]) {
      EXPECT_GT(shape["size"][0], 0);
    }
  }
}

// A square with a side of 2, as two triangles.
const char* const kTextStl = R"(solid square
facet normal 0 0 1
outer loop
vertex 0 0 0
vertex 2 0 0
vertex 2 2 0
endloop
endfacet
facet normal 0 0 1
outer loop
vertex 0 0 0
vertex 2 2 0
vertex 0 2 0
endloop
endfacet
endsolid square
)";

std::string make_binary_stl(const std::vector<std::vector<float>>& triangles) {
  std::string bytes(80, ' ');
  const auto append = [&bytes](std::uint32_t word, int count) {
    for (int i = 0; i < count; ++i) {
      bytes.push_back(static_cast<char>(word >> 8 * i & 0xff));
    }
  };
  append(static_cast<std::uint32_t>(triangles.size()), 4);
  for (const std::vector<float>& corners : triangles) {
    for (const float normal : {0.0F, 0.0F, 1.0F}) {
      append(std::bit_cast<std::uint32_t>(normal), 4);
    }
    for (const float value : corners) {
      append(std::bit_cast<std::uint32_t>(value), 4);
    }
    append(0, 2);
  }
  return bytes;
}

#ifdef ARMWRIGHT_WITH_ASSIMP

const std::vector<Eigen::Vector3f> kSquare = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0},
                                              {0, 0, 0}, {2, 2, 0}, {0, 2, 0}};

TEST(RobotScene, ReadsMeshesOfEachFormat) {
  const TemporaryFolder folder;
  write_text(folder.path() / "text.stl", kTextStl);
  write_text(folder.path() / "binary.STL",
             make_binary_stl({{0, 0, 0, 2, 0, 0, 2, 2, 0}, {0, 0, 0, 2, 2, 0, 0, 2, 0}}));
  write_text(folder.path() / "square.obj",
             "mtllib elsewhere.mtl\nv 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nf 1 2 3\nf 1 3 4\n");
  // The file says centimetres and y up, which readers of a URDF ignore.
  write_text(folder.path() / "square.dae", R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="centimetre" meter="0.01"/><up_axis>Y_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="a" count="12">0 0 0 200 0 0 200 200 0 0 200 0</float_array>
<technique_common><accessor source="#a" count="4" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="2"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2 0 2 3</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n"><instance_geometry url="#g"/></node>
</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>)");
  for (const std::string file : {"text.stl", "binary.STL", "square.obj", "square.dae"}) {
    std::vector<std::string> notes;
    const json robot = make_robot(make_arm(make_mesh_visual(file), make_mesh_visual(file)), {},
                                  folder.path(), notes);
    EXPECT_THAT(notes, IsEmpty()) << file;
    ASSERT_EQ(robot["meshes"].size(), 1u) << file;
    const std::vector<Eigen::Vector3f> corners = read_corners(robot["meshes"][0]);
    ASSERT_EQ(corners.size(), kSquare.size()) << file;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      EXPECT_LT((corners[i] - kSquare[i]).norm(), 1e-6F) << file << ' ' << i;
    }
    const json& shape = robot["bodies"][0]["shapes"][0];
    EXPECT_EQ(shape["kind"], "mesh");
    EXPECT_EQ(shape["mesh"], 0);
    EXPECT_EQ(shape["size"], json({0.5, 0.5, 2}));
  }
}

TEST(RobotScene, FindsMeshesInPackagesAndParents) {
  const TemporaryFolder folder;
  write_text(folder.path() / "bench_support/meshes/a.stl", kTextStl);
  const std::filesystem::path urdf_folder = folder.path() / "bench_support/urdf/";
  std::filesystem::create_directories(urdf_folder);
  for (const std::string& name :
       {std::string("package://bench_support/meshes/a.stl"), std::string("../meshes/a.stl"),
        std::string("meshes/a.stl"), (folder.path() / "bench_support/meshes/a.stl").string(),
        "file://" + (folder.path() / "bench_support/meshes/a.stl").string()}) {
    std::vector<std::string> notes;
    const json robot = make_robot(make_arm(make_mesh_visual(name), ""), {}, urdf_folder, notes);
    EXPECT_THAT(notes, IsEmpty()) << name;
    EXPECT_EQ(robot["meshes"].size(), 1u) << name;
  }
}

TEST(RobotScene, ShowsAMeshThatCannotBeReadAsPlainShapesAndSaysSo) {
  const TemporaryFolder folder;
  write_text(folder.path() / "bad.stl", "solid nothing");
  write_text(folder.path() / "bad.obj", "v 0 0 nan\nv 1 0 0\nv 1 1 0\nf 1 2 3\n");
  write_text(folder.path() / "bad.dae", "<COLLADA><asset></");
  write_text(folder.path() / "short.stl",
             make_binary_stl({{0, 0, 0, 2, 0, 0, 2, 2, 0}}).substr(0, 90));
  write_text(folder.path() / "arm.blend", "BLENDER");
  std::filesystem::create_directories(folder.path() / "folder.stl");
  for (const std::string file : {"bad.stl", "bad.obj", "bad.dae", "short.stl", "arm.blend",
                                 "folder.stl", "missing.stl", "package://nobody/x.stl"}) {
    std::vector<std::string> notes;
    const json robot = make_robot(make_arm(make_mesh_visual(file), make_mesh_visual(file)), {},
                                  folder.path(), notes);
    EXPECT_THAT(notes, ElementsAre(HasSubstr(file))) << "one note for both";
    EXPECT_EQ(robot["meshes"].size(), 0u) << file;
    EXPECT_EQ(robot["bodies"][0]["shapes"][0]["kind"], "sphere") << file;
    EXPECT_EQ(robot["bodies"][1]["shapes"].size(), 0u) << "as described";
  }
}

TEST(RobotScene, SaysThatMassesAreAssumed) {
  RobotModel arm = load_arm();
  arm.reading.assumed_links = {"link_1", "link_2"};
  std::vector<std::string> notes;
  make_robot(arm, {}, kRobots, notes);
  EXPECT_THAT(notes, ElementsAre("The description of the robot irb4600_40_255 states no mass for "
                                 "link_1, link_2. Masses are assumed, and all results depend on "
                                 "them."));
}

TEST(RobotScene, HasOneNoteForAllMeshesThatAreMissing) {
  const TemporaryFolder folder;
  std::vector<std::string> notes;
  make_robot(make_arm(make_mesh_visual("package://bench_support/a.stl") +
                          make_mesh_visual("package://bench_support/b.stl"),
                      make_mesh_visual("package://bench_support/c.stl")),
             {}, folder.path(), notes);
  EXPECT_THAT(notes, ElementsAre("Plain shapes stand for meshes: 3 meshes were not found, e.g. "
                                 "package://bench_support/a.stl; --package NAME=DIR "
                                 "(robot.packages) says where a package is."));
}

TEST(RobotScene, LooksForMeshesInTheRobotsPackages) {
  const TemporaryFolder folder;
  write_text(folder.path() / "elsewhere/meshes/a.stl", kTextStl);
  RobotModel arm = make_arm(make_mesh_visual("package://bench_support/meshes/a.stl"), "");
  arm.reading.packages["bench_support"] = folder.path() / "elsewhere";
  std::vector<std::string> notes;
  const json robot = make_robot(arm, {}, folder.path() / "urdf", notes);
  EXPECT_THAT(notes, IsEmpty());
  EXPECT_EQ(robot["meshes"].size(), 1u);
}

TEST(RobotScene, LeavesOutWhatIsTooLarge) {
  const TemporaryFolder folder;
  std::string many = "v 0 0 0\nv 1 0 0\nv 1 1 0\n";
  for (int i = 0; i < 120'000; ++i) {
    many += "f 1 2 3\n";
  }
  write_text(folder.path() / "first.obj", many);
  write_text(folder.path() / "second.obj", many);
  write_text(folder.path() / "huge.stl", "solid");
  std::filesystem::resize_file(folder.path() / "huge.stl", (64 << 20) + 1);
  std::vector<std::string> notes;
  const json robot =
      make_robot(make_arm(make_mesh_visual("first.obj") + make_mesh_visual("huge.stl"),
                          make_mesh_visual("second.obj")),
                 {}, folder.path(), notes);
  EXPECT_THAT(notes, ElementsAre(HasSubstr("huge.stl"),
                                 HasSubstr("second.obj of the robot is not shown: it has 120000")));
  EXPECT_EQ(robot["meshes"].size(), 1u);
}

#else

TEST(RobotScene, SaysThatItCannotReadMeshes) {
  const TemporaryFolder folder;
  write_text(folder.path() / "text.stl", kTextStl);
  write_text(folder.path() / "binary.stl", make_binary_stl({{0, 0, 0, 2, 0, 0, 2, 2, 0}}));
  std::vector<std::string> notes;
  make_robot(make_arm(make_mesh_visual("text.stl") + make_mesh_visual("binary.stl"), ""), {},
             folder.path(), notes);
  EXPECT_THAT(notes, ElementsAre(HasSubstr("without Assimp"), HasSubstr("without Assimp")));
}

#endif

}  // namespace
}  // namespace armwright
