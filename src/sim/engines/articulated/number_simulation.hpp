// One tracking simulation on numbers that carry derivatives (number_lane.hpp): by the code that
// simulates everything else, so the derivatives are those of what the engine computes, step by
// step, and not of the continuous motion.
#pragma once

#include <vector>

#include "sim/dynamics/chain_model.hpp"
#include "sim/engines/articulated/number_lane.hpp"
#include "sim/tracking/tracking.hpp"

namespace armwright::articulated {

// What a design says of a joint.
template <class Number>
struct NumberDrive {
  std::vector<Number> gains;  // in the order of the controller's GainSpecs
  Number effort_min, effort_max;
};

// The squares of the errors of the job's points, in m^2, as far as they are reached without a
// cut-off or divergence; gains and limits are those of `drives`, one a joint, in place of the
// job's design.
template <class Number>
std::vector<Number> calc_squared_errors(const TrackingSetup& setup, const TrackingJob& job,
                                        const std::vector<NumberDrive<Number>>& drives) {
  using V = lanes::NumberLane<Number>;
  const TrackingSetup& own = job.choose_setup(setup);
  const ChainModel& chain = own.chain();
  const int n = chain.joints();
  const std::vector<V> model(chain.numbers().begin(), chain.numbers().end());
  const ControllerRow& controller = find_controller(job.design->controller);
  const int control_packs =
      calc_control_packs(n, controller.states, static_cast<int>(controller.gains.size()));
  std::vector<V> state(static_cast<std::size_t>(calc_state_packs(n) + control_packs), V(0));
  std::vector<V> final_state = state;
  std::vector<V> scratch(static_cast<std::size_t>(calc_scratch_packs(n)), V(0));
  for (int i = 0; i < n; ++i) {
    const auto set = [&](StateField field, const V& value) {
      state[static_cast<std::size_t>(field * n + i)] = value;
    };
    const NumberDrive<Number>& drive = drives[static_cast<std::size_t>(i)];
    set(kQ, V(job.targets->start_rad[static_cast<std::size_t>(i)]));
    set(kIntegrating, V(1));
    set(kEffortMin, V(drive.effort_min));
    set(kEffortMax, V(drive.effort_max));
    int place = calc_state_packs(n) + controller.states * n + i;
    for (const Number& gain : drive.gains) {
      state[static_cast<std::size_t>(place)] = V(gain);
      place += n;
    }
  }
  V* const singles = state.data() + kStateFields * n;
  singles[kCutoffSquared] = V(job.cutoff_m * job.cutoff_m);

  std::vector<Number> squares;
  for (const Segment& segment : job.targets->segments) {
    const auto set_point = [&](int field, const Eigen::Vector3d& at_m) {
      const Eigen::Vector3d point = chain.base_pose().inverse() * at_m;
      for (int axis = 0; axis < 3; ++axis) {
        singles[field + axis] = V(point[axis]);
      }
    };
    set_point(kPointX, segment.to_m);
    const auto tool_points = job.targets->tool_points(squares.size());
    for (std::size_t k = 0; k < tool_points.size(); ++k) {
      set_point(kToolTargetX + 3 * static_cast<int>(k), tool_points[k]);
    }
    const double* const targets = job.targets->angles(segment.first_step).data();
    const double* const feed_forward = controller.feed_forward == FeedForward::none
                                           ? nullptr
                                           : job.targets->feed_forward(segment.first_step).data();
    SegmentCall<V> call;
    call.joints = n;
    call.flags = chain.flags().data();
    call.tilted_gravity = chain.tilted_gravity();
    call.prismatic = chain.prismatic();
    call.model = model.data();
    call.state = state.data();
    call.control_packs = control_packs;
    call.control = find_control<V>(controller.law, controllers::AllLaws{});
    call.scratch = scratch.data();
    call.steps = segment.steps;
    call.window_start = segment.window_start;
    call.tool_points = static_cast<int>(tool_points.size());
    call.substeps = own.task().physics.substeps;
    call.period_s = V(own.task().control_period_s);
    call.first_step_of_case = &segment == &job.targets->segments.front();
    call.shared_targets = true;
    call.targets = &targets;
    call.feed_forward = &feed_forward;
    call.alive = 1;
    call.final_state = final_state.data();
    // Fewer kernels than for simulations: every one takes long to compile.
    if (n == 4 && !call.prismatic && !call.tilted_gravity &&
        has_shape(call.flags, 4, kPalletiser)) {
      SegmentKernel<V, Palletiser>::run(call);
    } else {
      SegmentKernel<V, AnyChain>::run(call);
    }
    if (call.event[0] != LaneEvent::none) {
      break;
    }
    squares.push_back(singles[kWorstSquared].v);
  }
  return squares;
}

}  // namespace armwright::articulated
