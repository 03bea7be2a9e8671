// sim/plant_variation.hpp for one arm that is stepped alone.
#pragma once

#include <span>
#include <vector>

#include "sim/robot/robot_model.hpp"
#include "sim/tracking/plant_variation.hpp"

namespace armwright {

class ArmPlant {
 public:
  // At rest with joint positions q. All must outlive it.
  ArmPlant(const PlantVariation& variation, const RobotModel& robot, std::span<const double> q);

  // The angles as the controllers see them now.
  std::span<const double> measure();
  // What acts on the joints in a substep in place of the efforts, in the state at its start.
  std::span<const double> calc_torque(std::span<const double> effort_n_m, std::span<const double> q,
                                      std::span<const double> qd);
  // After a substep.
  void remember(std::span<const double> q);

 private:
  const PlantVariation& variation_;
  const RobotModel& robot_;
  std::vector<std::vector<double>> past_;  // a ring: as many angles as there are delays
  std::size_t newest_ = 0;
  std::vector<double> measured_, torque_;
};

}  // namespace armwright
