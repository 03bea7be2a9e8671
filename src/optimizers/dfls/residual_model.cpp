#include "optimizers/dfls/residual_model.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/decompositions.hpp"

namespace armwright {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

ResidualModel::ResidualModel(std::vector<ResidualSample> samples, MatrixXd jacobian,
                             bool power_laws)
    : samples_(std::move(samples)),
      power_laws_(power_laws),
      is_power_(static_cast<std::size_t>(jacobian.rows()), false),
      slopes_(std::move(jacobian)) {
  const auto best = std::ranges::min_element(samples_, {}, &ResidualSample::square_sum);
  centre_ = static_cast<std::size_t>(best - samples_.begin());
  fit();
}

std::optional<ResidualModel> ResidualModel::extend(const ResidualModel& old, ResidualSample sample,
                                                   std::size_t old_cases, std::size_t cases) {
  const auto before = static_cast<Index>(old_cases);
  const auto after = static_cast<Index>(cases);
  const Index more_rows = sample.residuals.size() - old.slopes_.rows();
  const Index each = after > before ? more_rows / (after - before) : 0;  // residuals per case
  const Index shared = old.slopes_.rows() - before * each;
  if (each < 1 || more_rows != each * (after - before) || shared < 0) {
    return std::nullopt;
  }
  // Linear residuals often are shares of a mean over the cases, and so become smaller.
  const double old_norm = old.centre().residuals.head(before * each).norm();
  const double scale = old_norm > 0 ? sample.residuals.head(before * each).norm() / old_norm : 1.0;
  const auto get_derivatives = [&](Index row, Index old_row, double scale_of_linear) {
    const double factor = old.is_power(old_row) ? sample.residuals[row] : scale_of_linear;
    return Eigen::RowVectorXd(old.slopes_.row(old_row) * factor);
  };
  MatrixXd jacobian = MatrixXd::Zero(sample.residuals.size(), old.slopes_.cols());
  for (Index row = 0; row < after * each; ++row) {
    if (row < before * each) {
      jacobian.row(row) = get_derivatives(row, row, scale);
      continue;
    }
    for (Index k = 0; k < before; ++k) {
      jacobian.row(row) +=
          get_derivatives(row, k * each + row % each, scale) / static_cast<double>(before);
    }
  }
  for (Index row = 0; row < shared; ++row) {
    jacobian.row(after * each + row) = get_derivatives(after * each + row, before * each + row, 1);
  }
  return ResidualModel({std::move(sample)}, std::move(jacobian), old.power_laws_);
}

std::vector<ResidualSample> ResidualModel::list_samples() const {
  std::vector<ResidualSample> samples = samples_;
  std::ranges::stable_sort(samples, {}, &ResidualSample::square_sum);
  return samples;
}

VectorXd ResidualModel::predict(const VectorXd& step) const {
  VectorXd residuals = slopes_ * step;
  for (Index i = 0; i < residuals.size(); ++i) {
    const double here = centre().residuals[i];
    residuals[i] = is_power(i) ? here * std::exp(residuals[i]) : here + residuals[i];
  }
  return residuals;
}

MatrixXd ResidualModel::calc_jacobian() const {
  MatrixXd jacobian = slopes_;
  for (Index i = 0; i < jacobian.rows(); ++i) {
    if (is_power(i)) {
      jacobian.row(i) *= centre().residuals[i];
    }
  }
  return jacobian;
}

VectorXd ResidualModel::find_step(const StepBox& box, double radius) const {
  if (std::ranges::find(is_power_, true) == is_power_.end()) {
    return solve_trust_region(slopes_, centre().residuals, box, radius);
  }
  // Newton's method: the sum is convex. The second derivative of a squared power law is 4 r^2 g g',
  // twice that of the squared linear residual with the same slope.
  constexpr int kMostIterations = 30;
  constexpr double kAccuracy = 1e-3;  // of the reduction
  constexpr double kLeastShare = 1e-3;
  VectorXd step = VectorXd::Zero(slopes_.cols());
  double sum = centre().square_sum;
  for (int iteration = 0; iteration < kMostIterations; ++iteration) {
    VectorXd residuals = predict(step);
    MatrixXd jacobian = slopes_;
    for (Index i = 0; i < jacobian.rows(); ++i) {
      if (is_power(i)) {
        jacobian.row(i) *= std::sqrt(2.0) * residuals[i];
        residuals[i] /= std::sqrt(2.0);
      }
    }
    residuals -= jacobian * step;
    const VectorXd change = solve_trust_region(jacobian, residuals, box, radius) - step;
    double share = 1;
    double next = predict(step + change).squaredNorm();
    while (!(next < sum) && share > kLeastShare) {
      share /= 2;
      next = predict(step + share * change).squaredNorm();
    }
    if (!(next < sum)) {
      break;
    }
    const double gain = sum - next;
    step += share * change;
    sum = next;
    if (gain <= kAccuracy * (centre().square_sum - sum)) {
      break;
    }
  }
  return step;
}

// Makes power laws of the residuals that have the same sign at all points.
void ResidualModel::choose_forms() {
  for (Index i = 0; i < slopes_.rows(); ++i) {
    const double here = centre().residuals[i];
    const bool fits = power_laws_ && std::ranges::all_of(samples_, [&](const auto& sample) {
                        return sample.residuals[i] * here > 0;
                      });
    if (fits != is_power(i)) {
      slopes_.row(i) *= fits ? 1 / here : here;
      is_power_[static_cast<std::size_t>(i)] = fits;
    }
  }
}

void ResidualModel::fit() {
  choose_forms();
  const Index n = slopes_.cols();
  const Index others = std::ssize(samples_) - 1;
  directions_.resize(others, n);
  MatrixXd misfits(others, slopes_.rows());  // per unit of length
  VectorXd lengths(others);
  for (std::size_t k = 0; k < samples_.size(); ++k) {
    if (k == centre_) {
      continue;
    }
    const Index row = to_row(k);
    const VectorXd direction = samples_[k].place - centre().place;
    lengths[row] = direction.norm();
    directions_.row(row) = direction.transpose() / lengths[row];
    VectorXd difference = samples_[k].residuals - centre().residuals;
    for (Index i = 0; i < difference.size(); ++i) {
      if (is_power(i)) {
        difference[i] = std::log(samples_[k].residuals[i] / centre().residuals[i]);
      }
    }
    misfits.row(row) =
        difference.transpose() / lengths[row] - directions_.row(row) * slopes_.transpose();
  }
  if (others == 0) {
    lagrange_.resize(n, 0);
    return;
  }
  Eigen::CompleteOrthogonalDecomposition<MatrixXd> factor;
  factor.setThreshold(1e-10);  // flatter sets tell nothing about the direction that they lack
  factor.compute(directions_);
  const MatrixXd inverse = factor.pseudoInverse();
  slopes_ += (inverse * misfits).transpose();
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
  const VectorXd rest = direction - directions_.transpose() * solve(factor, direction);
  return rest.norm() >= kLeastShare * direction.norm();
}

VectorXd ResidualModel::find_missing_direction() const {
  const Index n = slopes_.cols();
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
