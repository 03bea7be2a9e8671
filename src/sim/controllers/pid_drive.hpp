// PIDs that command a drive with an inner loop, as those of ros2_control do:
//   pid_velocity  u = ff r' + P e + I sum(e) h + D (e - e_prev) / h, a speed, as
//                 joint_trajectory_controller with a velocity interface
//   pid_position  u = r + P e + I sum(e) h + D (e - e_prev) / h, a position, as pid_controller with a
//                 position interface and a feed-forward of 1
// where r is the setpoint and r' = (r - r_prev) / h its rate.
//
// Start values: with T the lag of the drive and of sampling, lag_s + h / 2, the loop of pid_velocity
// crosses over at P = 1 / (4 T), which leaves 75 degrees of phase. I is a tenth of P^2, and D is
// small. pid_position begins with little more than the setpoint: its integral corrects with the rate
// 1 / (8 T).
#pragma once

#include "sim/controllers/law.hpp"

namespace armwright::controllers {

struct PidVelocity {
  static constexpr const char* kName = "pid_velocity";
  static constexpr const char* kSummary =
      "PID and the target's speed, for drives that take speeds (control.interface = velocity)";
  static constexpr const char* kFormula =
      "v = ff_velocity_scale r' + p e + i sum(e) h + d (e - e_prev) / h";
  static constexpr Gain kGains[] = {{"p", "p_per_s", "1/s"},
                                    {"i", "i_per_s2", "1/s^2"},
                                    {"d", "d", "1"},
                                    {"ff_velocity_scale", "ff_velocity_scale", "1", 1}};
  static constexpr ControlInterface kInterface = ControlInterface::velocity;
  static constexpr int kStates = 3;
  static constexpr FeedForward kFeedForward = FeedForward::none;

  static void convert(const PidStart& start, double* own) {
    const double p = 1 / (4 * (start.lag_s + start.period_s / 2));
    own[0] = p;
    own[1] = p * p / 10;
    own[2] = 0.02;
    own[3] = 1;
  }

  template <class In, class V = typename In::Value>
  ARMWRIGHT_INLINE static V calc(const In& in, Fields<V> gain, Fields<V> state) {
    const V target_speed = in.calc_rate(in.wrap_turns(update_change(in, in.setpoint, state[2])));
    return gain[3] * target_speed + calc_pid(in, gain[0], gain[1], gain[2], state);
  }
};

struct PidPosition {
  static constexpr const char* kName = "pid_position";
  static constexpr const char* kSummary =
      "the target's position and a PID, for drives that take positions (control.interface = "
      "position)";
  static constexpr const char* kFormula = "q = r + p e + i sum(e) h + d (e - e_prev) / h";
  static constexpr Gain kGains[] = {{"p", "p", "1"}, {"i", "i_per_s", "1/s"}, {"d", "d_s", "s"}};
  static constexpr ControlInterface kInterface = ControlInterface::position;
  static constexpr int kStates = 2;
  static constexpr FeedForward kFeedForward = FeedForward::none;

  static void convert(const PidStart& start, double* own) {
    own[0] = 0.1;
    own[1] = 1 / (8 * (start.lag_s + start.period_s / 2));
    own[2] = 0.001;
  }

  template <class In, class V = typename In::Value>
  ARMWRIGHT_INLINE static V calc(const In& in, Fields<V> gain, Fields<V> state) {
    return in.setpoint + calc_pid(in, gain[0], gain[1], gain[2], state);
  }
};

}  // namespace armwright::controllers
