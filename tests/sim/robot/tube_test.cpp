#include "sim/robot/tube.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sim/robot/shape_mass.hpp"

namespace armwright {
namespace {

// The numbers of the design problem's check point, computed with numpy.
TEST(Tube, MassesAndDeflectionAreThoseOfTheCheckPoint) {
  const TubeMaterial aluminium;
  const Tube tubes[] = {{0.06, 0.003}, {0.05, 0.003}};
  const double lengths_m[] = {0.5, 0.5};
  EXPECT_NEAR(aluminium.density_kg_per_m3 * tubes[0].section_m2() * 0.5, 0.725237, 5e-7);
  EXPECT_NEAR(aluminium.density_kg_per_m3 * tubes[1].section_m2() * 0.5, 0.598002, 5e-7);
  EXPECT_NEAR(1000 * calc_deflection_m(tubes, lengths_m, aluminium, 2, 9.80665), 0.571975, 5e-7);
}

// One tube of the sections of both halves sags as the two halves joined do.
TEST(Tube, DeflectionDoesNotDependOnWhereATubeIsDivided) {
  const TubeMaterial steel{.youngs_modulus_pa = 2e11, .density_kg_per_m3 = 7850};
  const Tube tube{0.04, 0.002};
  const Tube three[] = {tube, tube, tube};
  const double whole_m = 0.9, parts_m[] = {0.2, 0.4, 0.3};
  const double whole = calc_deflection_m({&tube, 1}, {&whole_m, 1}, steel, 1.5, 9.81);
  EXPECT_NEAR(calc_deflection_m(three, parts_m, steel, 1.5, 9.81) / whole, 1, 1e-13);
  const double ei = 2e11 * tube.second_moment_m4();
  const double weight = 7850 * tube.section_m2() * 9.81;
  EXPECT_NEAR(whole,
              weight * std::pow(0.9, 4) / (8 * ei) + 1.5 * 9.81 * std::pow(0.9, 3) / (3 * ei),
              1e-15);
}

// A tube is a cylinder less its bore.
TEST(Tube, InertiaIsThatOfACylinderWithoutItsBore) {
  RobotModel robot;
  robot.joints.resize(1);
  robot.links.resize(1);
  robot.tip_pose.translation() = Eigen::Vector3d(0.3, -0.4, 1.2);  // 1.3 m long
  robot.payload = Inertial{2, Eigen::Vector3d::Zero(), Eigen::Matrix3d::Zero()};
  const TubeMaterial material;
  const Tube tube{0.1, 0.01};
  make_tube(robot, 0, tube, material);
  const auto make_cylinder = [&](double radius_m) {
    const double mass = material.density_kg_per_m3 * std::numbers::pi * radius_m * radius_m * 1.3;
    const double across = mass * (3 * radius_m * radius_m + 1.3 * 1.3) / 12;
    return Eigen::Vector3d(mass, across, mass * radius_m * radius_m / 2);
  };
  const Eigen::Vector3d expected = make_cylinder(0.05) - make_cylinder(0.04);
  robot.payload.reset();
  make_tube(robot, 0, tube, material);
  const Inertial& made = robot.links[0].inertial;
  const Eigen::Vector3d axis = robot.tip_pose.translation() / 1.3;
  EXPECT_NEAR(made.mass_kg, expected[0], 1e-12);
  EXPECT_NEAR(axis.dot(made.inertia_kg_m2 * axis), expected[2], 1e-12);
  const Eigen::Vector3d across = axis.unitOrthogonal();
  EXPECT_NEAR(across.dot(made.inertia_kg_m2 * across), expected[1], 1e-12);
}

}  // namespace
}  // namespace armwright
