// Makes a test case of a motion that is given joint by joint.

#include <fmt/format.h>

#include <cmath>

#include "base/error.hpp"
#include "problems/config/problem_readers.hpp"
#include "problems/logs/motion_file.hpp"
#include "sim/kinematics/kinematics.hpp"
#include "sim/motion/motion_curve.hpp"

namespace armwright {
namespace {

// The periods of a motion whose end lies on one, up to rounding.
constexpr double kPeriodTolerance = 1e-9;

MotionCurve make_curve(const MotionSamples& motion) {
  if (motion.rates.size() > 0 && motion.accelerations.size() > 0) {
    const Eigen::MatrixXd accelerations = motion.accelerations.transpose();
    const Eigen::Index pieces = accelerations.cols() - 1;
    return {motion.times_s, motion.positions.transpose(), motion.rates.transpose(),
            accelerations.leftCols(pieces), accelerations.rightCols(pieces)};
  }
  std::vector<double> intervals_s;
  for (std::size_t k = 1; k < motion.times_s.size(); ++k) {
    intervals_s.push_back(motion.times_s[k] - motion.times_s[k - 1]);
  }
  return {CurveForm{.kind = CurveKind::cubic, .ends = SplineEnds::clamped},
          motion.positions.transpose(), intervals_s};
}

}  // namespace

TestCase read_motion_case(const std::filesystem::path& file, const RobotModel& robot,
                          const TrackingTask& task) {
  constexpr double kLongest_s = 3600;
  const MotionSamples motion = read_motion_file(file, robot);
  if (motion.times_s.back() > kLongest_s) {
    throw Error(ErrorKind::bad_data, file.string() + ": it takes more than an hour; leave a part");
  }
  // A spline of all samples takes time with their third power.
  constexpr std::size_t kMostWithoutRates = 2000;
  if (motion.accelerations.size() == 0 && motion.times_s.size() > kMostWithoutRates) {
    throw Error(ErrorKind::bad_data,
                fmt::format("{}: it has {} samples without velocities and accelerations, possible "
                            "are {}; add them, or leave out samples",
                            file.string(), motion.times_s.size(), kMostWithoutRates));
  }
  const MotionCurve curve = make_curve(motion);
  TestCase made;
  made.continuous = true;
  const double period_s = task.control_period_s;
  const auto moving = static_cast<int>(std::ceil(curve.duration_s() / period_s - kPeriodTolerance));
  const auto rest = static_cast<int>(std::ceil(task.rest_s / period_s - kPeriodTolerance));
  for (int step = 0; step <= moving + rest; ++step) {
    std::vector<double> q(robot.joint_count());
    curve.calc(step * period_s, 0, q);
    const Eigen::Isometry3d tip = calc_link_poses(robot, q).back() * robot.tip_pose;
    made.points_m.emplace_back(tip.translation());
    if (task.tool.orientation != ToolOrientation::free) {
      made.turns.emplace_back(tip.linear());
    }
    made.joints.push_back(std::move(q));
  }
  return made;
}

}  // namespace armwright
