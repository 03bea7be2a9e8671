#include "problems/motion/motion_problem.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.hpp"
#include "base/text.hpp"
#include "problems/interface/add_outcome.hpp"
#include "sim/dynamics/arm_equations.hpp"
#include "sim/dynamics/joint_effort.hpp"
#include "sim/kinematics/floor_clearance.hpp"
#include "sim/kinematics/kinematics.hpp"

namespace armwright {
namespace {

using Eigen::Index;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// What an evaluation without a number counts, in units of the objective at the start.
constexpr double kPenalty = 1e3;
// A violation of one limit by 1 then outweighs what a motion can gain by it: the duration falls at
// most in proportion to a limit.
constexpr double kViolation = 10;
// Of the start's intervals, on the time that the joints' speed limits ask for.
constexpr double kStartSlowness = 2;
constexpr std::size_t kBoundIntervals = 400;

const char* get_length_unit(const Joint& joint) {
  return joint.kind == JointKind::revolute ? "rad" : "m";
}

double& at(std::vector<double>& quantities, MotionQuantity quantity) {
  return quantities[static_cast<std::size_t>(quantity)];
}

Quantity describe_quantity(MotionQuantity quantity) {
  switch (quantity) {
    case MotionQuantity::duration:
      return {"duration", "s"};
    case MotionQuantity::jerk:
      return {"jerk", "rad^2/s^5"};
    case MotionQuantity::energy:
      return {"energy", "J"};
    case MotionQuantity::peak_torque:
      return {"peak torque", "N m"};
    case MotionQuantity::rms_torque:
      return {"rms torque", "N m"};
    case MotionQuantity::clearance:
      return {"clearance", "m"};
    case MotionQuantity::deflection:
      return {"deflection", "m"};
    case MotionQuantity::tool_speed:
      break;
  }
  return {"tool speed", "m/s"};
}

}  // namespace

const std::vector<std::string>& motion_quantity_names() {
  static const std::vector<std::string> names = {"duration",    "jerk",       "energy",
                                                 "peak_torque", "rms_torque", "clearance",
                                                 "deflection",  "tool_speed"};
  return names;
}

MotionProblem::MotionProblem(MotionConfig config) : config_(std::move(config)) {
  arm_length_m_ = calc_arm_length_m(config_.robot);
  if (!changes_arm()) {
    chain_ = std::make_shared<articulated::ChainModel>(config_.robot, config_.gravity_m_per_s2);
  }
  description_.name = config_.name;
  description_.summary = config_.summary;
  description_.cost_unit = "motion";
  description_.has_single_case = true;
  std::vector<double> weights;
  std::vector<std::string> names;
  for (const MotionTerm& term : config_.objective) {
    Quantity quantity = describe_quantity(term.quantity);
    names.push_back(quantity.name);
    if (term.quantity == MotionQuantity::clearance) {
      quantity.name = "negative clearance";
    }
    description_.objectives.push_back(quantity);
    weights.push_back(term.weight / term.scale);
  }
  const bool is_plain = config_.objective.size() == 1 && weights[0] == 1;
  if (config_.is_front) {
    description_.objective_weights = weights;
  } else if (!is_plain) {
    description_.objectives = {{join(names, " and "), "1"}};
  }
  for (std::size_t i = 0; i < kMotionQuantities; ++i) {
    const auto quantity = static_cast<MotionQuantity>(i);
    if ((quantity == MotionQuantity::clearance && !config_.clearance) ||
        (quantity == MotionQuantity::deflection && !changes_arm())) {
      continue;
    }
    description_.metrics.push_back(describe_quantity(quantity));
  }
  const JointLimits& limits = config_.limits;
  for (std::size_t i = 0; i < config_.robot.joint_count(); ++i) {
    const Joint& joint = config_.robot.joints[i];
    const auto add = [&](const char* kind, double limit) {
      if (std::isfinite(limit)) {
        description_.constraints.push_back({fmt::format("{}.{}", joint.name, kind), ""});
      }
    };
    add("range", config_.limits_range ? joint.upper - joint.lower : kInfinity);
    add("speed", limits.speed[i]);
    add("acceleration", limits.acceleration[i]);
    add("jerk", limits.jerk[i]);
    add("effort", limits.effort[i]);
  }
  for (const auto& [name, limit] : {std::pair{"tool_speed", config_.tool_speed_limit_m_per_s},
                                    std::pair{"clearance", config_.least_clearance_m},
                                    std::pair{"deflection", config_.deflection_limit_m}}) {
    if (limit) {
      description_.constraints.push_back({name, ""});
    }
  }
  // Without variables for the arm and the points, the points of the start are those of every motion.
  std::vector<Tube> tubes;
  const RobotModel arm = config_.robot;
  Eigen::MatrixXd points;
  std::string reason;
  if (!find_points(arm, {}, points, reason)) {
    throw Error(ErrorKind::bad_data, reason);
  }
  make_variables(points);
  const std::vector<double> start = list_starts(description_.variables);
  const auto plan = assess(start, config_.samples, reason);
  if (!plan) {
    throw Error(ErrorKind::bad_data, reason);
  }
  penalty_ = calc_objectives(plan->quantities);
  description_.violation_scale =
      kViolation * std::max(std::abs(calc_scalar(description_, penalty_)), 1e-12);
  for (double& value : penalty_) {
    value = kPenalty * std::max(std::abs(value), 1.0);
  }
}

// Makes the variables. The columns of `start` are the points, in which free ones lie on the line
// between their neighbours.
void MotionProblem::make_variables(const Eigen::MatrixXd& start) {
  auto& variables = description_.variables;
  const std::size_t intervals = count_intervals();
  for (std::size_t i = 0; config_.intervals_s.empty() && i < intervals; ++i) {
    // The points between which the interval lies; with virtual knots, two intervals share a way.
    std::size_t from = 0, to = 0;
    for (std::size_t point = 0; point < config_.points.size(); ++point) {
      const std::size_t knot = config_.form.find_knot(point, config_.points.size());
      from = knot <= i ? point : from;
      to = point > 0 && to == 0 && knot > i ? point : to;
    }
    const double share = static_cast<double>(config_.form.find_knot(to, config_.points.size()) -
                                             config_.form.find_knot(from, config_.points.size()));
    double time_s = 0;
    for (std::size_t joint = 0; joint < config_.robot.joint_count(); ++joint) {
      const auto row = static_cast<Index>(joint);
      const double way =
          std::abs(start(row, static_cast<Index>(to)) - start(row, static_cast<Index>(from)));
      const double speed = config_.limits.speed[joint];
      time_s = std::max(time_s, way / (std::isfinite(speed) ? speed : 1));
    }
    const MotionBounds& bounds = config_.interval_s;
    variables.push_back(
        {.name = fmt::format("interval_{}", i + 1),
         .unit = "s",
         .lower = bounds.lower,
         .upper = bounds.upper,
         .start = std::clamp(kStartSlowness * time_s / share, bounds.lower, bounds.upper),
         .scale = Scale::logarithmic});
  }
  for (std::size_t point = 0; point < config_.points.size(); ++point) {
    if (config_.points[point].q || config_.points[point].tool) {
      continue;
    }
    for (std::size_t joint = 0; joint < config_.robot.joint_count(); ++joint) {
      const Joint& its = config_.robot.joints[joint];
      const bool has_range = std::isfinite(its.upper - its.lower);
      constexpr double kTurn = 3.141592653589793;  // of joints without a range
      const double lower = has_range ? its.lower : -kTurn, upper = has_range ? its.upper : kTurn;
      variables.push_back(
          {.name = fmt::format("point_{}.{}", point + 1, its.name),
           .unit = get_length_unit(its),
           .lower = lower,
           .upper = upper,
           .start = std::clamp(start(static_cast<Index>(joint), static_cast<Index>(point)), lower,
                               upper)});
    }
  }
  const MotionTubes& tubes = config_.tubes;
  for (std::size_t link = 0; link < tubes.tubes.size(); ++link) {
    const auto add = [&](const char* what, const std::optional<MotionBounds>& bounds,
                         double value) {
      if (bounds) {
        variables.push_back({.name = fmt::format("{}.{}", config_.robot.links[link].name, what),
                             .unit = "m",
                             .lower = bounds->lower,
                             .upper = bounds->upper,
                             .start = std::clamp(value, bounds->lower, bounds->upper)});
      }
    };
    add("length", tubes.length_m, get_link_length_m(config_.robot, link));
    add("diameter", tubes.diameter_m, tubes.tubes[link].diameter_m);
    add("wall", tubes.wall_m, tubes.tubes[link].wall_m);
  }
}

RobotModel MotionProblem::make_arm(std::span<const double> x, std::vector<Tube>& tubes) const {
  RobotModel robot = config_.robot;
  const MotionTubes& its = config_.tubes;
  tubes = its.tubes;
  const std::size_t numbers = tubes.size() * ((its.length_m ? 1U : 0U) +
                                              (its.diameter_m ? 1U : 0U) + (its.wall_m ? 1U : 0U));
  const double* next = x.data() + (x.size() - numbers);
  for (std::size_t link = 0; link < tubes.size(); ++link) {
    if (its.length_m) {
      const bool is_last = link + 1 == robot.joint_count();
      Eigen::Isometry3d& end = is_last ? robot.tip_pose : robot.joints[link + 1].origin;
      end.translation() *= *next++ / end.translation().norm();
    }
    tubes[link].diameter_m = its.diameter_m ? *next++ : tubes[link].diameter_m;
    tubes[link].wall_m = its.wall_m ? *next++ : tubes[link].wall_m;
  }
  for (std::size_t link = 0; link < tubes.size(); ++link) {
    // A wall of more than the radius is a bar; the wall's constraint says how far it is off.
    Tube made = tubes[link];
    made.wall_m = std::min(made.wall_m, made.diameter_m / 2);
    make_tube(robot, link, made, its.material);
  }
  return robot;
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

std::optional<AssessedPlan> MotionProblem::assess(std::span<const double> x, std::size_t samples,
                                                  std::string& reason) const {
  std::vector<Tube> tubes;
  RobotModel robot = changes_arm() ? make_arm(x, tubes) : config_.robot;
  Eigen::MatrixXd points;
  if (!find_points(robot, x, points, reason)) {
    return std::nullopt;
  }
  const std::size_t intervals = count_intervals();
  const std::span<const double> times =
      config_.intervals_s.empty() ? x.first(intervals) : std::span(config_.intervals_s);
  AssessedPlan plan{.curve = MotionCurve(config_.form, points, times),
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
  const std::size_t n = plan.robot.joint_count();
  const auto columns = static_cast<Index>(n);
  std::vector<double>& quantities = plan.quantities;
  at(quantities, MotionQuantity::duration) = plan.curve.duration_s();
  for (std::size_t joint = 0; joint < n; ++joint) {
    at(quantities, MotionQuantity::jerk) += plan.curve.calc_jerk_integral(joint);
  }
  std::optional<articulated::ChainModel> own;
  if (changes_arm()) {
    own.emplace(plan.robot, config_.gravity_m_per_s2);
    std::vector<double> lengths_m;
    for (std::size_t link = 0; link < n; ++link) {
      lengths_m.push_back(get_link_length_m(plan.robot, link));
    }
    at(quantities, MotionQuantity::deflection) = calc_deflection_m(
        tubes, lengths_m, config_.tubes.material,
        plan.robot.payload ? plan.robot.payload->mass_kg : 0, config_.gravity_m_per_s2);
  }
  articulated::ArmEquations equations(own ? *own : *chain_);
  const Index samples = plan.times_s.size();
  plan.efforts.resize(samples, columns);
  std::vector<double> q(n), rate(n), acceleration(n);
  Eigen::VectorXd power = Eigen::VectorXd::Zero(samples);
  double fastest = 0;
  plan.nearest.distance_m = kInfinity;
  for (Index sample = 0; sample < samples; ++sample) {
    const double t = plan.times_s[sample];
    plan.curve.calc(t, 0, q);
    plan.curve.calc(t, 1, rate);
    plan.curve.calc(t, 2, acceleration);
    equations.set(q, rate);
    for (std::size_t i = 0; i < n; ++i) {
      const Joint& joint = plan.robot.joints[i];
      double effort = equations.bias(i);
      for (std::size_t k = 0; k < n; ++k) {
        effort += equations.mass(i, k) * acceleration[k];
      }
      if (!joint.plant.is_ideal()) {
        effort += joint.plant.armature * acceleration[i] + joint.plant.offset +
                  articulated::calc_friction_chord(joint.plant, rate[i]) * rate[i] -
                  articulated::calc_counterbalance(joint, q[i]);
      }
      plan.efforts(sample, static_cast<Index>(i)) = effort;
      power[sample] += std::max(0.0, effort * rate[i]);
    }
    const std::vector<Eigen::Isometry3d> poses = calc_link_poses(plan.robot, q);
    const Eigen::Vector3d tip = poses.back() * plan.robot.tip_pose.translation();
    Eigen::Vector3d speed = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < n; ++i) {
      const Joint& joint = plan.robot.joints[i];
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
  at(quantities, MotionQuantity::energy) =
      step_s * (power.sum() - (power[0] + power[samples - 1]) / 2);
  at(quantities, MotionQuantity::peak_torque) = plan.efforts.cwiseAbs().colwise().maxCoeff().sum();
  at(quantities, MotionQuantity::rms_torque) =
      (plan.efforts.cwiseAbs2().colwise().sum() / static_cast<double>(samples)).cwiseSqrt().sum();
  at(quantities, MotionQuantity::clearance) = plan.nearest.distance_m;
  at(quantities, MotionQuantity::tool_speed) = fastest;
}

void MotionProblem::make_constraints(AssessedPlan& plan) const {
  const JointLimits& limits = config_.limits;
  for (std::size_t i = 0; i < plan.robot.joint_count(); ++i) {
    const Joint& joint = plan.robot.joints[i];
    if (config_.limits_range && std::isfinite(joint.upper - joint.lower)) {
      const MotionCurve::Peak peak = plan.curve.find_peak(i, 0);
      const double middle = (joint.lower + joint.upper) / 2;
      const double half = (joint.upper - joint.lower) / 2;
      plan.constraints.push_back(std::max(peak.upper - middle, middle - peak.lower) / half - 1);
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
        at(plan.quantities, MotionQuantity::tool_speed) / *config_.tool_speed_limit_m_per_s - 1);
  }
  if (config_.least_clearance_m) {
    plan.constraints.push_back((*config_.least_clearance_m - plan.nearest.distance_m) /
                               arm_length_m_);
  }
  if (config_.deflection_limit_m) {
    plan.constraints.push_back(
        at(plan.quantities, MotionQuantity::deflection) / *config_.deflection_limit_m - 1);
  }
}

std::vector<double> MotionProblem::calc_objectives(std::span<const double> quantities) const {
  std::vector<double> objectives;
  double sum = 0;
  for (const MotionTerm& term : config_.objective) {
    const double sign = term.quantity == MotionQuantity::clearance ? -1 : 1;
    const double value = sign * quantities[static_cast<std::size_t>(term.quantity)];
    objectives.push_back(value);
    sum += term.weight * value / term.scale;
  }
  return config_.is_front ? objectives : std::vector<double>{sum};
}

std::vector<CaseOutcome> MotionProblem::simulate(std::span<const CaseJob> jobs) const {
  std::vector<CaseOutcome> outcomes(jobs.size());
  for (std::size_t job = 0; job < jobs.size(); ++job) {
    CaseOutcome& outcome = outcomes[job];
    const auto plan = assess(jobs[job].x, config_.samples, outcome.reason);
    if (!plan) {
      outcome.status = EvaluationStatus::unreachable;
      outcome.has_error = false;
      continue;
    }
    outcome.error = calc_scalar(description_, calc_objectives(plan->quantities));
    outcome.metrics = plan->quantities;
    outcome.metrics.insert(outcome.metrics.end(), plan->constraints.begin(),
                           plan->constraints.end());
    const auto is_number = [](double value) { return std::isfinite(value); };
    const bool clear = !config_.clearance || is_number(plan->nearest.distance_m);
    if (!config_.clearance) {
      at(outcome.metrics, MotionQuantity::clearance) = 0;
    }
    if (!is_number(outcome.error) || !clear || !std::ranges::all_of(outcome.metrics, is_number)) {
      outcome = {};
      outcome.status = EvaluationStatus::diverged;
      outcome.reason = "the motion needs efforts without bound";
      outcome.has_error = false;
    }
  }
  return outcomes;
}

Evaluation MotionProblem::aggregate(std::span<const double> /*x*/,
                                    std::span<const CaseOutcome> outcomes) const {
  Evaluation evaluation;
  for (const CaseOutcome& outcome : outcomes) {  // all are the same
    if (add_outcome(outcome, evaluation) && evaluation.objectives.empty()) {
      const std::span<const double> numbers(outcome.metrics);
      evaluation.objectives = calc_objectives(numbers.first(kMotionQuantities));
      const auto constraints = numbers.subspan(kMotionQuantities);
      evaluation.constraint_values.assign(constraints.begin(), constraints.end());
      for (std::size_t i = 0; i < kMotionQuantities; ++i) {
        const auto quantity = static_cast<MotionQuantity>(i);
        if ((quantity != MotionQuantity::clearance || config_.clearance) &&
            (quantity != MotionQuantity::deflection || changes_arm())) {
          evaluation.metrics.push_back(numbers[i]);
        }
      }
    }
  }
  return evaluation;
}

std::vector<double> MotionProblem::penalty_objectives() const {
  return penalty_;
}

std::optional<double> MotionProblem::calc_bound(const AssessedPlan& plan) const {
  // A motion that rests at its points is one path per interval.
  std::vector<double> rests = {0, plan.curve.duration_s()};
  if (config_.form.kind == CurveKind::rest) {
    rests = plan.curve.knots_s();
  }
  double sum_s = 0;
  for (std::size_t i = 0; i + 1 < rests.size(); ++i) {
    const LeastTime least = calc_least_time(
        plan.robot, config_.gravity_m_per_s2,
        measure_path(plan.curve, rests[i], rests[i + 1], kBoundIntervals), config_.limits);
    if (least.stuck_place || least.duration_s == 0) {
      return std::nullopt;
    }
    sum_s += least.duration_s;
  }
  return sum_s;
}

CaseRecord MotionProblem::record_case(std::span<const double> x, const CaseBlock& /*block*/,
                                      std::uint64_t /*number*/) const {
  std::string reason;
  const auto plan = assess(x, config_.samples, reason);
  if (!plan) {
    throw Error(ErrorKind::bad_data, reason);
  }
  CaseRecord record;
  record.abscissa = {"time", "s"};
  record.abscissa_values.assign(plan->times_s.begin(), plan->times_s.end());
  const std::size_t n = plan->robot.joint_count();
  std::vector<double> values(n);
  const char* const kinds[] = {"position", "speed", "acceleration", "jerk"};
  const char* const per[] = {"", "/s", "/s2", "/s3"};
  for (std::size_t joint = 0; joint < n; ++joint) {
    const Joint& its = plan->robot.joints[joint];
    for (int order = 0; order < 4; ++order) {
      CaseRecord::Series series{{fmt::format("{} {}", its.name, kinds[order]),
                                 fmt::format("{}{}", get_length_unit(its), per[order])},
                                {}};
      for (const double t : plan->times_s) {
        plan->curve.calc(t, order, values);
        series.values.push_back(values[joint]);
      }
      record.series.push_back(std::move(series));
    }
    const auto efforts = plan->efforts.col(static_cast<Index>(joint));
    record.series.push_back({{its.name + " effort", get_effort_unit(its.kind)},
                             std::vector<double>(efforts.begin(), efforts.end())});
  }
  const MotionSamples samples = sample(*plan);
  record.files = {{"motion.csv", write_motion_csv(plan->robot, samples, plan->efforts)},
                  {"trajectory.yaml", write_joint_trajectory(plan->robot, samples)}};
  return record;
}

MotionSamples MotionProblem::sample(const AssessedPlan& plan) const {
  const auto n = static_cast<Index>(plan.robot.joint_count());
  MotionSamples samples{.times_s = {plan.times_s.begin(), plan.times_s.end()}, .positions = {}};
  Eigen::MatrixXd* const parts[] = {&samples.positions, &samples.rates, &samples.accelerations};
  std::vector<double> values(plan.robot.joint_count());
  for (int order = 0; order < 3; ++order) {
    parts[order]->resize(plan.times_s.size(), n);
    for (Index k = 0; k < plan.times_s.size(); ++k) {
      plan.curve.calc(plan.times_s[k], order, values);
      parts[order]->row(k) = Eigen::Map<const Eigen::RowVectorXd>(values.data(), n);
    }
  }
  return samples;
}

const MotionProblem* find_motion(const Problem& problem) {
  return dynamic_cast<const MotionProblem*>(&problem);
}

}  // namespace armwright
