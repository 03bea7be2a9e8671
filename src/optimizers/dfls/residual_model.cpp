#include "optimizers/dfls/residual_model.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <utility>

namespace armwright {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

ResidualModel::ResidualModel(std::vector<ResidualSample> samples, MatrixXd jacobian)
    : samples_(std::move(samples)), jacobian_(std::move(jacobian)) {
  const auto best = std::ranges::min_element(samples_, {}, &ResidualSample::square_sum);
  centre_ = static_cast<std::size_t>(best - samples_.begin());
  fit();
}

void ResidualModel::fit() {
  const Index n = jacobian_.cols();
  const Index others = std::ssize(samples_) - 1;
  directions_.resize(others, n);
  MatrixXd misfits(others, jacobian_.rows());  // per unit of length
  VectorXd lengths(others);
  for (std::size_t k = 0; k < samples_.size(); ++k) {
    if (k == centre_) {
      continue;
    }
    const Index row = to_row(k);
    const VectorXd direction = samples_[k].place - centre().place;
    lengths[row] = direction.norm();
    directions_.row(row) = direction.transpose() / lengths[row];
    misfits.row(row) = (samples_[k].residuals - centre().residuals).transpose() / lengths[row] -
                       directions_.row(row) * jacobian_.transpose();
  }
  if (others == 0) {
    lagrange_.resize(n, 0);
    return;
  }
  Eigen::CompleteOrthogonalDecomposition<MatrixXd> factor;
  factor.setThreshold(1e-10);  // flatter sets tell nothing about the direction that they lack
  factor.compute(directions_);
  const MatrixXd inverse = factor.pseudoInverse();
  jacobian_ += (inverse * misfits).transpose();
  lagrange_ = inverse * lengths.cwiseInverse().asDiagonal();
}

void ResidualModel::include(ResidualSample sample, double radius) {
  const VectorXd direction = sample.place - centre().place;
  if (!(direction.norm() > 0)) {
    return;
  }
  const bool is_better = sample.square_sum < centre().square_sum;
  if (!is_full() && adds_direction(direction)) {
    samples_.push_back(std::move(sample));
    centre_ = is_better ? samples_.size() - 1 : centre_;
  } else {
    const std::size_t leaver = choose_leaver(sample, radius);
    samples_[leaver] = std::move(sample);
    centre_ = is_better ? leaver : centre_;
  }
  fit();
}

void ResidualModel::replace(std::size_t index, ResidualSample sample) {
  const bool is_better = sample.square_sum < centre().square_sum;
  samples_[index] = std::move(sample);
  centre_ = is_better ? index : centre_;
  fit();
}

void ResidualModel::remove(std::size_t index) {
  samples_.erase(samples_.begin() + static_cast<std::ptrdiff_t>(index));
  centre_ -= index < centre_ ? 1 : 0;
  fit();
}

ResidualModel::Distance ResidualModel::find_furthest() const {
  Distance furthest;
  for (std::size_t k = 0; k < samples_.size(); ++k) {
    const double length = (samples_[k].place - centre().place).norm();
    if (length > furthest.length) {
      furthest = {k, length};
    }
  }
  return furthest;
}

VectorXd ResidualModel::calc_lagrange_gradient(std::size_t index) const {
  return lagrange_.col(to_row(index));
}

bool ResidualModel::adds_direction(const VectorXd& direction) const {
  // The part of the direction that no combination of the others has.
  constexpr double kLeastShare = 0.1;
  if (directions_.rows() == 0) {
    return true;
  }
  const Eigen::CompleteOrthogonalDecomposition<MatrixXd> factor(directions_.transpose());
  const VectorXd rest = direction - directions_.transpose() * factor.solve(direction);
  return rest.norm() >= kLeastShare * direction.norm();
}

VectorXd ResidualModel::find_missing_direction() const {
  const Index n = jacobian_.cols();
  MatrixXd rest = MatrixXd::Identity(n, n);  // the axes without their parts along the directions
  if (directions_.rows() > 0) {
    const Eigen::CompleteOrthogonalDecomposition<MatrixXd> factor(directions_);
    rest -= factor.pseudoInverse() * directions_;
  }
  Index longest = 0;
  rest.colwise().norm().maxCoeff(&longest);
  return rest.col(longest).normalized();
}

// Returns the point whose loss harms the geometry least. |l_t(x)| of the Lagrange polynomial of
// point t is the factor by which the volume of the set changes if x replaces t; distant points are
// the first to leave (Powell 2009, The BOBYQA algorithm, equation 6.1).
std::size_t ResidualModel::choose_leaver(const ResidualSample& sample, double radius) const {
  const bool is_better = sample.square_sum < centre().square_sum;
  const VectorXd& best = is_better ? sample.place : centre().place;
  const VectorXd values = lagrange_.transpose() * (sample.place - centre().place);
  std::size_t leaver = centre_ == 0 ? 1 : 0;
  double largest = -1;
  for (std::size_t k = 0; k < samples_.size(); ++k) {
    if (k == centre_ && !is_better) {
      continue;
    }
    const double value = k == centre_ ? 1 - values.sum() : values[to_row(k)];
    const double share = (samples_[k].place - best).norm() / radius;
    const double weight = std::abs(value) * std::max(1.0, std::pow(share, 4));
    if (weight > largest) {
      largest = weight;
      leaver = k;
    }
  }
  return leaver;
}

}  // namespace armwright
