#include "problems/identification/identification_problem.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "problems/identification/linear_start.hpp"
#include "problems/identification/residual_memory.hpp"
#include "problems/interface/add_outcome.hpp"
#include "problems/logs/zero_phase_filter.hpp"

namespace armwright {
namespace {

using Eigen::Index;

// The error of a model that explains nothing is about 1.
constexpr double kFailedFit = 1e6;

// Returns the effort of a joint `share` samples later, and its rate per sample, by the cubic through
// the four nearest samples (Lagrange).
struct Shifted {
  double value = 0, rate = 0;
};
Shifted shift(const Eigen::MatrixXd& efforts, Index sample, Index joint, double share) {
  const Index last = efforts.rows() - 1;
  const double place = static_cast<double>(sample) + share;
  const Index first =
      std::clamp(static_cast<Index>(std::floor(place)) - 1, Index{0}, std::max(Index{0}, last - 3));
  const Index count = std::min<Index>(4, efforts.rows());
  Shifted shifted;
  for (Index i = 0; i < count; ++i) {
    double weight = 1, slope = 0;
    for (Index k = 0; k < count; ++k) {
      if (k != i) {
        const double width = static_cast<double>(i - k);
        slope = slope * (place - static_cast<double>(first + k)) / width + weight / width;
        weight *= (place - static_cast<double>(first + k)) / width;
      }
    }
    shifted.value += weight * efforts(first + i, joint);
    shifted.rate += slope * efforts(first + i, joint);
  }
  return shifted;
}

// Returns the filter that the logs have passed.
EffortSmoothing make_smoothing(double period_s, double cutoff_hz) {
  if (cutoff_hz <= 0) {
    return {};
  }
  const ZeroPhaseFilter filter(cutoff_hz, period_s / static_cast<double>(EffortSmoothing::kParts));
  return {period_s, [filter](const Eigen::VectorXd& signal) { return filter.apply(signal); }};
}

// A second encoder that differs by a constant tells nothing.
constexpr double kNoDeflection = 1e-7;  // rad or m

double find_spread(const Eigen::VectorXd& values) {
  return values.maxCoeff() - values.minCoeff();
}

FittedMotion make_motion(const IdentificationConfig::Log& log, const IdentificationConfig& config,
                         const std::vector<PlantParameter>& parameters) {
  const LogSamples& samples = log.samples;
  JointMotion motion = {samples.positions, samples.rates, samples.accelerations};
  Eigen::MatrixXd deflections;
  if (samples.link_positions.size() > 0) {
    deflections = samples.positions - samples.link_positions;
    motion.motor_rates = samples.rates;
    motion.motor_accelerations = samples.accelerations;
    for (Index i = 0; i < deflections.cols(); ++i) {
      if (samples.link_positions.col(i).allFinite()) {
        motion.positions.col(i) = samples.link_positions.col(i);
        motion.rates.col(i) = samples.link_rates.col(i);
        motion.accelerations.col(i) = samples.link_accelerations.col(i);
      }
    }
  }
  return {.name = log.name,
          .period_s = samples.period_s,
          .cutoff_hz = config.cutoff_hz,
          .model = PlantModel(config.robot, parameters, config.gravity_m_per_s2, motion,
                              make_smoothing(samples.period_s, config.cutoff_hz)),
          .efforts = samples.efforts,
          .effort_factors = samples.effort_factors,
          .deflections = std::move(deflections)};
}

// Returns the standard deviation of each column over all of the matrices.
Eigen::VectorXd calc_deviations(const std::vector<FittedMotion>& motions,
                                Eigen::MatrixXd FittedMotion::*member, Index columns) {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(columns), squares = sum;
  double count = 0;
  for (const FittedMotion& motion : motions) {
    const Eigen::MatrixXd& rows = motion.*member;
    if (rows.size() == 0) {
      return Eigen::VectorXd::Zero(columns);
    }
    sum += rows.colwise().sum().transpose();
    squares += rows.colwise().squaredNorm().transpose();
    count += static_cast<double>(rows.rows());
  }
  return (squares / count - (sum / count).cwiseAbs2()).cwiseMax(0).cwiseSqrt();
}

}  // namespace

IdentificationProblem::IdentificationProblem(const IdentificationConfig& config)
    : robot_(config.robot),
      plain_(config.plain),
      gravity_m_per_s2_(config.gravity_m_per_s2),
      notes_(config.notes) {
  const auto n = static_cast<Index>(robot_.joint_count());
  std::vector<bool> encoders(robot_.joint_count(), true);
  for (const IdentificationConfig::Log& log : config.fitted) {
    const Eigen::MatrixXd& links = log.samples.link_positions;
    for (Index i = 0; i < n; ++i) {
      const auto joint = static_cast<std::size_t>(i);
      encoders[joint] = encoders[joint] && links.size() > 0 && links.col(i).allFinite() &&
                        find_spread(log.samples.positions.col(i) - links.col(i)) > kNoDeflection;
    }
  }
  parameters_ = list_parameters(robot_, config.groups, encoders);
  own_ = get_parameters(robot_, parameters_);
  for (auto [logs, motions] :
       {std::pair{&config.fitted, &fitted_}, {&config.held_back, &held_back_}}) {
    for (const IdentificationConfig::Log& log : *logs) {
      motions->push_back(make_motion(log, config, parameters_));
    }
  }
  sigma_ = calc_deviations(fitted_, &FittedMotion::efforts, n);
  delta_.setZero(n);
  const Eigen::VectorXd deviations = calc_deviations(fitted_, &FittedMotion::deflections, n);
  for (const PlantParameter& parameter : parameters_) {
    if (parameter.kind == PlantParameter::Kind::stiffness) {
      delta_[static_cast<Index>(parameter.joint)] = deviations[static_cast<Index>(parameter.joint)];
    }
  }
  description_.name = config.name;
  description_.summary = config.summary;
  description_.objectives = {{"mean squared error", ""}};
  for (const Joint& joint : robot_.joints) {
    description_.metrics.push_back(
        {fmt::format("{}.rms", joint.name), get_effort_unit(joint.kind)});
  }
  description_.cost_unit = "motion of a log";
  description_.has_residuals = true;
  description_.has_jacobian = true;
  description_.variables = make_boxes(robot_, parameters_, fitted_);
  set_linear_start(*this, description_.variables);
  if (config.prior_scale > 0) {
    priors_ = config.prior_scale * list_priors(robot_, parameters_);
    const std::vector<double> fit = fit_roughly(*this);
    double square = 0, samples = 0;
    for (const FittedMotion& motion : fitted_) {
      const Eigen::VectorXd values = calc_residuals(motion, fit, false).values;
      for (Index i = 0; i < n; ++i) {
        const Eigen::VectorXd own = values(Eigen::seqN(i, motion.efforts.rows(), n));
        square += own.squaredNorm() * count_dependent({own.data(), own.data() + own.size()},
                                                      motion.period_s, motion.cutoff_hz);
      }
      samples += static_cast<double>(motion.efforts.rows());
    }
    prior_weight_ =
        std::sqrt(square / static_cast<double>(fitted_.size()) / samples / static_cast<double>(n));
    set_linear_start(*this, description_.variables);
  } else {
    priors_.setZero(static_cast<Index>(parameters_.size()));
  }
  const std::vector<double> start = fit_roughly(*this);
  for (std::size_t i = 0; i < start.size(); ++i) {
    description_.variables[i].start = start[i];
  }
}

IdentificationProblem::Residuals IdentificationProblem::calc_residuals(const FittedMotion& motion,
                                                                       std::span<const double> x,
                                                                       bool jacobian) const {
  const PlantModel::Efforts model = motion.model.calc(x, jacobian);
  const auto n = static_cast<Index>(robot_.joint_count());
  const Index samples = motion.efforts.rows();
  const Index columns = static_cast<Index>(parameters_.size());
  Index delay = -1;
  std::vector<std::pair<Index, Index>> elastic;  // joint and the number of its stiffness
  for (Index p = 0; p < columns; ++p) {
    const PlantParameter& parameter = parameters_[static_cast<std::size_t>(p)];
    delay = parameter.kind == PlantParameter::Kind::delay ? p : delay;
    if (parameter.kind == PlantParameter::Kind::stiffness) {
      elastic.emplace_back(static_cast<Index>(parameter.joint), p);
    }
  }
  const auto m = static_cast<Index>(elastic.size());
  Residuals residuals;
  const Index known = (priors_.array() > 0).count();
  const Index own = samples * (n + m);
  residuals.values.resize(own + known);
  residuals.rms.setZero(n);
  if (jacobian) {
    residuals.jacobian.setZero(own + known, columns);
  }
  for (Index p = 0, row = own; p < priors_.size(); ++p) {
    if (priors_[p] > 0) {
      const auto at = static_cast<std::size_t>(p);
      const double weight = prior_weight_ / priors_[p];
      residuals.values[row] = weight * (x[at] - own_[at]);
      if (jacobian) {
        residuals.jacobian(row, p) = weight;
      }
      ++row;
    }
  }
  const double root = std::sqrt(static_cast<double>(samples * n));
  const double share = delay < 0 ? 0 : x[static_cast<std::size_t>(delay)] / motion.period_s;
  for (Index k = 0; k < samples; ++k) {
    for (Index i = 0; i < n; ++i) {
      const Index row = k * n + i;
      const double weight = 1 / (sigma_[i] * root);
      const Shifted recorded =
          delay < 0 ? Shifted{motion.efforts(k, i), 0} : shift(motion.efforts, k, i, share);
      const double error = recorded.value - model.motor[row];
      residuals.rms[i] += error * error;
      residuals.values[row] = weight * error;
      if (jacobian) {
        residuals.jacobian.row(row) = -weight * model.motor_jacobian.row(row);
        if (delay >= 0) {
          residuals.jacobian(row, delay) = weight * recorded.rate / motion.period_s;
        }
      }
    }
  }
  residuals.rms = (residuals.rms / static_cast<double>(samples)).cwiseSqrt();
  for (Index e = 0; e < m; ++e) {
    const auto [i, p] = elastic[static_cast<std::size_t>(e)];
    const double k_stiff = x[static_cast<std::size_t>(p)];
    const double weight = 1 / (delta_[i] * std::sqrt(static_cast<double>(samples * m)));
    for (Index k = 0; k < samples; ++k) {
      const Index row = samples * n + e * samples + k;
      const double effort = model.link[k * n + i];
      residuals.values[row] = weight * (motion.deflections(k, i) -
                                        x[static_cast<std::size_t>(p + 1)] - effort / k_stiff);
      if (jacobian) {
        residuals.jacobian.row(row) = -weight / k_stiff * model.link_jacobian.row(k * n + i);
        residuals.jacobian(row, p) += weight * effort / (k_stiff * k_stiff);
        residuals.jacobian(row, p + 1) -= weight;
      }
    }
  }
  return residuals;
}

std::vector<CaseOutcome> IdentificationProblem::simulate(std::span<const CaseJob> jobs) const {
  std::vector<CaseOutcome> outcomes(jobs.size());
  for (std::size_t job = 0; job < jobs.size(); ++job) {
    const CaseJob& its = jobs[job];
    const auto& motions = its.block->role == CaseRole::test ? judged() : fitted_;
    const Residuals residuals =
        calc_residuals(motions[its.number % motions.size()], its.x, its.jacobian);
    CaseOutcome& outcome = outcomes[job];
    outcome.error = residuals.rms.cwiseQuotient(sigma_).mean();
    if (!std::isfinite(outcome.error) || outcome.error > kFailedFit) {
      outcome.status = EvaluationStatus::diverged;
      outcome.reason = "the model needs efforts without bound";
      outcome.error = 0;
      outcome.has_error = false;
      continue;
    }
    outcome.metrics.assign(residuals.rms.begin(), residuals.rms.end());
    outcome.metrics.push_back(residuals.values.squaredNorm());
    if (its.residuals) {
      outcome.residuals.assign(residuals.values.begin(), residuals.values.end());
    }
    if (its.jacobian) {
      const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> rows =
          residuals.jacobian;
      outcome.jacobian.assign(rows.data(), rows.data() + rows.size());
    }
  }
  return outcomes;
}

Evaluation IdentificationProblem::aggregate(std::span<const double> /*x*/,
                                            std::span<const CaseOutcome> outcomes) const {
  Evaluation evaluation;
  const std::size_t n = robot_.joint_count();
  std::vector<double> squares(n);
  double sum = 0;
  for (const CaseOutcome& outcome : outcomes) {
    if (!add_outcome(outcome, evaluation)) {
      continue;
    }
    sum += outcome.metrics.back();
    for (std::size_t i = 0; i < n; ++i) {
      squares[i] += outcome.metrics[i] * outcome.metrics[i];
    }
  }
  const double count = static_cast<double>(outcomes.size()) - evaluation.failed_cases;
  if (count == 0) {
    return evaluation;
  }
  evaluation.objectives = {sum / count};
  for (const double square : squares) {
    evaluation.metrics.push_back(std::sqrt(square / count));
  }
  const double root = std::sqrt(count);
  for (const CaseOutcome& outcome : outcomes) {
    for (const double residual : outcome.residuals) {
      evaluation.residuals.push_back(residual / root);
    }
    for (const double slope : outcome.jacobian) {
      evaluation.jacobian.push_back(slope / root);
    }
  }
  return evaluation;
}

std::vector<double> IdentificationProblem::penalty_objectives() const {
  return {kFailedFit * kFailedFit};
}

CaseRecord IdentificationProblem::record_case(std::span<const double> x, const CaseBlock& block,
                                              std::uint64_t number) const {
  const auto& motions = block.role == CaseRole::test ? judged() : fitted_;
  const FittedMotion& motion = motions[number % motions.size()];
  const PlantModel::Efforts model = motion.model.calc(x, false);
  const Index n = motion.efforts.cols();
  CaseRecord record;
  record.abscissa = {"time", "s"};
  for (Index k = 0; k < motion.efforts.rows(); ++k) {
    record.abscissa_values.push_back(static_cast<double>(k) * motion.period_s);
  }
  for (Index i = 0; i < n; ++i) {
    const Joint& joint = robot_.joints[static_cast<std::size_t>(i)];
    const std::string unit = get_effort_unit(joint.kind);
    CaseRecord::Series recorded{{joint.name + " recorded", unit}, {}};
    CaseRecord::Series modelled{{joint.name + " model", unit}, {}};
    for (Index k = 0; k < motion.efforts.rows(); ++k) {
      recorded.values.push_back(motion.efforts(k, i));
      modelled.values.push_back(model.motor[k * n + i]);
    }
    record.series.push_back(std::move(recorded));
    record.series.push_back(std::move(modelled));
  }
  return record;
}

const IdentificationProblem* find_identification(const Problem& problem) {
  return dynamic_cast<const IdentificationProblem*>(&problem);
}

}  // namespace armwright
