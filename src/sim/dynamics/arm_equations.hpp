// The equations of motion of an arm (chain_dynamics.hpp) as single numbers.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "sim/dynamics/chain_model.hpp"

namespace armwright::articulated {

// The chain must outlive the object.
class ArmEquations {
 public:
  explicit ArmEquations(const ChainModel& chain);
  ~ArmEquations();

  // Computes the equations for joint positions (rad or m) and rates (rad/s or m/s).
  void set(std::span<const double> q, std::span<const double> rate);
  // Return the effort (N m or N) that gravity and the rates need at a joint, and an element of the
  // links' mass matrix (kg m^2, kg m or kg).
  double bias(std::size_t joint) const;
  double mass(std::size_t row, std::size_t column) const;

  // Returns the effort on the links that gives the joints these accelerations: sum_k M_ik a_k + b_i.
  double calc_effort(std::size_t joint, std::span<const double> acceleration) const;

  // Returns the efforts with which the motors of `robot`, of which the chain is the model, hold it at
  // rest: tau = b(q, 0) + f(0) - s(q), with friction f and counterbalance s (joint_plant.hpp).
  // Friction itself helps to hold; f(0) is its offset. Elastic joints count as rigid.
  std::vector<double> calc_holding_efforts(const RobotModel& robot, std::span<const double> q);

 private:
  struct Numbers;
  std::unique_ptr<Numbers> numbers_;
};

}  // namespace armwright::articulated
