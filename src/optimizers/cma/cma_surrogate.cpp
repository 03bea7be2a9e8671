#include "optimizers/cma/cma_surrogate.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>
#include <utility>

#include "base/decompositions.hpp"

namespace armwright {
namespace {

constexpr double kUsedShare = 0.75;      // of the points, the best ones
constexpr double kPointsPerTerm = 1.1;   // at least, of the points that are used
constexpr double kLargestWeight = 20;    // of the best point; that of the worst is 1
constexpr double kLeastDiagonal = 1e-9;  // of R with columns of length 1: full rank

std::size_t count_terms(CmaModelKind kind, std::size_t n) {
  switch (kind) {
    case CmaModelKind::linear:
      return 1 + n;
    case CmaModelKind::diagonal:
      return 1 + 2 * n;
    case CmaModelKind::full:
      return 1 + n * (n + 3) / 2;
  }
  return 0;
}

CmaModelKind choose_kind(std::size_t points, std::size_t n) {
  for (const CmaModelKind kind : {CmaModelKind::full, CmaModelKind::diagonal}) {
    if (kUsedShare * static_cast<double>(points) >=
        kPointsPerTerm * static_cast<double>(count_terms(kind, n))) {
      return kind;
    }
  }
  return CmaModelKind::linear;
}

// Writes the terms of a point in the model's coordinates.
void write_terms(CmaModelKind kind, const Eigen::VectorXd& z, Eigen::Ref<Eigen::RowVectorXd> row) {
  const Eigen::Index n = z.size();
  row(0) = 1;
  row.segment(1, n) = z.transpose();
  if (kind != CmaModelKind::linear) {
    row.segment(1 + n, n) = z.cwiseAbs2().transpose();
  }
  if (kind == CmaModelKind::full) {
    for (Eigen::Index i = 0, place = 1 + 2 * n; i < n; place += n - 1 - i, ++i) {
      row.segment(place, n - 1 - i) = z(i) * z.tail(n - 1 - i).transpose();
    }
  }
}

// Returns the solution of least squares, or of these the one of least norm.
Eigen::VectorXd solve_least_squares(Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  Eigen::VectorXd lengths = a.colwise().norm().transpose();
  for (double& length : lengths) {
    length = length > 0 ? length : 1;
  }
  a = a * lengths.cwiseInverse().asDiagonal();
  if (a.rows() >= a.cols()) {
    // Several times as fast as the decomposition that finds the rank.
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(a);
    if (qr.matrixQR().diagonal().cwiseAbs().minCoeff() > kLeastDiagonal) {
      return qr.solve(b).cwiseQuotient(lengths);
    }
  }
  return solve(a.completeOrthogonalDecomposition(), b).cwiseQuotient(lengths);
}

}  // namespace

double calc_rank_agreement(std::span<const double> a, std::span<const double> b) {
  assert(a.size() == b.size());
  if (a.size() < 2) {
    return 0;
  }
  const auto sign = [](double x) { return x > 0 ? 1 : x < 0 ? -1 : 0; };
  int sum = 0;
  for (std::size_t i = 1; i < a.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      sum += sign(a[i] - a[k]) * sign(b[i] - b[k]);
    }
  }
  const auto size = static_cast<double>(a.size());
  return 2 * sum / (size * (size - 1));
}

struct CmaSurrogate::Model {
  Eigen::VectorXd center;
  Eigen::MatrixXd to_model;  // z = to_model (x - center)
  Eigen::MatrixXd to_point;  // its inverse
  Eigen::VectorXd coefficients;
  double offset = 0;  // of the values: coefficients of small differences would lose digits

  Eigen::VectorXd calc_coordinates(std::span<const double> point) const {
    return to_model * (Eigen::Map<const Eigen::VectorXd>(point.data(), center.size()) - center);
  }
};

CmaSurrogate::CmaSurrogate(std::size_t dimension, std::size_t population)
    : dimension_(dimension), population_(population), model_(std::make_unique<Model>()) {}

CmaSurrogate::~CmaSurrogate() = default;
CmaSurrogate::CmaSurrogate(CmaSurrogate&&) noexcept = default;
CmaSurrogate& CmaSurrogate::operator=(CmaSurrogate&&) noexcept = default;

void CmaSurrogate::add(std::vector<double> point, double value) {
  assert(point.size() == dimension_);
  const std::size_t most = std::max(population_, 2 * count_terms(CmaModelKind::full, dimension_));
  if (values_.size() == most) {
    points_.erase(points_.begin());
    values_.erase(values_.begin());
  }
  points_.push_back(std::move(point));
  values_.push_back(value);
}

void CmaSurrogate::fit(const CmaDistribution& distribution) {
  assert(!values_.empty());
  kind_ = choose_kind(size(), dimension_);
  const std::size_t terms = count_terms(kind_, dimension_);
  const auto n = static_cast<Eigen::Index>(dimension_);

  Model& m = *model_;
  m.center = Eigen::Map<const Eigen::VectorXd>(distribution.mean().data(), n);
  m.to_model = Eigen::MatrixXd::Zero(n, n);
  m.to_point = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto place = static_cast<std::size_t>(i);
    if (kind_ == CmaModelKind::full) {
      const std::vector<double> axis = distribution.calc_axis(place);
      m.to_point.col(i) = Eigen::Map<const Eigen::VectorXd>(axis.data(), n);
      m.to_model.row(i) = m.to_point.col(i).transpose() / m.to_point.col(i).squaredNorm();
    } else {
      m.to_point(i, i) = distribution.calc_standard_deviation(place);
      m.to_model(i, i) = 1 / m.to_point(i, i);
    }
  }

  std::vector<std::size_t> order(size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return values_[i]; });
  const auto share = static_cast<std::size_t>(kUsedShare * static_cast<double>(size() + 1));
  const std::size_t used = std::min(size(), std::max(terms + 2, share));
  m.offset = values_[order.front()];
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(used), static_cast<Eigen::Index>(terms));
  Eigen::VectorXd right(rows.rows());
  Eigen::RowVectorXd row(rows.cols());
  for (std::size_t i = 0; i < used; ++i) {
    const double rank = used > 1 ? static_cast<double>(i) / static_cast<double>(used - 1) : 0;
    const double weight = kLargestWeight + rank * (1 - kLargestWeight);
    write_terms(kind_, m.calc_coordinates(points_[order[i]]), row);
    rows.row(static_cast<Eigen::Index>(i)) = weight * row;
    right(static_cast<Eigen::Index>(i)) = weight * (values_[order[i]] - m.offset);
  }
  m.coefficients = solve_least_squares(rows, right);
  is_fitted_ = m.coefficients.allFinite();
}

double CmaSurrogate::calc_value(std::span<const double> point) const {
  assert(is_fitted_);
  Eigen::RowVectorXd row(model_->coefficients.size());
  write_terms(kind_, model_->calc_coordinates(point), row);
  return model_->offset + row.dot(model_->coefficients);
}

double CmaSurrogate::calc_agreement(std::size_t evaluated) const {
  const double wanted = std::max(15.0, std::min(1.2 * static_cast<double>(evaluated),
                                                kUsedShare * static_cast<double>(population_)));
  const std::size_t count = std::min(size(), static_cast<std::size_t>(wanted));
  if (count < 3) {
    return 0;
  }
  std::vector<double> model;
  for (std::size_t i = size() - count; i < size(); ++i) {
    model.push_back(calc_value(points_[i]));
  }
  return calc_rank_agreement(std::span(values_).last(count), model);
}

std::vector<double> CmaSurrogate::find_minimum(double radius) const {
  assert(is_fitted_);
  const Model& m = *model_;
  const auto n = static_cast<Eigen::Index>(dimension_);
  const Eigen::VectorXd slope = m.coefficients.segment(1, n);
  Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(n, n);
  if (kind_ != CmaModelKind::linear) {
    hessian.diagonal() = 2 * m.coefficients.segment(1 + n, n);
  }
  if (kind_ == CmaModelKind::full) {
    for (Eigen::Index i = 0, place = 1 + 2 * n; i < n; place += n - 1 - i, ++i) {
      for (Eigen::Index k = i + 1; k < n; ++k) {
        hessian(i, k) = hessian(k, i) = m.coefficients(place + k - i - 1);
      }
    }
  }
  // The step -(H + shift)^-1 g with the least shift >= 0 for which it has the length `radius` or
  // less and H + shift has no negative eigenvalue.
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(hessian);
  const Eigen::VectorXd& curvatures = solver.eigenvalues();
  const Eigen::VectorXd along = solver.eigenvectors().transpose() * slope;
  const auto make_step = [&](double shift) {
    return Eigen::VectorXd(-along.cwiseQuotient((curvatures.array() + shift).max(1e-300).matrix()));
  };
  double lower = std::max(0.0, -curvatures.minCoeff());
  Eigen::VectorXd step = make_step(lower);
  if (!(step.norm() <= radius)) {
    double upper = lower + slope.norm() / radius;  // its step is not longer than the radius
    for (int i = 0; i < 100; ++i) {
      const double middle = 0.5 * (lower + upper);
      (make_step(middle).norm() <= radius ? upper : lower) = middle;
    }
    step = make_step(upper);
  }
  const Eigen::VectorXd point = m.center + m.to_point * (solver.eigenvectors() * step);
  return {point.data(), point.data() + point.size()};
}

}  // namespace armwright
