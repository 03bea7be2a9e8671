#include "study/identification/fit_analysis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>

#include "base/decompositions.hpp"
#include "base/text.hpp"
#include "problems/identification/residual_memory.hpp"

namespace armwright {
namespace {

using Eigen::Index;

constexpr double kConfidence = 0.95;
constexpr int kWhitenessLags = 10;
constexpr double kWindow = 8;
// The smallest eigenvalue that is not rounding, as a share of the largest, of the normal matrix with
// columns of length 1.
constexpr double kNoInformation = 1e-11;
// The part in such a direction from which on a parameter counts as undetermined.
constexpr double kPart = 0.05;
// An interval of more than this share of the box tells nothing.
constexpr double kWide = 0.5;
constexpr double kStrong = 0.9;
constexpr double kAtBound = 1e-6;

// The residuals of one channel of one motion, evenly spaced in time.
struct Channel {
  std::vector<Index> rows;
  double period_s = 0;
  double cutoff_hz = 0;
};

std::vector<Channel> list_channels(const IdentificationProblem& problem,
                                   const FittedMotion& motion) {
  const auto n = static_cast<Index>(problem.robot().joint_count());
  const Index samples = motion.efforts.rows();
  std::vector<Channel> channels;
  for (Index i = 0; i < n; ++i) {
    Channel& channel = channels.emplace_back(Channel{{}, motion.period_s, motion.cutoff_hz});
    for (Index k = 0; k < samples; ++k) {
      channel.rows.push_back(k * n + i);
    }
  }
  const Index elastic = (problem.deflection_scales().array() > 0).count();
  for (Index e = 0; e < elastic; ++e) {
    Channel& channel = channels.emplace_back(Channel{{}, motion.period_s, motion.cutoff_hz});
    for (Index k = 0; k < samples; ++k) {
      channel.rows.push_back(samples * n + e * samples + k);
    }
  }
  return channels;
}

std::vector<double> pick(const Eigen::VectorXd& values, const Channel& channel) {
  std::vector<double> some;
  for (const Index row : channel.rows) {
    some.push_back(values[row]);
  }
  return some;
}

double count_dependent(const std::vector<double>& values, const Channel& channel) {
  return armwright::count_dependent(values, channel.period_s, channel.cutoff_hz);
}

// Returns J^T R J, R being the residuals' correlations: those at a lag count less the longer it is, so
// that R is positive definite (Bartlett's window). The window ends at kWindow times the residuals' own
// memory: the longer it is, the more of the noise that the fit has taken away is missing in the sum.
Eigen::MatrixXd calc_spread(const Eigen::MatrixXd& rows, const std::vector<double>& values,
                            double dependent) {
  const Index count = rows.rows();
  const auto longest = static_cast<Index>(
      std::min(kLongestMemory * static_cast<double>(count), kWindow * dependent));
  Eigen::MatrixXd spread = rows.transpose() * rows;
  for (Index lag = 1; lag < longest; ++lag) {
    const double weight = 1 - static_cast<double>(lag) / static_cast<double>(longest);
    const Eigen::MatrixXd product =
        rows.bottomRows(count - lag).transpose() * rows.topRows(count - lag);
    spread += weight * calc_correlation(values, static_cast<std::size_t>(lag)) *
              (product + product.transpose());
  }
  return spread;
}

// Returns the p-value of the test of Ljung and Box on every `stride`-th value.
double calc_whiteness(const std::vector<double>& values, std::size_t stride) {
  std::vector<double> thinned;
  double mean = 0;
  for (std::size_t k = 0; k < values.size(); k += stride) {
    thinned.push_back(values[k]);
    mean += values[k];
  }
  mean /= static_cast<double>(thinned.size());
  for (double& value : thinned) {
    value -= mean;
  }
  const auto count = static_cast<double>(thinned.size());
  double q = 0;
  for (int lag = 1; lag <= kWhitenessLags && lag + 1 < static_cast<int>(count); ++lag) {
    const double correlation = calc_correlation(thinned, static_cast<std::size_t>(lag));
    q += count * (count + 2) * correlation * correlation / (count - lag);
  }
  return boost::math::cdf(boost::math::complement(boost::math::chi_squared(kWhitenessLags), q));
}

FitSet compare(const IdentificationProblem& problem, const std::vector<FittedMotion>& motions,
               std::span<const double> x) {
  FitSet set;
  const auto n = static_cast<Index>(problem.robot().joint_count());
  Eigen::VectorXd before = Eigen::VectorXd::Zero(n), after = before;
  const std::vector<double>& own = problem.own_values();
  set.joints.resize(static_cast<std::size_t>(n));
  Eigen::RowVectorXd sums = Eigen::RowVectorXd::Zero(n), squares = sums;
  double samples = 0;
  for (const FittedMotion& motion : motions) {
    set.logs.push_back(motion.name);
    sums += motion.efforts.colwise().sum();
    squares += motion.efforts.colwise().squaredNorm();
    samples += static_cast<double>(motion.efforts.rows());
    before += problem.calc_residuals(motion, own, false).rms.cwiseAbs2();
    const IdentificationProblem::Residuals found = problem.calc_residuals(motion, x, false);
    after += found.rms.cwiseAbs2();
    const std::vector<Channel> channels = list_channels(problem, motion);
    for (Index i = 0; i < n; ++i) {
      const Channel& channel = channels[static_cast<std::size_t>(i)];
      const std::vector<double> values = pick(found.values, channel);
      const double independent = 1 / (2 * std::max(channel.cutoff_hz, 1e-9) * channel.period_s);
      JointFit& joint = set.joints[static_cast<std::size_t>(i)];
      const double p =
          calc_whiteness(values, static_cast<std::size_t>(std::max(1.0, std::ceil(independent))));
      joint.whiteness_p = set.logs.size() == 1 ? p : std::min(p, joint.whiteness_p);
      joint.independent_s =
          std::max(joint.independent_s, channel.period_s * count_dependent(values, channel));
    }
  }
  const auto count = static_cast<double>(motions.size());
  for (Index i = 0; i < n; ++i) {
    const Joint& own_joint = problem.robot().joints[static_cast<std::size_t>(i)];
    JointFit& joint = set.joints[static_cast<std::size_t>(i)];
    joint.joint = own_joint.name;
    joint.unit = get_effort_unit(own_joint.kind);
    joint.deviation = std::sqrt(squares[i] / samples - sums[i] * sums[i] / samples / samples);
    joint.before = std::sqrt(before[i] / count);
    joint.after = std::sqrt(after[i] / count);
    set.before += joint.before / joint.deviation / static_cast<double>(n);
    set.after += joint.after / joint.deviation / static_cast<double>(n);
  }
  return set;
}

// The normal matrix J^T J of all fitted motions, and what the channels make of it.
struct Information {
  Eigen::MatrixXd normal, spread;  // J^T J, and the sum of s_i^2 J_i^T R_i J_i
  double independent = 0;          // samples
};

Information gather(const IdentificationProblem& problem, std::span<const double> x) {
  const auto p = static_cast<Index>(x.size());
  Information all{Eigen::MatrixXd::Zero(p, p), Eigen::MatrixXd::Zero(p, p), 0};
  for (const FittedMotion& motion : problem.fitted()) {
    const IdentificationProblem::Residuals residuals = problem.calc_residuals(motion, x, true);
    for (const Channel& channel : list_channels(problem, motion)) {
      Eigen::MatrixXd rows(static_cast<Index>(channel.rows.size()), p);
      for (Index k = 0; k < rows.rows(); ++k) {
        rows.row(k) = residuals.jacobian.row(channel.rows[static_cast<std::size_t>(k)]);
      }
      const std::vector<double> values = pick(residuals.values, channel);
      double square = 0;
      for (const double value : values) {
        square += value * value / static_cast<double>(values.size());
      }
      const double dependent = count_dependent(values, channel);
      all.normal += rows.transpose() * rows;
      all.spread += square * calc_spread(rows, values, dependent);
      all.independent += static_cast<double>(values.size()) / dependent;
    }
  }
  // What is known beforehand is the same in all motions.
  const auto motions = static_cast<double>(problem.fitted().size());
  for (Index i = 0; i < p; ++i) {
    if (problem.priors()[i] > 0) {
      const double information = std::pow(problem.prior_weight() / problem.priors()[i], 2);
      all.normal(i, i) += motions * information;
      all.spread(i, i) += std::pow(motions * problem.prior_weight(), 2) * information;
    }
  }
  return all;
}

// Says which parameters only a combination of which is known, and marks them.
void find_unknown(const Eigen::MatrixXd& directions, std::vector<FittedParameter>& parameters,
                  std::vector<std::string>& sentences) {
  for (Index d = 0; d < directions.cols(); ++d) {
    std::vector<std::string> names;
    for (Index i = 0; i < directions.rows(); ++i) {
      if (std::abs(directions(i, d)) > kPart) {
        FittedParameter& parameter = parameters[static_cast<std::size_t>(i)];
        names.push_back(parameter.name);
        parameter.is_determined = false;
      }
    }
    sentences.push_back(
        names.size() == 1
            ? fmt::format("{} cannot be told from this motion: it moves no effort", names.front())
            : fmt::format("only combinations of {} can be told from this motion",
                          join(names, ", ")));
  }
}

}  // namespace

FitAnalysis analyse_fit(const IdentificationProblem& problem, std::span<const double> x) {
  FitAnalysis analysis;
  const auto& variables = problem.description().variables;
  const Information information = gather(problem, x);
  const auto p = static_cast<Index>(x.size());
  const std::vector<double>& own = problem.own_values();
  for (std::size_t i = 0; i < x.size(); ++i) {
    const DecisionVariable& variable = variables[i];
    const double near = kAtBound * (variable.upper - variable.lower);
    analysis.parameters.push_back(
        {.name = variable.name,
         .unit = variable.unit,
         .before = own[i],
         .start = variable.start,
         .value = x[i],
         .is_at_bound = x[i] < variable.lower + near || x[i] > variable.upper - near});
  }
  const Eigen::VectorXd lengths =
      information.normal.diagonal().cwiseSqrt().cwiseMax(std::numeric_limits<double>::min());
  const Eigen::VectorXd inverse_lengths = lengths.cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(Eigen::MatrixXd(
      inverse_lengths.asDiagonal() * information.normal * inverse_lengths.asDiagonal()));
  const Eigen::VectorXd& eigenvalues = solver.eigenvalues();
  const double largest = eigenvalues.maxCoeff();
  const Index unknown = (eigenvalues.array() <= kNoInformation * largest).count();
  find_unknown(solver.eigenvectors().leftCols(unknown), analysis.parameters, analysis.undetermined);
  analysis.condition =
      unknown < p ? std::sqrt(largest / eigenvalues[unknown]) : std::numeric_limits<double>::max();
  const Index known = p - unknown;
  const Eigen::MatrixXd basis =
      inverse_lengths.asDiagonal() * solver.eigenvectors().rightCols(known);
  const Eigen::MatrixXd inverse =
      basis * eigenvalues.tail(known).cwiseInverse().asDiagonal() * basis.transpose();
  const double freedom = std::max(1.0, information.independent - static_cast<double>(known));
  analysis.covariance = information.independent / freedom * inverse * information.spread * inverse;
  const double quantile =
      boost::math::quantile(boost::math::students_t(freedom), 0.5 * (1 + kConfidence));
  for (Index i = 0; i < p; ++i) {
    FittedParameter& parameter = analysis.parameters[static_cast<std::size_t>(i)];
    parameter.standard_error = std::sqrt(std::max(0.0, analysis.covariance(i, i)));
    const double half = quantile * parameter.standard_error;
    parameter.lower = parameter.value - half;
    parameter.upper = parameter.value + half;
    const DecisionVariable& variable = variables[static_cast<std::size_t>(i)];
    if (parameter.is_determined && half > kWide * (variable.upper - variable.lower)) {
      parameter.is_determined = false;
      analysis.undetermined.push_back(fmt::format(
          "{} cannot be told from this motion: its interval is {:.3g} +- {:.3g}{}", parameter.name,
          parameter.value, half, parameter.unit.empty() ? "" : " " + parameter.unit));
    }
    for (Index k = 0; k < i; ++k) {
      const double both = std::sqrt(analysis.covariance(i, i) * analysis.covariance(k, k));
      const double correlation = both > 0 ? analysis.covariance(i, k) / both : 0;
      if (std::abs(correlation) > kStrong) {
        analysis.correlations.push_back(
            {analysis.parameters[static_cast<std::size_t>(k)].name, parameter.name, correlation});
      }
    }
  }
  analysis.fitted = compare(problem, problem.fitted(), x);
  if (!problem.held_back().empty()) {
    analysis.judged = compare(problem, problem.held_back(), x);
  }
  return analysis;
}

RobotModel make_fitted_robot(const IdentificationProblem& problem, std::span<const double> x) {
  RobotModel robot = problem.robot();
  set_parameters(robot, problem.parameters(), x);
  for (const PlantParameter& parameter : problem.parameters()) {
    if (parameter.kind == PlantParameter::Kind::inertia) {
      robot.payload.reset();  // the last link's numbers include it
    }
  }
  return robot;
}

FittedPlant make_fitted_plant(const IdentificationProblem& problem, std::span<const double> x,
                              const FitAnalysis& analysis) {
  FittedPlant fitted;
  std::vector<Index> kept;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const PlantParameter& parameter = problem.parameters()[i];
    if (parameter.kind == PlantParameter::Kind::delay) {
      fitted.delay_s = x[i];
    } else if (parameter.kind != PlantParameter::Kind::encoder_offset) {
      fitted.parameters.push_back(parameter);
      fitted.values.push_back(x[i]);
      kept.push_back(static_cast<Index>(i));
    }
  }
  fitted.covariance = analysis.covariance(kept, kept);
  for (std::size_t i = 0; i < kept.size(); ++i) {
    if (!analysis.parameters[static_cast<std::size_t>(kept[i])].is_determined) {
      fitted.covariance.row(static_cast<Index>(i)).setZero();
      fitted.covariance.col(static_cast<Index>(i)).setZero();
    }
  }
  return fitted;
}

}  // namespace armwright
