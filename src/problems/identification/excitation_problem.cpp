#include "problems/identification/excitation_problem.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/decompositions.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "problems/interface/add_outcome.hpp"
#include "sim/kinematics/kinematics.hpp"

namespace armwright {
namespace {

using Eigen::Index;

constexpr int kRandomStates = 400;
// The smallest eigenvalue that is not rounding, as a share of the largest, of A^T A with columns of
// length 1 over random states.
constexpr double kNotTold = 1e-10;
// A parameter counts as told by itself if at most this share of its square lies outside of the basis.
constexpr double kOutside = 1e-6;
constexpr int kPostures = 500;
constexpr double kStartAmplitude = 0.2;  // of the boxes of a and b
constexpr int kHalvings = 30;
constexpr double kShrinking = 0.01;
constexpr double kSmallest = 0.5;
// The condition number of a motion that does not tell a parameter at all.
constexpr double kWorstLog10 = 16;
constexpr double kWorstObjective = 1e3;

double find_share(const Eigen::MatrixXd& values, Index joint, double middle, double limit) {
  return (values.col(joint).array() - middle).abs().maxCoeff() / limit;
}

const char* get_length_unit(const Joint& joint) {
  return joint.kind == JointKind::revolute ? "rad" : "m";
}

}  // namespace

const std::vector<std::string>& excitation_criterion_names() {
  static const std::vector<std::string> names = {"condition", "d-optimal"};
  return names;
}

ExcitationProblem::ExcitationProblem(ExcitationConfig config) : config_(std::move(config)) {
  for (Link& link : config_.robot.links) {
    link.visuals.clear();
  }
  config_.robot.base.visuals.clear();
  parameters_ = list_parameters(config_.robot, config_.groups);
  own_ = get_parameters(config_.robot, parameters_);
  find_basis();
  training_times_s_ = make_times(kTrainingSamples);
  training_shape_ = make_shape(training_times_s_);
  arm_length_m_ = calc_arm_length_m(config_.robot);
  if (config_.floor_m) {
    kinematics_ =
        std::make_unique<NumericKinematics>(config_.robot, ToolTask{}, std::vector<double>{}, true);
    floor_ = std::make_unique<FloorClearance>(config_.robot, *kinematics_, *config_.floor_m);
  }
  description_.name = config_.name;
  description_.summary = config_.summary;
  description_.cost_unit = "motion";
  description_.has_single_case = true;
  // A violation of one per cent then outweighs what a motion gains by it.
  description_.violation_scale = 10;
  description_.objectives = {{config_.criterion == ExcitationCriterion::condition
                                  ? "log10 of the condition number"
                                  : "-log(det) per parameter",
                              ""}};
  for (const char* kind : {"position", "speed", "acceleration", "effort"}) {
    for (const Joint& joint : config_.robot.joints) {
      if (!config_.acceleration_limits.empty() || std::string_view(kind) != "acceleration") {
        description_.constraints.push_back({fmt::format("{}.{}", joint.name, kind), ""});
      }
    }
  }
  if (config_.floor_m) {
    description_.constraints.push_back({"floor", ""});
  }
  if (config_.clearance) {
    description_.constraints.push_back({"obstacles", ""});
  }
  description_.metrics = {{"condition number", ""}};
  make_variables();
  set_start();
}

double ExcitationProblem::get_middle(std::size_t joint) const {
  const Joint& its = config_.robot.joints[joint];
  return std::isfinite(its.upper - its.lower) ? (its.lower + its.upper) / 2 : 0;
}

double ExcitationProblem::get_half(std::size_t joint) const {
  const Joint& its = config_.robot.joints[joint];
  return std::isfinite(its.upper - its.lower) ? (its.upper - its.lower) / 2 : std::numbers::pi;
}

// Returns the largest amplitude that the speed and acceleration limits leave to a harmonic.
double ExcitationProblem::get_slowest_limit(std::size_t joint, int harmonic) const {
  const double w = 2 * std::numbers::pi * harmonic / config_.period_s;
  double amplitude = config_.speed_share * config_.robot.joints[joint].speed_limit / w;
  if (!config_.acceleration_limits.empty()) {
    amplitude = std::min(amplitude, config_.acceleration_limits[joint] / (w * w));
  }
  return std::min(amplitude, config_.position_share * get_half(joint));
}

bool ExcitationProblem::can_tell(std::size_t parameter) const {
  return 1 - basis_.row(static_cast<Index>(parameter)).squaredNorm() < kOutside;
}

// Finds what motions can tell, with random states within the limits.
void ExcitationProblem::find_basis() {
  const auto n = static_cast<Index>(config_.robot.joint_count());
  const auto p = static_cast<Index>(parameters_.size());
  JointMotion states;
  for (Eigen::MatrixXd* rows : {&states.positions, &states.rates, &states.accelerations}) {
    rows->resize(kRandomStates, n);
  }
  RandomStream random("excitation/states", 0);
  // The frequency in the middle of the series.
  const double w = 2 * std::numbers::pi * (config_.harmonics + 1) / 2 / config_.period_s;
  for (Index k = 0; k < kRandomStates; ++k) {
    for (Index i = 0; i < n; ++i) {
      const auto joint = static_cast<std::size_t>(i);
      const double speed = config_.speed_share * config_.robot.joints[joint].speed_limit;
      states.positions(k, i) =
          get_middle(joint) + random.uniform(-1, 1) * config_.position_share * get_half(joint);
      states.rates(k, i) = random.uniform(-1, 1) * speed;
      states.accelerations(k, i) = random.uniform(-1, 1) * speed * w;
    }
  }
  Eigen::MatrixXd a = PlantModel(config_.robot, parameters_, config_.gravity_m_per_s2, states)
                          .calc(own_, true)
                          .motor_jacobian;
  for (Index row = 0; row < a.rows(); ++row) {
    a.row(row) /= config_.robot.joints[static_cast<std::size_t>(row % n)].effort_limit *
                  std::sqrt(static_cast<double>(a.rows()));
  }
  lengths_ = a.colwise().norm();
  for (double& length : lengths_) {
    length = length > 0 ? length : 1;
  }
  a *= lengths_.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(Eigen::MatrixXd(a.transpose() * a));
  const Eigen::VectorXd& values = solver.eigenvalues();
  const Index known =
      p == 0 ? 0 : (values.array() > kNotTold * std::max(values.maxCoeff(), kNotTold)).count();
  if (known == 0) {
    throw Error(
        ErrorKind::bad_data,
        "there is nothing to fit: no motion of this robot tells a parameter of the groups that "
        "are to be fitted; fit others, such as friction and armature (stiffness and delay "
        "need no motion of their own, counterbalance needs a plant's file with one)");
  }
  basis_ = solver.eigenvectors().rightCols(known);
}

Eigen::VectorXd ExcitationProblem::make_times(Index samples) const {
  return Eigen::VectorXd::LinSpaced(samples, 0, config_.duration_s);
}

ExcitationProblem::Shape ExcitationProblem::make_shape(const Eigen::VectorXd& times_s) const {
  Shape shape;
  for (Eigen::MatrixXd* rows : {&shape.values, &shape.rates, &shape.accelerations}) {
    rows->resize(times_s.size(), 2 * config_.harmonics);
  }
  for (Index sample = 0; sample < times_s.size(); ++sample) {
    const double t = times_s[sample];
    const bool is_beginning = t < config_.duration_s / 2;
    const double u =
        std::clamp((is_beginning ? t : config_.duration_s - t) / config_.blend_s, 0.0, 1.0);
    const double by_time = (is_beginning ? 1 : -1) / config_.blend_s;
    const double c = u * u * u * (10 + u * (-15 + 6 * u));
    const double dc = 30 * u * u * (1 - u) * (1 - u) * by_time;
    const double ddc = 60 * u * (1 - u) * (1 - 2 * u) * by_time * by_time;
    for (int k = 0; k < config_.harmonics; ++k) {
      const double w = 2 * std::numbers::pi * (k + 1) / config_.period_s;
      const double sine = std::sin(w * t), cosine = std::cos(w * t);
      const auto set = [&](Index column, double s, double ds) {
        shape.values(sample, column) = c * s;
        shape.rates(sample, column) = dc * s + c * ds;
        shape.accelerations(sample, column) = ddc * s + 2 * dc * ds - c * w * w * s;
      };
      set(2 * k, sine, w * cosine);
      set(2 * k + 1, cosine, -w * sine);
    }
  }
  return shape;
}

AssessedMotion ExcitationProblem::assess(std::span<const double> x, Index samples) const {
  const Eigen::VectorXd times_s = make_times(samples);
  return assess(x, make_shape(times_s), times_s);
}

AssessedMotion ExcitationProblem::assess_finely(std::span<const double> x) const {
  return assess(x, static_cast<Index>(std::ceil(kFineSamples * config_.harmonics *
                                                config_.duration_s / config_.period_s)) +
                       1);
}

AssessedMotion ExcitationProblem::assess(std::span<const double> x, const Shape& shape,
                                         const Eigen::VectorXd& times_s) const {
  const RobotModel& robot = config_.robot;
  const auto n = static_cast<Index>(robot.joint_count());
  const Index samples = times_s.size();
  const Eigen::Map<const Eigen::MatrixXd> numbers(x.data(), 1 + 2 * config_.harmonics, n);
  AssessedMotion assessed;
  assessed.times_s = times_s;
  JointMotion& motion = assessed.motion;
  motion.positions = shape.values * numbers.bottomRows(2 * config_.harmonics);
  motion.positions.rowwise() += numbers.row(0);
  motion.rates = shape.rates * numbers.bottomRows(2 * config_.harmonics);
  motion.accelerations = shape.accelerations * numbers.bottomRows(2 * config_.harmonics);
  PlantModel::Efforts model =
      PlantModel(robot, parameters_, config_.gravity_m_per_s2, motion).calc(own_, true);
  assessed.efforts = Eigen::Map<const Eigen::MatrixXd>(model.motor.data(), n, samples).transpose();
  assessed.jacobian = std::move(model.motor_jacobian);
  for (Eigen::VectorXd* shares : {&assessed.positions, &assessed.speeds, &assessed.efforts_share}) {
    shares->resize(n);
  }
  assessed.accelerations.resize(config_.acceleration_limits.empty() ? 0 : n);
  Eigen::VectorXd limits(n);
  for (Index i = 0; i < n; ++i) {
    const auto joint = static_cast<std::size_t>(i);
    limits[i] = robot.joints[joint].effort_limit;
    assessed.positions[i] = find_share(motion.positions, i, get_middle(joint), get_half(joint));
    assessed.speeds[i] = find_share(motion.rates, i, 0, robot.joints[joint].speed_limit);
    assessed.efforts_share[i] = find_share(assessed.efforts, i, 0, limits[i]);
    if (assessed.accelerations.size() > 0) {
      assessed.accelerations[i] =
          find_share(motion.accelerations, i, 0, config_.acceleration_limits[joint]);
    }
  }
  assessed.depth_m = -arm_length_m_;
  std::vector<double> q(robot.joint_count());
  assessed.gap_m = arm_length_m_;
  for (Index k = 0; (floor_ || config_.clearance) && k < samples; ++k) {
    Eigen::RowVectorXd::Map(q.data(), n) = motion.positions.row(k);
    if (floor_) {
      assessed.depth_m = std::max(assessed.depth_m, floor_->find_lowest(q).excess_m);
    }
    if (config_.clearance) {
      const auto nearest = config_.clearance->find_nearest(calc_link_poses(robot, q));
      assessed.gap_m = std::min(assessed.gap_m, nearest.distance_m);
    }
  }
  // A^T A of the combinations that can be told.
  const Eigen::VectorXd weights =
      limits.cwiseAbs2().cwiseInverse().replicate(samples, 1) / static_cast<double>(samples * n);
  const Eigen::MatrixXd a = weights.cwiseSqrt().asDiagonal() * assessed.jacobian *
                            (lengths_.cwiseInverse().asDiagonal() * basis_);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(Eigen::MatrixXd(a.transpose() * a),
                                                              Eigen::EigenvaluesOnly);
  const Eigen::VectorXd values = solver.eigenvalues().cwiseMax(
      std::max(solver.eigenvalues().maxCoeff(), 1e-300) * std::pow(10, -2 * kWorstLog10));
  assessed.condition = std::sqrt(values.maxCoeff() / values.minCoeff());
  assessed.log_det = values.array().log().mean();
  return assessed;
}

std::vector<double> ExcitationProblem::calc_constraints(const AssessedMotion& motion,
                                                        double reserve) const {
  std::vector<double> values;
  const std::pair<const Eigen::VectorXd*, double> kinds[] = {
      {&motion.positions, config_.position_share},
      {&motion.speeds, config_.speed_share},
      {&motion.accelerations, 1},
      {&motion.efforts_share, config_.effort_share}};
  for (const auto& [shares, limit] : kinds) {
    for (const double share : *shares) {
      values.push_back(share / (reserve * limit) - 1);
    }
  }
  if (config_.floor_m) {
    values.push_back(motion.depth_m / arm_length_m_ + 1 - reserve);
  }
  if (config_.clearance) {
    values.push_back(-motion.gap_m / arm_length_m_ + 1 - reserve);
  }
  return values;
}

bool ExcitationProblem::is_within_limits(const AssessedMotion& motion) const {
  return calc_violation(calc_constraints(motion, 1)) == 0;
}

double ExcitationProblem::shrink_to_limits(std::vector<double>& x) const {
  const std::size_t numbers = 1 + 2 * static_cast<std::size_t>(config_.harmonics);
  for (double factor = 1; factor > kSmallest; factor -= kShrinking) {
    std::vector<double> smaller = x;
    for (std::size_t i = 0; i < x.size(); ++i) {
      smaller[i] *= i % numbers == 0 ? 1 : factor;
    }
    if (is_within_limits(assess_finely(smaller))) {
      x = smaller;
      return factor;
    }
  }
  return 0;
}

Eigen::VectorXd ExcitationProblem::calc_standard_errors(const AssessedMotion& motion,
                                                        const Eigen::VectorXd& noise) const {
  const Index samples = motion.times_s.size();
  const Eigen::MatrixXd transform = lengths_.cwiseInverse().asDiagonal() * basis_;
  const Eigen::MatrixXd a =
      noise.cwiseInverse().replicate(samples, 1).asDiagonal() * motion.jacobian * transform;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(Eigen::MatrixXd(a.transpose() * a));
  const Eigen::VectorXd values = solver.eigenvalues().cwiseMax(
      std::max(solver.eigenvalues().maxCoeff(), 1e-300) * std::pow(10, -2 * kWorstLog10));
  return (transform * solver.eigenvectors() * values.cwiseSqrt().cwiseInverse().asDiagonal())
      .rowwise()
      .norm();
}

void ExcitationProblem::make_variables() {
  for (std::size_t joint = 0; joint < config_.robot.joint_count(); ++joint) {
    const Joint& its = config_.robot.joints[joint];
    const std::string unit = get_length_unit(its);
    const double reach = config_.position_share * get_half(joint);
    description_.variables.push_back({.name = its.name + ".offset",
                                      .unit = unit,
                                      .lower = get_middle(joint) - reach,
                                      .upper = get_middle(joint) + reach,
                                      .start = get_middle(joint)});
    for (int k = 1; k <= config_.harmonics; ++k) {
      const double amplitude = get_slowest_limit(joint, k);
      for (const char* part : {"sin", "cos"}) {
        description_.variables.push_back({.name = fmt::format("{}.{}_{}", its.name, part, k),
                                          .unit = unit,
                                          .lower = -amplitude,
                                          .upper = amplitude});
      }
    }
  }
}

// Starts with a random motion around the random posture that keeps the largest distance from the
// limits; its amplitudes are halved until it keeps all limits.
void ExcitationProblem::set_start() {
  const std::size_t numbers = 1 + 2 * static_cast<std::size_t>(config_.harmonics);
  auto& variables = description_.variables;
  RandomStream random("excitation/start", 0);
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(1);
  const Shape shape = make_shape(rest);
  std::vector<double> best = list_starts(variables);
  double least = std::numeric_limits<double>::infinity();
  std::size_t worst = 0;
  for (int posture = 0; posture < kPostures; ++posture) {
    std::vector<double> x = list_starts(variables);
    for (std::size_t i = 0; posture > 0 && i < x.size(); i += numbers) {
      x[i] = random.uniform(variables[i].lower, variables[i].upper);
    }
    const std::vector<double> values = calc_constraints(assess(x, shape, rest), kReserve);
    const auto at = std::ranges::max_element(values);
    if (*at < least) {
      least = *at;
      best = x;
      worst = static_cast<std::size_t>(at - values.begin());
    }
  }
  if (least > 0) {
    throw Error(
        ErrorKind::bad_data,
        fmt::format("the limits leave no posture from which a motion could begin: in the best "
                    "of {} random postures, {} is {:.3g} times what is allowed; {}",
                    kPostures, sanitize(description_.constraints[worst].name), 1 + least,
                    description_.constraints[worst].name == "floor" ? "lower excitation.floor_m"
                    : description_.constraints[worst].name == "obstacles"
                        ? "move the obstacles"
                        : "raise excitation.effort_share, or check the effort limits and "
                          "the masses of the robot and its payload"));
  }
  for (std::size_t i = 0; i < best.size(); ++i) {
    if (i % numbers > 0) {
      best[i] = kStartAmplitude * random.uniform(variables[i].lower, variables[i].upper);
    }
  }
  for (int halving = 0; halving < kHalvings; ++halving) {
    if (calc_violation(
            calc_constraints(assess(best, training_shape_, training_times_s_), kReserve)) == 0) {
      break;
    }
    for (std::size_t i = 0; i < best.size(); ++i) {
      best[i] *= i % numbers > 0 ? 0.5 : 1;
    }
  }
  for (std::size_t i = 0; i < best.size(); ++i) {
    variables[i].start = best[i];
  }
}

std::vector<CaseOutcome> ExcitationProblem::simulate(std::span<const CaseJob> jobs) const {
  std::vector<CaseOutcome> outcomes(jobs.size());
  for (std::size_t job = 0; job < jobs.size(); ++job) {
    const AssessedMotion motion = assess(jobs[job].x, training_shape_, training_times_s_);
    CaseOutcome& outcome = outcomes[job];
    outcome.error = config_.criterion == ExcitationCriterion::condition
                        ? std::log10(motion.condition)
                        : -motion.log_det;
    outcome.metrics = calc_constraints(motion, kReserve);
    outcome.metrics.push_back(motion.condition);
    if (!std::isfinite(outcome.error) ||
        !std::ranges::all_of(outcome.metrics, [](double g) { return std::isfinite(g); })) {
      outcome = {};
      outcome.status = EvaluationStatus::diverged;
      outcome.reason = "the motion needs efforts without bound";
      outcome.has_error = false;
    }
  }
  return outcomes;
}

Evaluation ExcitationProblem::aggregate(std::span<const double> /*x*/,
                                        std::span<const CaseOutcome> outcomes) const {
  Evaluation evaluation;
  for (const CaseOutcome& outcome : outcomes) {  // all are the same
    if (add_outcome(outcome, evaluation) && evaluation.objectives.empty()) {
      evaluation.objectives = {outcome.error};
      evaluation.constraint_values.assign(outcome.metrics.begin(), outcome.metrics.end() - 1);
      evaluation.metrics = {outcome.metrics.back()};
    }
  }
  return evaluation;
}

std::vector<double> ExcitationProblem::penalty_objectives() const {
  return {kWorstObjective};
}

CaseRecord ExcitationProblem::record_case(std::span<const double> x, const CaseBlock& /*block*/,
                                          std::uint64_t /*number*/) const {
  const AssessedMotion motion = assess(x, 4 * kTrainingSamples);
  CaseRecord record;
  record.abscissa = {"time", "s"};
  record.abscissa_values.assign(motion.times_s.begin(), motion.times_s.end());
  for (std::size_t i = 0; i < config_.robot.joint_count(); ++i) {
    const Joint& joint = config_.robot.joints[i];
    const std::string unit = get_length_unit(joint);
    const auto add = [&](const char* what, const std::string& its_unit, const Eigen::MatrixXd& of) {
      const auto column = of.col(static_cast<Index>(i));
      record.series.push_back(
          {{joint.name + what, its_unit}, std::vector<double>(column.begin(), column.end())});
    };
    add(" position", unit, motion.motion.positions);
    add(" speed", unit + "/s", motion.motion.rates);
    add(" effort", get_effort_unit(joint.kind), motion.efforts);
  }
  return record;
}

}  // namespace armwright
