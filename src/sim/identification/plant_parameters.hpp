// The numbers of a robot that a recorded motion can tell: one list of parameters, in groups that a
// user chooses. A parameter vector has one value per parameter, in the list's order and in the
// parameters' units.
//
//   friction        per joint d, c and o (sim/robot/joint_plant.hpp)
//   stribeck        per joint the friction at breakaway, c + s_t, and v_s. The friction is then
//                   f = o + d v + (c + s_t) (tanh(v / v_w) - tanh(v / v_s)) + c tanh(v / v_s)
//   armature        per joint A
//   payload         mass and centre of mass, in the tip's frame, of a body on the last link
//   counterbalance  per joint that has one: its scale (joint_plant.hpp)
//   counterbalance_slope  likewise its slope
//   stiffness       per joint with a second encoder at the link: k, and the difference of the two
//                   encoders' zeros
//   delay           the age of the recorded efforts, the same for all joints
//   inertial        per link ten numbers (a, d_1, d_2, d_3, s_12, s_13, s_23, t_1, t_2, t_3) that
//                   give a physically consistent body, whatever their values: its pseudo-inertia is
//                   U U^T with
//                       U = e^a [e^d_1 s_12 s_13 t_1; 0 e^d_2 s_23 t_2; 0 0 e^d_3 t_3; 0 0 0 1]
//                   (Rucker and Wensing 2022, Smooth parameterization of rigid-body inertia, IEEE
//                   Robotics and Automation Letters 7, 2771-2778, eq. 13).
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sim/identification/link_regressor.hpp"
#include "sim/robot/robot_model.hpp"

namespace armwright {

enum class FitGroup : std::uint8_t {
  friction,
  stribeck,
  armature,
  payload,
  counterbalance,
  counterbalance_slope,
  stiffness,
  delay,
  inertial
};
const std::vector<std::string>& fit_group_names();  // in the order of the enum

struct PlantParameter {
  enum class Kind : std::uint8_t {
    viscous,
    coulomb,
    offset,
    breakaway,
    stribeck_rate,
    armature,
    payload,         // part 0: mass; 1, 2, 3: x, y, z of the centre of mass
    counterbalance,  // part 0: scale; 1: slope
    stiffness,
    encoder_offset,
    delay,
    inertia  // part 0 to 9, as above
  };
  Kind kind = Kind::viscous;
  std::size_t joint = 0;  // or link; 0 for payload and delay
  int part = 0;
  std::string name;  // "joint_2.viscous", "payload.mass", "link_3.inertia_1"
  std::string unit;
};

// Returns the parameters of the groups, in the order of FitGroup. `has_link_encoder` has one flag
// per joint; empty: no joint has a second encoder.
std::vector<PlantParameter> list_parameters(const RobotModel& robot,
                                            std::span<const FitGroup> groups,
                                            const std::vector<bool>& has_link_encoder = {});
// Returns the robot's parameters with these names. Throws Error{bad_data} for a name that it does
// not have; the message begins with the name.
std::vector<PlantParameter> find_parameters(const RobotModel& robot,
                                            std::span<const std::string> names);

// Returns the robot's own value. It is 0 for a delay and an encoder offset.
double get_parameter(const RobotModel& robot, const PlantParameter& parameter);
std::vector<double> get_parameters(const RobotModel& robot,
                                   std::span<const PlantParameter> parameters);
// Gives the robot the values. One that is out of its range (joint_plant.hpp) is moved to the end of
// the range. The values of delays and encoder offsets are not used.
void set_parameters(RobotModel& robot, std::span<const PlantParameter> parameters,
                    std::span<const double> values);

// Sets the robot's payload (RobotModel::payload) in place of the one that it has.
void set_payload(RobotModel& robot, const Inertial& payload);

// Returns the numbers of a link with these ten inertia parameters; `derivatives` gets those of
// each number, one column per parameter.
LinkNumbers calc_link_numbers(std::span<const double, kLinkNumbers> parameters,
                              Eigen::Matrix<double, 10, 10>* derivatives = nullptr);
// Returns the ten parameters of a body. Its mass and its pseudo-inertia must be positive definite,
// which holds for every body that fills a volume.
LinkNumbers calc_inertia_parameters(const Inertial& body);

}  // namespace armwright
