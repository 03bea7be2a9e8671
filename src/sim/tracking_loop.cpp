#include "sim/tracking_loop.hpp"

namespace armwright {

TrackingLoop::TrackingLoop(const TrackingSetup& setup, const TrackingJob& job)
    : setup_(setup),
      job_(job),
      period_s_(setup.task().control_period_s),
      substep_s_(period_s_ / setup.task().physics.substeps) {
  const std::size_t joints = setup.robot().joint_count();
  const ControllerRow& row = find_controller(job.design->controller);
  for (std::size_t i = 0; i < joints; ++i) {
    const JointDrive& drive = job.design->joints[i];
    controllers_.push_back(row.make(drive.gains, drive.limits, setup.robot().joints[i].kind));
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

void TrackingLoop::abandon(SimulationStatus status, std::string reason) {
  result_.status = status;
  result_.reason = std::move(reason);
  if (std::isfinite(job_.cutoff_m)) {
    result_.point_error_m.resize(job_.targets->segments.size(), job_.cutoff_m);
  }
}

void TrackingLoop::finish() {
  const double steps = std::max(1, result_.steps);
  for (std::size_t i = 0; i < q_.size(); ++i) {
    result_.rms_effort_n_m[i] = std::sqrt(result_.rms_effort_n_m[i] / steps);
    result_.saturated_share.push_back(saturated_steps_[i] / steps);
  }
  const std::size_t first = setup_.task().count_first_point ? 0 : 1;
  if (result_.point_error_m.size() == job_.targets->segments.size()) {
    double sum = 0;
    for (std::size_t k = first; k < result_.point_error_m.size(); ++k) {
      sum += result_.point_error_m[k];
    }
    result_.mean_error_m = sum / static_cast<double>(result_.point_error_m.size() - first);
  }
}

}  // namespace armwright
