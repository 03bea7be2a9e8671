#include "sim/robot/shape_mass.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <fstream>
#include <string>

#include "base/error.hpp"
#include "base/temporary_folder.hpp"
#include "sim/support.hpp"

namespace armwright {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

constexpr double kDensity_kg_per_m3 = 2700;
const Eigen::Vector3d kAsItIs(1, 1, 1);

// Twelve triangles that face outwards. The corners' coordinates are sums of powers of two, which
// floats represent exactly.
TriangleMesh make_box_mesh(const Eigen::Vector3f& low, const Eigen::Vector3f& high) {
  TriangleMesh mesh;
  for (int corner = 0; corner < 8; ++corner) {
    mesh.positions.push_back((corner & 1) != 0 ? high.x() : low.x());
    mesh.positions.push_back((corner & 2) != 0 ? high.y() : low.y());
    mesh.positions.push_back((corner & 4) != 0 ? high.z() : low.z());
  }
  mesh.indices = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                  2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
  return mesh;
}

void append(TriangleMesh& mesh, const TriangleMesh& other) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size() / 3);
  mesh.positions.insert(mesh.positions.end(), other.positions.begin(), other.positions.end());
  for (const std::uint32_t index : other.indices) {
    mesh.indices.push_back(first + index);
  }
}

TriangleMesh turn_inside_out(TriangleMesh mesh) {
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    std::swap(mesh.indices[i], mesh.indices[i + 1]);
  }
  return mesh;
}

VisualShape make_shape(ShapeKind kind, const Eigen::Vector3d& size_m) {
  VisualShape shape;
  shape.kind = kind;
  shape.size_m = size_m;
  return shape;
}

Inertial calc_solid(const VisualShape& shape) {
  MeshFinder meshes(".");
  return calc_shape_mass(shape, kDensity_kg_per_m3, meshes).inertial;
}

void expect_near(const Inertial& found, const Inertial& expected, double relative) {
  const double size = expected.inertia_kg_m2.norm();
  EXPECT_NEAR(found.mass_kg, expected.mass_kg, relative * expected.mass_kg);
  EXPECT_LT((found.com_m - expected.com_m).norm(), relative * (1 + expected.com_m.norm()));
  EXPECT_LT((found.inertia_kg_m2 - expected.inertia_kg_m2).norm(), relative * size)
      << found.inertia_kg_m2;
}

constexpr double kRounding = 1e-13;  // some hundred roundings

// From the definition, by hand: a box of 0.25 x 0.5 x 1 m, 337.5 kg.
TEST(ShapeMass, OfABox) {
  const Inertial box = calc_solid(make_shape(ShapeKind::box, {0.25, 0.5, 1}));
  EXPECT_DOUBLE_EQ(box.mass_kg, 337.5);
  EXPECT_DOUBLE_EQ(box.inertia_kg_m2(0, 0), 337.5 * (0.25 + 1) / 12);
  EXPECT_DOUBLE_EQ(box.inertia_kg_m2(1, 1), 337.5 * (0.0625 + 1) / 12);
  EXPECT_DOUBLE_EQ(box.inertia_kg_m2(2, 2), 337.5 * (0.0625 + 0.25) / 12);
}

// A general pose, and 2 pi instead of the textbook's formulas: sums over thin rings and discs (the
// midpoint rule, whose error is below (1/n)^2).
TEST(ShapeMass, OfACylinderAndASphereAgreeWithSums) {
  constexpr double kRadius_m = 0.3, kCylinder_m = 0.8;
  constexpr int kCount = 1000;
  double cylinder = 0, along = 0, sphere = 0, moment = 0, across = 0;
  for (int i = 0; i < kCount; ++i) {
    const double r = (i + 0.5) / kCount * kRadius_m;
    const double ring = 2 * kPi * r * kRadius_m / kCount * kCylinder_m * kDensity_kg_per_m3;
    cylinder += ring;
    along += ring * r * r;
    across += ring * r * r / 2;
    const double z = (2 * (i + 0.5) / kCount - 1) * kRadius_m;
    const double square = kRadius_m * kRadius_m - z * z;
    const double disc = kPi * square * 2 * kRadius_m / kCount * kDensity_kg_per_m3;
    sphere += disc;
    moment += disc * square / 2;
  }
  for (int i = 0; i < kCount; ++i) {
    const double z = ((i + 0.5) / kCount - 0.5) * kCylinder_m;
    across += cylinder / kCount * z * z;
  }
  const double error = 2.0 / kCount / kCount;
  const Inertial rod = calc_solid(make_shape(ShapeKind::cylinder, {kRadius_m, kCylinder_m, 0}));
  EXPECT_NEAR(rod.mass_kg / cylinder, 1, error);
  EXPECT_NEAR(rod.inertia_kg_m2(2, 2) / along, 1, error);
  EXPECT_NEAR(rod.inertia_kg_m2(0, 0) / across, 1, error);
  EXPECT_EQ(rod.inertia_kg_m2(0, 0), rod.inertia_kg_m2(1, 1));
  const Inertial ball = calc_solid(make_shape(ShapeKind::sphere, {kRadius_m, 0, 0}));
  EXPECT_NEAR(ball.mass_kg / sphere, 1, error);
  EXPECT_NEAR(ball.inertia_kg_m2(1, 1) / moment, 1, error);
}

TEST(ShapeMass, LiesWhereTheShapeLies) {
  VisualShape shape = make_shape(ShapeKind::box, {0.25, 0.5, 1});
  const Inertial straight = calc_solid(shape);
  shape.pose.translation() << 0.1, -0.2, 0.3;
  shape.pose.linear() =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  expect_near(calc_solid(shape), transform(straight, shape.pose), kRounding);
}

TEST(ShapeMass, OfNothingIsRefused) {
  EXPECT_THAT(
      [] {
        try {
          calc_solid(make_shape(ShapeKind::sphere, {1e-120, 0, 0}));
        } catch (const Error& error) {
          return std::string(error.what());
        }
        return std::string("no error");
      }(),
      HasSubstr("gives the link a mass of 0 kg, which no simulation can use"));
}

TEST(MeshMass, OfABoxIsTheBoxs) {
  const Eigen::Vector3f low(0.5F, -0.25F, 2), high(0.75F, 0.25F, 3);
  VisualShape same = make_shape(ShapeKind::box, {0.25, 0.5, 1});
  same.pose.translation() << 0.625, 0, 2.5;
  expect_near(calc_mesh_inertial(make_box_mesh(low, high), kAsItIs, kDensity_kg_per_m3),
              calc_solid(same), kRounding);
}

// The corner of a cube: V = 1/6, int x = 1/24, int x^2 = 1/60, int x y = 1/120, so about its centre
// of mass, (1, 1, 1)/4, int x^2 is 1/60 - 1/96 and int x y 1/120 - 1/96.
TEST(MeshMass, OfATetrahedronIsByHand) {
  const TriangleMesh mesh{{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1},
                          {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3}};
  ASSERT_EQ(find_gap(count_edges(mesh)), std::nullopt);
  const double square = 1.0 / 60 - 1.0 / 96, product = 1.0 / 120 - 1.0 / 96;
  Inertial expected{6.0 / 6, Eigen::Vector3d::Constant(0.25),
                    Eigen::Matrix3d::Constant(-6 * product)};
  expected.inertia_kg_m2.diagonal().setConstant(6 * 2 * square);
  expect_near(calc_mesh_inertial(mesh, kAsItIs, 6), expected, kRounding);
}

// Vertices on a sphere: halving the step divides the error by four.
TEST(MeshMass, OfABallConverges) {
  const auto make_ball = [](int count) {
    TriangleMesh mesh;
    const auto add = [&](double z, double radius, int at) {
      const double angle = kPi * at / count;
      for (const double value : {radius * std::cos(angle), radius * std::sin(angle), z}) {
        mesh.positions.push_back(static_cast<float>(value));
      }
    };
    const auto index = [count](int row, int column) {  // the poles are one vertex each
      return row == 0 ? 0u
             : row == count
                 ? 1u
                 : 2u + static_cast<std::uint32_t>((row - 1) * 2 * count + column % (2 * count));
    };
    add(1, 0, 0);
    add(-1, 0, 0);
    for (int row = 1; row < count; ++row) {
      for (int column = 0; column < 2 * count; ++column) {
        add(std::cos(kPi * row / count), std::sin(kPi * row / count), column);
      }
    }
    for (int row = 0; row < count; ++row) {
      for (int column = 0; column < 2 * count; ++column) {
        for (const std::uint32_t i :
             {index(row, column), index(row + 1, column), index(row + 1, column + 1),
              index(row, column), index(row + 1, column + 1), index(row, column + 1)}) {
          mesh.indices.push_back(i);
        }
      }
    }
    return mesh;
  };
  const Inertial ball = calc_solid(make_shape(ShapeKind::sphere, {1, 0, 0}));
  double mass_error[2], moment_error[2];
  for (const int i : {0, 1}) {
    const TriangleMesh mesh = make_ball(i == 0 ? 20 : 40);
    ASSERT_EQ(find_gap(count_edges(mesh)), std::nullopt);
    const Inertial body = calc_mesh_inertial(mesh, kAsItIs, kDensity_kg_per_m3);
    mass_error[i] = 1 - body.mass_kg / ball.mass_kg;
    moment_error[i] = 1 - body.inertia_kg_m2(0, 0) / ball.inertia_kg_m2(0, 0);
  }
  EXPECT_GT(mass_error[1], 0) << "it lies within the ball";
  EXPECT_NEAR(mass_error[0] / mass_error[1], 4, 0.05);
  EXPECT_NEAR(moment_error[0] / moment_error[1], 4, 0.05);
}

TEST(MeshMass, AHoleInsideCountsAsOne) {
  const Eigen::Vector3f outer(1, 1, 1), inner(0.5F, 0.25F, 0.75F);
  TriangleMesh mesh = make_box_mesh(-outer, outer);
  append(mesh, turn_inside_out(make_box_mesh(-inner, inner)));
  ASSERT_EQ(find_gap(count_edges(mesh)), std::nullopt);
  const Inertial hollow = calc_mesh_inertial(mesh, kAsItIs, 1);
  const Inertial whole = calc_mesh_inertial(make_box_mesh(-outer, outer), kAsItIs, 1);
  const Inertial hole = calc_mesh_inertial(make_box_mesh(-inner, inner), kAsItIs, 1);
  expect_near(combine(hollow, hole), whole, kRounding);
}

// A mesh in millimetres, and a mirrored one, whose triangles face inwards without a correction.
TEST(MeshMass, FollowsTheScale) {
  const TriangleMesh mesh = make_box_mesh({0, 0, 0}, {256, 512, 1024});
  VisualShape same = make_shape(ShapeKind::box, {0.256, 0.512, 1.024});
  same.pose.translation() << 0.128, 0.256, 0.512;
  expect_near(calc_mesh_inertial(mesh, 0.001 * kAsItIs, kDensity_kg_per_m3), calc_solid(same),
              kRounding);
  same.pose.translation().y() *= -1;
  expect_near(calc_mesh_inertial(mesh, {0.001, -0.001, 0.001}, kDensity_kg_per_m3),
              calc_solid(same), kRounding);
}

TEST(MeshMass, RefusesWhatHasNoVolume) {
  const auto message_of = [](const TriangleMesh& mesh, const Eigen::Vector3d& scale) {
    try {
      calc_mesh_inertial(mesh, scale, 1);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::bad_data);
      return std::string(error.what());
    }
    return std::string("no error");
  };
  const TriangleMesh cube = make_box_mesh({0, 0, 0}, {1, 1, 1});
  EXPECT_EQ(message_of(turn_inside_out(cube), kAsItIs),
            "its volume is -1 m3, as if its triangles faced inwards");
  EXPECT_THAT(message_of(cube, {1, 1, 0}),
              ::testing::AllOf(StartsWith("its volume is "), HasSubstr("of a sheet")));
}

TEST(MeshMass, FindsGaps) {
  TriangleMesh mesh = make_box_mesh({0, 0, 0}, {1, 1, 1});
  EXPECT_EQ(find_gap(count_edges(mesh)), std::nullopt);
  std::swap(mesh.indices[0], mesh.indices[1]);
  EXPECT_EQ(find_gap(count_edges(mesh)),
            "its triangles are not all oriented alike (those at 3 of 18 edges are not)");
  mesh.indices.resize(mesh.indices.size() - 3);
  EXPECT_THAT(*find_gap(count_edges(mesh)),
              StartsWith("it is not closed (3 of its 18 edges have a triangle on one side only)"));
  // As in STL, where every triangle has corners of its own; and -0 is 0.
  TriangleMesh apart;
  const TriangleMesh cube = make_box_mesh({-1, -1, -0.0F}, {0.0F, 1, 1});
  for (const std::uint32_t index : cube.indices) {
    apart.indices.push_back(static_cast<std::uint32_t>(apart.indices.size()));
    for (int k = 0; k < 3; ++k) {
      const float value = cube.positions[3 * index + static_cast<std::uint32_t>(k)];
      apart.positions.push_back(value == 0 && index % 2 == 0 ? -value : value);
    }
  }
  EXPECT_EQ(find_gap(count_edges(apart)), std::nullopt);
}

// A box whose faces are grids of squares with sides of 1/8 m, each cut into two triangles.
TriangleMesh make_fine_box() {
  constexpr int kCount = 8;
  TriangleMesh mesh;
  const auto add = [&mesh](int axis, int a, int b, int side) {
    const float first = static_cast<float>(a) / kCount, second = static_cast<float>(b) / kCount;
    float corner[3];
    corner[axis] = static_cast<float>(side);
    corner[(axis + 1) % 3] = first;
    corner[(axis + 2) % 3] = second;
    mesh.indices.push_back(static_cast<std::uint32_t>(mesh.positions.size() / 3));
    mesh.positions.insert(mesh.positions.end(), corner, corner + 3);
  };
  for (int axis = 0; axis < 3; ++axis) {
    for (int a = 0; a < kCount; ++a) {
      for (int b = 0; b < kCount; ++b) {
        const int ways[6][2] = {{a, b}, {a + 1, b},     {a + 1, b + 1},
                                {a, b}, {a + 1, b + 1}, {a, b + 1}};
        for (const int i : {0, 1, 2, 3, 4, 5}) {
          add(axis, ways[i][0], ways[i][1], 1);
        }
        for (const int i : {0, 2, 1, 3, 5, 4}) {
          add(axis, ways[i][0], ways[i][1], 0);
        }
      }
    }
  }
  return mesh;
}

// 768 triangles have 1152 edges. Without three triangles that share no edge, 9 edges are open, which
// is 0.8 %. Each triangle bounds a pyramid of at most 1/384 of the unit box about its centre, so 3 of
// 768 triangles change the volume by 3/768.
TEST(MeshMass, CountsAMeshWithFewOpenEdgesAsClosed) {
  TriangleMesh mesh = make_fine_box();
  ASSERT_EQ(count_edges(mesh).count, 1152u);
  ASSERT_EQ(find_gap(count_edges(mesh)), std::nullopt);
  const auto leave_out = [&mesh](std::size_t triangle) {
    mesh.indices.erase(mesh.indices.begin() + static_cast<long>(3 * triangle),
                       mesh.indices.begin() + static_cast<long>(3 * triangle + 3));
  };
  leave_out(600);
  leave_out(300);
  leave_out(0);
  EXPECT_EQ(count_edges(mesh).open, 9u);
  EXPECT_EQ(find_gap(count_edges(mesh)), std::nullopt);
  EXPECT_NEAR(calc_mesh_inertial(mesh, kAsItIs, 1).mass_kg, 1 - 3.0 / 768, 1e-6);
  leave_out(100);
  EXPECT_EQ(find_gap(count_edges(mesh)),
            "it is not closed (12 of its 1152 edges have a triangle on one side only)");
}

// From the file to the arm: a link with three shapes in general places, a finger on a fixed joint,
// and a base whose mesh is not needed.
constexpr const char* kArm = R"(<robot name="arm"><link name="base">
  <visual><geometry><mesh filename="nowhere.stl"/></geometry></visual></link>
  <joint name="turn" type="continuous"><parent link="base"/><child link="bar"/></joint>
  <link name="bar">
    <visual><origin xyz="0.1 0.2 0.3" rpy="0.4 0.5 0.6"/><geometry><box size="0.1 0.2 0.4"/></geometry></visual>
    <visual><origin rpy="0 0.3 0"/><geometry><cylinder radius="0.05" length="0.3"/></geometry></visual>%s
  </link>
  <joint name="grip" type="fixed"><parent link="bar"/><child link="finger"/><origin xyz="0 0 0.5" rpy="0 0 0.2"/></joint>
  <link name="finger"><visual><geometry><sphere radius="0.1"/></geometry></visual></link>
  <joint name="end" type="fixed"><parent link="finger"/><child link="weight"/></joint>
  <link name="weight"><inertial><mass value="2"/><inertia ixx="0.2" iyy="0.2" izz="0.2" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><geometry><box size="5 5 5"/></geometry></visual></link>
</robot>)";

std::string make_arm(const std::string& more = "") {
  std::string xml = kArm;
  return xml.replace(xml.find("%s"), 2, more);
}

TEST(LinkMass, ComesFromTheShapesOfLinksWithoutInertial) {
  const RobotModel arm = parse_urdf(make_arm(), "arm.urdf", {.density_kg_per_m3 = 2700});
  const RobotModel looks = parse_urdf(
      make_arm(), "arm.urdf", {.density_kg_per_m3 = 1});  // for its shapes, which have poses
  const auto& shapes = looks.links[0].visuals;
  ASSERT_EQ(shapes.size(), 4u);
  Inertial expected;
  for (std::size_t i = 0; i < 3; ++i) {
    expected = combine(expected, calc_solid(shapes[i]));
  }
  const double moment = 0.2;
  expected =
      combine(expected, {2, Eigen::Vector3d(0, 0, 0.5), moment * Eigen::Matrix3d::Identity()});
  expect_near(arm.links[0].inertial, expected, kRounding);
  EXPECT_EQ(arm.base.inertial.mass_kg, 0) << "it does not move";
  EXPECT_THAT(arm.notes,
              ElementsAre("link 'bar' has no <inertial>: 27.96 kg and their inertia come from its "
                          "2 shapes at 2700 kg/m3",
                          "link 'finger' has no <inertial>: 11.31 kg and their inertia come from "
                          "its shape at 2700 kg/m3"));
  EXPECT_THAT(arm.mass_files, IsEmpty());
}

std::string refusal_of(const std::string& xml, const std::string& name = "arm.urdf") {
  try {
    parse_urdf(xml, name, {.density_kg_per_m3 = 2700});
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::bad_data);
    return error.what();
  }
  return "no error";
}

TEST(LinkMass, NeedsAShape) {
  EXPECT_EQ(
      refusal_of("<robot name=\"r\"><link name=\"a\"/>\n<joint name=\"j\" type=\"continuous\">"
                 "<parent link=\"a\"/><child link=\"b\"/></joint><link name=\"b\"/></robot>"),
      "arm.urdf:2: joint 'j' moves link 'b', which has no mass and no <visual> to take it "
      "from; give it an <inertial> element (or make the joint fixed)");
}

TEST(LinkMass, NamesAMeshThatIsNotThere) {
  EXPECT_EQ(refusal_of(make_arm("<visual><geometry><mesh "
                                "filename=\"package://p/nothing.stl\"/></geometry></visual>")),
            "arm.urdf: link 'bar': there is no mesh 'package://p/nothing.stl' in the URDF's folder "
            "and the folders above it, but the link's mass comes from this mesh; put it there, say "
            "where its package is (--package NAME=DIR, robot.packages), or give the link an "
            "<inertial> element");
}

#ifdef ARMWRIGHT_WITH_ASSIMP

std::string make_obj(const TriangleMesh& mesh) {
  std::string text;
  for (std::size_t i = 0; i < mesh.positions.size(); i += 3) {
    text += "v";
    for (std::size_t k = i; k < i + 3; ++k) {
      text += ' ' + std::to_string(mesh.positions[k]);
    }
    text += '\n';
  }
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    text += "f";
    for (std::size_t k = i; k < i + 3; ++k) {
      text += ' ' + std::to_string(mesh.indices[k] + 1);
    }
    text += '\n';
  }
  return text;
}

std::string make_stl(const TriangleMesh& mesh) {
  std::string text = "solid s\n";
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (std::size_t k = i; k < i + 3; ++k) {
      const float* at = mesh.positions.data() + 3 * std::size_t{mesh.indices[k]};
      text += "vertex " + std::to_string(at[0]) + ' ' + std::to_string(at[1]) + ' ' +
              std::to_string(at[2]) + '\n';
    }
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid s\n";
}

TEST(LinkMass, NotesAMeshThatIsNotQuiteClosed) {
  const TemporaryFolder folder;
  TriangleMesh box = make_fine_box();
  box.indices.resize(box.indices.size() - 3);
  std::ofstream(folder.path() / "box.stl") << make_stl(box);
  const RobotModel arm =
      parse_urdf(make_arm("<visual><geometry><mesh filename=\"box.stl\"/></geometry></visual>"),
                 (folder.path() / "arm.urdf").string(), {.density_kg_per_m3 = 2700});
  EXPECT_THAT(
      arm.notes,
      testing::Contains("link 'bar': the mesh box.stl is not quite closed (3 of its 1152 edges "
                        "have a triangle on one side only); its volume is that within its "
                        "triangles"));
}

TEST(LinkMass, ComesFromMeshes) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder.path() / "urdf");
  TriangleMesh box = make_box_mesh({0, 0, 0}, {256, 512, 1024});
  std::ofstream(folder.path() / "box.obj") << make_obj(box);
  std::ofstream(folder.path() / "box.stl") << make_stl(box);
  box.indices.resize(box.indices.size() - 3);
  std::ofstream(folder.path() / "open.stl") << make_stl(box);
  const std::string urdf = (folder.path() / "urdf/arm.urdf").string();
  const auto make_mesh_arm = [](const std::string& file) {
    return make_arm("<visual><origin xyz=\"0 0 1\"/><geometry><mesh filename=\"../" + file +
                    "\" scale=\"0.001 0.001 0.001\"/></geometry></visual>");
  };
  const Inertial same =
      parse_urdf(make_arm("<visual><origin xyz=\"0.128 0.256 1.512\"/><geometry><box size=\"0.256 "
                          "0.512 1.024\"/></geometry></visual>"),
                 urdf, {.density_kg_per_m3 = 2700})
          .links[0]
          .inertial;
  for (const std::string file : {"box.obj", "box.stl"}) {
    const RobotModel arm = parse_urdf(make_mesh_arm(file), urdf, {.density_kg_per_m3 = 2700});
    expect_near(arm.links[0].inertial, same, kRounding);
    ASSERT_EQ(arm.mass_files.size(), 1u);
    const auto& [name, path] = *arm.mass_files.begin();
    EXPECT_EQ(name, "../" + file);
    EXPECT_TRUE(std::filesystem::equivalent(path, folder.path() / file));
  }
  const std::string message = refusal_of(make_mesh_arm("open.stl"), urdf);
  EXPECT_THAT(message, StartsWith(urdf + ": link 'bar': the mesh "));
  EXPECT_THAT(message,
              HasSubstr("open.stl gives the link no mass: it is not closed (3 of its 18 "
                        "edges have a triangle on one side only); repair the mesh, or give "
                        "the link an <inertial> element"));
}

#endif

}  // namespace
}  // namespace armwright
