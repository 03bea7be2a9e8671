// The numbers of a joint's plant (sim/robot/joint_plant.hpp) as the kernels get them.
#pragma once

#include <vector>

#include "sim/dynamics/joint_effort.hpp"
#include "sim/engines/articulated/kernels.hpp"
#include "sim/tracking/simulation.hpp"

namespace armwright::articulated {

// Returns the DriveFlag bits of a joint.
inline std::uint8_t get_drive_flags(const JointPlant& plant) {
  const auto flag = [](bool holds, DriveFlag bit) { return holds ? bit : 0; };
  return static_cast<std::uint8_t>(
      flag(plant.armature > 0, kHasArmature) | flag(plant.has_friction(), kHasFriction) |
      flag(plant.stribeck != 0, kHasStribeck) | flag(plant.is_elastic(), kElastic) |
      flag(plant.is_elastic() && plant.measured == MeasuredSide::motor, kMeasuresMotor) |
      flag(!plant.counterbalance.efforts.empty(), kBalanced));
}

// Sets what the call needs to know of the joints' DriveFlag bits. `perturbed`: the plants have a
// PlantVariation.
template <class T>
void set_drives(const std::vector<std::uint8_t>& drives, const ArmDrives& arm_drives,
                bool perturbed, SegmentCall<T>& call) {
  call.drives = drives.data();
  call.elastic = false;
  call.measures_apart = perturbed || arm_drives.has_resolution();
  for (const std::uint8_t flags : drives) {
    call.elastic |= (flags & kElastic) != 0;
    call.measures_apart |= (flags & kMeasuresMotor) != 0;
  }
}

// Sets the drives of a job: calls set(pack, number) for the numbers of their packs that are not 0,
// but not for the effort limits.
template <class Set>
void set_drive_packs(const TrackingSetup& setup, const TrackingJob& job, const CommandClock& clock,
                     const Set& set) {
  const std::size_t joints = setup.robot().joint_count();
  const std::vector<double>& start = job.targets->start_positions;
  const std::vector<double> holding = setup.calc_holding_efforts(start);
  for (std::size_t i = 0; i < joints; ++i) {
    setup.task().drives.set_numbers(setup.robot().joints[i], holding[i], start[i], clock,
                                    [&](int field, double number) {
                                      set(static_cast<std::size_t>(field) * joints + i, number);
                                    });
  }
}

// Calls set(field, number) for each PlantField of a JointPlant.
template <class Set>
void set_plant_numbers(const JointPlant& plant, const Set& set) {
  set(kArmature, plant.armature);
  set(kDrag, plant.get_drag());
  set(kBreakaway, plant.coulomb + plant.stribeck);
  set(kStribeck, plant.stribeck);
  set(kInverseTransition, 1 / plant.transition_rate);
  set(kInverseStribeck, 1 / plant.stribeck_rate);
  set(kOffset, plant.offset);
  set(kStiffness, plant.stiffness);
  set(kDamping, plant.damping);
}

}  // namespace armwright::articulated
