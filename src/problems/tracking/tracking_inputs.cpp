#include "problems/tracking/tracking_inputs.hpp"

#include <fmt/format.h>

#include <utility>

#include "base/error.hpp"
#include "sim/tracking/designed_arm.hpp"

namespace armwright {
namespace {

// Some 4000 cases of the thesis's task: above what a run comes back to, and little enough for many
// problems in one process.
constexpr std::size_t kTargetCache_bytes = std::size_t{128} << 20;

}  // namespace

TrackingInputs::TrackingInputs(const TrackingConfig& config)
    : config_(config),
      setup_(std::make_shared<TrackingSetup>(config.robot, config.task)),
      targets_(kTargetCache_bytes),
      plants_(config.perturbation, config.robot, config.task) {}

void TrackingInputs::forget_cases() const {
  targets_.clear();
  plants_.clear();
}

RobotModel TrackingInputs::make_robot(const ArmDesign& design) const {
  return armwright::make_robot(config_.robot, design, config_.torque_per_mass_n_m_per_kg);
}

TrackingTask TrackingInputs::make_task(const ArmDesign& design) const {
  return armwright::make_task(config_.task, design);
}

std::shared_ptr<const TrackingSetup> TrackingInputs::get_setup(const ArmDesign& design) const {
  if (!is_stretched(design) && config_.torque_per_mass_n_m_per_kg == 0 && !design.speed_m_per_s) {
    return setup_;
  }
  return std::make_shared<TrackingSetup>(make_robot(design), make_task(design));
}

// Motors move no target, but efforts in advance are those of the arm with them.
bool TrackingInputs::has_own_targets(const ArmDesign& design) const {
  return is_stretched(design) || design.speed_m_per_s ||
         (config_.torque_per_mass_n_m_per_kg > 0 && config_.task.feed_forward != FeedForward::none);
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

TrackingInputs::OfCase TrackingInputs::prepare(CaseRole role, const TestSet& set,
                                               std::uint64_t number) const {
  auto targets = targets_.get(*setup_, set, number);
  check_points(*targets, set, number);
  return {set, number, std::move(targets), plants_.get(role, set.name(), number)};
}

TrackingJob TrackingInputs::make_job(const OfDesign& of_design, const OfCase& of_case,
                                     Kept& kept) const {
  const ArmDesign& design = *of_design.design;
  const TrackingSetup& setup = *of_design.setup;
  const bool is_nominal = of_design.setup == setup_;
  TrackingJob job;
  job.design = &design;
  job.targets = of_case.targets.get();
  job.setup = is_nominal ? nullptr : &setup;
  if (!is_nominal && has_own_targets(design)) {
    kept.targets.push_back(std::make_shared<const TargetTable>(
        setup.make_targets(of_case.set.make_case(of_case.number))));
    job.targets = kept.targets.back().get();
  }
  if (of_case.plant == nullptr) {
    return job;
  }
  const Plant& plant = of_case.plant->plant;
  job.variation = plant.variation ? &*plant.variation : nullptr;
  if (of_case.plant->setup) {
    job.setup = &*of_case.plant->setup;
    if (!is_nominal) {
      kept.setups.push_back(std::make_shared<const TrackingSetup>(
          plant.make_arm(make_robot(design)), plant.make_task(make_task(design))));
      job.setup = kept.setups.back().get();
    }
  }
  if (config_.perturbation.changes_design()) {
    plant.change_design(kept.designs.emplace_back(design));
    job.design = &kept.designs.back();
  }
  return job;
}

std::vector<ArmDesign> TrackingInputs::change_directions(
    const OfCase& of_case, std::span<const ArmDesign> directions) const {
  std::vector<ArmDesign> changed(directions.begin(), directions.end());
  if (of_case.plant != nullptr && config_.perturbation.changes_design()) {
    for (ArmDesign& direction : changed) {
      of_case.plant->plant.change_design(direction);
    }
  }
  return changed;
}

}  // namespace armwright
