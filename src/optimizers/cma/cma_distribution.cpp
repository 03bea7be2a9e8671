#include "optimizers/cma/cma_distribution.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "base/decompositions.hpp"

namespace armwright {
namespace {

constexpr double kAlphaCov = 2;  // of the tutorial's table 1

double choose(double given, double fallback) {
  return given > 0 ? given : fallback;
}

// Returns (sum w)^2 / sum w^2.
double calc_selection_mass(std::span<const double> weights) {
  double sum = 0;
  double squares = 0;
  for (const double w : weights) {
    sum += w;
    squares += w * w;
  }
  return squares > 0 ? sum * sum / squares : 0;
}

void scale_to_sum(std::span<double> weights, double sum) {
  double current = 0;
  for (const double w : weights) {
    current += w;
  }
  for (double& w : weights) {
    w = current == 0 ? 0 : w * sum / current;
  }
}

// Rotates the columns, n at a time, until they are at right angles (Gram and Schmidt, done twice
// against rounding errors). They keep their lengths.
void make_orthogonal(Eigen::MatrixXd& z) {
  const Eigen::Index n = z.rows();
  for (Eigen::Index i = 0; i < z.cols(); ++i) {
    const Eigen::Index others = i % n;
    const double length = z.col(i).norm();
    for (int pass = 0; pass < 2; ++pass) {
      for (Eigen::Index k = i - others; k < i; ++k) {
        z.col(i) -= z.col(k).dot(z.col(i)) / std::max(z.col(k).squaredNorm(), 1e-300) * z.col(k);
      }
    }
    z.col(i) *= length / std::max(z.col(i).norm(), 1e-300);
  }
}

}  // namespace

std::size_t calc_default_population(std::size_t dimension) {
  return 4 + static_cast<std::size_t>(std::floor(3 * std::log(static_cast<double>(dimension))));
}

CmaParameters make_cma_parameters(std::size_t dimension, const CmaSettings& settings) {
  assert(dimension >= 1);
  const auto n = static_cast<double>(dimension);
  CmaParameters p;
  p.dimension = dimension;
  p.population = settings.population > 0 ? settings.population : calc_default_population(dimension);
  p.mu = settings.mu > 0 ? settings.mu : p.population / 2;
  assert(p.population >= 2 && p.mu <= p.population);

  // With another mu than the tutorial's, the logarithm passes zero at another place.
  const double zero = settings.mu > 0 ? static_cast<double>(p.mu) + 0.5
                                      : (static_cast<double>(p.population) + 1) / 2;
  for (std::size_t i = 1; i <= p.population; ++i) {
    p.weights.push_back(std::log(zero) - std::log(static_cast<double>(i)));
  }
  const std::span<double> positive = std::span(p.weights).first(p.mu);
  const std::span<double> negative = std::span(p.weights).subspan(p.mu);
  p.mu_eff = calc_selection_mass(positive);
  const double mu_eff = p.mu_eff;

  p.c_sigma = choose(settings.c_sigma, (mu_eff + 2) / (n + mu_eff + 5));
  p.d_sigma = choose(settings.d_sigma,
                     1 + 2 * std::max(0.0, std::sqrt((mu_eff - 1) / (n + 1)) - 1) + p.c_sigma);
  p.c_c = choose(settings.c_c, (4 + mu_eff / n) / (n + 4 + 2 * mu_eff / n));
  p.c_1 = choose(settings.c_1, kAlphaCov / ((n + 1.3) * (n + 1.3) + mu_eff));
  const double rank_mu =
      kAlphaCov * (0.25 + mu_eff + 1 / mu_eff - 2) / ((n + 2) * (n + 2) + kAlphaCov * mu_eff / 2);
  p.c_mu = std::min(1 - p.c_1, choose(settings.c_mu, rank_mu));

  scale_to_sum(positive, 1);
  double negative_sum = 0;
  if (settings.active && p.c_mu > 0) {
    const double no_decay = 1 + p.c_1 / p.c_mu;
    const double by_mass = 1 + 2 * calc_selection_mass(negative) / (mu_eff + 2);
    const double positive_definite = (1 - p.c_1 - p.c_mu) / (n * p.c_mu);
    negative_sum = -std::min({no_decay, by_mass, positive_definite});
  }
  scale_to_sum(negative, negative_sum);

  p.orthogonal = settings.orthogonal;
  p.expected_norm = std::sqrt(n) * (1 - 1 / (4 * n) + 1 / (21 * n * n));
  p.decomposition_interval = std::max(
      std::int64_t{1}, static_cast<std::int64_t>(std::min(1e6, 1 / (10 * n * (p.c_1 + p.c_mu)))));
  return p;
}

struct CmaDistribution::State {
  Eigen::VectorXd mean;
  Eigen::VectorXd scales;  // a: of the samples, one per coordinate
  Eigen::VectorXd sigma_path;
  Eigen::VectorXd covariance_path;
  Eigen::MatrixXd covariance;
  Eigen::MatrixXd axes;     // B: eigenvectors, in columns
  Eigen::VectorXd lengths;  // D: square roots of the eigenvalues, ascending
  Eigen::MatrixXd z;        // one column an individual, N(0, I)
  Eigen::MatrixXd y;        // B D z
  Eigen::MatrixXd scaled;   // scratch of the update
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
};

CmaDistribution::CmaDistribution(CmaParameters parameters, std::span<const double> mean,
                                 double sigma)
    : parameters_(std::move(parameters)), sigma_(sigma), state_(std::make_unique<State>()) {
  assert(mean.size() == parameters_.dimension);
  const auto n = static_cast<Eigen::Index>(parameters_.dimension);
  const auto population = static_cast<Eigen::Index>(parameters_.population);
  State& s = *state_;
  s.mean = Eigen::Map<const Eigen::VectorXd>(mean.data(), n);
  s.scales = Eigen::VectorXd::Ones(n);
  s.sigma_path = Eigen::VectorXd::Zero(n);
  s.covariance_path = Eigen::VectorXd::Zero(n);
  s.covariance = Eigen::MatrixXd::Identity(n, n);
  s.axes = Eigen::MatrixXd::Identity(n, n);
  s.lengths = Eigen::VectorXd::Ones(n);
  s.z.resize(n, population);
  s.y.resize(n, population);
  s.scaled.resize(n, population);
  points_.assign(parameters_.population, std::vector<double>(parameters_.dimension));
}

CmaDistribution::~CmaDistribution() = default;
CmaDistribution::CmaDistribution(CmaDistribution&&) noexcept = default;
CmaDistribution& CmaDistribution::operator=(CmaDistribution&&) noexcept = default;

const std::vector<std::vector<double>>& CmaDistribution::sample(RandomStream& random) {
  State& s = *state_;
  for (Eigen::Index i = 0; i < s.z.cols(); ++i) {
    for (Eigen::Index j = 0; j < s.z.rows(); ++j) {
      s.z(j, i) = random.normal();
    }
  }
  if (parameters_.orthogonal) {
    make_orthogonal(s.z);
  }
  s.y.noalias() = s.axes * (s.lengths.asDiagonal() * s.z);
  for (std::size_t i = 0; i < points_.size(); ++i) {
    Eigen::Map<Eigen::VectorXd>(points_[i].data(), s.mean.size()) =
        s.mean + sigma_ * s.scales.cwiseProduct(s.y.col(static_cast<Eigen::Index>(i)));
  }
  return points_;
}

void CmaDistribution::inject(std::span<const double> point, double most) {
  State& s = *state_;
  const Eigen::VectorXd step =
      (Eigen::Map<const Eigen::VectorXd>(point.data(), s.mean.size()) - s.mean)
          .cwiseQuotient(sigma_ * s.scales);
  s.z.col(0) = (s.axes.transpose() * step).cwiseQuotient(s.lengths);
  s.z.col(0) *= std::min(1.0, most / std::max(s.z.col(0).norm(), 1e-300));
  s.y.col(0).noalias() = s.axes * s.lengths.cwiseProduct(s.z.col(0));
  Eigen::Map<Eigen::VectorXd>(points_[0].data(), s.mean.size()) =
      s.mean + sigma_ * s.scales.cwiseProduct(s.y.col(0));
}

void CmaDistribution::update(std::span<const std::size_t> ranking) {
  const CmaParameters& p = parameters_;
  assert(ranking.size() == p.population);
  State& s = *state_;
  const auto n = static_cast<double>(p.dimension);
  ++generation_;

  Eigen::VectorXd mean_y = Eigen::VectorXd::Zero(s.mean.size());
  Eigen::VectorXd mean_z = Eigen::VectorXd::Zero(s.mean.size());
  for (std::size_t i = 0; i < p.mu; ++i) {
    const auto place = static_cast<Eigen::Index>(ranking[i]);
    mean_y += p.weights[i] * s.y.col(place);
    mean_z += p.weights[i] * s.z.col(place);
  }
  s.mean += sigma_ * mean_y;

  // C^(-1/2) <y>_w = B <z>_w, because y = B D z
  s.sigma_path = (1 - p.c_sigma) * s.sigma_path +
                 std::sqrt(p.c_sigma * (2 - p.c_sigma) * p.mu_eff) * (s.axes * mean_z);
  const double norm = s.sigma_path.norm();
  const double settled =
      std::sqrt(1 - std::pow(1 - p.c_sigma, 2 * static_cast<double>(generation_)));
  const bool is_short = norm / settled < (1.4 + 2 / (n + 1)) * p.expected_norm;
  s.covariance_path *= 1 - p.c_c;
  if (is_short) {
    s.covariance_path += std::sqrt(p.c_c * (2 - p.c_c) * p.mu_eff) * mean_y;
  }

  double weight_sum = 0;
  Eigen::VectorXd weights(s.z.cols());
  for (std::size_t i = 0; i < p.population; ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    const auto place = static_cast<Eigen::Index>(ranking[i]);
    const double w = p.weights[i];
    weight_sum += w;
    weights(column) = w >= 0 ? w : w * n / std::max(s.z.col(place).squaredNorm(), 1e-300);
    s.scaled.col(column) = s.y.col(place);
  }
  const double lost = is_short ? 0 : p.c_c * (2 - p.c_c);
  s.covariance *= 1 + p.c_1 * lost - p.c_1 - p.c_mu * weight_sum;
  s.covariance.noalias() += p.c_1 * (s.covariance_path * s.covariance_path.transpose());
  s.covariance.noalias() += s.scaled * (p.c_mu * weights).asDiagonal() * s.scaled.transpose();

  sigma_ *= std::exp(std::min(1.0, p.c_sigma / p.d_sigma * (norm / p.expected_norm - 1)));
  if (generation_ - decomposed_at_ >= p.decomposition_interval) {
    decompose();
  }
}

void CmaDistribution::decompose() {
  State& s = *state_;
  decomposed_at_ = generation_;
  s.covariance = (0.5 * (s.covariance + s.covariance.transpose())).eval();
  s.solver.compute(s.covariance);
  if (s.solver.info() != Eigen::Success) {
    return;  // the last decomposition is still one of a distribution near this one
  }
  // Rounding may make the smallest eigenvalue negative. The condition number then ends the run.
  const double floor = 1e-20 * std::max(s.solver.eigenvalues().maxCoeff(), 1e-280);
  s.axes = s.solver.eigenvectors();
  s.lengths = s.solver.eigenvalues().cwiseMax(floor).cwiseSqrt();
}

void CmaDistribution::scale_sigma(double factor) {
  sigma_ *= factor;
}

std::span<const double> CmaDistribution::mean() const {
  return {state_->mean.data(), parameters_.dimension};
}

double CmaDistribution::calc_standard_deviation(std::size_t coordinate) const {
  return sigma_ * std::sqrt(std::max(0.0, covariance(coordinate, coordinate)));
}

CmaMarginal CmaDistribution::marginal(std::size_t coordinate) const {
  const auto i = static_cast<Eigen::Index>(coordinate);
  return {.mean = state_->mean(i), .scale = state_->scales(i)};
}

void CmaDistribution::set_marginal(std::size_t coordinate, const CmaMarginal& marginal) {
  const auto i = static_cast<Eigen::Index>(coordinate);
  state_->mean(i) = marginal.mean;
  state_->scales(i) = marginal.scale;
}

double CmaDistribution::covariance(std::size_t row, std::size_t column) const {
  return state_->covariance(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column));
}

std::span<const double> CmaDistribution::covariance_path() const {
  return {state_->covariance_path.data(), parameters_.dimension};
}

double CmaDistribution::longest_axis() const {
  return sigma_ * state_->lengths.maxCoeff();
}

double CmaDistribution::shortest_axis() const {
  return sigma_ * state_->lengths.minCoeff();
}

std::vector<double> CmaDistribution::calc_axis(std::size_t number) const {
  const auto i = static_cast<Eigen::Index>(number);
  const Eigen::VectorXd axis = sigma_ * state_->lengths(i) * state_->axes.col(i);
  return {axis.data(), axis.data() + axis.size()};
}

}  // namespace armwright
