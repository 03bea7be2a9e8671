#include "sim/identification/fitted_plant.hpp"

#include "base/decompositions.hpp"

namespace armwright {
namespace {

constexpr double kCornerDeviations = 2;

std::vector<double> add(const std::vector<double>& values, const Eigen::VectorXd& change) {
  std::vector<double> sum = values;
  for (std::size_t i = 0; i < sum.size(); ++i) {
    sum[i] += change[static_cast<Eigen::Index>(i)];
  }
  return sum;
}

}  // namespace

Eigen::MatrixXd FittedPlant::calc_axes() const {
  const Eigen::VectorXd errors = covariance.diagonal().cwiseMax(0).cwiseSqrt();
  const Eigen::VectorXd inverse =
      errors.unaryExpr([](double error) { return error > 0 ? 1 / error : 0.0; });
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(
      Eigen::MatrixXd(inverse.asDiagonal() * covariance * inverse.asDiagonal()));
  return errors.asDiagonal() * solver.eigenvectors() *
         solver.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal();
}

std::vector<double> FittedPlant::draw(RandomStream& random) const {
  Eigen::VectorXd z(covariance.rows());
  for (double& number : z) {
    number = random.normal();
  }
  return add(values, calc_axes() * z);
}

std::vector<double> FittedPlant::get_corner(std::uint64_t number) const {
  const auto axes = static_cast<std::uint64_t>(covariance.rows());
  const std::uint64_t corner = number % (2 * axes);
  const double sign = corner % 2 == 0 ? 1 : -1;
  return add(values,
             sign * kCornerDeviations * calc_axes().col(static_cast<Eigen::Index>(corner / 2)));
}

}  // namespace armwright
