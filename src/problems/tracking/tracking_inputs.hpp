// The inputs of the engines: jobs, each with a design on a case, and the arm, task, targets and
// plant that belong to it. A design can change the arm and the task
// (sim/tracking/designed_arm.hpp). A plant (perturbation.hpp) changes the arm of the design.
// Targets are those of the design's own arm and task, whatever the plant.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "problems/tracking/case_cache.hpp"
#include "problems/tracking/tracking_config.hpp"

namespace armwright {

// Makes the jobs of a tracking problem. Caches target tables and plants per case. Thread-safe.
class TrackingInputs {
 public:
  // Keeps a reference to the configuration, which must live as long as this object. Throws
  // Error{bad_data} if the robot does not suit the task.
  explicit TrackingInputs(const TrackingConfig& config);

  const TrackingSetup& setup() const { return *setup_; }  // of the nominal arm and task
  const CaseCache<TargetTable>& targets() const { return targets_; }
  void forget_cases() const;  // empties both caches
  // Returns the design with the tubes of the problem where it has none of its own.
  ArmDesign complete(ArmDesign design) const;
  RobotModel make_robot(const ArmDesign& design) const;  // without load
  TrackingTask make_task(const ArmDesign& design) const;
  // Returns the setup of a design: the nominal one if the design changes neither arm nor task.
  std::shared_ptr<const TrackingSetup> get_setup(const ArmDesign& design) const;

  // The inputs that all designs on one case share.
  struct PreparedCase {
    TestSet set;
    std::uint64_t number = 0;
    std::shared_ptr<const TargetTable> targets;  // of the nominal arm and task
    std::shared_ptr<const Plant> plant;          // null: the nominal plant
  };
  // The most cases whose target tables make_ahead() should make at once.
  static constexpr std::size_t kAhead = 64;
  // Makes the target tables that the cache lacks, for prepare_case() of each of these cases. Tables
  // of numeric kinematics are made faster together than one by one.
  void make_ahead(const TestSet& set, std::span<const std::uint64_t> numbers) const;
  // Throws Error{bad_data} if no point of the case counts.
  PreparedCase prepare_case(CaseRole role, const TestSet& set, std::uint64_t number) const;

  // Returns the job of a design on a case, without cut-off, recording or bound. `setup` is
  // get_setup(design). The job points into all arguments. The objects that this function makes for
  // the job are appended to `owned`; the job is valid as long as they live.
  TrackingJob make_job(const ArmDesign& design, const TrackingSetup& setup,
                       const PreparedCase& prepared,
                       std::vector<std::shared_ptr<const void>>& owned) const;
  // Returns how the design of the case's plant changes if the design changes along `directions`.
  std::vector<ArmDesign> perturb_directions(const PreparedCase& prepared,
                                            std::span<const ArmDesign> directions) const;

 private:
  bool has_own_links(const ArmDesign& design) const;
  bool has_own_targets(const ArmDesign& design) const;
  void check_points(const TargetTable& table, const TestSet& set, std::uint64_t number) const;
  Plant make_plant(const TestSet& set, std::uint64_t number) const;

  const TrackingConfig& config_;
  std::shared_ptr<const TrackingSetup> setup_;
  RobotModel plant_robot_;  // the robot without visuals; each plant's setup has a copy of it
  mutable CaseCache<TargetTable> targets_;
  mutable CaseCache<Plant> plants_;
};

}  // namespace armwright
