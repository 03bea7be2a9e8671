#include "sim/tracking/response.hpp"

#include <algorithm>
#include <cmath>

#include "sim/kinematics/kinematics.hpp"

namespace armwright {
namespace {

// Returns the first time (s) at which s reaches `level_m`; nothing if it does not.
std::optional<double> find_first_time_s(const TipMove& move, double level_m) {
  const std::vector<double>& along_m = move.along_m;
  const auto reached =
      std::ranges::find_if(along_m, [&](double value_m) { return value_m >= level_m; });
  if (reached == along_m.end()) {
    return std::nullopt;
  }
  const auto k = static_cast<double>(reached - along_m.begin());
  if (reached == along_m.begin()) {
    return 0;
  }
  const double before_m = *(reached - 1);
  return (k - 1 + (level_m - before_m) / (*reached - before_m)) * move.period_s;
}

double calc_end_s(const TipMove& move) {
  return static_cast<double>(move.along_m.size() - 1) * move.period_s;
}

// Calls `use` with the number of a joint and its signed speed, for each period and joint of a recording.
template <typename Use>
void for_each_speed(const RobotModel& robot, const TargetTable& targets,
                    const TrackingResult& result, double period_s, const Use& use) {
  const std::size_t joints = targets.joints;
  std::span<const double> before(targets.start_positions);
  const std::span<const double> angles(result.joint_positions);
  for (std::size_t at = 0; at + joints <= angles.size(); at += joints) {
    const auto now = angles.subspan(at, joints);
    for (std::size_t i = 0; i < joints; ++i) {
      use(i, calc_displacement(robot.joints[i].kind, before[i], now[i]) / period_s);
    }
    before = now;
  }
}

}  // namespace

bool is_move(const Segment& segment) {
  return segment.window_start > 0 && segment.steps > segment.window_start &&
         (segment.to_m - segment.from_m).norm() >= kShortestMove_m;
}

std::optional<TipMove> find_tip_move(const TargetTable& targets, std::size_t segment,
                                     std::span<const Eigen::Vector3d> tips_m, double period_s) {
  const Segment& its = targets.segments[segment];
  const auto first = static_cast<std::size_t>(its.first_step);
  const auto steps = static_cast<std::size_t>(its.steps);
  if (!is_move(its) || tips_m.size() < first + steps) {
    return std::nullopt;
  }
  const Eigen::Vector3d way_m = its.to_m - its.from_m;
  TipMove move{.length_m = way_m.norm(),
               .arrival_s = its.duration_s,
               .period_s = period_s,
               .along_m = {},
               .away_m = {}};
  move.along_m.reserve(steps + 1);
  move.away_m.reserve(steps + 1);
  const auto add = [&](const Eigen::Vector3d& tip_m) {
    move.along_m.push_back((tip_m - its.from_m).dot(way_m) / move.length_m);
    move.away_m.push_back((tip_m - its.to_m).norm());
  };
  add(first == 0 ? its.from_m : tips_m[first - 1]);
  std::ranges::for_each(tips_m.subspan(first, steps), add);
  return move;
}

double calc_overshoot(const TipMove& move) {
  return std::max(0.0, std::ranges::max(move.along_m) - move.length_m) / move.length_m;
}

double calc_rise_time_s(const TipMove& move) {
  constexpr double kBegin = 0.1;
  constexpr double kEnd = 0.9;
  const auto end_s = find_first_time_s(move, kEnd * move.length_m);
  // A tip that reaches 90 % has reached 10 % before or at the same time.
  return end_s ? *end_s - *find_first_time_s(move, kBegin * move.length_m) : calc_end_s(move);
}

double calc_settling_time_s(const TipMove& move, double band_m) {
  const std::vector<double>& away_m = move.away_m;
  const auto outside = std::find_if(away_m.rbegin(), away_m.rend(),
                                    [&](double value_m) { return !(value_m <= band_m); });
  if (outside == away_m.rend()) {
    return 0;
  }
  if (outside == away_m.rbegin()) {
    return calc_end_s(move) - move.arrival_s;
  }
  const auto k = static_cast<double>(away_m.rend() - outside - 1);
  const double inside_m = *(outside - 1);
  const double settled_s = (k + (*outside - band_m) / (*outside - inside_m)) * move.period_s;
  return std::max(0.0, settled_s - move.arrival_s);
}

void MotionErrors::add(const MotionErrors& other) {
  moving_squares_m2 += other.moving_squares_m2;
  moving_periods += other.moving_periods;
  moving_peak_m = std::max(moving_peak_m, other.moving_peak_m);
  if (other.start_up_m) {
    start_up_m = std::max(start_up_m.value_or(0), *other.start_up_m);
  }
}

std::optional<MotionSummary> MotionErrors::summarize() const {
  if (moving_periods == 0) {
    return std::nullopt;
  }
  const double rms_m = std::sqrt(moving_squares_m2 / static_cast<double>(moving_periods));
  return MotionSummary{
      .moving_rms_m = rms_m, .moving_peak_m = moving_peak_m, .start_up_m = start_up_m};
}

MotionErrors measure_motion(const TrackingTask& task, const TargetTable& targets,
                            std::span<const double> errors_m) {
  MotionErrors errors;
  for (std::size_t k = 0; k < targets.segments.size(); ++k) {
    const Segment& segment = targets.segments[k];
    const auto own = errors_m.subspan(static_cast<std::size_t>(segment.first_step),
                                      static_cast<std::size_t>(segment.steps));
    if (k == 0 && !segment.is_sample) {
      errors.start_up_m = std::ranges::max(own);
    }
    if (k == 0 && !task.count_first_point) {
      continue;
    }
    const auto moving =
        segment.is_sample ? own : own.first(static_cast<std::size_t>(segment.window_start));
    for (const double error_m : moving) {
      errors.moving_squares_m2 += error_m * error_m;
      errors.moving_peak_m = std::max(errors.moving_peak_m, error_m);
    }
    errors.moving_periods += moving.size();
  }
  return errors;
}

std::vector<double> calc_joint_speeds(const RobotModel& robot, const TargetTable& targets,
                                      const TrackingResult& result, double period_s) {
  std::vector<double> speeds(targets.joints);
  for_each_speed(robot, targets, result, period_s, [&](std::size_t joint, double speed) {
    speeds[joint] = std::max(speeds[joint], std::abs(speed));
  });
  return speeds;
}

double calc_jerk_integral(const RobotModel& robot, const TargetTable& targets,
                          const TrackingResult& result, double period_s) {
  std::vector<double> last(targets.joints), last_change(targets.joints);
  double sum = 0;
  for_each_speed(robot, targets, result, period_s, [&](std::size_t joint, double speed) {
    const double change = speed - last[joint];
    const double jerk = (change - last_change[joint]) / (period_s * period_s);
    sum += jerk * jerk * period_s;
    last[joint] = speed;
    last_change[joint] = change;
  });
  return sum;
}

}  // namespace armwright
