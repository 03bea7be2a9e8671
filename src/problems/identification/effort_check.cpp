#include "problems/identification/effort_check.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "base/text.hpp"

namespace armwright {
namespace {

using Eigen::Index;

constexpr double kOpposite = -0.5;
// The model's error with exchanged columns, as a share of that without. The robot's own model may be
// off, but hardly so that the efforts of another joint suit a joint better.
constexpr double kEffortGain = 0.8;
constexpr double kJointGain = 0.5;
constexpr double kExplained = 0.9;

double correlate(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  const Eigen::VectorXd x = a.array() - a.mean();
  const Eigen::VectorXd y = b.array() - b.mean();
  const double both = x.norm() * y.norm();
  return both > 0 ? x.dot(y) / both : 0;
}

// Returns the model's efforts, one row per sample.
Eigen::MatrixXd calc_own_efforts(const PlantModel& model, Index joints,
                                 const std::vector<double>& own) {
  const Eigen::VectorXd efforts = model.calc(own, false).motor;
  return Eigen::MatrixXd(efforts.reshaped<Eigen::RowMajor>(efforts.size() / joints, joints));
}

double calc_error(const Eigen::MatrixXd& model, const Eigen::MatrixXd& recorded) {
  double sum = 0;
  for (Index i = 0; i < model.cols(); ++i) {
    const Eigen::VectorXd x = recorded.col(i).array() - recorded.col(i).mean();
    sum += (model.col(i) - recorded.col(i)).norm() / std::max(x.norm(), 1e-300);
  }
  return sum / static_cast<double>(model.cols());
}

// Returns the two joints whose efforts are exchanged, or positions and efforts, if the model says so.
std::optional<std::pair<Index, Index>> find_swapped(const IdentificationProblem& problem,
                                                    const FittedMotion& motion,
                                                    const Eigen::MatrixXd& own_efforts,
                                                    bool are_positions_swapped) {
  const double error = calc_error(own_efforts, motion.efforts);
  const Index n = motion.efforts.cols();
  std::optional<std::pair<Index, Index>> best;
  double least = std::min(kExplained, (are_positions_swapped ? kJointGain : kEffortGain) * error);
  for (Index i = 0; i < n; ++i) {
    for (Index k = i + 1; k < n; ++k) {
      Eigen::MatrixXd efforts = motion.efforts;
      const double ratio = motion.effort_factors[i] / motion.effort_factors[k];
      efforts.col(i) = ratio * motion.efforts.col(k);
      efforts.col(k) = motion.efforts.col(i) / ratio;
      double other = 0;
      if (are_positions_swapped) {
        JointMotion swapped = motion.model.motion();
        for (Eigen::MatrixXd* columns : {&swapped.positions, &swapped.rates, &swapped.accelerations,
                                         &swapped.motor_rates, &swapped.motor_accelerations}) {
          if (columns->size() > 0) {
            columns->col(i).swap(columns->col(k));
          }
        }
        const PlantModel model(problem.robot(), {}, problem.gravity_m_per_s2(), swapped);
        other = calc_error(calc_own_efforts(model, n, {}), efforts);
      } else {
        other = calc_error(own_efforts, efforts);
      }
      if (other < least) {
        least = other;
        best = {i, k};
      }
    }
  }
  return best;
}

}  // namespace

std::vector<std::string> find_effort_faults(const IdentificationProblem& problem) {
  std::vector<std::string> faults;
  const auto name = [&](Index joint) {
    return sanitize(problem.robot().joints[static_cast<std::size_t>(joint)].name);
  };
  const auto check = [&](const FittedMotion& motion) {
    const Index n = motion.efforts.cols();
    const Eigen::MatrixXd model = calc_own_efforts(motion.model, n, problem.own_values());
    const std::string log = sanitize(motion.name);
    const auto efforts = find_swapped(problem, motion, model, false);
    if (efforts) {
      const auto [i, k] = *efforts;
      faults.push_back(fmt::format(
          "{}: the efforts of joints '{}' and '{}' are swapped: exchanged, they are much nearer to "
          "those that the motion needs; name their columns with --column",
          log, name(i), name(k)));
    }
    for (Index i = 0; i < n && !efforts; ++i) {
      const double correlation = correlate(motion.efforts.col(i), model.col(i));
      if (correlation < kOpposite) {
        faults.push_back(fmt::format(
            "{}: the efforts of joint '{}' have the opposite sign of those that the motion needs "
            "(correlation {:.2f}); if the sensor counts the other way, give --sign {}=-1",
            log, name(i), correlation, name(i)));
      }
    }
    if (faults.empty()) {
      if (const auto swapped = find_swapped(problem, motion, model, true)) {
        faults.push_back(fmt::format(
            "{}: joints '{}' and '{}' are swapped: with their positions and efforts exchanged, the "
            "robot's model fits more than twice as well; name their columns with --column, or the "
            "order with --joints",
            log, name(swapped->first), name(swapped->second)));
      }
    }
  };
  for (const FittedMotion& motion : problem.fitted()) {
    check(motion);
  }
  for (const FittedMotion& motion : problem.held_back()) {
    check(motion);
  }
  return faults;
}

}  // namespace armwright
