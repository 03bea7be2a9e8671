#include "problems/tracking/tracking_problem.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <iterator>
#include <numeric>
#include <optional>
#include <unordered_map>

#include "base/error.hpp"
#include "base/text.hpp"
#include "sim/tracking/designed_arm.hpp"

namespace armwright {
namespace {

// Returns whether the simulation of a training case ended because the arm lost its target.
bool has_ended_early(SimulationStatus status) {
  return status != SimulationStatus::ok && status != SimulationStatus::abandoned;
}

// Returns the outcome of a simulated job, without the requirements' metrics. Its residuals are the
// errors (m) of the counted points; aggregate() scales them. `own_targets` says that the targets of
// the job are those of its design, not the nominal ones.
CaseOutcome make_outcome(TrackingResult result, const TrackingConfig& config, CaseRole role,
                         const TrackingJob& job, bool own_targets, bool residuals) {
  const TrackingTask& task = config.task;
  const TargetTable& targets = *job.targets;
  CaseOutcome outcome;
  outcome.reason = std::move(result.reason);
  switch (result.status) {
    case SimulationStatus::ok:
    case SimulationStatus::cut_off:  // a valid, bad result of training
      break;
    case SimulationStatus::diverged:
      outcome.status = EvaluationStatus::diverged;
      // In training it counts like a cut-off. Elsewhere it has no error.
      outcome.has_error = role == CaseRole::training;
      break;
    case SimulationStatus::abandoned:
      outcome.status = EvaluationStatus::abandoned;
      residuals = false;  // the vector would be shorter, as points are missing
      break;
    case SimulationStatus::unreachable:
      outcome.status = EvaluationStatus::unreachable;
      if (role != CaseRole::training || !own_targets) {
        outcome.has_error = false;
        return outcome;
      }
      // The design caused it. If the case did not count, the best arm would be one that reaches the
      // easy cases only.
      result.mean_error_m = job.cutoff_m;
      result.point_error_m.assign(targets.segments.size(), job.cutoff_m);
      result.peak_effort.assign(targets.joints, 0);
      result.rms_effort.assign(targets.joints, 0);
      result.saturated_share.assign(targets.joints, 0);
      break;
  }
  const bool is_ordered = role == CaseRole::training && config.failure_rule == FailureRule::ordered;
  if (is_ordered && has_ended_early(result.status)) {
    const double share = static_cast<double>(result.steps) / std::max(1, targets.steps);
    result.mean_error_m = job.cutoff_m * (2 - share);
    std::ranges::fill(result.point_error_m, result.mean_error_m);
  }
  outcome.error = outcome.has_error ? result.mean_error_m : 0;
  if (residuals && outcome.has_error) {
    outcome.residuals.assign(result.point_error_m.begin() + (task.count_first_point ? 0 : 1),
                             result.point_error_m.end());
  }
  const std::size_t joints = result.peak_effort.size();
  double saturation = 0;
  for (const double share : result.saturated_share) {
    saturation += share / static_cast<double>(result.saturated_share.size());
  }
  outcome.metrics.resize(case_metrics::first_requirement(joints));
  outcome.metrics[case_metrics::kEnergy] = result.energy_j;
  outcome.metrics[case_metrics::kSaturatedShare] = saturation;
  outcome.metrics[case_metrics::kDuration] = targets.steps * task.control_period_s;
  outcome.metrics[case_metrics::kFailed] = is_ordered && outcome.error > kFailureError_m ? 1 : 0;
  for (std::size_t i = 0; i < joints; ++i) {
    outcome.metrics[case_metrics::peak_effort(i)] = result.peak_effort[i];
    outcome.metrics[case_metrics::rms_effort(i)] = result.rms_effort[i];
  }
  return outcome;
}

// Returns one design per parameter: the parameter is 1, all other numbers are 0.
std::vector<ArmDesign> make_directions(const TrackingConfig& config) {
  ArmDesign zero = config.start;
  for (JointDrive& joint : zero.joints) {
    joint.gains.assign(joint.gains.size(), 0.0);
    joint.limits = {};
    joint.length_scale = 0;
    joint.section_scale = 0;
    joint.tube = {};
  }
  if (zero.speed_m_per_s) {
    zero.speed_m_per_s = 0;
  }
  std::vector<ArmDesign> directions(config.parameters.size(), zero);
  for (std::size_t i = 0; i < directions.size(); ++i) {
    get_parameter(directions[i], config.parameters[i]) = 1;
  }
  return directions;
}

}  // namespace

TrackingProblem::TrackingProblem(TrackingConfig config)
    : config_(std::move(config)), inputs_(config_) {
  check_design(config_.start);
  description_ = make_tracking_description(config_);
  check_bounds();
  describe_jacobian();
  directions_ = make_directions(config_);
  strongest_ = make_strongest_design();
  worst_terms_ = make_worst_terms();
}

void TrackingProblem::check_bounds() const {
  if (!changes_links(config_)) {
    return;
  }
  // Tests each variable at either bound, with the others at the start. Links are stretched
  // independently of each other, so this finds every link that cannot be stretched that far.
  for (std::size_t i = 0; i < config_.parameters.size(); ++i) {
    const DecisionVariable& variable = description_.variables[i];
    for (const double bound : {variable.lower, variable.upper}) {
      ArmDesign design = config_.start;
      get_parameter(design, config_.parameters[i]) = bound;
      get_setup(design);
    }
  }
}

void TrackingProblem::describe_jacobian() {
  std::string& advice = description_.jacobian_advice;
  if (config_.objective.energy_weight > 0) {
    advice =
        config_.objective.kind == TrackingObjective::Kind::front
            ? "the energy in the objective has no derivatives; leave it out of "
              "objective.quantities"
            : "the energy in the objective has no derivatives; set objective.energy_weight to 0";
  } else if (changes_links(config_) || changes_speed(config_)) {
    advice =
        "variables that change the arm or the task have no derivatives; leave length_scale, "
        "section_scale, tube_diameter, tube_wall and speed out of [variables]";
  } else if (config_.torque_per_mass_n_m_per_kg > 0 &&
             std::ranges::any_of(config_.parameters, is_effort)) {
    advice =
        "the masses of motors have no derivatives; leave [motors] out, or effort_min and "
        "effort_max "
        "out of [variables]";
  } else if (config_.perturbation.applies_to(CaseRole::training) &&
             config_.perturbation.changes_loop()) {
    advice =
        "friction, quantisation, delay and torque ripple in training have no derivatives; leave "
        "these out of [perturbation] or set apply_to to judging";
  } else if (config_.task.drives.has_resolution()) {
    advice =
        "positions of finite resolution have no derivatives; set control.resolution_rad and "
        "control.resolution_m to 0";
  } else if (!config_.engines.training->has_derivatives()) {
    advice =
        fmt::format("engine '{}' computes no derivatives; choose --engine articulated, which does",
                    config_.engines.training_name);
  }
  description_.has_jacobian = description_.has_residuals && advice.empty();
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
  check_unactuated(design, config_.robot);
  check_links(design);
  const ControllerRow& controller = find_controller(design.controller);
  check_interface(controller, config_.task.drives);
  if (controller.feed_forward != FeedForward::none &&
      controller.feed_forward != config_.task.feed_forward) {
    throw Error(ErrorKind::usage,
                fmt::format("the design is for controller '{}', whose feed-forward efforts "
                            "problem {} does not compute; set control.controller to '{}'",
                            controller.name, config_.name, controller.name));
  }
}

void TrackingProblem::check_links(const ArmDesign& design) const {
  const bool is_of_tubes = has_deflection_metric(config_);
  if (!is_of_tubes && has_tubes(design)) {
    throw Error(ErrorKind::usage,
                fmt::format("the design makes links tubes (tube_diameter_m), and problem {} does "
                            "not say of which material: add [tubes] to it",
                            config_.name));
  }
  for (std::size_t i = 0; is_of_tubes && i < design.joints.size(); ++i) {
    const JointDrive& joint = design.joints[i];
    if (joint.section_scale != 1) {
      throw Error(ErrorKind::usage,
                  fmt::format("the design has section_scale = {:g} for {}, and the links of "
                              "problem {} are tubes ([tubes]), whose sections follow from "
                              "tube_diameter_m and tube_wall_m; leave it out",
                              joint.section_scale, config_.robot.joints[i].name, config_.name));
    }
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
  if (name.starts_with("file:")) {  // a generated set must not replace the cases of a file
    throw Error(ErrorKind::usage,
                fmt::format("problem {} has no test cases named {}; load the file they came from",
                            config_.name, sanitize(name)));
  }
  return config_.path ? TestSet::make_repeated(name, *config_.path)
                      : TestSet::make_generated(name, config_.workspace);
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
  ArmDesign copy = inputs_.complete(design);
  if (changes_speed(config_)) {
    copy.speed_m_per_s = design.speed_m_per_s.value_or(config_.task.speed_m_per_s);
  }
  std::vector<double> x;
  for (const DesignParameter& parameter : config_.parameters) {
    x.push_back(get_parameter(copy, parameter));
  }
  return x;
}

double TrackingProblem::calc_deflection_m(const ArmDesign& design) const {
  const auto& payload = config_.robot.payload;
  return armwright::calc_deflection_m(config_.robot, inputs_.complete(design),
                                      config_.tubes.material,
                                      config_.task.load_kg + (payload ? payload->mass_kg : 0),
                                      config_.task.physics.gravity_m_per_s2);
}

BatchSize TrackingProblem::batch_size(CaseRole role) const {
  return config_.engines.get(role).batch_size();
}

std::vector<CaseOutcome> TrackingProblem::simulate(std::span<const CaseJob> jobs) const {
  // The engine's jobs point into `candidates`, `cases` and `owned` until the simulation ends.
  struct Candidate {
    ArmDesign design;
    std::shared_ptr<const TrackingSetup> setup;
  };
  std::unordered_map<const double*, Candidate> candidates;  // by the address of the decision vector
  // An engine with SIMD needs only about 60 us per job. So sets, tables and plants are looked up
  // once for all neighbouring jobs that share a block.
  std::optional<TestSet> set;
  std::deque<std::unordered_map<std::uint64_t, TrackingInputs::PreparedCase>> cases;
  std::vector<const TrackingInputs::PreparedCase*> case_of_job;
  std::vector<std::shared_ptr<const void>> owned;
  std::vector<TrackingJob> tracking;
  tracking.reserve(jobs.size());
  std::size_t looked_ahead = 0;  // the jobs whose target tables were asked for
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    const CaseJob& job = jobs[i];
    const auto [candidate, is_new] = candidates.try_emplace(job.x.data());
    if (is_new) {
      candidate->second.design = make_design(job.x);
      candidate->second.setup = inputs_.get_setup(candidate->second.design);
    }
    if (i == 0 || job.block != jobs[i - 1].block) {
      set = get_set(job.block->set);
      cases.emplace_back();
    }
    if (i == looked_ahead) {
      std::vector<std::uint64_t> numbers;
      for (; looked_ahead < jobs.size() && jobs[looked_ahead].block == job.block &&
             numbers.size() < TrackingInputs::kAhead;
           ++looked_ahead) {
        if (numbers.empty() || numbers.back() != jobs[looked_ahead].number) {
          numbers.push_back(jobs[looked_ahead].number);
        }
      }
      inputs_.make_ahead(*set, numbers);
    }
    auto its_case = cases.back().find(job.number);
    if (its_case == cases.back().end()) {
      its_case = cases.back()
                     .emplace(job.number, inputs_.prepare_case(job.block->role, *set, job.number))
                     .first;
      check_moves(config_.requirements, config_.task, *its_case->second.targets, set->name(),
                  job.number);
    }
    case_of_job.push_back(&its_case->second);
    TrackingJob& one = tracking.emplace_back(inputs_.make_job(
        candidate->second.design, *candidate->second.setup, its_case->second, owned));
    one.abandon_above_m = job.abandon_above;
    if (job.block->role == CaseRole::training) {
      one.cutoff_m = config_.cutoff_error_m;
    }
  }
  auto results = run_engines(jobs, tracking);
  std::vector<CaseOutcome> outcomes;
  outcomes.reserve(jobs.size());
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    const bool own_targets = tracking[i].targets != case_of_job[i]->targets.get();
    const CaseRole role = jobs[i].block->role;
    const std::vector<double> required = make_required_metrics(
        config_.requirements, results[i], *tracking[i].targets, role == CaseRole::training);
    const bool ended_early = has_ended_early(results[i].result.status);
    outcomes.push_back(make_outcome(std::move(results[i].result), config_, role, tracking[i],
                                    own_targets, jobs[i].residuals));
    if (outcomes[i].has_error) {
      outcomes[i].metrics.insert(outcomes[i].metrics.end(), required.begin(), required.end());
    }
    const PhysicsEngine& engine = config_.engines.get(role);
    if (jobs[i].jacobian && engine.has_derivatives() && tracking[i].variation == nullptr &&
        !outcomes[i].residuals.empty()) {
      const std::size_t counted = outcomes[i].residuals.size() * directions_.size();
      if (config_.failure_rule == FailureRule::ordered && ended_early) {
        outcomes[i].jacobian.assign(counted, 0.0);  // the share of the time moves in steps
        continue;
      }
      outcomes[i].jacobian = engine.calc_derivatives(
          inputs_.setup(), tracking[i], inputs_.perturb_directions(*case_of_job[i], directions_));
      outcomes[i].jacobian.erase(outcomes[i].jacobian.begin(),
                                 outcomes[i].jacobian.end() - static_cast<std::ptrdiff_t>(counted));
    }
  }
  return outcomes;
}

std::vector<MeasuredCase> TrackingProblem::run_engines(
    std::span<const CaseJob> jobs, std::span<const TrackingJob> tracking) const {
  std::vector<MeasuredCase> results;
  results.reserve(jobs.size());
  for (std::size_t first = 0; first < jobs.size();) {
    const PhysicsEngine& engine = config_.engines.get(jobs[first].block->role);
    std::size_t end = first + 1;
    while (end < jobs.size() && &config_.engines.get(jobs[end].block->role) == &engine) {
      ++end;
    }
    auto some = simulate_measured(engine, inputs_.setup(), tracking.subspan(first, end - first),
                                  config_.requirements);
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
  std::vector<TrackingResult> results;
  for (MeasuredCase& one : simulate_judged(design, set, first, count, recording, {})) {
    results.push_back(std::move(one.result));
  }
  return results;
}

std::vector<MeasuredCase> TrackingProblem::measure(const ArmDesign& design, const TestSet& set,
                                                   std::uint64_t first, std::size_t count,
                                                   bool motion) const {
  auto cases =
      simulate_judged(design, set, first, count, {.error_series = motion}, config_.requirements);
  for (MeasuredCase& one : cases) {
    one.result.error_series_m = {};
  }
  return cases;
}

std::vector<MeasuredCase> TrackingProblem::simulate_judged(
    const ArmDesign& design, const TestSet& set, std::uint64_t first, std::size_t count,
    RecordingOptions recording, std::span<const Requirement> requirements) const {
  check_design(design);
  const auto design_setup = inputs_.get_setup(design);
  std::deque<TrackingInputs::PreparedCase> cases;
  std::vector<std::shared_ptr<const void>> owned;
  std::vector<TrackingJob> jobs;
  for (std::size_t i = 0; i < count; ++i) {
    if (i % TrackingInputs::kAhead == 0) {
      std::vector<std::uint64_t> numbers(std::min(count - i, TrackingInputs::kAhead));
      std::iota(numbers.begin(), numbers.end(), first + i);
      inputs_.make_ahead(set, numbers);
    }
    cases.push_back(inputs_.prepare_case(CaseRole::test, set, first + i));
    jobs.push_back(inputs_.make_job(design, *design_setup, cases.back(), owned));
    jobs.back().recording = recording;
  }
  return simulate_measured(*config_.engines.judging, inputs_.setup(), jobs, requirements);
}

}  // namespace armwright
