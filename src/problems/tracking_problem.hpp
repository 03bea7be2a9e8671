// The thesis's problem: tune the controllers and effort limits of an arm so that its tip follows a
// moving target. Objectives:
//   error              e, the mean over the cases of the case's positional error (m)
//   error_and_torque   e / e_0 + w tau / tau_0, tau the sum over the joints of max(-min, max)
//                      of their effort limits (thesis section 6.3)
//   error_vs_torque    e (m) and tau (N m) as two objectives; as one number, error_and_torque
//   torque_with_error_limit  tau (N m) where e <= e_max
//   error_with_torque_limit  e (m) where tau <= tau_max
// All but error_vs_torque also as their natural logarithm: the same minimiser, but steps of equal
// ratio count alike, which wrapped local methods like.
// A limit is one constraint, g = e / e_max - 1 or tau / tau_max - 1, in the logarithm's problem
// too. e counts a training case that was cut off or diverged as the objectives do: 1 m for each
// point from there on. Where no case has a number there is no g either. Residuals, of the kinds
// without a limit: sqrt(e_kl / (K_l L)) of each point k that counts, K_l of them, in each of L
// cases l, divided by sqrt(e_0) where the objective has torque, then sqrt(w tau_j / tau_0) of each
// joint j: the sum of their squares is the objective before the logarithm. Decision variables: any
// of the controllers' gains and effort limits of any joints, in natural units, bounded by a factor
// around the start values, sign kept, or by a range to either side where the gain has one
// (GainSpec); what is not a variable keeps its start value.
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
#include "sim/tracking.hpp"

namespace armwright {

// A case whose error exceeds this counts as failed in every summary (the arm lost its target).
inline constexpr double kFailureError_m = 0.1;

struct TrackingObjective {
  enum class Kind {
    error,
    error_and_torque,
    error_vs_torque,
    torque_with_error_limit,
    error_with_torque_limit
  };
  Kind kind = Kind::error;
  bool logarithm = false;             // not of error_vs_torque
  double torque_weight = 0;           // w
  double error_scale_m = 0.0058;      // e_0: the thesis's Q1 winner
  double torque_scale_n_m = 963686;   // tau_0: the same
  double error_limit_m = 0;           // e_max, of torque_with_error_limit
  double total_torque_limit_n_m = 0;  // tau_max, of error_with_torque_limit
};

// One number of the design that is optimized.
struct DesignParameter {
  enum class Kind { gain, effort_min, effort_max };
  std::size_t joint = 0;
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

  const TrackingConfig& config() const { return config_; }
  const TrackingSetup& setup() const { return setup_; }
  const TargetCache& targets() const { return targets_; }

 private:
  // One result a job of `tracking`, each from the engine of its case's role.
  std::vector<TrackingResult> simulate(std::span<const CaseJob> jobs,
                                       std::span<const TrackingJob> tracking) const;
  // `cases` is how many of the outcomes have an error.
  std::vector<double> calc_residuals(const ArmDesign& design, std::span<const CaseOutcome> outcomes,
                                     double cases) const;
  // Of calc_residuals()'s `residuals`.
  std::vector<double> calc_jacobian(const ArmDesign& design, std::span<const CaseOutcome> outcomes,
                                    std::span<const double> residuals) const;
  std::shared_ptr<const TargetTable> get_targets(const TestSet& set, std::uint64_t number) const;

  TrackingConfig config_;
  TrackingSetup setup_;
  ProblemDescription description_;
  std::vector<ArmDesign> directions_;  // how the design changes with each variable
  std::map<std::string, TestSet> sets_;
  mutable TargetCache targets_;
};

}  // namespace armwright
