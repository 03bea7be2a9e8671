#include "sim/tracking/elasticity.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "base/decompositions.hpp"
#include "base/random.hpp"
#include "sim/dynamics/chain_dynamics.hpp"
#include "sim/dynamics/chain_model.hpp"

namespace armwright {
namespace {

struct ElasticityLevel;  // tags the code that this file instantiates
using ElasticNumber = lanes::Single<double, ElasticityLevel>;
using ElasticChain = articulated::ChainShape<0, articulated::kAnyShape, true>;

constexpr int kSampledPostures = 32;
constexpr double kWidest = std::numbers::pi;  // rad or m, for joints without range

// Returns the mass matrix with the rotors of rigid joints.
Eigen::MatrixXd calc_mass(const RobotModel& robot, const articulated::ChainModel& chain,
                          const std::vector<ElasticNumber>& q) {
  const std::vector<ElasticNumber> model(chain.numbers().begin(), chain.numbers().end());
  const std::vector<ElasticNumber> rest(q.size(), ElasticNumber(0));
  std::vector<ElasticNumber> scratch(
      static_cast<std::size_t>(articulated::calc_dynamics_packs(chain.joints())), ElasticNumber(0));
  ElasticNumber* memory = scratch.data();
  articulated::ChainDynamics<ElasticNumber, ElasticChain> dynamics(
      ElasticChain(chain.joints(), chain.flags().data(), chain.tilted_gravity()), model.data(),
      memory);
  dynamics.set_posture(q.data(), true);
  dynamics.calc_equations(q.data(), rest.data());
  const int n = chain.joints();
  Eigen::MatrixXd mass(n, n);
  for (int row = 0; row < n; ++row) {
    for (int column = 0; column <= row; ++column) {
      mass(row, column) = mass(column, row) = dynamics.mass(row, column).v;
    }
    const JointPlant& plant = robot.joints[static_cast<std::size_t>(row)].plant;
    mass(row, row) += plant.is_elastic() ? 0 : plant.armature;
  }
  return mass;
}

// Returns the largest eigenvalue of S C S, with S the diagonal matrix of the scales' roots, and the
// index with the largest part in its vector.
std::pair<double, Eigen::Index> find_largest(const Eigen::MatrixXd& compliance,
                                             const Eigen::VectorXd& scales) {
  const Eigen::VectorXd roots = scales.cwiseSqrt();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(
      Eigen::MatrixXd(roots.asDiagonal() * compliance * roots.asDiagonal()));
  const Eigen::Index last = scales.size() - 1;  // eigenvalues come in ascending order
  Eigen::Index part = 0;
  solver.eigenvectors().col(last).cwiseAbs().maxCoeff(&part);
  return {solver.eigenvalues()[last], part};
}

}  // namespace

int count_substeps(const ElasticMode& mode, double control_period_s) {
  const double substeps = std::ceil(mode.rate_rad_per_s * control_period_s / kMostTurnPerStep_rad);
  return static_cast<int>(std::min(substeps, 1e9));
}

std::optional<ElasticMode> find_fastest_mode(const RobotModel& robot) {
  std::vector<Eigen::Index> elastic;
  for (std::size_t i = 0; i < robot.joint_count(); ++i) {
    if (robot.joints[i].plant.stiffness > 0) {
      elastic.push_back(static_cast<Eigen::Index>(i));
    }
  }
  if (elastic.empty()) {
    return {};
  }
  const auto size = static_cast<Eigen::Index>(elastic.size());
  Eigen::VectorXd stiffness(size), damping(size), mobility(size);
  for (Eigen::Index k = 0; k < size; ++k) {
    const JointPlant& plant =
        robot.joints[static_cast<std::size_t>(elastic[static_cast<std::size_t>(k)])].plant;
    stiffness[k] = plant.stiffness;
    damping[k] = plant.is_elastic() ? plant.damping : 0;
    mobility[k] = plant.is_elastic() ? 1 / plant.armature : 0;
  }
  const articulated::ChainModel chain(robot, 0);
  RandomStream random("elastic joints/postures", 0);
  ElasticMode fastest{0, static_cast<std::size_t>(elastic.front())};
  for (int posture = 0; posture < kSampledPostures; ++posture) {
    std::vector<ElasticNumber> q;
    for (const Joint& joint : robot.joints) {
      const double lower = std::clamp(joint.lower, -kWidest, kWidest);
      q.emplace_back(random.uniform(lower, std::clamp(joint.upper, lower, kWidest)));
    }
    const Eigen::MatrixXd inverse = calc_mass(robot, chain, q).inverse();
    Eigen::MatrixXd compliance = inverse(elastic, elastic);
    compliance.diagonal() += mobility;
    const auto [square, swinging] = find_largest(compliance, stiffness);
    const auto [decay, damped] = find_largest(compliance, damping);
    const bool swings = std::sqrt(square) >= decay;
    const double rate = swings ? std::sqrt(square) : decay;
    if (rate > fastest.rate_rad_per_s) {
      const Eigen::Index part = swings ? swinging : damped;
      fastest = {rate, static_cast<std::size_t>(elastic[static_cast<std::size_t>(part)])};
    }
  }
  return fastest;
}

}  // namespace armwright
