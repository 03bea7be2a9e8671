// The controllers of a pack of lanes: the laws of controllers/law_table.hpp on lane types. Their
// efforts are clamped, and the state records which steps were clamped.
#pragma once

#include "sim/controllers/law_table.hpp"
#include "sim/engines/articulated/kernels.hpp"

namespace armwright::articulated {

// Loads one number per lane, each from the table of its lane. A table has one row per step.
template <class V>
ARMWRIGHT_INLINE V load_lanes(const double* const* tables, bool shared, int index) {
  using T = typename V::Scalar;
  if (shared) {
    return V(static_cast<T>(tables[0][index]));
  }
  alignas(64) T lanes[V::kLanes];
  for (int lane = 0; lane < V::kLanes; ++lane) {
    lanes[lane] = static_cast<T>(tables[lane][index]);
  }
  return *reinterpret_cast<const V*>(lanes);
}

// Computes the effort of one joint in one step.
template <class V, class Law>
ARMWRIGHT_INLINE V control_joint(const SegmentCall<typename V::Scalar>& call, V* state, int joints,
                                 int joint, bool turns, int step, V period_s, V frequency_hz) {
  const int index = step * joints + joint;
  V* const control = state + calc_state_packs(joints) + joint;
  const V low = state[kEffortMin * joints + joint];
  const V high = state[kEffortMax * joints + joint];
  V& integrating = state[kIntegrating * joints + joint];
  controllers::LawInput<V> in;
  in.setpoint = load_lanes<V>(call.targets, call.shared_targets, index);
  in.measurement = state[kQ * joints + joint];
  in.integrating = integrating;
  in.effort_limit = max(high, V(0) - low);
  in.period_s = period_s;
  in.frequency_hz = frequency_hz;
  in.turns = turns;
  in.first = call.first_step_of_case && step == 0;
  in.error = in.wrap_turns(in.setpoint - in.measurement);
  if constexpr (Law::kFeedForward != FeedForward::none) {
    in.feed_forward = load_lanes<V>(call.feed_forward, call.shared_targets, index);
  } else {
    in.feed_forward = V(0);
  }
  const V wanted = Law::calc(in, controllers::Fields<V>{control + Law::kStates * joints, joints},
                             controllers::Fields<V>{control, joints});
  integrating = select(wanted < low, V(0), select(wanted > high, V(0), V(1)));
  // NaN stays NaN: min and max return their second argument if they cannot compare.
  return min(high, max(low, wanted));
}

template <class V, class Law>
void control_joints(SegmentCall<typename V::Scalar>& call, int step) {
  V* const state = reinterpret_cast<V*>(call.state);
  const V period_s = call.period_s;
  const V frequency_hz = typename V::Scalar{1} / call.period_s;
  for (int joint = 0; joint < call.joints; ++joint) {
    const bool turns = (call.flags[joint] & kPrismatic) == 0;
    state[kEffort * call.joints + joint] =
        control_joint<V, Law>(call, state, call.joints, joint, turns, step, period_s, frequency_hz);
  }
}

// Returns the function for the law at that place of the table; null for the PID, the first one.
template <class V, class Pid, class... Others>
ControlFunction<typename V::Scalar> find_control(int law, controllers::LawList<Pid, Others...>) {
  constexpr ControlFunction<typename V::Scalar> kFunctions[] = {nullptr,
                                                                control_joints<V, Others>...};
  return kFunctions[law];
}

}  // namespace armwright::articulated
