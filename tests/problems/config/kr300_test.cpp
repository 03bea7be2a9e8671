// The shipped KUKA KR 300 against its source: a table of Denavit-Hartenberg parameters, masses, rotors,
// catalogue friction and the formula of the gas spring (configs/robots/kr300.urdf names it).
#include <gmock/gmock.h>

#include <cmath>
#include <fstream>
#include <sstream>
#include <vector>

#include "problems/config/plant_file.hpp"
#include "sim/dynamics/arm_equations.hpp"
#include "sim/dynamics/joint_effort.hpp"
#include "sim/kinematics/kinematics.hpp"

namespace armwright {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::size_t kAxes = 6;
// The gear ratios of the table, as fractions.
constexpr double kGearRatios[kAxes] = {1798.0 / 7, 1872.0 / 7,  757.0 / 3,
                                       221.0,      5032.0 / 21, 206793.0 / 1340};

std::filesystem::path find_robot_file(const std::string& name) {
  return std::filesystem::path(ARMWRIGHT_CONFIGS) / "robots" / name;
}

RobotModel load_kr300() {
  RobotModel robot = load_urdf(find_robot_file("kr300.urdf"));
  load_plant(find_robot_file("kr300.plant.toml"), robot);
  return robot;
}

// The torques that the motors give, without their gears.
std::vector<double> calc_motor_torques(const RobotModel& robot, const std::vector<double>& q,
                                       const std::vector<double>& rate,
                                       const std::vector<double>& acceleration) {
  const articulated::ChainModel chain(robot, 9.81);
  articulated::ArmEquations equations(chain);
  equations.set(q, rate);
  std::vector<double> torques;
  for (std::size_t i = 0; i < kAxes; ++i) {
    const Joint& joint = robot.joints[i];
    double effort = equations.bias(i) + joint.plant.armature * acceleration[i] +
                    articulated::calc_friction_chord(joint.plant, rate[i]) * rate[i] -
                    articulated::calc_counterbalance(joint, q[i]);
    for (std::size_t j = 0; j < kAxes; ++j) {
      effort += equations.mass(i, j) * acceleration[j];
    }
    torques.push_back(effort / kGearRatios[i]);
  }
  return torques;
}

struct KukaRow {
  double payload_kg;  // a point mass 50 mm behind the flange
  std::vector<double> q, rate, acceleration, motor_torque_n_m;
};

// Made by another program (plain Python): Newton's and Euler's equations, link by link, in the frames
// of the table, with 0.01 kg m^2 about every axis of the last link. Friction at the motor is
// viscous * (gear ratio * rate) + Coulomb * tanh(rate / 0.01 rad/s). The gas spring's h p A is added
// to the effort of axis 2, and rotor inertia * gear ratio * acceleration to each motor. Positions are
// drawn over the ranges, rates over the speed limits or a hundredth of them.
//
// With filtered recordings in place of drawn motions and 200 kg, the same program has these errors
// of the motors' torques, RMS in N m (4th-order zero-phase Butterworth at 8 Hz, central differences,
// 60 samples cut at each end):
//   trajectory A: 2.388 2.735 4.010 0.389 0.673 1.051,
//   trajectory B: 1.936 2.492 3.578 0.323 0.583 0.658.
const std::vector<KukaRow> kRows = {
    {0,
     {0.5013, -0.0605, -3.5187, -1.8761, 1.3818, -0.9352},
     {0.2926, -1.19266, -0.2702, -0.56129, -1.42568, -1.54951},
     {-3.245, 2.949, 0.022, 0.122, 2.176, 1.523},
     {-8.6730711, 13.611058, -4.4447113, -0.5584311, 0.0543417, -0.4934521}},
    {0,
     {-1.0427, 1.2158, -0.9506, 5.5838, -0.964, -1.8277},
     {-0.01589, 0.01073, 0.00464, 0.01316, -0.00489, 0.0256},
     {2.012, 2.514, -3.724, 2.584, 3.634, 1.855},
     {11.8888675, 26.5055653, -13.0068318, 1.3051463, 1.2299227, 0.8723604}},
    {0,
     {-0.286, 0.5838, -2.2715, -3.709, 1.6787, 1.7267},
     {1.37811, -0.92331, -0.33977, 1.36647, -1.4175, 0.12852},
     {-0.365, -2.083, 2.023, 1.267, -0.786, 2.106},
     {-3.8882679, -7.3654582, -4.2519113, 1.6304654, -1.423782, 0.9789579}},
    {200,
     {2.4494, -0.6611, 1.0832, -2.8347, -0.2941, -3.5584},
     {-1.64051, 0.23034, -1.42412, 0.41499, 1.71816, 1.91995},
     {-2.59, -2.444, 2.88, 0.138, 3.952, -1.1},
     {-11.9297246, -21.242677, -30.392064, 0.5435038, 3.5122743, 0.7321992}},
    {200,
     {0.3881, 0.0733, -3.1191, -0.0814, 0.0568, -1.4667},
     {0.01806, 0.00733, -0.01172, -0.02108, -0.01617, -0.0213},
     {-3.026, -3.525, 2.238, -1.53, -1.112, -0.838},
     {-9.2929018, -6.5659158, 14.9151709, -0.9089853, 0.4386742, -0.5933778}},
    {200,
     {-0.2699, -0.0678, -1.1201, 0.8968, -0.8854, 0.0471},
     {},
     {},
     {0.0, -2.0976583, -4.3713362, -0.4443459, 0.973076, 0.0}}};

TEST(Kr300, HasTheMotorTorquesOfItsTable) {
  const RobotModel bare = load_kr300();
  for (std::size_t k = 0; k < kRows.size(); ++k) {
    const KukaRow& row = kRows[k];
    const LoadBody point{.com_m = {0, 0, -0.05}};
    const RobotModel robot = row.payload_kg > 0 ? add_load(bare, row.payload_kg, point) : bare;
    const std::vector<double> rest(kAxes, 0);
    const std::vector<double> torques =
        calc_motor_torques(robot, row.q, row.rate.empty() ? rest : row.rate,
                           row.acceleration.empty() ? rest : row.acceleration);
    for (std::size_t i = 0; i < kAxes; ++i) {
      // The spring is straight between 1025 positions, 2.3e-3 rad apart: 2.3e-3^2 / 8 times a second
      // derivative of at most 2e4 N m/rad^2 is 0.013 N m, 5e-5 N m at the motor. The friction in the
      // plant's file has 6 digits: 1e-5 N m at most.
      EXPECT_NEAR(torques[i], row.motor_torque_n_m[i], i == 1 ? 6e-5 : 1e-5)
          << "row " << k << ", axis " << i + 1;
    }
  }
}

// In the recorded zero, the upper arm is vertical and the forearm horizontal. The axes turn as the
// table's do: 1 clockwise seen from above, 2 and 3 forwards.
TEST(Kr300, TurnsAsTheRecordedRobot) {
  const RobotModel robot = load_kr300();
  const auto tip = [&](std::vector<double> q) { return calc_tip_position(robot, q); };
  // Roundings of numbers of size 3.
  EXPECT_LT((tip({0, 0, 0, 0, 0, 0}) - Eigen::Vector3d(1.59, 0, 1.784)).norm(), 1e-14);
  EXPECT_LT(tip({0.1, 0, 0, 0, 0, 0}).y(), -0.1);
  EXPECT_GT(tip({0, 0.1, 0, 0, 0, 0}).x(), 1.6);
  EXPECT_LT(tip({0, 0, 0.1, 0, 0, 0}).z(), 1.7);
}

TEST(Kr300, IsReadAsItIs) {
  const RobotModel robot = load_urdf(find_robot_file("kr300.urdf"), {.repair = true});
  EXPECT_THAT(robot.reading.repairs, IsEmpty());
  EXPECT_THAT(robot.notes, IsEmpty());
  EXPECT_EQ(robot.reading.tip, "flange");
}

// Every recorded position lies inside the ranges, every torque inside the limits.
TEST(Kr300, CanDoWhatWasRecorded) {
  const RobotModel robot = load_kr300();
  for (const char* name : {"trajectory-A.csv", "trajectory-B.csv"}) {
    const auto file = std::filesystem::path(ARMWRIGHT_CONFIGS) / "logs" / "kr300" / name;
    std::ifstream stream(file);
    std::string line;
    ASSERT_TRUE(std::getline(stream, line)) << file;
    ASSERT_THAT(line, HasSubstr(",motor_torque_6_n_m"));
    int rows = 0;
    for (; std::getline(stream, line); ++rows) {
      std::vector<double> numbers;
      std::istringstream cells(line);
      for (std::string cell; std::getline(cells, cell, ',');) {
        numbers.push_back(std::stod(cell));
      }
      ASSERT_EQ(numbers.size(), 28u) << file << ':' << rows + 2;
      EXPECT_NEAR(numbers[0], 0.004 * rows, 1e-12);
      for (std::size_t i = 0; i < kAxes; ++i) {
        const Joint& joint = robot.joints[i];
        for (const std::size_t column : {1 + i, 7 + i}) {  // reference and position
          ASSERT_GT(numbers[column], joint.lower) << file << ':' << rows + 2;
          ASSERT_LT(numbers[column], joint.upper) << file << ':' << rows + 2;
        }
        ASSERT_LT(std::abs(numbers[13 + i]), joint.speed_limit) << file << ':' << rows + 2;
        ASSERT_LT(std::abs(numbers[22 + i]) * kGearRatios[i], joint.effort_limit / 2)
            << file << ':' << rows + 2;
      }
    }
    EXPECT_EQ(rows, 2501) << file;
  }
}

}  // namespace
}  // namespace armwright
