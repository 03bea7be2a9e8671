#include "problems/tracking/requirement_meter.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/error.hpp"
#include "sim/tracking/response.hpp"

namespace armwright {
namespace {

using Q = RequiredQuantity;

std::size_t get_first_counted(const TrackingTask& task) {
  return task.count_first_point ? 0 : 1;
}

// The named one of the joints' values, or the largest.
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
  if (!job.recording.motion) {
    result.tips_m = {};
    result.joint_positions = {};
  }
  measured.result = std::move(result);
  return measured;
}

}  // namespace

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
      metrics.push_back(std::min(value.value_or(0), most));  // a bound, of what there is
    } else if ((is_lost && in_training) || !value) {
      metrics.push_back(most * (2 - share));
    } else {
      metrics.push_back(in_training ? std::min(*value, most) : *value);
    }
  }
  return metrics;
}

std::vector<double> calc_worst_required(std::span<const CaseOutcome> outcomes, std::size_t count) {
  std::vector<double> worst(count);
  for (const CaseOutcome& outcome : outcomes) {
    for (std::size_t i = 0; outcome.has_error && i < count; ++i) {
      worst[i] = std::max(worst[i], outcome.metrics[outcome.metrics.size() - count + i]);
    }
  }
  return worst;
}

void check_moves(std::span<const Requirement> requirements, const TrackingTask& task,
                 const TargetTable& targets, const std::string& set, std::uint64_t number) {
  const auto wanted = std::ranges::find_if(requirements, [](const Requirement& requirement) {
    return get_row(requirement.quantity).of_moves;
  });
  if (wanted == requirements.end()) {
    return;
  }
  for (std::size_t k = get_first_counted(task); k < targets.segments.size(); ++k) {
    if (is_move(targets.segments[k])) {
      return;
    }
  }
  throw Error(ErrorKind::bad_data,
              fmt::format("test set {}: case {} has no move of which {} can be measured: of at "
                          "least {} mm and longer than a control period; leave that requirement "
                          "out, or use other test cases",
                          set, number, get_row(wanted->quantity).name, 1000 * kShortestMove_m));
}

}  // namespace armwright
