// The problem of the thesis: tune the controllers and effort limits of an arm so that its tip
// follows a moving target. tracking_objective.hpp has the objectives.
//
// Decision variables: any of the controllers' gains and effort limits of any joints in natural
// units, the lengths and sections of links, and the task's speed. A variable is bounded by a factor
// around its start value, with the same sign, or by a range to either side if the gain has one
// (controllers::Gain). A number that is not a variable keeps its start value.
//
// If a design or its motors change the arm or the task (sim/tracking/designed_arm.hpp), the design
// is simulated with its own setup and, where they differ, its own targets. If such an arm cannot
// reach a target of a training case, the case counts as cut off at its first point.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "problems/interface/problem.hpp"
#include "problems/tracking/tracking_config.hpp"
#include "problems/tracking/tracking_inputs.hpp"

namespace armwright {

// The layout of CaseOutcome::metrics: the index of each number of a case. The case executor sends
// the numbers in this order.
namespace case_metrics {

inline constexpr std::size_t kEnergy = 0;          // J
inline constexpr std::size_t kSaturatedShare = 1;  // the mean over the joints
inline constexpr std::size_t kDuration = 2;        // s, of the whole case, even if it ended early
inline constexpr std::size_t kFailed = 3;          // 1 if FailureRule::ordered counts a failure
inline constexpr std::size_t kFirstJoint = 4;
inline constexpr std::size_t kPerJoint = 2;
constexpr std::size_t peak_effort(std::size_t joint) {  // N m, or N for a joint that slides
  return kFirstJoint + kPerJoint * joint;
}
constexpr std::size_t rms_effort(std::size_t joint) {  // the root mean square, in the same unit
  return peak_effort(joint) + 1;
}
// The first of the requirements' metrics, one per requirement.
constexpr std::size_t first_requirement(std::size_t joints) {
  return peak_effort(joints);
}

}  // namespace case_metrics

// The tracking problem. All const functions are thread-safe.
class TrackingProblem final : public Problem {
 public:
  // Throws Error{usage} if the start is for another robot or a variable has no bounds, and
  // Error{bad_data} if the robot does not suit the task.
  explicit TrackingProblem(TrackingConfig config);
  TrackingProblem(const TrackingProblem&) = delete;
  TrackingProblem& operator=(const TrackingProblem&) = delete;

  const ProblemDescription& description() const override { return description_; }
  const TrackingProblem* tracking() const override { return this; }
  BatchSize batch_size(CaseRole role) const override;
  void forget_cases() const override { inputs_.forget_cases(); }
  std::vector<CaseOutcome> simulate(std::span<const CaseJob> jobs) const override;
  Evaluation aggregate(std::span<const double> x,
                       std::span<const CaseOutcome> outcomes) const override;
  std::vector<double> calc_case_objectives(std::span<const double> x,
                                           const Evaluation& evaluation) const override;
  std::optional<double> calc_lower_bound(std::span<const double> x,
                                         std::span<const CaseOutcome> outcomes,
                                         std::size_t cases) const override;
  std::vector<double> penalty_objectives() const override;

  // Makes a set from a file of test cases available under its name. Must be called before the first
  // evaluation.
  void add_set(const TestSet& set);
  // Returns the added set of that name or, without one, the generated set. Throws Error{usage} for
  // the name of a file's set that was not added.
  TestSet get_set(const std::string& name) const;

  // Returns the design that a decision vector stands for.
  ArmDesign make_design(std::span<const double> x) const;
  // Returns the decision vector of a design; it may lie outside the bounds. Throws Error{usage} if
  // the design is for another robot or another controller.
  std::vector<double> make_vector(const ArmDesign& design) const;
  // Throws Error{usage} if the design is for another robot, for links of another kind (tubes or
  // scaled sections), or for a controller whose feed-forward efforts this problem does not compute.
  void check_design(const ArmDesign& design) const;
  // Returns how far the tip of the design's stretched arm sags (tube.hpp), with the load at its tip.
  // The problem must have tubes.
  double calc_deflection_m(const ArmDesign& design) const;

  // Simulates a design on one case as in validation and test: with the judging engine and without
  // cut-off. Throws Error{bad_data} if no point of the case counts, and Error{usage} as
  // check_design().
  TrackingResult track(const ArmDesign& design, const TestSet& set, std::uint64_t number,
                       RecordingOptions recording = {}) const;
  // Simulates the cases first, ..., first + count - 1 likewise, in one batch.
  std::vector<TrackingResult> track(const ArmDesign& design, const TestSet& set,
                                    std::uint64_t first, std::size_t count,
                                    RecordingOptions recording) const;
  // Simulates them likewise and measures the problem's requirements and, with `motion`, the errors
  // of the motion.
  std::vector<MeasuredCase> measure(const ArmDesign& design, const TestSet& set,
                                    std::uint64_t first, std::size_t count,
                                    bool motion = false) const;

  // Return the arm of a design without its load, its task, and the setup of both. They are the
  // problem's own if the design changes neither.
  RobotModel make_robot(const ArmDesign& design) const { return inputs_.make_robot(design); }
  TrackingTask make_task(const ArmDesign& design) const { return inputs_.make_task(design); }
  std::shared_ptr<const TrackingSetup> get_setup(const ArmDesign& design) const {
    return inputs_.get_setup(design);
  }

  const TrackingConfig& config() const { return config_; }
  const TrackingSetup& setup() const { return inputs_.setup(); }  // of the nominal arm and task
  const CaseCache<TargetTable>& targets() const { return inputs_.targets(); }

 private:
  // Simulates `tracking`, the engines' jobs of `jobs`. The role of each case chooses its engine.
  // Returns one measured case per job.
  std::vector<MeasuredCase> run_engines(std::span<const CaseJob> jobs,
                                        std::span<const TrackingJob> tracking) const;
  // Simulates the cases first, ..., first + count - 1 with the judging engine, without cut-off.
  std::vector<MeasuredCase> simulate_judged(const ArmDesign& design, const TestSet& set,
                                            std::uint64_t first, std::size_t count,
                                            RecordingOptions recording,
                                            std::span<const Requirement> requirements) const;
  // Returns the start with the largest effort limits that the bounds allow.
  ArmDesign make_strongest_design() const;
  // Returns the largest torque, energy, duration, mass and deflection that the bounds allow. The
  // error is 0, and nothing is required.
  ObjectiveTerms make_worst_terms() const;
  void check_links(const ArmDesign& design) const;
  void check_bounds() const;  // throws if a design within the bounds is no arm
  void describe_jacobian();

  TrackingConfig config_;
  TrackingInputs inputs_;  // refers to config_
  ProblemDescription description_;
  std::vector<ArmDesign> directions_;  // per variable, the derivative of the design
  ArmDesign strongest_;                // make_strongest_design()
  ObjectiveTerms worst_terms_;         // make_worst_terms(), of strongest_
  std::map<std::string, TestSet> sets_;
};

}  // namespace armwright
