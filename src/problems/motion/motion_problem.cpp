#include "problems/motion/motion_problem.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.hpp"
#include "base/text.hpp"
#include "problems/interface/add_outcome.hpp"
#include "sim/kinematics/floor_clearance.hpp"

namespace armwright {
namespace {

using Eigen::Index;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// The objectives of an evaluation without a number, in units of those at the start.
constexpr double kPenaltyFactor = 1e3;
// With this factor, a violation of one limit outweighs what a motion can gain by it: the duration falls
// at most in proportion to a limit.
constexpr double kViolation = 10;
// Of the start's intervals, on the time that the joints' speed limits ask for.
constexpr double kStartSlowness = 2;

const char* get_position_unit(const Joint& joint) {
  return joint.kind == JointKind::revolute ? "rad" : "m";
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

MotionProblem::MotionProblem(MotionConfig config)
    : config_(std::move(config)), robot_(std::make_shared<const RobotModel>(config_.robot)) {
  arm_length_m_ = calc_arm_length_m(config_.robot);
  if (!changes_arm()) {
    chain_ = std::make_shared<articulated::ChainModel>(*robot_, config_.gravity_m_per_s2);
  }
  description_.name = config_.name;
  description_.summary = config_.summary;
  description_.cost_unit = "motion";
  description_.has_single_case = true;
  std::vector<double> weights;
  std::vector<std::string> names;
  for (const WeightedQuantity& term : config_.objective) {
    const auto which = static_cast<MotionQuantity>(term.quantity);
    Quantity quantity = describe_quantity(which);
    names.push_back(quantity.name);
    if (which == MotionQuantity::clearance) {
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
    if (has_metric(static_cast<MotionQuantity>(i))) {
      description_.metrics.push_back(describe_quantity(static_cast<MotionQuantity>(i)));
    }
  }
  const JointLimits& limits = config_.limits;
  for (std::size_t i = 0; i < robot_->joint_count(); ++i) {
    const Joint& joint = robot_->joints[i];
    const auto add = [&](const char* kind, double limit) {
      if (std::isfinite(limit)) {
        description_.constraints.push_back({fmt::format("{}.{}", joint.name, kind), ""});
      }
    };
    add("range", config_.limits_range ? joint.upper - joint.lower : kInfinity);
    if (is_line()) {
      continue;  // its timing keeps the others
    }
    add("speed", limits.speed[i]);
    add("acceleration", limits.acceleration[i]);
    add("jerk", limits.jerk[i]);
    add("effort", limits.effort[i]);
  }
  for (const auto& [name, limit] : {std::pair{"tool_speed", config_.tool_speed_limit_m_per_s},
                                    std::pair{"clearance", config_.least_clearance_m},
                                    std::pair{"deflection", config_.tubes.deflection_limit_m}}) {
    if (limit) {
      description_.constraints.push_back({name, ""});
    }
  }
  // Without variables for the arm and the points, the points of the start are those of every motion.
  Eigen::MatrixXd points;
  std::string reason;
  if (!find_points(*robot_, {}, points, reason)) {
    throw Error(ErrorKind::bad_data, reason);
  }
  if (is_line() && !changes_arm()) {
    lines_ = trace_lines(*robot_, points, reason);
    if (lines_.empty()) {
      throw Error(ErrorKind::bad_data, reason);
    }
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
    value = kPenaltyFactor * std::max(std::abs(value), 1.0);
  }
}

// Makes the variables. The columns of `start` are the points, in which free ones lie on the line
// between their neighbours.
void MotionProblem::make_variables(const Eigen::MatrixXd& start) {
  auto& variables = description_.variables;
  const std::size_t intervals = count_intervals();
  for (std::size_t joint = 0; is_line() && joint < robot_->joint_count(); ++joint) {
    const VariableBounds& bounds = config_.effort_share;
    variables.push_back(
        {.name = robot_->joints[joint].name + ".effort_share",
         .unit = "1",
         .lower = bounds.lower,
         .upper = bounds.upper,
         .start = bounds.upper,
         .lower_widening = "the key motion.effort_share_bounds",
         .upper_widening = bounds.upper < 1 ? "the key motion.effort_share_bounds" : ""});
  }
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
    for (std::size_t joint = 0; joint < robot_->joint_count(); ++joint) {
      const auto row = static_cast<Index>(joint);
      const double way =
          std::abs(start(row, static_cast<Index>(to)) - start(row, static_cast<Index>(from)));
      const double speed = config_.limits.speed[joint];
      time_s = std::max(time_s, way / (std::isfinite(speed) ? speed : 1));
    }
    const VariableBounds& bounds = config_.interval_s;
    variables.push_back(
        {.name = fmt::format("interval_{}", i + 1),
         .unit = "s",
         .lower = bounds.lower,
         .upper = bounds.upper,
         .start = std::clamp(kStartSlowness * time_s / share, bounds.lower, bounds.upper),
         .scale = Scale::logarithmic,
         .lower_widening = "the key motion.shortest_interval_s",
         .upper_widening = "the key motion.longest_interval_s"});
  }
  for (std::size_t point = 0; point < config_.points.size(); ++point) {
    if (config_.points[point].q || config_.points[point].tool) {
      continue;
    }
    for (std::size_t joint = 0; joint < robot_->joint_count(); ++joint) {
      const Joint& its = robot_->joints[joint];
      const bool has_range = std::isfinite(its.upper - its.lower);
      constexpr double kTurn = 3.141592653589793;  // of joints without a range
      const double lower = has_range ? its.lower : -kTurn, upper = has_range ? its.upper : kTurn;
      variables.push_back(
          {.name = fmt::format("point_{}.{}", point + 1, its.name),
           .unit = get_position_unit(its),
           .lower = lower,
           .upper = upper,
           .start = std::clamp(start(static_cast<Index>(joint), static_cast<Index>(point)), lower,
                               upper)});
    }
  }
  const ArmTubes& tubes = config_.tubes;
  for (std::size_t link = 0; link < tubes.tubes.size(); ++link) {
    const auto add = [&](const char* what, const std::optional<VariableBounds>& bounds,
                         double value) {
      if (bounds) {
        variables.push_back({.name = fmt::format("{}.{}", robot_->links[link].name, what),
                             .unit = "m",
                             .lower = bounds->lower,
                             .upper = bounds->upper,
                             .start = std::clamp(value, bounds->lower, bounds->upper),
                             .lower_widening = fmt::format("the key tubes.{}_bounds_m", what),
                             .upper_widening = fmt::format("the key tubes.{}_bounds_m", what)});
      }
    };
    add("length", tubes.length_m, get_link_length_m(*robot_, link));
    add("diameter", tubes.diameter_m, tubes.tubes[link].diameter_m);
    add("wall", tubes.wall_m, tubes.tubes[link].wall_m);
  }
}

bool MotionProblem::has_metric(MotionQuantity quantity) const {
  switch (quantity) {
    case MotionQuantity::jerk:
      return !is_line();
    case MotionQuantity::clearance:
      return config_.clearance != nullptr;
    case MotionQuantity::deflection:
      return changes_arm();
    default:
      return true;
  }
}

std::vector<double> MotionProblem::calc_objectives(std::span<const double> quantities) const {
  std::vector<double> objectives;
  double sum = 0;
  for (const WeightedQuantity& term : config_.objective) {
    const bool is_large = term.quantity == static_cast<std::size_t>(MotionQuantity::clearance);
    const double value = (is_large ? -1 : 1) * quantities[term.quantity];
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
      outcome.metrics[static_cast<std::size_t>(MotionQuantity::clearance)] = 0;
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
        if (has_metric(static_cast<MotionQuantity>(i))) {
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
  const std::size_t n = plan->robot->joint_count();
  std::vector<double> values(n);
  const char* const kinds[] = {"position", "speed", "acceleration", "jerk"};
  const char* const per[] = {"", "/s", "/s2", "/s3"};
  for (std::size_t joint = 0; joint < n; ++joint) {
    const Joint& its = plan->robot->joints[joint];
    for (int order = 0; order < (is_line() ? 3 : 4); ++order) {  // the jerk of a line has no bound
      CaseRecord::Series series{{fmt::format("{} {}", its.name, kinds[order]),
                                 fmt::format("{}{}", get_position_unit(its), per[order])},
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
  record.files = {{"motion.csv", write_motion_csv(*plan->robot, samples, plan->efforts)},
                  {"trajectory.yaml", write_joint_trajectory(*plan->robot, samples)}};
  return record;
}

const MotionProblem* find_motion(const Problem& problem) {
  return dynamic_cast<const MotionProblem*>(&problem);
}

}  // namespace armwright
