// Eigen's decompositions of matrices, compiled once for the whole program. Each takes a compiler
// several seconds, and some are hidden in Eigen's other functions: Quaternion::FromTwoVectors
// decomposes a matrix. Pass a matrix to them: an expression, such as a product, is compiled anew.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>

extern template class Eigen::JacobiSVD<Eigen::Matrix<double, 2, 3>>;
extern template class Eigen::JacobiSVD<Eigen::MatrixXd>;
extern template class Eigen::HouseholderQR<Eigen::MatrixXd>;
extern template class Eigen::ColPivHouseholderQR<Eigen::MatrixXd>;
extern template class Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>;
extern template class Eigen::PartialPivLU<Eigen::MatrixXd>;
extern template Eigen::LLT<Eigen::MatrixXd>& Eigen::LLT<Eigen::MatrixXd>::compute(
    const Eigen::EigenBase<Eigen::MatrixXd>&);
extern template Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>&
Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>::compute(const Eigen::EigenBase<Eigen::Matrix3d>&,
                                                        int);
extern template Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>&
Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>::compute(const Eigen::EigenBase<Eigen::MatrixXd>&,
                                                        int);

namespace armwright {

// Returns factor.solve(right).
Eigen::VectorXd solve(const Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>& factor,
                      const Eigen::VectorXd& right);

}  // namespace armwright
