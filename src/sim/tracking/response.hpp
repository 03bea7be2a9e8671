// How the tip answers a move of the target, and how fast joints turn: measured on what
// RecordingOptions::motion recorded.
//
// A move goes from `from` to `to`, at a distance of ds along the unit vector d; its clock starts
// with it, and the target arrives at t_m. With p(t) the tip,
//   s(t) = (p(t) - from) . d    how far the tip has come along the move (m)
//   a(t) = |p(t) - to|          how far it is from the end, in whatever direction (m)
//   overshoot                   max over the segment of max(0, s - ds) / ds, without unit
//   rise time (s)               from the first t where s = 0.1 ds to the first where s = 0.9 ds;
//   the
//                               whole segment's time where the tip does not come so far in it
//   settling time (s)           from t_m to the time after which a <= band until the segment's end;
//   0
//                               if that is before t_m, and the segment's time after t_m where a >
//                               band at its end
// A joint's speed between two recorded angles is |dq| / h, h the control period, the short way
// round for joints that turn.
//
// Source: overshoot, rise and settling time as of step responses, Franklin, Powell and Emami-Naeini
// (2019), Feedback Control of Dynamic Systems, section 3.4; IEC 60050-351. Ours is what they are
// measured on: the way of the tip along a straight move instead of one variable after a step, and
// settling from when the target arrives, since before that nobody can stand still at it.
// Limits of validity: the tip is known at the ends of control periods. Between two of them times
// are interpolated linearly; a peak is missed by at most |s''| h^2 / 8.
//
// Neither a response nor its measures exist of a segment that is no move: shorter than
// kShortestMove_m, or over (or measured) within its first control period, as the samples of a
// continuous path are.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "sim/tracking/tracking.hpp"

namespace armwright {

// Below it, what is left of the move before (0.1 mm at best) would be more than a tenth of it.
inline constexpr double kShortestMove_m = 0.001;

bool is_move(const Segment& segment);

// The tip on one move, at its beginning and at the ends of its control periods.
struct TipMove {
  double length_m = 0;          // ds
  double arrival_s = 0;         // t_m
  double period_s = 0;          // h
  std::vector<double> along_m;  // s
  std::vector<double> away_m;   // a
};

// Nothing if the segment is no move or the recording ends before it does. Before the first segment
// the tip is where it starts.
std::optional<TipMove> find_tip_move(const TargetTable& targets, std::size_t segment,
                                     std::span<const Eigen::Vector3d> tips_m, double period_s);

double calc_overshoot(const TipMove& move);
double calc_rise_time_s(const TipMove& move);
double calc_settling_time_s(const TipMove& move, double band_m);

// The largest speed of each joint (rad/s or m/s), from the start posture on.
std::vector<double> calc_joint_speeds(const RobotModel& robot, const TargetTable& targets,
                                      const TrackingResult& result, double period_s);

}  // namespace armwright
