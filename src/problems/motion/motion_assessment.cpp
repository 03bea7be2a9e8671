// Makes the motion of a decision vector and measures it.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/text.hpp"
#include "problems/motion/motion_problem.hpp"
#include "sim/dynamics/arm_equations.hpp"
#include "sim/dynamics/joint_effort.hpp"
#include "sim/kinematics/kinematics.hpp"

namespace armwright {
namespace {

using Eigen::Index;

constexpr std::size_t kBoundIntervals = 400;

}  // namespace

std::shared_ptr<const RobotModel> MotionProblem::make_arm(std::span<const double> x,
                                                          std::vector<Tube>& tubes) const {
  if (!changes_arm()) {
    return robot_;
  }
  RobotModel robot = *robot_;
  const ArmTubes& its = config_.tubes;
  tubes = its.tubes;
  const std::size_t numbers = tubes.size() * ((its.length_m ? 1U : 0U) +
                                              (its.diameter_m ? 1U : 0U) + (its.wall_m ? 1U : 0U));
  const double* next = x.data() + (x.size() - numbers);
  for (std::size_t link = 0; link < tubes.size(); ++link) {
    if (its.length_m) {
      Eigen::Isometry3d& end = get_link_end(robot, link);
      end.translation() *= *next++ / end.translation().norm();
    }
    tubes[link].diameter_m = its.diameter_m ? *next++ : tubes[link].diameter_m;
    tubes[link].wall_m = its.wall_m ? *next++ : tubes[link].wall_m;
  }
  for (std::size_t link = 0; link < tubes.size(); ++link) {
    make_tube(robot, link, tubes[link], its.material);
  }
  return std::make_shared<const RobotModel>(std::move(robot));
}

// Finds the joint positions of all points. Without a decision vector, free points get positions
// between their neighbours.
bool MotionProblem::find_points(const RobotModel& robot, std::span<const double> x,
                                Eigen::MatrixXd& points, std::string& reason) const {
  const auto n = static_cast<Index>(robot.joint_count());
  const auto count = static_cast<Index>(config_.points.size());
  points.resize(n, count);
  std::unique_ptr<NumericKinematics> position, pose;
  const double* next = x.data() + (config_.intervals_s.empty() ? count_intervals() : 0);
  for (Index k = 0; k < count; ++k) {
    const MotionPoint& point = config_.points[static_cast<std::size_t>(k)];
    if (point.q) {
      points.col(k) = *point.q;
    } else if (point.tool) {
      std::unique_ptr<NumericKinematics>& kinematics = point.has_turn ? pose : position;
      if (!kinematics) {
        ToolTask tool;
        tool.orientation = point.has_turn ? ToolOrientation::pose : ToolOrientation::free;
        kinematics =
            std::make_unique<NumericKinematics>(robot, tool, config_.home, config_.limits_range);
      }
      // The search begins at home, or at the given point before, so that the arm keeps its form.
      const bool follows = config_.home.empty() && k > 0;
      const Eigen::VectorXd from =
          follows ? Eigen::VectorXd(points.col(k - 1))
                  : Eigen::Map<const Eigen::VectorXd>(kinematics->home().data(), n);
      NumericKinematics::Approach search = kinematics->make_search(
          *point.tool, std::span<const double>(from.data(), static_cast<std::size_t>(n)));
      NumericKinematics::Approach* const searches[] = {&search};
      kinematics->approach(searches);
      std::vector<double> q(search.q.begin(), search.q.end());
      if (!search.reached && !kinematics->find(*point.tool, q)) {
        const Eigen::Vector3d& at_m = point.tool->position_m;
        reason =
            fmt::format("point {}: the arm cannot reach the tool's {} ({:g}, {:g}, {:g}) m", k + 1,
                        point.has_turn ? "pose at" : "position", at_m.x(), at_m.y(), at_m.z());
        return false;
      }
      points.col(k) = Eigen::Map<const Eigen::VectorXd>(q.data(), n);
    } else if (x.empty()) {
      points.col(k).setConstant(std::numeric_limits<double>::quiet_NaN());
    } else {
      points.col(k) = Eigen::Map<const Eigen::VectorXd>(next, n);
      next += n;
    }
  }
  for (Index k = 1; x.empty() && k + 1 < count; ++k) {
    if (std::isnan(points(0, k))) {
      Index end = k;
      while (std::isnan(points(0, end))) {
        ++end;
      }
      points.col(k) = points.col(k - 1) +
                      (points.col(end) - points.col(k - 1)) / static_cast<double>(end - k + 1);
    }
  }
  return true;
}

std::vector<std::vector<PathPlace>> MotionProblem::trace_lines(const RobotModel& robot,
                                                               const Eigen::MatrixXd& points,
                                                               std::string& reason) const {
  std::vector<std::vector<PathPlace>> paths;
  const auto places = static_cast<Index>(config_.samples);
  const std::vector<double> still(robot.joint_count(), 0);
  for (std::size_t k = 0; k + 1 < config_.points.size(); ++k) {
    const MotionPoint &from = config_.points[k], &to = config_.points[k + 1];
    const bool has_turn = from.has_turn && to.has_turn;
    ToolTask tool;
    tool.orientation = has_turn ? ToolOrientation::pose : ToolOrientation::free;
    const NumericKinematics kinematics(robot, tool, config_.home, config_.limits_range);
    Eigen::MatrixXd positions(points.rows(), places);
    positions.col(0) = points.col(static_cast<Index>(k));
    const Eigen::Quaterniond first(from.tool->turn), last(to.tool->turn);
    for (Index i = 1; i < places; ++i) {
      const double s = static_cast<double>(i) / static_cast<double>(places - 1);
      const ToolPose target{.position_m = (1 - s) * from.tool->position_m + s * to.tool->position_m,
                            .turn = first.slerp(s, last).toRotationMatrix()};
      positions.col(i) = positions.col(i - 1);
      if (!kinematics.follow(target, still, {positions.col(i).data(), robot.joint_count()})) {
        reason = fmt::format(
            "between points {} and {}: the arm cannot follow the straight line, it fails at "
            "({:.4g}, {:.4g}, {:.4g}) m; choose points without a singular posture or the end of a "
            "range between them",
            k + 1, k + 2, target.position_m.x(), target.position_m.y(), target.position_m.z());
        return {};
      }
    }
    paths.push_back(sample_path(positions));
  }
  return paths;
}

std::vector<LeastTime> MotionProblem::time_lines(const RobotModel& robot,
                                                 std::span<const std::vector<PathPlace>> paths,
                                                 const JointLimits& limits,
                                                 std::string& reason) const {
  std::vector<LeastTime> times;
  for (std::size_t k = 0; k < paths.size(); ++k) {
    times.push_back(calc_least_time(robot, config_.gravity_m_per_s2, paths[k], limits));
    if (const auto place = times.back().stuck_place) {
      reason = fmt::format(
          "between points {} and {}: no speed suits the line at {:.3g} % of it; "
          "joint '{}' cannot hold the arm there within {:.4g} {}",
          k + 1, k + 2,
          100 * static_cast<double>(*place) / static_cast<double>(paths[k].size() - 1),
          robot.joints[times.back().stuck_joint].name, limits.effort[times.back().stuck_joint],
          get_effort_unit(robot.joints[times.back().stuck_joint].kind));
      return {};
    }
  }
  return times;
}

std::optional<MotionCurve> MotionProblem::make_curve(const RobotModel& robot,
                                                     const Eigen::MatrixXd& points,
                                                     std::span<const double> x,
                                                     std::string& reason) const {
  if (!is_line()) {
    return MotionCurve(
        config_.form, points,
        config_.intervals_s.empty() ? x.first(count_intervals()) : std::span(config_.intervals_s));
  }
  std::vector<std::vector<PathPlace>> own;
  if (changes_arm()) {
    own = trace_lines(robot, points, reason);
  }
  const std::vector<std::vector<PathPlace>>& paths = changes_arm() ? own : lines_;
  JointLimits limits = config_.limits;
  for (std::size_t joint = 0; joint < limits.effort.size(); ++joint) {
    limits.effort[joint] *= x[joint];
  }
  const std::vector<LeastTime> times = time_lines(robot, paths, limits, reason);
  if (times.empty()) {
    return std::nullopt;
  }
  return make_fastest_motion(paths, times);
}

std::optional<AssessedPlan> MotionProblem::assess(std::span<const double> x, std::size_t samples,
                                                  std::string& reason) const {
  std::vector<Tube> tubes;
  std::shared_ptr<const RobotModel> robot = make_arm(x, tubes);
  Eigen::MatrixXd points;
  if (!find_points(*robot, x, points, reason)) {
    return std::nullopt;
  }
  std::optional<MotionCurve> curve = make_curve(*robot, points, x, reason);
  if (!curve) {
    return std::nullopt;
  }
  AssessedPlan plan{.curve = *std::move(curve),
                    .robot = std::move(robot),
                    .times_s = {},
                    .efforts = {},
                    .quantities = std::vector<double>(kMotionQuantities, 0),
                    .constraints = {},
                    .nearest = {},
                    .nearest_s = 0};
  plan.times_s =
      Eigen::VectorXd::LinSpaced(static_cast<Index>(samples), 0, plan.curve.duration_s());
  measure(tubes, plan);
  make_constraints(plan);
  return plan;
}

void MotionProblem::measure(std::span<const Tube> tubes, AssessedPlan& plan) const {
  const std::size_t n = plan.robot->joint_count();
  const auto columns = static_cast<Index>(n);
  plan.quantity(MotionQuantity::duration) = plan.curve.duration_s();
  for (std::size_t joint = 0; joint < n; ++joint) {
    plan.quantity(MotionQuantity::jerk) += plan.curve.calc_jerk_integral(joint);
  }
  std::optional<articulated::ChainModel> own;
  if (changes_arm()) {
    own.emplace(*plan.robot, config_.gravity_m_per_s2);
    std::vector<double> lengths_m;
    for (std::size_t link = 0; link < n; ++link) {
      lengths_m.push_back(get_link_length_m(*plan.robot, link));
    }
    plan.quantity(MotionQuantity::deflection) = calc_deflection_m(
        tubes, lengths_m, config_.tubes.material,
        plan.robot->payload ? plan.robot->payload->mass_kg : 0, config_.gravity_m_per_s2);
  }
  articulated::ArmEquations equations(own ? *own : *chain_);
  const Index samples = plan.times_s.size();
  plan.efforts.resize(samples, columns);
  std::vector<double> q(n), rate(n), acceleration(n);
  Eigen::VectorXd power = Eigen::VectorXd::Zero(samples);
  double fastest = 0;
  plan.nearest.distance_m = std::numeric_limits<double>::infinity();
  for (Index sample = 0; sample < samples; ++sample) {
    const double t = plan.times_s[sample];
    plan.curve.calc(t, 0, q);
    plan.curve.calc(t, 1, rate);
    plan.curve.calc(t, 2, acceleration);
    equations.set(q, rate);
    for (std::size_t i = 0; i < n; ++i) {
      const Joint& joint = plan.robot->joints[i];
      double effort = equations.calc_effort(i, acceleration);
      if (!joint.plant.is_ideal()) {
        effort += articulated::calc_plant_effort(joint, q[i], rate[i], acceleration[i]);
      }
      plan.efforts(sample, static_cast<Index>(i)) = effort;
      power[sample] += std::max(0.0, effort * rate[i]);
    }
    const std::vector<Eigen::Isometry3d> poses = calc_link_poses(*plan.robot, q);
    const Eigen::Vector3d tip = poses.back() * plan.robot->tip_pose.translation();
    Eigen::Vector3d speed = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < n; ++i) {
      const Joint& joint = plan.robot->joints[i];
      const Eigen::Vector3d axis = poses[i].linear() * joint.axis;
      speed += rate[i] * (joint.kind == JointKind::prismatic
                              ? axis
                              : Eigen::Vector3d(axis.cross(tip - poses[i].translation())));
    }
    fastest = std::max(fastest, speed.norm());
    if (config_.clearance) {
      const ArmClearance::Nearest nearest = config_.clearance->find_nearest(poses);
      if (nearest.distance_m < plan.nearest.distance_m) {
        plan.nearest = nearest;
        plan.nearest_s = t;
      }
    }
  }
  const double step_s = plan.curve.duration_s() / static_cast<double>(samples - 1);
  plan.quantity(MotionQuantity::energy) =
      step_s * (power.sum() - (power[0] + power[samples - 1]) / 2);
  plan.quantity(MotionQuantity::peak_torque) = plan.efforts.cwiseAbs().colwise().maxCoeff().sum();
  plan.quantity(MotionQuantity::rms_torque) =
      (plan.efforts.cwiseAbs2().colwise().sum() / static_cast<double>(samples)).cwiseSqrt().sum();
  plan.quantity(MotionQuantity::clearance) = plan.nearest.distance_m;
  plan.quantity(MotionQuantity::tool_speed) = fastest;
}

void MotionProblem::make_constraints(AssessedPlan& plan) const {
  const JointLimits& limits = config_.limits;
  for (std::size_t i = 0; i < plan.robot->joint_count(); ++i) {
    const Joint& joint = plan.robot->joints[i];
    if (config_.limits_range && std::isfinite(joint.upper - joint.lower)) {
      const MotionCurve::Peak peak = plan.curve.find_peak(i, 0);
      const double middle = (joint.lower + joint.upper) / 2;
      const double half = (joint.upper - joint.lower) / 2;
      plan.constraints.push_back(std::max(peak.upper - middle, middle - peak.lower) / half - 1);
    }
    if (is_line()) {
      continue;
    }
    int order = 1;
    for (const std::vector<double>* limit : {&limits.speed, &limits.acceleration, &limits.jerk}) {
      if (std::isfinite((*limit)[i])) {
        plan.constraints.push_back(plan.curve.find_peak(i, order).magnitude() / (*limit)[i] - 1);
      }
      ++order;
    }
    if (std::isfinite(limits.effort[i])) {
      plan.constraints.push_back(
          plan.efforts.col(static_cast<Index>(i)).cwiseAbs().maxCoeff() / limits.effort[i] - 1);
    }
  }
  if (config_.tool_speed_limit_m_per_s) {
    plan.constraints.push_back(
        plan.quantity(MotionQuantity::tool_speed) / *config_.tool_speed_limit_m_per_s - 1);
  }
  if (config_.least_clearance_m) {
    plan.constraints.push_back((*config_.least_clearance_m - plan.nearest.distance_m) /
                               arm_length_m_);
  }
  if (config_.tubes.deflection_limit_m) {
    plan.constraints.push_back(
        plan.quantity(MotionQuantity::deflection) / *config_.tubes.deflection_limit_m - 1);
  }
}

std::optional<double> MotionProblem::calc_bound(const AssessedPlan& plan) const {
  // A motion that rests at its points is one path per interval, or per line.
  std::vector<double> rests = {0, plan.curve.duration_s()};
  if (config_.form.kind == CurveKind::rest) {
    rests = plan.curve.knots_s();
  } else if (is_line()) {
    const std::vector<double>& knots_s = plan.curve.knots_s();
    rests.clear();
    for (std::size_t i = 0; i < knots_s.size(); i += config_.samples - 1) {
      rests.push_back(knots_s[i]);
    }
  }
  double sum_s = 0;
  for (std::size_t i = 0; i + 1 < rests.size(); ++i) {
    const LeastTime least = calc_least_time(
        *plan.robot, config_.gravity_m_per_s2,
        measure_path(plan.curve, rests[i], rests[i + 1], kBoundIntervals), config_.limits);
    if (least.stuck_place || least.duration_s == 0) {
      return std::nullopt;
    }
    sum_s += least.duration_s;
  }
  return sum_s;
}

MotionSamples MotionProblem::sample(const AssessedPlan& plan) const {
  const auto n = static_cast<Index>(plan.robot->joint_count());
  MotionSamples samples{.times_s = {plan.times_s.begin(), plan.times_s.end()}, .positions = {}};
  Eigen::MatrixXd* const parts[] = {&samples.positions, &samples.rates, &samples.accelerations};
  std::vector<double> values(plan.robot->joint_count());
  for (int order = 0; order < 3; ++order) {
    parts[order]->resize(plan.times_s.size(), n);
    for (Index k = 0; k < plan.times_s.size(); ++k) {
      plan.curve.calc(plan.times_s[k], order, values);
      parts[order]->row(k) = Eigen::Map<const Eigen::RowVectorXd>(values.data(), n);
    }
  }
  return samples;
}

}  // namespace armwright
