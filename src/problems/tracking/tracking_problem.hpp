// The thesis's problem: tune the controllers and effort limits of an arm so that its tip follows a
// moving target; what it is judged by is in tracking_objective.hpp. Decision variables: any of the
// controllers' gains and effort limits of any joints, in natural units, bounded by a factor around
// the start values, sign kept, or by a range to either side where the gain has one (Gain); and
// of how long and wide links are, and of the task's speed. What is not a variable keeps its start
// value. Where a design or its motors change the arm or the task (sim/designed_arm.hpp), it is
// simulated with a setup of its own, and its targets are its own where they differ. A training case
// of which such an arm cannot reach a target counts as if it had been cut off at once.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "problems/interface/problem.hpp"
#include "problems/tracking/requirement_meter.hpp"
#include "problems/tracking/tracking_config.hpp"
#include "problems/tracking/tracking_inputs.hpp"

namespace armwright {

class TrackingProblem final : public Problem {
 public:
  // Error{usage} if the design is for another robot or a variable has no bounds; Error{bad_data} if
  // the robot does not suit the task.
  explicit TrackingProblem(TrackingConfig config);
  TrackingProblem(const TrackingProblem&) = delete;
  TrackingProblem& operator=(const TrackingProblem&) = delete;

  const ProblemDescription& description() const override { return description_; }
  BatchSize batch_size(CaseRole role) const override;
  void forget_cases() const override { inputs_.forget_cases(); }
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
  // The same with what is required of them.
  std::vector<MeasuredCase> measure(const ArmDesign& design, const TestSet& set,
                                    std::uint64_t first, std::size_t count) const;
  void check_design(const ArmDesign& design) const;
  // The arm of a design without its load, its task, and both ready to be simulated; the problem's
  // own where the design changes nothing.
  RobotModel make_robot(const ArmDesign& design) const { return inputs_.make_robot(design); }
  TrackingTask make_task(const ArmDesign& design) const { return inputs_.make_task(design); }
  std::shared_ptr<const TrackingSetup> get_setup(const ArmDesign& design) const {
    return inputs_.get_setup(design);
  }

  const TrackingConfig& config() const { return config_; }
  const TrackingSetup& setup() const { return inputs_.setup(); }  // of the nominal arm and task
  const TargetCache& targets() const { return inputs_.targets(); }

 private:
  // One result a job of `tracking`, each from the engine of its case's role.
  std::vector<MeasuredCase> simulate(std::span<const CaseJob> jobs,
                                     std::span<const TrackingJob> tracking) const;
  // Cases first, ..., first + count - 1, as they are judged.
  std::vector<MeasuredCase> simulate_judged(const ArmDesign& design, const TestSet& set,
                                            std::uint64_t first, std::size_t count,
                                            RecordingOptions recording,
                                            std::span<const Requirement> requirements) const;
  void check_bounds() const;  // that every design within them is an arm
  void set_jacobian();

  TrackingConfig config_;
  TrackingInputs inputs_;  // refers to the configuration
  ProblemDescription description_;
  std::vector<ArmDesign> directions_;  // how the design changes with each variable
  std::map<std::string, TestSet> sets_;
};

}  // namespace armwright
