#include "problems/tracking_problem.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <unordered_map>

#include "base/error.hpp"
#include "base/text.hpp"
#include "problems/tracking_description.hpp"

namespace armwright {
namespace {

constexpr std::size_t kTargetCache_bytes = std::size_t{512} << 20;

// What simulate() puts into a case's metrics before the peaks and root-mean-squares of the joints'
// efforts.
enum CaseMetric : std::size_t { kEnergy, kSaturation, kFirstJointMetric };

// Of an error (m) and a total torque (N m).
std::vector<double> calc_objectives(const TrackingObjective& objective, double error_m,
                                    double torque_n_m) {
  // No arm comes near it: keeps the logarithm finite whatever happens.
  constexpr double kLeast = 1e-300;
  const auto apply_scale = [&](double value) {
    return objective.logarithm ? std::log(std::max(value, kLeast)) : value;
  };
  switch (objective.kind) {
    case TrackingObjective::Kind::error:
    case TrackingObjective::Kind::error_with_torque_limit:
      return {apply_scale(error_m)};
    case TrackingObjective::Kind::torque_with_error_limit:
      return {apply_scale(torque_n_m)};
    case TrackingObjective::Kind::error_and_torque:
      return {apply_scale(error_m / objective.error_scale_m +
                          objective.torque_weight * torque_n_m / objective.torque_scale_n_m)};
    case TrackingObjective::Kind::error_vs_torque:
      break;
  }
  return {error_m, torque_n_m};
}

std::vector<double> calc_constraints(const TrackingObjective& objective, double error_m,
                                     double torque_n_m) {
  switch (objective.kind) {
    case TrackingObjective::Kind::torque_with_error_limit:
      return {error_m / objective.error_limit_m - 1};
    case TrackingObjective::Kind::error_with_torque_limit:
      return {torque_n_m / objective.total_torque_limit_n_m - 1};
    case TrackingObjective::Kind::error:
    case TrackingObjective::Kind::error_and_torque:
    case TrackingObjective::Kind::error_vs_torque:
      break;
  }
  return {};
}

// The residuals of an outcome are the errors (m) of the points that count; aggregate() scales them.
CaseOutcome make_outcome(TrackingResult result, CaseRole role, bool residuals,
                         bool count_first_point) {
  CaseOutcome outcome;
  outcome.reason = std::move(result.reason);
  switch (result.status) {
    case SimulationStatus::ok:
    case SimulationStatus::cut_off:  // an ordinary, bad result of training: the error counts as the
                                     // limit from there on
      break;
    case SimulationStatus::diverged:
      outcome.status = EvaluationStatus::diverged;
      // In training it counts like a cut-off; nowhere else does a number stand for it.
      outcome.has_error = role == CaseRole::training;
      break;
    case SimulationStatus::abandoned:
      outcome.status = EvaluationStatus::abandoned;
      residuals = false;  // those of some points only would be a vector of another length
      break;
    case SimulationStatus::unreachable:
      outcome.status = EvaluationStatus::unreachable;
      outcome.has_error = false;
      return outcome;
  }
  outcome.error = outcome.has_error ? result.mean_error_m : 0;
  if (residuals && outcome.has_error) {
    outcome.residuals.assign(result.point_error_m.begin() + (count_first_point ? 0 : 1),
                             result.point_error_m.end());
  }
  const double joints = static_cast<double>(result.saturated_share.size());
  double saturation = 0;
  for (const double share : result.saturated_share) {
    saturation += share / joints;
  }
  outcome.metrics.reserve(kFirstJointMetric + 2 * result.peak_effort_n_m.size());
  outcome.metrics.assign({result.energy_j, saturation});
  for (std::size_t i = 0; i < result.peak_effort_n_m.size(); ++i) {
    outcome.metrics.push_back(result.peak_effort_n_m[i]);
    outcome.metrics.push_back(result.rms_effort_n_m[i]);
  }
  return outcome;
}

// Of every parameter: a design that is 1 there and 0 elsewhere.
std::vector<ArmDesign> make_directions(const TrackingConfig& config) {
  ArmDesign zero = config.start;
  for (JointDrive& joint : zero.joints) {
    joint.gains.assign(joint.gains.size(), 0.0);
    joint.limits = {};
  }
  std::vector<ArmDesign> directions(config.parameters.size(), zero);
  for (std::size_t i = 0; i < directions.size(); ++i) {
    get_parameter(directions[i], config.parameters[i]) = 1;
  }
  return directions;
}

}  // namespace

TrackingProblem::TrackingProblem(TrackingConfig config)
    : config_(std::move(config)),
      setup_(config_.robot, config_.task),
      targets_(kTargetCache_bytes) {
  check_design(config_.start);
  description_ = make_tracking_description(config_);
  const bool has_derivatives = config_.engines.training->has_derivatives();
  description_.has_jacobian = description_.has_residuals && has_derivatives;
  if (!has_derivatives) {
    description_.jacobian_advice =
        fmt::format("engine '{}' computes no derivatives; choose --engine articulated, which does",
                    config_.engines.training_name);
  }
  directions_ = make_directions(config_);
}

void TrackingProblem::check_design(const ArmDesign& design) const {
  if (design.joints.size() != config_.robot.joint_count()) {
    throw Error(
        ErrorKind::usage,
        fmt::format("the design has {} joints, the robot {} of problem {} has {}; use a design "
                    "made for this robot",
                    design.joints.size(), config_.robot.name, config_.name,
                    config_.robot.joint_count()));
  }
  const ControllerRow& controller = find_controller(design.controller);
  if (controller.feed_forward != FeedForward::none &&
      controller.feed_forward != config_.task.feed_forward) {
    throw Error(ErrorKind::usage,
                fmt::format("the design is for controller '{}', whose efforts in advance problem "
                            "{} does not make; set control.controller to '{}'",
                            controller.name, config_.name, controller.name));
  }
}

void TrackingProblem::add_set(const TestSet& set) {
  sets_.insert_or_assign(set.name(), set);
}

TestSet TrackingProblem::get_set(const std::string& name) const {
  const auto found = sets_.find(name);
  if (found != sets_.end()) {
    return found->second;
  }
  if (name.starts_with("file:")) {  // any other name generates cases, but never those of the file
    throw Error(ErrorKind::usage,
                fmt::format("problem {} has no test cases named {}; load the file they came from",
                            config_.name, sanitize(name)));
  }
  return TestSet::make_generated(name, config_.workspace);
}

std::shared_ptr<const TargetTable> TrackingProblem::get_targets(const TestSet& set,
                                                                std::uint64_t number) const {
  auto table = targets_.get(setup_, set, number);
  if (table->segments.size() < 2 && !config_.task.count_first_point) {
    throw Error(ErrorKind::bad_data,
                fmt::format("test set {}: case {} has 2 points, but the first after the start does "
                            "not count (task.count_first_point is false); give it a third one",
                            set.name(), number));
  }
  return table;
}

ArmDesign TrackingProblem::make_design(std::span<const double> x) const {
  ArmDesign design = config_.start;
  for (std::size_t i = 0; i < config_.parameters.size(); ++i) {
    get_parameter(design, config_.parameters[i]) = x[i];
  }
  return design;
}

std::vector<double> TrackingProblem::make_vector(const ArmDesign& design) const {
  check_design(design);
  if (design.controller != config_.start.controller) {
    throw Error(
        ErrorKind::usage,
        fmt::format("the design is for controller '{}', the variables of problem {} are "
                    "those of '{}'; set control.controller to '{}'",
                    design.controller, config_.name, config_.start.controller, design.controller));
  }
  ArmDesign copy = design;
  std::vector<double> x;
  for (const DesignParameter& parameter : config_.parameters) {
    x.push_back(get_parameter(copy, parameter));
  }
  return x;
}

BatchSize TrackingProblem::batch_size(CaseRole role) const {
  return config_.engines.get(role).batch_size();
}

std::vector<CaseOutcome> TrackingProblem::simulate(std::span<const CaseJob> jobs) const {
  std::unordered_map<const double*, ArmDesign> designs;  // by where the decision vector lies
  std::vector<TrackingJob> tracking;
  tracking.reserve(jobs.size());
  // An engine with SIMD needs some 60 us for a job: sets and tables are looked up once for all
  // neighbours that share a block. Nothing is taken from the map before the simulation ends.
  std::optional<TestSet> set;
  std::vector<std::unordered_map<std::uint64_t, std::shared_ptr<const TargetTable>>> tables;
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    const CaseJob& job = jobs[i];
    const auto [design, is_new] = designs.try_emplace(job.x.data());
    if (is_new) {
      design->second = make_design(job.x);
    }
    if (i == 0 || job.block != jobs[i - 1].block) {
      set = get_set(job.block->set);
      tables.emplace_back();
    }
    std::shared_ptr<const TargetTable>& table = tables.back()[job.number];
    if (table == nullptr) {
      table = get_targets(*set, job.number);
    }
    TrackingJob& one = tracking.emplace_back();
    one.design = &design->second;
    one.targets = table.get();
    one.abandon_above_m = job.abandon_above;
    if (job.block->role == CaseRole::training) {
      one.cutoff_m = config_.cutoff_error_m;
    }
  }
  auto results = simulate(jobs, tracking);
  std::vector<CaseOutcome> outcomes;
  outcomes.reserve(jobs.size());
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    outcomes.push_back(make_outcome(std::move(results[i]), jobs[i].block->role, jobs[i].residuals,
                                    config_.task.count_first_point));
    const PhysicsEngine& engine = config_.engines.get(jobs[i].block->role);
    if (jobs[i].jacobian && engine.has_derivatives() && !outcomes[i].residuals.empty()) {
      outcomes[i].jacobian = engine.calc_derivatives(setup_, tracking[i], directions_);
      const std::size_t counted = outcomes[i].residuals.size() * directions_.size();
      outcomes[i].jacobian.erase(outcomes[i].jacobian.begin(),
                                 outcomes[i].jacobian.end() - static_cast<std::ptrdiff_t>(counted));
    }
  }
  return outcomes;
}

std::vector<TrackingResult> TrackingProblem::simulate(std::span<const CaseJob> jobs,
                                                      std::span<const TrackingJob> tracking) const {
  std::vector<TrackingResult> results;
  results.reserve(jobs.size());
  for (std::size_t first = 0; first < jobs.size();) {
    const PhysicsEngine& engine = config_.engines.get(jobs[first].block->role);
    std::size_t end = first + 1;
    while (end < jobs.size() && &config_.engines.get(jobs[end].block->role) == &engine) {
      ++end;
    }
    auto some = engine.simulate(setup_, tracking.subspan(first, end - first));
    std::ranges::move(some, std::back_inserter(results));
    first = end;
  }
  return results;
}

TrackingResult TrackingProblem::track(const ArmDesign& design, const TestSet& set,
                                      std::uint64_t number, RecordingOptions recording) const {
  return std::move(track(design, set, number, 1, recording).front());
}

std::vector<TrackingResult> TrackingProblem::track(const ArmDesign& design, const TestSet& set,
                                                   std::uint64_t first, std::size_t count,
                                                   RecordingOptions recording) const {
  check_design(design);
  std::vector<std::shared_ptr<const TargetTable>> tables;
  std::vector<TrackingJob> jobs(count);
  for (std::size_t i = 0; i < count; ++i) {
    tables.push_back(get_targets(set, first + i));
    jobs[i].design = &design;
    jobs[i].targets = tables.back().get();
    jobs[i].recording = recording;
  }
  return config_.engines.judging->simulate(setup_, jobs);
}

Evaluation TrackingProblem::aggregate(std::span<const double> x,
                                      std::span<const CaseOutcome> outcomes) const {
  Evaluation evaluation;
  const std::size_t joints = config_.robot.joint_count();
  std::vector<double> sums(kFirstJointMetric + 2 * joints);
  double error = 0;
  double failures = 0;
  double numbers = 0;
  for (const CaseOutcome& outcome : outcomes) {
    // That the numbers are bounds matters more than why others are missing.
    const bool is_first_abandoned = outcome.status == EvaluationStatus::abandoned &&
                                    evaluation.status != EvaluationStatus::abandoned;
    if (is_first_abandoned ||
        (outcome.status != EvaluationStatus::ok && evaluation.status == EvaluationStatus::ok)) {
      evaluation.status = outcome.status;
      evaluation.reason = outcome.reason;
    }
    if (!outcome.has_error) {
      evaluation.case_errors.push_back(std::numeric_limits<double>::quiet_NaN());
      ++evaluation.failed_cases;
      ++failures;
      continue;
    }
    evaluation.case_errors.push_back(outcome.error);
    error += outcome.error;
    failures += outcome.error > kFailureError_m ? 1 : 0;
    ++numbers;
    sums[kEnergy] += outcome.metrics[kEnergy];
    sums[kSaturation] += outcome.metrics[kSaturation];
    for (std::size_t i = kFirstJointMetric; i < sums.size(); i += 2) {
      sums[i] = std::max(sums[i], outcome.metrics[i]);
      sums[i + 1] += outcome.metrics[i + 1];
    }
  }
  if (numbers == 0) {
    return evaluation;
  }
  error /= numbers;
  const ArmDesign design = make_design(x);
  const double torque = calc_total_torque_n_m(design);
  evaluation.objectives = calc_objectives(config_.objective, error, torque);
  evaluation.constraint_values = calc_constraints(config_.objective, error, torque);
  // Asked for and not abandoned: a case with an error has a residual for each point that counts.
  const bool has_residuals =
      description_.has_residuals && std::ranges::all_of(outcomes, [](const CaseOutcome& outcome) {
        return !outcome.has_error || !outcome.residuals.empty();
      });
  if (has_residuals) {
    evaluation.residuals = calc_residuals(design, outcomes, numbers);
    evaluation.jacobian = calc_jacobian(design, outcomes, evaluation.residuals);
  }
  evaluation.metrics = {error, torque, failures, sums[kEnergy] / numbers,
                        sums[kSaturation] / numbers};
  for (std::size_t i = kFirstJointMetric; i < sums.size(); i += 2) {
    evaluation.metrics.push_back(sums[i]);
    evaluation.metrics.push_back(sums[i + 1] / numbers);
  }
  return evaluation;
}

std::vector<double> TrackingProblem::calc_residuals(const ArmDesign& design,
                                                    std::span<const CaseOutcome> outcomes,
                                                    double cases) const {
  const TrackingObjective& objective = config_.objective;
  const bool with_torque = objective.kind != TrackingObjective::Kind::error;
  std::vector<double> residuals;
  for (const CaseOutcome& outcome : outcomes) {
    const double share = cases * static_cast<double>(outcome.residuals.size()) *
                         (with_torque ? objective.error_scale_m : 1);
    for (const double error_m : outcome.residuals) {
      residuals.push_back(std::sqrt(error_m / share));
    }
  }
  if (with_torque) {
    for (const JointDrive& joint : design.joints) {
      residuals.push_back(std::sqrt(objective.torque_weight * calc_largest_torque_n_m(joint) /
                                    objective.torque_scale_n_m));
    }
  }
  return residuals;
}

std::vector<double> TrackingProblem::calc_jacobian(const ArmDesign& design,
                                                   std::span<const CaseOutcome> outcomes,
                                                   std::span<const double> residuals) const {
  std::vector<double> jacobian;
  const std::size_t n = directions_.size();
  // A residual r = sqrt(c v) of a value v: dr = r / (2 v) dv.
  const auto calc_share = [](double residual, double value) {
    return value > 0 ? residual / (2 * value) : 0;
  };
  std::size_t row = 0;
  for (const CaseOutcome& outcome : outcomes) {
    if (!outcome.has_error) {
      continue;
    }
    if (outcome.jacobian.empty()) {
      return {};  // not asked for
    }
    for (std::size_t k = 0; k < outcome.residuals.size(); ++k, ++row) {
      const double share = calc_share(residuals[row], outcome.residuals[k]);
      for (std::size_t i = 0; i < n; ++i) {
        jacobian.push_back(share * outcome.jacobian[k * n + i]);
      }
    }
  }
  for (std::size_t joint = 0; row < residuals.size(); ++joint, ++row) {  // with torque
    const EffortLimits& limits = design.joints[joint].limits;
    const double share = calc_share(residuals[row], calc_largest_torque_n_m(design.joints[joint]));
    for (const ArmDesign& direction : directions_) {
      const EffortLimits& change = direction.joints[joint].limits;
      jacobian.push_back(share *
                         (-limits.min_n_m < limits.max_n_m ? change.max_n_m : -change.min_n_m));
    }
  }
  return jacobian;
}

std::vector<double> TrackingProblem::penalty_objectives() const {
  // Ten times the error of a design that is cut off at once on every case, and as much torque as
  // the box allows; where torque alone is minimised, ten times that.
  ArmDesign strongest = config_.start;
  for (const DesignParameter& parameter : config_.parameters) {
    if (parameter.kind != DesignParameter::Kind::gain) {
      get_parameter(strongest, parameter) *= config_.bounds_factor;
    }
  }
  const bool is_torque = config_.objective.kind == TrackingObjective::Kind::torque_with_error_limit;
  return calc_objectives(config_.objective, 10 * config_.cutoff_error_m,
                         (is_torque ? 10 : 1) * calc_total_torque_n_m(strongest));
}

}  // namespace armwright
