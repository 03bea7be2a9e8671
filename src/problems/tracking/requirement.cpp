#include "problems/tracking/requirement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/error.hpp"

namespace armwright {
namespace {

using Q = RequiredQuantity;

std::size_t get_first_counted(const TrackingTask& task) {
  return task.count_first_point ? 0 : 1;
}

// Returns the value of the named joint or, without one, the largest value.
RequiredValue choose_joint(const Requirement& requirement, std::span<const double> values) {
  if (values.empty()) {
    return {};
  }
  const std::size_t joint =
      requirement.joint
          ? *requirement.joint
          : static_cast<std::size_t>(std::ranges::max_element(values) - values.begin());
  return {.value = values[joint], .joint = joint, .point = {}};
}

void keep_larger(RequiredValue& worst, double value, std::size_t segment) {
  if (!worst.value || value > *worst.value) {
    worst.value = value;
    worst.point = segment + 1;
  }
}

double calc_response(const Requirement& requirement, const TipMove& move) {
  switch (requirement.quantity) {
    case Q::overshoot:
      return calc_overshoot(move);
    case Q::rise_time:
      return calc_rise_time_s(move);
    default:
      return calc_settling_time_s(move,
                                  requirement.band_m.value_or(kSettlingBandShare * move.length_m));
  }
}

RequiredValue measure_one(const Requirement& requirement, const TrackingSetup& setup,
                          const TargetTable& targets, const TrackingResult& result) {
  const TrackingTask& task = setup.task();
  RequiredValue worst;
  switch (requirement.quantity) {
    case Q::peak_torque:
      return choose_joint(requirement, result.peak_effort);
    case Q::rms_torque:
      return choose_joint(requirement, result.rms_effort);
    case Q::joint_speed:
      return choose_joint(requirement,
                          calc_joint_speeds(setup.robot(), targets, result, task.control_period_s));
    case Q::energy:
      return {.value = result.energy_j, .joint = {}, .point = {}};
    case Q::jerk:
      return {.value = calc_jerk_integral(setup.robot(), targets, result, task.control_period_s),
              .joint = {},
              .point = {}};
    case Q::tip_error:
      for (std::size_t k = get_first_counted(task); k < result.point_error_m.size(); ++k) {
        keep_larger(worst, result.point_error_m[k], k);
      }
      return worst;
    case Q::overshoot:
    case Q::settling_time:
    case Q::rise_time:
      break;
  }
  for (std::size_t k = get_first_counted(task); k < targets.segments.size(); ++k) {
    if (const auto move = find_tip_move(targets, k, result.tips_m, task.control_period_s)) {
      keep_larger(worst, calc_response(requirement, *move), k);
    }
  }
  return worst;
}

MeasuredCase measure(const TrackingSetup& setup, const TrackingJob& job, TrackingResult result,
                     std::span<const Requirement> requirements) {
  MeasuredCase measured;
  for (const Requirement& requirement : requirements) {
    measured.required.push_back(
        measure_one(requirement, job.choose_setup(setup), *job.targets, result));
  }
  // As find_tip_move(): what was not recorded to its end is not measured.
  if (result.status == SimulationStatus::ok &&
      result.error_series_m.size() == static_cast<std::size_t>(job.targets->steps)) {
    measured.motion = measure_motion(setup.task(), *job.targets, result.error_series_m);
  }
  if (!job.recording.motion) {
    result.tips_m = {};
    result.joint_positions = {};
  }
  measured.result = std::move(result);
  return measured;
}

// Returns true if simulations must record the motion (RecordingOptions::motion).
bool needs_motion(std::span<const Requirement> requirements) {
  return std::ranges::any_of(requirements, [](const Requirement& requirement) {
    return get_requirement_row(requirement.quantity).of_moves ||
           requirement.quantity == RequiredQuantity::joint_speed ||
           requirement.quantity == RequiredQuantity::jerk;
  });
}

}  // namespace

const std::vector<RequirementRow>& requirement_table() {
  static const std::vector<RequirementRow> table = {
      {Q::overshoot, "overshoot", "overshoot", "limit_relative", "1", false, true},
      {Q::settling_time, "settling_time", "settling time", "limit_s", "s", false, true},
      {Q::rise_time, "rise_time", "rise time", "limit_s", "s", false, true},
      {Q::tip_error, "tip_error", "tip error", "limit_m", "m"},
      {Q::peak_torque, "peak_torque", "peak torque", "limit_n_m", "N m", true, false, "peak force",
       "limit_n", "N"},
      {Q::rms_torque, "rms_torque", "RMS torque", "limit_n_m", "N m", true, false, "RMS force",
       "limit_n", "N"},
      {Q::energy, "energy", "energy", "limit_j", "J"},
      {Q::joint_speed, "joint_speed", "joint speed", "limit_rad_per_s", "rad/s", true, false,
       "joint speed", "limit_m_per_s", "m/s"},
      {Q::jerk, "jerk", "jerk", "limit_rad2_per_s5", "rad^2/s^5"},
  };
  return table;
}

const RequirementRow& get_requirement_row(RequiredQuantity quantity) {
  return *std::ranges::find(requirement_table(), quantity, &RequirementRow::quantity);
}

Quantity describe_requirement(const Requirement& requirement, const RobotModel& robot) {
  const RequirementRow& row = get_requirement_row(requirement.quantity);
  // Without a named joint, all joints are of one kind; the reader of the file checks that.
  const bool slides =
      row.of_joints && robot.joints[requirement.joint.value_or(0)].kind == JointKind::prismatic;
  Quantity quantity{slides ? row.slider_name : row.name, slides ? row.slider_unit : row.unit};
  if (requirement.joint) {
    quantity.name += " of " + robot.joints[*requirement.joint].name;
  }
  if (requirement.quantity == RequiredQuantity::settling_time) {
    quantity.name += requirement.band_m
                         ? fmt::format(" to {:g} mm", 1000 * *requirement.band_m)
                         : fmt::format(" to {:g} % of the move", 100 * kSettlingBandShare);
  }
  return quantity;
}

std::vector<std::string> name_requirement_metrics(std::span<const Requirement> requirements,
                                                  const RobotModel& robot) {
  std::vector<std::string> names;
  for (const Requirement& requirement : requirements) {
    std::string name = "requirement." + get_requirement_row(requirement.quantity).key;
    if (requirement.joint) {
      name += "." + robot.joints[*requirement.joint].name;
    }
    std::string unique = name;
    for (int number = 2; std::ranges::count(names, unique) > 0; ++number) {
      unique = fmt::format("{}.{}", name, number);
    }
    names.push_back(std::move(unique));
  }
  return names;
}

void describe_requirements(std::span<const Requirement> requirements, const RobotModel& robot,
                           ProblemDescription& description) {
  const auto names = name_requirement_metrics(requirements, robot);
  for (std::size_t i = 0; i < requirements.size(); ++i) {
    const Limit limit{describe_requirement(requirements[i], robot), requirements[i].limit};
    description.requirements.push_back(
        {description.metrics.size(), limit, requirements[i].is_constraint});
    description.metrics.push_back({names[i], limit.quantity.unit});
    if (requirements[i].is_constraint) {
      description.limits.push_back(limit);
    }
  }
}

std::vector<MeasuredCase> simulate_measured(const PhysicsEngine& engine, const TrackingSetup& setup,
                                            std::span<const TrackingJob> jobs,
                                            std::span<const Requirement> requirements) {
  const bool records = needs_motion(requirements);
  const std::size_t at_once = records ? engine.batch_size().granularity : jobs.size();
  std::vector<MeasuredCase> all;
  all.reserve(jobs.size());
  for (std::size_t first = 0; first < jobs.size(); first += at_once) {
    const auto some = jobs.subspan(first, std::min(at_once, jobs.size() - first));
    std::vector<TrackingResult> results;
    if (records) {
      std::vector<TrackingJob> recorded(some.begin(), some.end());
      for (TrackingJob& job : recorded) {
        job.recording.motion = true;
      }
      results = engine.simulate(setup, recorded);
    } else {
      results = engine.simulate(setup, some);
    }
    for (std::size_t i = 0; i < some.size(); ++i) {
      all.push_back(measure(setup, some[i], std::move(results[i]), requirements));
    }
  }
  return all;
}

void check_moves(std::span<const Requirement> requirements, const TrackingTask& task,
                 const TargetTable& targets, const std::string& set, std::uint64_t number) {
  const auto wanted = std::ranges::find_if(requirements, [](const Requirement& requirement) {
    return get_requirement_row(requirement.quantity).of_moves;
  });
  if (wanted == requirements.end()) {
    return;
  }
  for (std::size_t k = get_first_counted(task); k < targets.segments.size(); ++k) {
    if (is_move(targets.segments[k])) {
      return;
    }
  }
  throw Error(
      ErrorKind::bad_data,
      fmt::format("test set {}: case {} has no move long enough to measure the {}: at least "
                  "one move must be {} mm or longer and take more than one control period; leave "
                  "that requirement out, or use other test cases",
                  set, number, get_requirement_row(wanted->quantity).name, 1000 * kShortestMove_m));
}

std::vector<double> make_required_metrics(std::span<const Requirement> requirements,
                                          const MeasuredCase& measured, const TargetTable& targets,
                                          bool in_training) {
  const TrackingResult& result = measured.result;
  const double share = static_cast<double>(result.steps) / std::max(1, targets.steps);
  const bool is_lost =
      result.status != SimulationStatus::ok && result.status != SimulationStatus::abandoned;
  std::vector<double> metrics;
  for (std::size_t i = 0; i < requirements.size(); ++i) {
    const double most = kWorstRatio * requirements[i].limit;
    const auto& value = measured.required[i].value;
    if (result.status == SimulationStatus::abandoned) {
      metrics.push_back(std::min(value.value_or(0), most));  // a lower bound
    } else if ((is_lost && in_training) || !value) {
      metrics.push_back(most * (2 - share));
    } else {
      metrics.push_back(in_training ? std::min(*value, most) : *value);
    }
  }
  return metrics;
}

std::vector<double> calc_worst_required(std::span<const CaseOutcome> outcomes, std::size_t first,
                                        std::size_t count) {
  std::vector<double> worst(count);
  for (const CaseOutcome& outcome : outcomes) {
    for (std::size_t i = 0; outcome.has_error && i < count; ++i) {
      worst[i] = std::max(worst[i], outcome.metrics[first + i]);
    }
  }
  return worst;
}

void append_constraints(std::span<const Requirement> requirements, std::span<const double> worst,
                        std::vector<double>& constraint_values) {
  for (std::size_t i = 0; i < requirements.size(); ++i) {
    if (requirements[i].is_constraint) {
      constraint_values.push_back(worst[i] / requirements[i].limit - 1);
    }
  }
}

}  // namespace armwright
