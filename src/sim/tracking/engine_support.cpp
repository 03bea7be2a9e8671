#include "sim/tracking/engine_support.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"

namespace armwright {
namespace {

// Returns the case's error over the points that count, as if the points not yet reached had none.
double calc_mean_error(const TrackingTask& task, const TrackingJob& job,
                       const TrackingResult& result) {
  const std::size_t first = task.count_first_point ? 0 : 1;
  double sum = 0;
  for (std::size_t k = first; k < result.point_error_m.size(); ++k) {
    sum += result.point_error_m[k];
  }
  return sum / static_cast<double>(job.targets->segments.size() - first);
}

void fill_points(const TrackingJob& job, TrackingResult& result) {
  if (std::isfinite(job.cutoff_m)) {
    result.point_error_m.resize(job.targets->segments.size(), job.cutoff_m);
  }
}

}  // namespace

void check_controller(const TrackingTask& task, const TrackingJob& job) {
  const ControllerRow& row = find_controller(job.design->controller);
  check_interface(row, task.drives);
  const TargetTable& targets = *job.targets;
  if (row.feed_forward != FeedForward::none && targets.unreachable.empty() &&
      targets.feed_forward_effort.size() != targets.joint_positions.size()) {
    throw Error(ErrorKind::usage,
                fmt::format("controller '{}' needs feed-forward efforts, which the target tables "
                            "of this task do not have; set control.controller to '{}'",
                            row.name, row.name));
  }
}

bool apply_unreachable(const TrackingJob& job, TrackingResult& result) {
  if (job.targets->unreachable.empty()) {
    return false;
  }
  result.status = SimulationStatus::unreachable;
  result.reason = job.targets->unreachable;
  return true;
}

void apply_cutoff(const TrackingTask& task, const TrackingJob& job, TrackingResult& result) {
  result.status = SimulationStatus::cut_off;
  result.reason = fmt::format("cut off at point {} ({:.2f} s): the error exceeds {} m",
                              result.point_error_m.size() + 1, result.steps * task.control_period_s,
                              job.cutoff_m);
  fill_points(job, result);
}

void apply_divergence(const TrackingTask& task, const TrackingJob& job, const std::string& what,
                      TrackingResult& result) {
  result.status = SimulationStatus::diverged;
  result.reason = fmt::format("diverged at {:.2f} s, on the way to point {}: {}",
                              (result.steps + 1) * task.control_period_s,
                              result.point_error_m.size() + 1, what);
  fill_points(job, result);
}

bool apply_abandonment(const TrackingTask& task, const TrackingJob& job, TrackingResult& result) {
  const std::size_t done = result.point_error_m.size();
  if (std::isinf(job.abandon_above_m) || done == job.targets->segments.size() ||
      !(calc_mean_error(task, job, result) > job.abandon_above_m)) {
    return false;
  }
  result.status = SimulationStatus::abandoned;
  result.reason =
      fmt::format("abandoned after point {} ({:.2f} s): the error is certain to exceed {} m", done,
                  result.steps * task.control_period_s, job.abandon_above_m);
  return true;
}

void complete_result(const TrackingTask& task, const TrackingJob& job, TrackingResult& result) {
  const double steps = std::max(1, result.steps);
  for (double& squares : result.rms_effort) {
    squares = std::sqrt(squares / steps);
  }
  for (double& count : result.saturated_share) {
    count /= steps;
  }
  if (result.point_error_m.size() == job.targets->segments.size() ||
      result.status == SimulationStatus::abandoned) {
    result.mean_error_m = calc_mean_error(task, job, result);
  }
}

}  // namespace armwright
