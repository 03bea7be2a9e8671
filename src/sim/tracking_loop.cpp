#include "sim/tracking_loop.hpp"

namespace armwright {

TrackingLoop::TrackingLoop(const TrackingSetup& setup, const TrackingJob& job)
    : setup_(setup),
      job_(job),
      period_s_(setup.task().control_period_s),
      substep_s_(period_s_ / setup.task().physics.substeps) {
  const std::size_t joints = setup.robot().joint_count();
  const ControllerRow& row = find_controller(job.design->controller);
  for (const JointDrive& joint : job.design->joints) {
    controllers_.push_back(row.make(joint.gains, joint.limits));
  }
  q_.resize(joints);
  q_before_.resize(joints);
  effort_.resize(joints);
  saturated_steps_.resize(joints);
  result_.peak_effort_n_m.resize(joints);
  result_.rms_effort_n_m.resize(joints);
  result_.point_error_m.reserve(job.targets->segments.size());
  if (job.recording.error_series) {
    result_.error_series_m.reserve(static_cast<std::size_t>(job.targets->steps));
  }
}

void TrackingLoop::cut_short(SimulationStatus status, std::string reason) {
  result_.status = status;
  result_.reason = std::move(reason);
  if (std::isfinite(job_.cutoff_m)) {
    result_.point_error_m.resize(job_.targets->segments.size(), job_.cutoff_m);
  }
}

bool TrackingLoop::should_abandon() {
  const std::size_t points = job_.targets->segments.size();
  const std::size_t done = result_.point_error_m.size();
  const std::size_t first = setup_.task().count_first_point ? 0 : 1;
  if (done > first) {
    error_sum_m_ += result_.point_error_m.back();
  }
  const double least_m = error_sum_m_ / static_cast<double>(points - first);
  if (done == points || !(least_m > job_.abandon_above_m)) {
    return false;
  }
  result_.status = SimulationStatus::abandoned;
  result_.reason =
      fmt::format("abandoned after point {} ({:.2f} s): the error is certain to exceed {} m", done,
                  result_.steps * period_s_, job_.abandon_above_m);
  return true;
}

void TrackingLoop::finish() {
  const double steps = std::max(1, result_.steps);
  for (std::size_t i = 0; i < q_.size(); ++i) {
    result_.rms_effort_n_m[i] = std::sqrt(result_.rms_effort_n_m[i] / steps);
    result_.saturated_share.push_back(saturated_steps_[i] / steps);
  }
  const std::size_t first = setup_.task().count_first_point ? 0 : 1;
  const std::size_t points = job_.targets->segments.size();
  if (result_.point_error_m.size() == points || result_.status == SimulationStatus::abandoned) {
    double sum = 0;
    for (std::size_t k = first; k < result_.point_error_m.size(); ++k) {
      sum += result_.point_error_m[k];
    }
    result_.mean_error_m = sum / static_cast<double>(points - first);
  }
}

}  // namespace armwright
