#include "optimizers/turbo/gaussian_process.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "optimizers/turbo/box_descent.hpp"

namespace armwright {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kRoot5 = 2.23606797749978969641;
constexpr Index kFrequencies = 256;

// A prior that is normal in the logarithm of a hyperparameter, and the bounds of the logarithm.
struct Prior {
  double mean = 0;
  double deviation = 0;
  double lower = 0;
  double upper = 0;
};

// Length scales grow with the root of the number of variables, as the distances in the box do
// (Hvarfner, Hellsten and Nardi 2024, Vanilla Bayesian optimization performs great in high
// dimensions). The other numbers are ours, for standardised values: s^2 is near 1, and the noise may
// have any share from rounding errors to everything.
Prior make_length_prior(Index variables) {
  return {.mean = std::log(0.5 * std::sqrt(static_cast<double>(variables))),
          .deviation = 1,
          .lower = std::log(5e-3),
          .upper = std::log(200.0)};
}
const Prior kVariancePrior{
    .mean = 0, .deviation = 1.5, .lower = std::log(1e-2), .upper = std::log(1e4)};
const Prior kNoisePrior{
    .mean = std::log(1e-6), .deviation = 3, .lower = std::log(1e-9), .upper = 0};

std::vector<Prior> make_priors(Index variables) {
  std::vector<Prior> priors(static_cast<std::size_t>(variables), make_length_prior(variables));
  priors.push_back(kVariancePrior);
  priors.push_back(kNoisePrior);
  return priors;
}

// Returns the squared distances of the columns of a and b, both already scaled. A negative rounding
// error becomes 0.
MatrixXd calc_squared_distances(const MatrixXd& a, const MatrixXd& b) {
  MatrixXd squares = -2 * a.transpose() * b;
  squares.colwise() += a.colwise().squaredNorm().transpose();
  squares.rowwise() += b.colwise().squaredNorm();
  return squares.cwiseMax(0);
}

// Turns squared distances into the kernel for s^2 = 1.
void apply_kernel(MatrixXd& squares) {
  for (double& entry : squares.reshaped()) {
    const double r = kRoot5 * std::sqrt(entry);
    entry = (1 + r + r * r / 3) * std::exp(-r);
  }
}

// Does the same for the squared distances of places among themselves. If `slopes` is not null, writes
// -2 times the kernel's derivative with respect to the squared distance.
void apply_symmetric_kernel(MatrixXd& squares, MatrixXd* slopes) {
  if (slopes != nullptr) {
    slopes->resize(squares.rows(), squares.cols());
  }
  for (Index j = 0; j < squares.cols(); ++j) {
    squares(j, j) = 0;
    for (Index i = j; i < squares.rows(); ++i) {
      const double r = kRoot5 * std::sqrt(squares(i, j));
      const double decay = std::exp(-r);
      squares(i, j) = (1 + r + r * r / 3) * decay;
      squares(j, i) = squares(i, j);
      if (slopes != nullptr) {
        (*slopes)(i, j) = 5.0 / 3 * (1 + r) * decay;
        (*slopes)(j, i) = (*slopes)(i, j);
      }
    }
  }
}

}  // namespace

VectorXd ProcessFunction::calc_values(const MatrixXd& features) const {
  const MatrixXd scaled = inverse_lengths_.asDiagonal() * features;
  MatrixXd kernel = calc_squared_distances(data_, scaled);
  apply_kernel(kernel);
  VectorXd values = variance_ * (kernel.transpose() * weights_);
  values.array() += mean_;
  if (frequencies_.rows() > 0) {
    const MatrixXd phases = frequencies_ * scaled;
    for (Index j = 0; j < phases.cols(); ++j) {
      for (Index i = 0; i < phases.rows(); ++i) {
        values[j] +=
            cosine_weights_[i] * std::cos(phases(i, j)) + sine_weights_[i] * std::sin(phases(i, j));
      }
    }
  }
  return values;
}

double ProcessFunction::calc_gradient(const VectorXd& features, VectorXd& gradient) const {
  const VectorXd scaled = inverse_lengths_.cwiseProduct(features);
  double value = mean_;
  VectorXd slope = VectorXd::Zero(scaled.size());
  for (Index k = 0; k < data_.cols(); ++k) {
    const double r = kRoot5 * (scaled - data_.col(k)).norm();
    const double factor = variance_ * weights_[k] * std::exp(-r);
    value += factor * (1 + r + r * r / 3);
    slope -= factor * 5.0 / 3 * (1 + r) * (scaled - data_.col(k));
  }
  for (Index k = 0; k < frequencies_.rows(); ++k) {
    const double phase = frequencies_.row(k).dot(scaled);
    const double cosine = std::cos(phase);
    const double sine = std::sin(phase);
    value += cosine_weights_[k] * cosine + sine_weights_[k] * sine;
    slope +=
        (sine_weights_[k] * cosine - cosine_weights_[k] * sine) * frequencies_.row(k).transpose();
  }
  gradient = inverse_lengths_.cwiseProduct(slope);
  return value;
}

GaussianProcess::GaussianProcess(std::vector<std::size_t> feature_variables)
    : feature_variables_(std::move(feature_variables)),
      variables_(static_cast<Index>(feature_variables_.back()) + 1),
      hyperparameters_(variables_ + 2) {
  const std::vector<Prior> priors = make_priors(variables_);
  for (Index i = 0; i < hyperparameters_.size(); ++i) {
    hyperparameters_[i] = priors[static_cast<std::size_t>(i)].mean;
  }
}

VectorXd GaussianProcess::calc_inverse_lengths(const Hyperparameters& at) const {
  VectorXd inverse(static_cast<Index>(feature_variables_.size()));
  for (Index f = 0; f < inverse.size(); ++f) {
    inverse[f] = std::exp(-at[static_cast<Index>(feature_variables_[static_cast<std::size_t>(f)])]);
  }
  return inverse;
}

void GaussianProcess::condition(const MatrixXd& features, const VectorXd& values) {
  const Index known = factor_.rows();
  const bool extends = known > 0 && known <= features.cols() &&
                       factor_hyperparameters_ == hyperparameters_ &&
                       features_ == features.leftCols(known);
  features_ = features;
  values_ = values;
  if (extends) {
    extend_factor(known);
  } else {
    factorise();
  }
  const auto lower = factor_.triangularView<Eigen::Lower>();
  const VectorXd ones = lower.solve(VectorXd::Ones(values_.size()));
  const VectorXd half = lower.solve(values_);
  mean_ = ones.dot(half) / ones.squaredNorm();
  weights_ = factor_.transpose().triangularView<Eigen::Upper>().solve(half - mean_ * ones);
}

// Returns the covariance of the values at places among themselves.
MatrixXd GaussianProcess::calc_covariance(const MatrixXd& scaled) const {
  MatrixXd covariance = calc_squared_distances(scaled, scaled);
  apply_symmetric_kernel(covariance, nullptr);
  covariance *= std::exp(hyperparameters_[variables_]);
  covariance.diagonal().array() += std::exp(hyperparameters_[variables_ + 1]);
  return covariance;
}

void GaussianProcess::factorise() {
  constexpr double kMoreNoise = 10;
  constexpr double kLeastAdded = 1e-12;  // of the variance, far above the rounding errors
  const MatrixXd scaled = calc_inverse_lengths(hyperparameters_).asDiagonal() * features_;
  Eigen::LLT<MatrixXd> decomposition(calc_covariance(scaled));
  while (decomposition.info() != Eigen::Success) {
    hyperparameters_[variables_ + 1] =
        std::max(hyperparameters_[variables_ + 1] + std::log(kMoreNoise),
                 hyperparameters_[variables_] + std::log(kLeastAdded));
    decomposition.compute(calc_covariance(scaled));
  }
  factor_ = decomposition.matrixL();
  factor_hyperparameters_ = hyperparameters_;
}

void GaussianProcess::extend_factor(Index known) {
  const Index added = features_.cols() - known;
  if (added == 0) {
    return;
  }
  const MatrixXd scaled = calc_inverse_lengths(hyperparameters_).asDiagonal() * features_;
  MatrixXd across = calc_squared_distances(scaled.leftCols(known), scaled.rightCols(added));
  apply_kernel(across);
  across *= std::exp(hyperparameters_[variables_]);
  const MatrixXd left = factor_.triangularView<Eigen::Lower>().solve(across).transpose();
  const Eigen::LLT<MatrixXd> decomposition(calc_covariance(scaled.rightCols(added)) -
                                           left * left.transpose());
  if (decomposition.info() != Eigen::Success) {
    factorise();
    return;
  }
  factor_.conservativeResize(known + added, known + added);
  factor_.topRightCorner(known, added).setZero();
  factor_.bottomLeftCorner(added, known) = left;
  factor_.bottomRightCorner(added, added) = decomposition.matrixL();
}

double GaussianProcess::calc_log_posterior(const MatrixXd& features, const VectorXd& values,
                                           const Hyperparameters& at, VectorXd& gradient) const {
  const Index n = variables_;
  const Index count = values.size();
  gradient.setZero(n + 2);
  const MatrixXd scaled = calc_inverse_lengths(at).asDiagonal() * features;
  MatrixXd kernel = calc_squared_distances(scaled, scaled);
  MatrixXd slopes;
  apply_symmetric_kernel(kernel, &slopes);
  const double variance = std::exp(at[n]);
  const double noise = std::exp(at[n + 1]);
  MatrixXd covariance = variance * kernel;
  covariance.diagonal().array() += noise;
  const Eigen::LLT<MatrixXd> decomposition(covariance);
  if (decomposition.info() != Eigen::Success) {
    return -std::numeric_limits<double>::infinity();
  }
  // The inverse, from which every derivative is a sum over its entries.
  const MatrixXd precision = decomposition.solve(MatrixXd::Identity(count, count));
  const VectorXd sums = precision.rowwise().sum();
  const double mean = sums.dot(values) / sums.sum();
  const VectorXd weights = precision * values - mean * sums;
  double log_determinant = 0;
  for (Index i = 0; i < count; ++i) {
    log_determinant += std::log(decomposition.matrixLLT()(i, i));
  }
  double value = -0.5 * (values.array() - mean).matrix().dot(weights) - log_determinant;
  // Half the difference of w w^T and K^-1. The mean is a maximum, so its derivatives vanish.
  const MatrixXd half = 0.5 * (weights * weights.transpose() - precision);
  gradient[n] = variance * half.cwiseProduct(kernel).sum();
  gradient[n + 1] = noise * half.trace();
  const MatrixXd pulls = variance * half.cwiseProduct(slopes);
  const VectorXd pull_sums = pulls.rowwise().sum();
  // sum_ij P_ij (x_i - x_j)^2 = 2 sum_i (sum_j P_ij) x_i^2 - 2 x^T P x per feature
  const MatrixXd products = scaled * pulls;
  for (Index f = 0; f < scaled.rows(); ++f) {
    gradient[static_cast<Index>(feature_variables_[static_cast<std::size_t>(f)])] +=
        2 * (scaled.row(f).array().square().matrix().dot(pull_sums) -
             scaled.row(f).dot(products.row(f)));
  }
  const std::vector<Prior> priors = make_priors(n);
  for (Index i = 0; i < n + 2; ++i) {
    const Prior& prior = priors[static_cast<std::size_t>(i)];
    const double z = (at[i] - prior.mean) / prior.deviation;
    value -= 0.5 * z * z;
    gradient[i] -= z / prior.deviation;
  }
  return value;
}

void GaussianProcess::fit(const MatrixXd& features, const VectorXd& values, int iterations) {
  constexpr double kNoisyStart = 0.1;
  const std::vector<Prior> priors = make_priors(variables_);
  Box box{VectorXd(variables_ + 2), VectorXd(variables_ + 2)};
  for (Index i = 0; i < hyperparameters_.size(); ++i) {
    box.lower[i] = priors[static_cast<std::size_t>(i)].lower;
    box.upper[i] = priors[static_cast<std::size_t>(i)].upper;
  }
  const SmoothFunction loss = [&](const VectorXd& at, VectorXd& gradient) {
    const double value = -calc_log_posterior(features, values, at, gradient);
    gradient = -gradient;
    return value;
  };
  // Short length scales and much noise can explain the same values, and each is a local maximum.
  Hyperparameters present = hyperparameters_.cwiseMax(box.lower).cwiseMin(box.upper);
  Hyperparameters noisy = GaussianProcess(feature_variables_).hyperparameters();
  noisy[variables_ + 1] = std::log(kNoisyStart);
  const double present_loss = descend_in_box(loss, box, iterations, present);
  const double noisy_loss = descend_in_box(loss, box, iterations, noisy);
  hyperparameters_ = noisy_loss < present_loss ? noisy : present;
}

ProcessFunction GaussianProcess::mean() const {
  ProcessFunction function;
  function.mean_ = mean_;
  function.variance_ = std::exp(hyperparameters_[variables_]);
  function.inverse_lengths_ = calc_inverse_lengths(hyperparameters_);
  function.data_ = function.inverse_lengths_.asDiagonal() * features_;
  function.weights_ = weights_;
  return function;
}

ProcessFunction GaussianProcess::draw_sample(RandomStream& random) const {
  ProcessFunction sample = mean();
  // The spectrum of the kernel is a multivariate t distribution with 5 degrees of freedom.
  constexpr int kFreedom = 5;
  sample.frequencies_.resize(kFrequencies, sample.data_.rows());
  sample.cosine_weights_.resize(kFrequencies);
  sample.sine_weights_.resize(kFrequencies);
  const double scale = std::sqrt(sample.variance_ / static_cast<double>(kFrequencies));
  for (Index i = 0; i < kFrequencies; ++i) {
    double chi_square = 0;
    for (int k = 0; k < kFreedom; ++k) {
      const double z = random.normal();
      chi_square += z * z;
    }
    for (Index f = 0; f < sample.data_.rows(); ++f) {
      sample.frequencies_(i, f) = random.normal() / std::sqrt(chi_square / kFreedom);
    }
    sample.cosine_weights_[i] = scale * random.normal();
    sample.sine_weights_[i] = scale * random.normal();
  }
  const double noise_deviation = std::exp(0.5 * hyperparameters_[variables_ + 1]);
  VectorXd gaps = values_;
  const MatrixXd phases = sample.frequencies_ * sample.data_;
  for (Index j = 0; j < gaps.size(); ++j) {
    double prior = mean_ + noise_deviation * random.normal();
    for (Index i = 0; i < kFrequencies; ++i) {
      prior += sample.cosine_weights_[i] * std::cos(phases(i, j)) +
               sample.sine_weights_[i] * std::sin(phases(i, j));
    }
    gaps[j] -= prior;
  }
  sample.weights_ = factor_.transpose().triangularView<Eigen::Upper>().solve(
      factor_.triangularView<Eigen::Lower>().solve(gaps));
  return sample;
}

}  // namespace armwright
