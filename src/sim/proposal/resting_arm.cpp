#include "sim/proposal/resting_arm.hpp"

#include <cmath>

#include "base/decompositions.hpp"

namespace armwright {

RestingArm::RestingArm(const RobotModel& robot, const PhysicsSettings& physics)
    : robot_(robot), chain_(robot, physics.gravity_m_per_s2), equations_(chain_) {}

std::vector<double> RestingArm::calc_holding_efforts(std::span<const double> q) {
  return equations_.calc_holding_efforts(robot_, q);
}

RestingArm::Hardest RestingArm::find_hardest(std::span<const double> q) {
  Hardest hardest;
  const std::vector<double> efforts = calc_holding_efforts(q);
  for (std::size_t i = 0; i < efforts.size(); ++i) {
    const double share = std::abs(efforts[i]) / robot_.joints[i].effort_limit;
    if (share > hardest.share) {
      hardest = {i, share, std::abs(efforts[i])};
    }
  }
  return hardest;
}

Eigen::MatrixXd RestingArm::calc_mass_matrix(std::span<const double> q) {
  equations_.set(q, std::vector<double>(q.size(), 0));
  const auto n = static_cast<Eigen::Index>(q.size());
  Eigen::MatrixXd mass(n, n);
  for (std::size_t row = 0; row < q.size(); ++row) {
    for (std::size_t column = 0; column < q.size(); ++column) {
      mass(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column)) =
          equations_.mass(row, column);
    }
    mass.diagonal()[static_cast<Eigen::Index>(row)] += robot_.joints[row].plant.armature;
  }
  return mass;
}

double RestingArm::calc_coupling(std::span<const double> q) {
  const Eigen::MatrixXd mass = calc_mass_matrix(q);
  return mass.diagonal().cwiseProduct(mass.inverse().diagonal()).maxCoeff();
}

}  // namespace armwright
