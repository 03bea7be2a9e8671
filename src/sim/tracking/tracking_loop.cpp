#include "sim/tracking/tracking_loop.hpp"

namespace armwright {

TrackingLoop::TrackingLoop(const TrackingSetup& setup, const TrackingJob& job)
    : setup_(setup),
      job_(job),
      period_s_(setup.task().control_period_s),
      substep_s_(period_s_ / setup.task().physics.substeps) {
  const std::size_t joints = setup.robot().joint_count();
  const ControllerRow& row = find_controller(job.design->controller);
  check_feed_forward(job);
  has_feed_forward_ = row.feed_forward != FeedForward::none;
  for (std::size_t i = 0; i < joints; ++i) {
    const JointDrive& drive = job.design->joints[i];
    controllers_.push_back(row.make(drive.gains, drive.limits, setup.robot().joints[i].kind));
  }
  q_.resize(joints);
  q_before_.resize(joints);
  effort_.resize(joints);
  result_.peak_effort_n_m.resize(joints);
  result_.rms_effort_n_m.resize(joints);
  result_.saturated_share.resize(joints);
  result_.point_error_m.reserve(job.targets->segments.size());
  if (job.recording.error_series) {
    result_.error_series_m.reserve(static_cast<std::size_t>(job.targets->steps));
  }
}

}  // namespace armwright
