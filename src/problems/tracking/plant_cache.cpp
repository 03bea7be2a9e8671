#include "problems/tracking/plant_cache.hpp"

namespace armwright {
namespace {

constexpr std::size_t kPlantCache_bytes = std::size_t{64} << 20;

// Looks are for people; every setup would hold a copy of them.
RobotModel strip_looks(RobotModel robot) {
  robot.base.visuals.clear();
  for (Link& link : robot.links) {
    link.visuals.clear();
  }
  return robot;
}

}  // namespace

std::size_t CasePlant::size_bytes() const {
  // Roughly, and rather too much: a joint has some fifty numbers in each form of the arm, a name,
  // and its factors.
  constexpr std::size_t kJoint_bytes = 4096;
  return sizeof *this + plant.mass_factors.size() * kJoint_bytes;
}

PlantCache::PlantCache(const Perturbation& perturbation, const RobotModel& robot,
                       const TrackingTask& task)
    : perturbation_(perturbation),
      robot_(strip_looks(robot)),
      task_(task),
      plants_(kPlantCache_bytes) {}

std::shared_ptr<const CasePlant> PlantCache::get(CaseRole role, const std::string& set,
                                                 std::uint64_t number) {
  if (!perturbation_.applies_to(role)) {
    return nullptr;
  }
  return plants_.get(set, number, [&] { return make(set, number); });
}

CasePlant PlantCache::make(const std::string& set, std::uint64_t number) const {
  CasePlant made;
  made.plant = draw_plant(perturbation_, robot_.joint_count(),
                          task_.control_period_s / task_.physics.substeps, set, number);
  if (perturbation_.changes_arm()) {
    made.setup.emplace(made.plant.make_arm(robot_), made.plant.make_task(task_));
  }
  return made;
}

}  // namespace armwright
