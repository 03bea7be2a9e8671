// What engines are given to simulate: designs, with the arm and the task that they make their own
// (sim/designed_arm.hpp), on cases, with the plants that these meet (perturbation.hpp). A plant is
// laid over the arm of the design; targets are those of the design's own arm and task, whatever the
// plant.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <span>
#include <vector>

#include "problems/tracking/plant_cache.hpp"
#include "problems/tracking/target_cache.hpp"
#include "problems/tracking/tracking_config.hpp"

namespace armwright {

class TrackingInputs {
 public:
  // Refers to the configuration, which must stay.
  explicit TrackingInputs(const TrackingConfig& config);

  const TrackingSetup& setup() const { return *setup_; }  // of the nominal arm and task
  const TargetCache& targets() const { return targets_; }
  void forget_cases() const;
  RobotModel make_robot(const ArmDesign& design) const;  // without load
  TrackingTask make_task(const ArmDesign& design) const;
  // The problem's own where the design changes nothing.
  std::shared_ptr<const TrackingSetup> get_setup(const ArmDesign& design) const;

  struct OfDesign {
    const ArmDesign* design = nullptr;
    std::shared_ptr<const TrackingSetup> setup;
  };
  OfDesign prepare(const ArmDesign& design) const { return {&design, get_setup(design)}; }

  struct OfCase {
    TestSet set;
    std::uint64_t number = 0;
    std::shared_ptr<const TargetTable> targets;  // of the nominal arm and task
    std::shared_ptr<const CasePlant> plant;      // null: the nominal one
  };
  // Error{bad_data} if no point of the case counts.
  OfCase prepare(CaseRole role, const TestSet& set, std::uint64_t number) const;

  // What jobs refer to and nobody else keeps.
  struct Kept {
    std::deque<ArmDesign> designs;
    std::vector<std::shared_ptr<const TrackingSetup>> setups;
    std::vector<std::shared_ptr<const TargetTable>> targets;
  };
  // It refers to the design, to both inputs and to what it adds to `kept`. Without cut-off,
  // recording or bound.
  TrackingJob make_job(const OfDesign& of_design, const OfCase& of_case, Kept& kept) const;
  // How the job's design changes where the design given to prepare() changes like this.
  std::vector<ArmDesign> change_directions(const OfCase& of_case,
                                           std::span<const ArmDesign> directions) const;

 private:
  bool has_own_targets(const ArmDesign& design) const;
  void check_points(const TargetTable& table, const TestSet& set, std::uint64_t number) const;

  const TrackingConfig& config_;
  std::shared_ptr<const TrackingSetup> setup_;
  mutable TargetCache targets_;
  mutable PlantCache plants_;
};

}  // namespace armwright
