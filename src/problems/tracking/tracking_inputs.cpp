#include "problems/tracking/tracking_inputs.hpp"

#include <fmt/format.h>

#include <type_traits>
#include <utility>

#include "base/error.hpp"
#include "sim/tracking/designed_arm.hpp"

namespace armwright {
namespace {

// About 4000 cases of the thesis's task. This is more than a run uses repeatedly, and small enough
// for many problems in one process.
constexpr std::size_t kTargetCache_bytes = std::size_t{128} << 20;
constexpr std::size_t kPlantCache_bytes = std::size_t{64} << 20;

// Removes the visuals, which simulations do not use.
RobotModel strip_visuals(RobotModel robot) {
  robot.base.visuals.clear();
  for (Link& link : robot.links) {
    link.visuals.clear();
  }
  return robot;
}

}  // namespace

TrackingInputs::TrackingInputs(const TrackingConfig& config)
    : config_(config),
      setup_(std::make_shared<TrackingSetup>(config.robot, config.task)),
      plant_robot_(strip_visuals(config.robot)),
      targets_(kTargetCache_bytes),
      plants_(kPlantCache_bytes) {}

void TrackingInputs::forget_cases() const {
  targets_.clear();
  plants_.clear();
}

ArmDesign TrackingInputs::complete(ArmDesign design) const {
  for (std::size_t i = 0; i < config_.tubes.tubes.size(); ++i) {
    if (design.joints[i].tube.diameter_m == 0) {
      design.joints[i].tube = config_.tubes.tubes[i];
    }
  }
  return design;
}

RobotModel TrackingInputs::make_robot(const ArmDesign& design) const {
  return armwright::make_robot(config_.robot, complete(design), config_.torque_per_mass_n_m_per_kg,
                               config_.tubes.material);
}

bool TrackingInputs::has_own_links(const ArmDesign& design) const {
  if (is_stretched(design)) {
    return true;
  }
  for (std::size_t i = 0; i < config_.tubes.tubes.size(); ++i) {
    const Tube& tube = design.joints[i].tube;
    if (tube.diameter_m > 0 && tube != config_.tubes.tubes[i]) {
      return true;
    }
  }
  return false;
}

TrackingTask TrackingInputs::make_task(const ArmDesign& design) const {
  TrackingTask task = armwright::make_task(config_.task, design);
  if (task.clearance && has_own_links(design)) {
    task.clearance = make_clearance(*task.clearance, config_.robot, complete(design));
  }
  return task;
}

std::shared_ptr<const TrackingSetup> TrackingInputs::get_setup(const ArmDesign& design) const {
  if (!has_own_links(design) && config_.torque_per_mass_n_m_per_kg == 0 && !design.speed_m_per_s) {
    return setup_;
  }
  return std::make_shared<TrackingSetup>(make_robot(design), make_task(design));
}

// The mass of motors does not change the targets, but it changes the efforts in their table.
bool TrackingInputs::has_own_targets(const ArmDesign& design) const {
  return has_own_links(design) || design.speed_m_per_s ||
         (config_.torque_per_mass_n_m_per_kg > 0 &&
          (config_.task.feed_forward != FeedForward::none ||
           config_.task.control_start != ControlStart::empty));
}

void TrackingInputs::check_points(const TargetTable& table, const TestSet& set,
                                  std::uint64_t number) const {
  if (table.segments.size() < 2 && !config_.task.count_first_point) {
    throw Error(ErrorKind::bad_data,
                fmt::format("test set {}: case {} has 2 points, but the first after the start does "
                            "not count (task.count_first_point is false); give it a third one",
                            set.name(), number));
  }
}

Plant TrackingInputs::make_plant(const TestSet& set, std::uint64_t number) const {
  const TrackingTask& task = config_.task;
  Plant plant = draw_plant(config_.perturbation, plant_robot_.joint_count(),
                           task.control_period_s / task.physics.substeps, set.name(), number);
  if (config_.perturbation.changes_arm()) {
    plant.setup.emplace(plant.make_arm(plant_robot_), plant.make_task(task));
  }
  return plant;
}

void TrackingInputs::make_ahead(const TestSet& set, std::span<const std::uint64_t> numbers) const {
  if (setup_->has_closed_form()) {
    return;
  }
  targets_.fill(set.name(), numbers, [&](std::span<const std::uint64_t> lacking) {
    std::vector<TestCase> cases;
    for (const std::uint64_t number : lacking) {
      cases.push_back(set.make_case(number));
    }
    return setup_->make_targets(cases);
  });
}

TrackingInputs::PreparedCase TrackingInputs::prepare_case(CaseRole role, const TestSet& set,
                                                          std::uint64_t number) const {
  auto targets =
      targets_.get(set.name(), number, [&] { return setup_->make_targets(set.make_case(number)); });
  check_points(*targets, set, number);
  PreparedCase prepared{set, number, std::move(targets), nullptr};
  if (config_.perturbation.applies_to(role)) {
    prepared.plant = plants_.get(set.name(), number, [&] { return make_plant(set, number); });
  }
  return prepared;
}

TrackingJob TrackingInputs::make_job(const ArmDesign& design, const TrackingSetup& setup,
                                     const PreparedCase& prepared,
                                     std::vector<std::shared_ptr<const void>>& owned) const {
  // Moves an object to the heap, appends it to `owned` and returns it.
  const auto own = [&](auto&& object) {
    auto kept = std::make_shared<const std::remove_cvref_t<decltype(object)>>(
        std::forward<decltype(object)>(object));
    owned.push_back(kept);
    return kept.get();
  };
  const bool is_nominal = &setup == setup_.get();
  TrackingJob job;
  job.design = &design;
  job.targets = prepared.targets.get();
  job.setup = is_nominal ? nullptr : &setup;
  if (!is_nominal && has_own_targets(design)) {
    job.targets = own(setup.make_targets(prepared.set.make_case(prepared.number)));
  }
  if (prepared.plant == nullptr) {
    return job;
  }
  const Plant& plant = *prepared.plant;
  job.variation = plant.variation ? &*plant.variation : nullptr;
  if (plant.setup) {
    job.setup = is_nominal ? &*plant.setup
                           : own(TrackingSetup(plant.make_arm(make_robot(design)),
                                               plant.make_task(make_task(design))));
  }
  if (config_.perturbation.changes_design()) {
    ArmDesign changed = design;
    plant.change_design(changed);
    job.design = own(std::move(changed));
  }
  return job;
}

std::vector<ArmDesign> TrackingInputs::perturb_directions(
    const PreparedCase& prepared, std::span<const ArmDesign> directions) const {
  std::vector<ArmDesign> changed(directions.begin(), directions.end());
  if (prepared.plant != nullptr && config_.perturbation.changes_design()) {
    for (ArmDesign& direction : changed) {
      prepared.plant->change_design(direction);
    }
  }
  return changed;
}

}  // namespace armwright
