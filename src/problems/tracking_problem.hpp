// The thesis's problem: tune the controllers and effort limits of an arm so that its tip follows a
// moving target; what it is judged by is in tracking_objective.hpp. Decision variables: any of the
// controllers' gains and effort limits of any joints, in natural units, bounded by a factor around
// the start values, sign kept; and of how long and wide links are, and of the task's speed. What is
// not a variable keeps its start value. Where a design or its motors change the arm or the task
// (sim/designed_arm.hpp), it is simulated with a setup of its own, and its targets are its own
// where they differ. A training case of which such an arm cannot reach a target counts as if it had
// been cut off at once.
#pragma once

#include <limits>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "problems/engine_choice.hpp"
#include "problems/problem.hpp"
#include "problems/target_cache.hpp"
#include "problems/tracking_objective.hpp"
#include "sim/tracking.hpp"

namespace armwright {

// One number of the design that is optimized.
struct DesignParameter {
  enum class Kind { gain, effort_min, effort_max, length_scale, section_scale, speed };
  std::size_t joint = 0;  // not of the speed
  Kind kind = Kind::gain;
  std::size_t gain = 0;  // which one, for a gain
};

struct TrackingConfig {
  std::string name;
  std::string summary;
  RobotModel robot;
  double mass_scale = 1;  // what its masses were multiplied by when it was loaded
  TrackingTask task;
  WorkspaceSphere workspace;
  EnginePair engines;           // both must be there (choose_engines)
  double cutoff_error_m = 1.0;  // training only
  TrackingObjective objective;
  ArmDesign start;
  std::vector<DesignParameter> parameters;
  double bounds_factor = 100;
  double length_bounds_factor = 1.5;
  double section_bounds_factor = 2;
  double speed_bounds_factor = 2;
  double torque_per_mass_n_m_per_kg = 0;  // of the motors; 0: they weigh nothing
};

class TrackingProblem final : public Problem {
 public:
  // Error{usage} if the design is for another robot or a variable has no bounds; Error{bad_data} if
  // the robot does not suit the task.
  explicit TrackingProblem(TrackingConfig config);

  const ProblemDescription& description() const override { return description_; }
  BatchSize batch_size(CaseRole role) const override;
  std::vector<CaseOutcome> simulate(std::span<const CaseJob> jobs) const override;
  Evaluation aggregate(std::span<const double> x,
                       std::span<const CaseOutcome> outcomes) const override;
  std::optional<double> calc_lower_bound(std::span<const double> x,
                                         std::span<const CaseOutcome> outcomes,
                                         std::size_t cases) const override;
  std::vector<double> penalty_objectives() const override;

  // Makes a finite set (a file of test cases) available under its name. Before the first evaluation
  // only.
  void add_set(const TestSet& set);
  // A set that was added, or the generated one of that name. Error{usage} for the name of a file
  // that was not.
  TestSet get_set(const std::string& name) const;

  ArmDesign make_design(std::span<const double> x) const;
  std::vector<double> make_vector(
      const ArmDesign& design) const;  // the variables of a design; bounds are not checked
  // A design on one case, as it is judged: without cut-off, with whatever recording is asked for.
  // Error{usage} if the design is for another robot, Error{bad_data} if the case has no point that
  // counts.
  TrackingResult track(const ArmDesign& design, const TestSet& set, std::uint64_t number,
                       RecordingOptions recording = {}) const;
  // The same on the cases first, ..., first + count - 1, in one batch.
  std::vector<TrackingResult> track(const ArmDesign& design, const TestSet& set,
                                    std::uint64_t first, std::size_t count,
                                    RecordingOptions recording) const;
  void check_design(const ArmDesign& design) const;
  // The arm of a design without its load, its task, and both ready to be simulated; the problem's
  // own where the design changes nothing.
  RobotModel make_robot(const ArmDesign& design) const;
  TrackingTask make_task(const ArmDesign& design) const;
  std::shared_ptr<const TrackingSetup> get_setup(const ArmDesign& design) const;

  const TrackingConfig& config() const { return config_; }
  const TrackingSetup& setup() const { return *setup_; }  // of the nominal arm and task
  const TargetCache& targets() const { return targets_; }

 private:
  // One result a job of `tracking`, each from the engine of its case's role.
  std::vector<TrackingResult> simulate(std::span<const CaseJob> jobs,
                                       std::span<const TrackingJob> tracking) const;
  // `setup` is get_setup() of the design.
  std::shared_ptr<const TargetTable> get_targets(const ArmDesign& design,
                                                 const TrackingSetup& setup, const TestSet& set,
                                                 std::uint64_t number) const;
  bool has_own_targets(const ArmDesign& design) const;
  void check_bounds() const;  // that every design within them is an arm
  void set_jacobian();

  TrackingConfig config_;
  std::shared_ptr<const TrackingSetup> setup_;
  ProblemDescription description_;
  std::vector<ArmDesign> directions_;  // how the design changes with each variable
  std::map<std::string, TestSet> sets_;
  mutable TargetCache targets_;
};

}  // namespace armwright
