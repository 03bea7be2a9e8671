// Gaussian process regression with a Matern 5/2 kernel and one length scale per variable. With
//   r^2 = sum over the features f of (x_f - x'_f)^2 / l_i(f)^2,
//   k(r) = s^2 (1 + sqrt(5) r + 5/3 r^2) exp(-sqrt(5) r),
// values y at places X have the covariance K = k(X, X) + v I and the mean m, which is the generalised
// least-squares estimate m = 1^T K^-1 y / 1^T K^-1 1. l are the length scales, s^2 is the variance of
// the function and v the variance of the noise. They maximise the marginal likelihood times
// log-normal priors. Source: Rasmussen and Williams 2006, Gaussian Processes for Machine Learning,
// equations 2.25, 4.17, 5.8 and 5.9.
//
// Samples of the posterior are functions with a gradient, by Matheron's rule: a sample of the prior,
// made of random Fourier features, plus the kernel's correction at the data (Wilson et al. 2020,
// Efficiently sampling functions from Gaussian process posteriors). Limits: a sample of the prior is
// a sum of 256 waves.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "base/decompositions.hpp"
#include "base/random.hpp"

namespace armwright {

// The logarithms of the length scales, then of s^2 and of v.
using Hyperparameters = Eigen::VectorXd;

// A function of features: the posterior's mean, or a sample. It stays valid on its own.
class ProcessFunction {
 public:
  // Returns the value at each column.
  Eigen::VectorXd calc_values(const Eigen::MatrixXd& features) const;
  // Returns the value at one place and writes the gradient with respect to its features.
  double calc_gradient(const Eigen::VectorXd& features, Eigen::VectorXd& gradient) const;

 private:
  friend class GaussianProcess;

  double mean_ = 0;
  double variance_ = 0;
  Eigen::VectorXd inverse_lengths_;  // one per feature
  Eigen::MatrixXd data_;             // the scaled features of the data, one place per column
  Eigen::VectorXd weights_;          // one per place of the data
  Eigen::MatrixXd frequencies_;      // one row per wave; no rows: no sample of the prior
  Eigen::VectorXd cosine_weights_;
  Eigen::VectorXd sine_weights_;
};

class GaussianProcess {
 public:
  // `feature_variables` has the variable of each feature. The variables are 0, 1, ..., in order.
  explicit GaussianProcess(std::vector<std::size_t> feature_variables);

  const Hyperparameters& hyperparameters() const { return hyperparameters_; }
  void set_hyperparameters(const Hyperparameters& values) { hyperparameters_ = values; }

  // Returns the logarithm of the marginal likelihood of the values times the priors, up to a
  // constant, and writes its gradient. Returns minus infinity where the covariance has no Cholesky
  // factor. Costs about N^3 multiplications for N places.
  double calc_log_posterior(const Eigen::MatrixXd& features, const Eigen::VectorXd& values,
                            const Hyperparameters& at, Eigen::VectorXd& gradient) const;
  // Maximises that in at most `iterations` steps, once from the present hyperparameters and once from
  // the means of the priors with much noise. Keeps the better result.
  void fit(const Eigen::MatrixXd& features, const Eigen::VectorXd& values, int iterations);

  // Replaces the data on which the process is conditioned: one place per column, and its value. If
  // the first columns are the places of the last call and the hyperparameters are the same, only the
  // new rows of the Cholesky factor are computed. Adds noise if rounding leaves no factor.
  void condition(const Eigen::MatrixXd& features, const Eigen::VectorXd& values);

  // Return the mean and a sample of the posterior, for the last data.
  ProcessFunction mean() const;
  ProcessFunction draw_sample(RandomStream& random) const;

 private:
  Eigen::VectorXd calc_inverse_lengths(const Hyperparameters& at) const;
  Eigen::MatrixXd calc_covariance(const Eigen::MatrixXd& scaled) const;
  void factorise();
  void extend_factor(Eigen::Index known);

  std::vector<std::size_t> feature_variables_;
  Eigen::Index variables_;
  Hyperparameters hyperparameters_;
  Hyperparameters factor_hyperparameters_;  // those of the factor
  Eigen::MatrixXd features_;
  Eigen::VectorXd values_;
  Eigen::MatrixXd factor_;  // lower triangle
  double mean_ = 0;
  Eigen::VectorXd weights_;  // K^-1 (y - m)
};

}  // namespace armwright
