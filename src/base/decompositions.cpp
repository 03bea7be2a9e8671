#include "base/decompositions.hpp"

template class Eigen::JacobiSVD<Eigen::Matrix<double, 2, 3>>;
template class Eigen::JacobiSVD<Eigen::MatrixXd>;
template class Eigen::HouseholderQR<Eigen::MatrixXd>;
template class Eigen::ColPivHouseholderQR<Eigen::MatrixXd>;
template class Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>;
template class Eigen::PartialPivLU<Eigen::MatrixXd>;
template Eigen::LLT<Eigen::MatrixXd>& Eigen::LLT<Eigen::MatrixXd>::compute(
    const Eigen::EigenBase<Eigen::MatrixXd>&);
template Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>&
Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>::compute(const Eigen::EigenBase<Eigen::Matrix3d>&,
                                                        int);
template Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>&
Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>::compute(const Eigen::EigenBase<Eigen::MatrixXd>&,
                                                        int);

namespace armwright {

Eigen::VectorXd solve(const Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>& factor,
                      const Eigen::VectorXd& right) {
  return factor.solve(right);
}

}  // namespace armwright
