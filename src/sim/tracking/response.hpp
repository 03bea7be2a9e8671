// Measures how the tip follows a move of the target, and how fast joints move, from recordings made
// with RecordingOptions::motion.
//
// A move goes from `from` to `to`, over the distance ds along the unit vector d. Its clock starts
// with it, and the target arrives at t_m. With p(t) the tip,
//   s(t) = (p(t) - from) . d    how far the tip has come along the move (m)
//   a(t) = |p(t) - to|          how far the tip is from the end, in any direction (m)
//   overshoot                   max over the segment of max(0, s - ds) / ds, without unit
//   rise time (s)               from the first t with s = 0.1 ds to the first t with s = 0.9 ds;
//                               the whole segment's time if s stays below 0.9 ds
//   settling time (s)           from t_m to the time after which a <= band until the segment's end;
//                               0 if that time is before t_m, and the segment's time after t_m if
//                               a > band at its end
// A joint's speed between two recorded positions is |dq| / h, with h the control period and dq
// taken the short way round for revolute joints. With v_k its signed speed in period k, and v_0 = v_-1
// = 0 before the start, the jerk integral of an arm is the sum over joints and periods of
// h ((v_k - 2 v_(k-1) + v_(k-2)) / h^2)^2: the integral of the squared jerk of a motion that is smooth
// over a few periods (rad^2/s^5; joints that slide, m^2/s^5, are added).
//
// The other half of this file measures the distance d_i between the tip and the moving target at the
// ends of the control periods i, from recordings made with RecordingOptions::error_series. Every tip
// counts, whatever the tool's orientation. The error of a point counts the rests alone
// (simulation.hpp), so these are the moves and the start:
//   error while moving     the root mean square of d_i, and the largest d_i, over the periods of the
//                          moves that count in the case's error, from the start of each move to the
//                          last end of a period before the target's arrival (t < t_m)
//   error after start-up   the largest d_i of the first segment: until the target's first rest ends
// A continuous path has no rests. All its samples count as moving, and it has no error after start-up.
//
// Source: overshoot, rise and settling time as of step responses, Franklin, Powell and Emami-Naeini
// (2019), Feedback Control of Dynamic Systems, section 3.4; IEC 60050-351. Two things differ from
// the source. The quantity is the way of the tip along a straight move, not one variable after a
// step. Settling counts from the target's arrival, because no arm can stand still at it before.
// Limits of validity: the tip is known at the ends of control periods only. Times between two of
// them are interpolated linearly; a peak is missed by at most |s''| h^2 / 8.
//
// A segment is no move, and has no response, if it is shorter than kShortestMove_m, or if it ends
// or is first measured within its first control period. The samples of a continuous path are no
// moves.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "sim/tracking/simulation.hpp"

namespace armwright {

// For shorter moves, the error left over from the move before (0.1 mm at best) would be more than a
// tenth of the distance.
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

// Returns nothing if the segment is no move, or if the recording ends before the segment does. At
// the beginning of the first segment the tip is taken to be at the segment's start.
std::optional<TipMove> find_tip_move(const TargetTable& targets, std::size_t segment,
                                     std::span<const Eigen::Vector3d> tips_m, double period_s);

double calc_overshoot(const TipMove& move);
double calc_rise_time_s(const TipMove& move);
double calc_settling_time_s(const TipMove& move, double band_m);

// The errors of one or several simulations beside those of their points.
struct MotionSummary {
  double moving_rms_m = 0, moving_peak_m = 0;
  std::optional<double> start_up_m;  // nothing for continuous paths
};

// The sums from which a MotionSummary is made.
struct MotionErrors {
  double moving_squares_m2 = 0;  // the sum of d_i^2 over the periods of the moves
  std::size_t moving_periods = 0;
  double moving_peak_m = 0;
  std::optional<double> start_up_m;  // nothing for continuous paths

  // Adds the errors of another simulation.
  void add(const MotionErrors& other);
  // Returns nothing if no period of a move was added.
  std::optional<MotionSummary> summarize() const;
};

// Measures a simulation that came to its end. `errors_m` is its error series.
MotionErrors measure_motion(const TrackingTask& task, const TargetTable& targets,
                            std::span<const double> errors_m);

// Returns the largest speed of each joint (rad/s or m/s), from the start positions on.
std::vector<double> calc_joint_speeds(const RobotModel& robot, const TargetTable& targets,
                                      const TrackingResult& result, double period_s);
// Returns the jerk integral of the recorded motion.
double calc_jerk_integral(const RobotModel& robot, const TargetTable& targets,
                          const TrackingResult& result, double period_s);

}  // namespace armwright
