#include "problems/identification/linear_start.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/decompositions.hpp"
#include "sim/tracking/designed_arm.hpp"

namespace armwright {
namespace {

using Eigen::Index;
using ParameterKind = PlantParameter::Kind;

// The boxes end where one parameter would explain this many times the joint's largest effort.
constexpr double kBoxShare = 3;
// Stribeck rate over transition rate. Closer, the two rises of friction cannot be told apart.
constexpr double kLeastRates = 3;
constexpr double kMostDelay_s = 0.05;
constexpr double kLongestDeflection = 0.1;  // rad or m
constexpr double kMostBalance = 3;
constexpr double kInertiaSpan = 2;  // of the logarithms, and of the ratios s and t in their scale
constexpr double kReach_m = 1;      // farthest centre of a payload's mass from the tip
constexpr double kPayloadPlace_m = 0.05;  // how well the place of a stated payload is known
constexpr double kStiffest = 1e9;         // N m/rad or N/m

// The largest magnitudes that the motions have of a joint.
struct Largest {
  double effort = 0, rate = 0, acceleration = 0;
};

Largest find_largest(std::span<const FittedMotion> motions, std::size_t joint) {
  Largest largest;
  const auto i = static_cast<Index>(joint);
  for (const FittedMotion& motion : motions) {
    largest.effort = std::max(largest.effort, motion.efforts.col(i).cwiseAbs().maxCoeff());
    const JointMotion& its = motion.model.motion();
    largest.rate = std::max(largest.rate, its.rates.col(i).cwiseAbs().maxCoeff());
    largest.acceleration =
        std::max(largest.acceleration, its.accelerations.col(i).cwiseAbs().maxCoeff());
  }
  return largest;
}

// Returns the lower and the upper end of a parameter's box. The robot's own value is inside.
std::pair<double, double> find_box(const RobotModel& robot, const PlantParameter& parameter,
                                   const Largest& largest) {
  const double effort = kBoxShare * largest.effort;
  const double tiny = 1e-9;
  switch (parameter.kind) {
    case ParameterKind::viscous:
      return {0, effort / std::max(largest.rate, tiny)};
    case ParameterKind::coulomb:
    case ParameterKind::breakaway:
      return {0, effort};
    case ParameterKind::offset:
      return {-effort, effort};
    case ParameterKind::stribeck_rate:
      return {kLeastRates * robot.joints[parameter.joint].plant.transition_rate,
              std::max(largest.rate,
                       2 * kLeastRates * robot.joints[parameter.joint].plant.transition_rate)};
    case ParameterKind::armature:
      return {0, effort / std::max(largest.acceleration, tiny)};
    case ParameterKind::payload:
      return parameter.part == 0 ? std::pair(0.0, std::max(10.0, calc_moving_mass_kg(robot)))
                                 : std::pair(-kReach_m, kReach_m);
    case ParameterKind::counterbalance:
      return parameter.part == 0 ? std::pair(1e-3, kMostBalance) : std::pair(-0.9, 0.9);
    case ParameterKind::stiffness:
      return {std::max(1e-3, largest.effort / kLongestDeflection), kStiffest};
    case ParameterKind::encoder_offset:
      return {-kLongestDeflection, kLongestDeflection};
    case ParameterKind::delay:
      return {-kMostDelay_s, kMostDelay_s};
    case ParameterKind::inertia:
      return {-kInertiaSpan, kInertiaSpan};  // around the robot's own value
  }
  return {0, 0};
}

// Returns whether efforts are linear in the parameter.
bool is_linear(const PlantParameter& parameter) {
  switch (parameter.kind) {
    case ParameterKind::stribeck_rate:
    case ParameterKind::stiffness:
    case ParameterKind::encoder_offset:
    case ParameterKind::delay:
    case ParameterKind::inertia:
    case ParameterKind::payload:  // its ten numbers are in its place
      return false;
    case ParameterKind::counterbalance:
      return parameter.part == 0;
    default:
      return true;
  }
}

// Solves the normal equations by least squares. Columns get one length, so that the rank does not
// depend on units; what the equations do not determine becomes 0.
Eigen::VectorXd solve_even(const Eigen::MatrixXd& normal, const Eigen::VectorXd& right) {
  const Eigen::VectorXd lengths =
      normal.diagonal().cwiseSqrt().cwiseMax(std::numeric_limits<double>::min());
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver;
  solver.setThreshold(1e-9);
  solver.compute(lengths.cwiseInverse().asDiagonal() * normal *
                 lengths.cwiseInverse().asDiagonal());
  return solve(solver, right.cwiseQuotient(lengths)).cwiseQuotient(lengths);
}

// Does the same within ranges. The number farthest beyond its range, in units of the range, is held
// at the range's end, and the others are solved again, until none is beyond.
Eigen::VectorXd solve_within(Eigen::MatrixXd normal, Eigen::VectorXd right,
                             const std::vector<std::pair<double, double>>& ranges) {
  std::vector<bool> is_held(ranges.size());
  while (true) {
    const Eigen::VectorXd found = solve_even(normal, right);
    double farthest = 1e-9;
    Index worst = -1;
    for (std::size_t i = 0; i < ranges.size(); ++i) {
      const auto [lower, upper] = ranges[i];
      const double value = found[static_cast<Index>(i)];
      const double beyond = std::max(lower - value, value - upper) / (upper - lower);
      if (!is_held[i] && beyond > farthest) {
        farthest = beyond;
        worst = static_cast<Index>(i);
      }
    }
    if (worst < 0) {
      return found;
    }
    const auto at = static_cast<std::size_t>(worst);
    const double end = std::clamp(found[worst], ranges[at].first, ranges[at].second);
    is_held[at] = true;
    right -= end * normal.col(worst);
    const double unit = normal(worst, worst);
    normal.row(worst).setZero();
    normal.col(worst).setZero();
    normal(worst, worst) = unit;
    right[worst] = unit * end;
  }
}

double move_into(const DecisionVariable& variable, double value) {
  return std::clamp(value, variable.lower, variable.upper);
}

// Sets the payload's start of the ten numbers by which the last link differs from the robot's.
void set_payload_start(const RobotModel& robot, std::span<const PlantParameter> parameters,
                       const LinkNumbers& change, std::vector<DecisionVariable>& variables) {
  const Inertial own = transform(robot.payload.value_or(Inertial{}), robot.tip_pose);
  const double mass_kg = own.mass_kg + change[0];
  const Eigen::Vector3d moment = own.mass_kg * own.com_m + change.segment<3>(1);
  const Eigen::Vector3d com_m = mass_kg > 1e-3
                                    ? Eigen::Vector3d(robot.tip_pose.inverse() * (moment / mass_kg))
                                    : Eigen::Vector3d::Zero();
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    if (parameters[p].kind == ParameterKind::payload) {
      const int part = parameters[p].part;
      variables[p].start = move_into(variables[p], part == 0 ? mass_kg : com_m[part - 1]);
    }
  }
}

// Sets the start of the stiffness of the joints: least squares on deflections of the start's model.
void set_stiffness_start(const IdentificationProblem& problem,
                         std::vector<DecisionVariable>& variables) {
  const auto& parameters = problem.parameters();
  if (std::ranges::find(parameters, ParameterKind::stiffness, &PlantParameter::kind) ==
      parameters.end()) {
    return;
  }
  const std::vector<double> x = list_starts(variables);
  std::vector<Eigen::VectorXd> efforts;  // on the links, of each motion
  for (const FittedMotion& motion : problem.fitted()) {
    efforts.push_back(motion.model.calc(x, false).link);
  }
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    if (parameters[p].kind != ParameterKind::stiffness) {
      continue;
    }
    const auto i = static_cast<Index>(parameters[p].joint);
    Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
    Eigen::Vector2d right = Eigen::Vector2d::Zero();
    for (std::size_t m = 0; m < efforts.size(); ++m) {
      const FittedMotion& motion = problem.fitted()[m];
      const Index n = motion.efforts.cols();
      for (Index k = 0; k < motion.efforts.rows(); ++k) {
        const Eigen::Vector2d row(efforts[m][k * n + i], 1);
        normal += row * row.transpose();
        right += row * motion.deflections(k, i);
      }
    }
    const Eigen::Vector2d found = normal.colPivHouseholderQr().solve(right);
    variables[p].start = move_into(variables[p], found[0] > 0 ? 1 / found[0] : variables[p].upper);
    variables[p + 1].start = move_into(variables[p + 1], found[1]);
  }
}

}  // namespace

std::vector<DecisionVariable> make_boxes(const RobotModel& robot,
                                         std::span<const PlantParameter> parameters,
                                         std::span<const FittedMotion> motions) {
  std::vector<DecisionVariable> variables;
  for (const PlantParameter& parameter : parameters) {
    auto [lower, upper] = find_box(robot, parameter, find_largest(motions, parameter.joint));
    const double own = get_parameter(robot, parameter);
    if (parameter.kind == ParameterKind::inertia) {
      const bool is_length = parameter.part > 3;
      const double scale = is_length ? std::max(std::abs(own), kReach_m / 2) : 1;
      lower = own + lower * scale;
      upper = own + upper * scale;
    }
    if (parameter.kind == ParameterKind::stiffness) {
      upper = std::max(upper, 2 * lower);
    }
    variables.push_back(
        {.name = parameter.name,
         .unit = parameter.unit,
         .lower = std::min(lower, own),
         .upper = std::max(upper, own),
         .start = own,
         .scale = parameter.kind == ParameterKind::stiffness ? Scale::logarithmic : Scale::linear});
    DecisionVariable& variable = variables.back();
    if (variable.scale == Scale::logarithmic) {
      variable.lower = lower;
      variable.start = std::clamp(own, lower, upper);
    }
  }
  return variables;
}

Eigen::VectorXd list_priors(const RobotModel& robot, std::span<const PlantParameter> parameters) {
  Eigen::VectorXd deviations = Eigen::VectorXd::Zero(static_cast<Index>(parameters.size()));
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    const double own = get_parameter(robot, parameters[p]);
    double& deviation = deviations[static_cast<Index>(p)];
    switch (parameters[p].kind) {
      case ParameterKind::armature:
        deviation = 0.3 * own;
        break;
      case ParameterKind::counterbalance:
        deviation = 0.2;
        break;
      case ParameterKind::stribeck_rate:
        deviation = own;
        break;
      case ParameterKind::payload:
        if (robot.payload && robot.payload->mass_kg > 0) {
          deviation = parameters[p].part == 0 ? 0.1 * own : kPayloadPlace_m;
        }
        break;
      case ParameterKind::inertia:
        deviation = 0.3;
        break;
      default:
        deviation = 0;
    }
  }
  return deviations;
}

void set_linear_start(const IdentificationProblem& problem,
                      std::vector<DecisionVariable>& variables) {
  const auto& parameters = problem.parameters();
  const auto n = static_cast<Index>(problem.robot().joint_count());
  std::vector<Index> columns;
  bool has_payload = false;
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    if (is_linear(parameters[p])) {
      columns.push_back(static_cast<Index>(p));
    }
    has_payload = has_payload || parameters[p].kind == ParameterKind::payload;
  }
  const auto count = static_cast<Index>(columns.size()) + (has_payload ? kLinkNumbers : 0);
  if (count > 0) {
    std::vector<double> own;
    for (std::size_t p = 0; p < parameters.size(); ++p) {
      own.push_back(move_into(variables[p], problem.own_values()[p]));
    }
    // The normal equations of all motions, in units of sigma.
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(count, count);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(count);
    double samples = 0;  // efforts, which have no other weights here, per motion
    for (const FittedMotion& motion : problem.fitted()) {
      const PlantModel::Efforts model = motion.model.calc(own, true);
      Eigen::MatrixXd rows(model.motor.size(), count);
      for (std::size_t c = 0; c < columns.size(); ++c) {
        rows.col(static_cast<Index>(c)) = model.motor_jacobian.col(columns[c]);
      }
      if (has_payload) {
        rows.rightCols<kLinkNumbers>() = motion.model.last_link();
      }
      Eigen::VectorXd errors(model.motor.size());
      for (Index row = 0; row < errors.size(); ++row) {
        const double sigma = problem.effort_scales()[row % n];
        errors[row] = (motion.efforts(row / n, row % n) - model.motor[row]) / sigma;
        rows.row(row) /= sigma;
      }
      normal += rows.transpose() * rows;
      right += rows.transpose() * errors;
      samples += static_cast<double>(errors.size()) / static_cast<double>(problem.fitted().size());
    }
    for (std::size_t c = 0; c < columns.size() && problem.prior_weight() > 0; ++c) {
      const double deviation = problem.priors()[columns[c]];
      if (deviation > 0) {
        const auto p = static_cast<std::size_t>(columns[c]);
        const double weight = std::pow(problem.prior_weight() / deviation, 2) *
                              static_cast<double>(problem.fitted().size()) * samples;
        normal(static_cast<Index>(c), static_cast<Index>(c)) += weight;
        right[static_cast<Index>(c)] += weight * (problem.own_values()[p] - own[p]);
      }
    }
    std::vector<std::pair<double, double>> ranges(
        static_cast<std::size_t>(count),
        {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()});
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const auto p = static_cast<std::size_t>(columns[c]);
      ranges[c] = {variables[p].lower - own[p], variables[p].upper - own[p]};
    }
    const Eigen::VectorXd change = solve_within(std::move(normal), std::move(right), ranges);
    for (std::size_t c = 0; c < columns.size(); ++c) {
      DecisionVariable& variable = variables[static_cast<std::size_t>(columns[c])];
      variable.start = move_into(
          variable, own[static_cast<std::size_t>(columns[c])] + change[static_cast<Index>(c)]);
    }
    if (has_payload) {
      set_payload_start(problem.robot(), parameters, change.tail<kLinkNumbers>(), variables);
    }
  }
  set_stiffness_start(problem, variables);
}

std::vector<double> fit_roughly(const IdentificationProblem& problem) {
  constexpr int kMostSteps = 6;
  constexpr double kLeastGain = 0.01;
  const auto& variables = problem.description().variables;
  std::vector<double> x = list_starts(variables);
  const auto p = static_cast<Index>(x.size());
  double before = std::numeric_limits<double>::infinity();
  std::vector<double> next = x;
  for (int step = 0; step < kMostSteps; ++step) {
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(p, p);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(p);
    double square = 0;
    for (const FittedMotion& motion : problem.fitted()) {
      const IdentificationProblem::Residuals residuals = problem.calc_residuals(motion, next, true);
      normal += residuals.jacobian.transpose() * residuals.jacobian;
      right -= residuals.jacobian.transpose() * residuals.values;
      square += residuals.values.squaredNorm();
    }
    if (!(square < before)) {
      break;
    }
    x = next;
    if (square > (1 - kLeastGain) * before) {
      break;
    }
    before = square;
    const Eigen::VectorXd change = solve_even(normal, right);
    for (std::size_t i = 0; i < x.size(); ++i) {
      next[i] = move_into(variables[i], x[i] + change[static_cast<Index>(i)]);
    }
  }
  return x;
}

}  // namespace armwright
