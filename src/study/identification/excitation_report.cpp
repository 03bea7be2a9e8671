#include "study/identification/excitation_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/random.hpp"
#include "base/text.hpp"
#include "problems/logs/motion_file.hpp"

namespace armwright {
namespace {

using Eigen::Index;
using nlohmann::json;

const char* get_unit(const Joint& joint, const char* angle, const char* length) {
  return joint.kind == JointKind::revolute ? angle : length;
}

// Returns "position_1_rad,position_2_rad" for "position".
std::string write_heads(const RobotModel& robot, const char* what, const char* angle,
                        const char* length) {
  std::string heads;
  for (std::size_t i = 0; i < robot.joint_count(); ++i) {
    heads += fmt::format(",{}_{}_{}", what, i + 1, get_unit(robot.joints[i], angle, length));
  }
  return heads;
}

std::string write_numbers(const Eigen::MatrixXd& rows, Index row, const char* separator) {
  std::string text;
  for (Index i = 0; i < rows.cols(); ++i) {
    text += fmt::format("{}{:.9g}", i == 0 ? "" : separator, rows(row, i));
  }
  return text;
}

MotionSamples make_samples(const AssessedMotion& motion) {
  return {std::vector<double>(motion.times_s.begin(), motion.times_s.end()),
          motion.motion.positions, motion.motion.rates, motion.motion.accelerations};
}

// Returns the rates of a smooth signal: central differences, and one-sided ones at its ends.
Eigen::VectorXd differentiate(const Eigen::VectorXd& values, const Eigen::VectorXd& times_s) {
  Eigen::VectorXd rates(values.size());
  for (Index k = 0; k < values.size(); ++k) {
    const Index from = std::max<Index>(k - 1, 0), to = std::min(k + 1, values.size() - 1);
    rates[k] = (values[to] - values[from]) / (times_s[to] - times_s[from]);
  }
  return rates;
}

}  // namespace

Index count_samples(const ExcitationProblem& problem, double rate_hz) {
  return static_cast<Index>(std::round(problem.config().duration_s * rate_hz)) + 1;
}

Eigen::VectorXd calc_effort_noise(const Eigen::MatrixXd& efforts) {
  return kEffortNoise * (efforts.colwise().maxCoeff() - efforts.colwise().minCoeff()).transpose();
}

std::string write_motion(const ExcitationProblem& problem, const AssessedMotion& motion) {
  return write_motion_csv(problem.config().robot, make_samples(motion), motion.efforts);
}

std::string write_trajectory(const ExcitationProblem& problem, std::span<const double> x) {
  const ExcitationConfig& config = problem.config();
  return write_joint_trajectory(
      config.robot,
      make_samples(problem.assess(
          x, count_samples(problem, kTrajectoryPoints * config.harmonics / config.period_s))));
}

std::string write_simulated_log(const RobotModel& robot, double gravity_m_per_s2,
                                const AssessedMotion& motion, std::uint64_t noise_seed) {
  const Index samples = motion.times_s.size();
  const auto n = static_cast<Index>(robot.joint_count());
  const auto to_rows = [&](const Eigen::VectorXd& efforts) {
    return Eigen::MatrixXd(
        Eigen::Map<const Eigen::MatrixXd>(efforts.data(), n, samples).transpose());
  };
  const PlantModel::Efforts links =
      PlantModel(robot, {}, gravity_m_per_s2, motion.motion).calc({}, false);
  JointMotion moved = motion.motion;
  moved.motor_rates = moved.rates;
  moved.motor_accelerations = moved.accelerations;
  Eigen::MatrixXd positions = moved.positions;  // of the motors
  Eigen::MatrixXd efforts = to_rows(links.motor);
  std::vector<Index> elastic;
  std::string text = "time_s" + write_heads(robot, "position", "rad", "m") +
                     write_heads(robot, "effort", "n_m", "n");
  for (Index i = 0; i < n; ++i) {
    const Joint& joint = robot.joints[static_cast<std::size_t>(i)];
    if (joint.plant.is_elastic()) {
      elastic.push_back(i);
      const Eigen::VectorXd deflections = to_rows(links.link).col(i) / joint.plant.stiffness;
      const Eigen::VectorXd rates = differentiate(deflections, motion.times_s);
      positions.col(i) += deflections;
      moved.motor_rates.col(i) += rates;
      moved.motor_accelerations.col(i) += differentiate(rates, motion.times_s);
      text += fmt::format(",link_position_{}_{}", i + 1, get_unit(joint, "rad", "m"));
    }
  }
  text += "\n";
  if (!elastic.empty()) {  // rotors and friction are on the motors' side of the gears
    efforts = to_rows(PlantModel(robot, {}, gravity_m_per_s2, moved).calc({}, false).motor);
  }
  const Eigen::VectorXd noise = calc_effort_noise(efforts);
  RandomStream random("excitation/noise", noise_seed);
  for (Index k = 0; k < samples; ++k) {
    for (Index i = 0; i < n; ++i) {
      positions(k, i) += kPositionNoise * random.normal();
      efforts(k, i) += noise[i] * random.normal();
    }
    text += fmt::format("{:.9g},{},{}", motion.times_s[k], write_numbers(positions, k, ","),
                        write_numbers(efforts, k, ","));
    for (const Index i : elastic) {
      text +=
          fmt::format(",{:.9g}", motion.motion.positions(k, i) + kPositionNoise * random.normal());
    }
    text += "\n";
  }
  return text;
}

std::vector<ExpectedParameter> list_expected(const ExcitationProblem& problem,
                                             const AssessedMotion& motion) {
  const Eigen::VectorXd errors =
      problem.calc_standard_errors(motion, calc_effort_noise(motion.efforts));
  std::vector<ExpectedParameter> expected;
  for (std::size_t i = 0; i < problem.parameters().size(); ++i) {
    const PlantParameter& parameter = problem.parameters()[i];
    expected.push_back({parameter.name, parameter.unit, problem.own_values()[i],
                        errors[static_cast<Index>(i)], problem.can_tell(i)});
  }
  return expected;
}

std::string to_json(const ExcitationProblem& problem, const AssessedMotion& start,
                    const AssessedMotion& motion, double shrinking) {
  const RobotModel& robot = problem.config().robot;
  json parameters = json::array(), joints = json::array();
  for (const ExpectedParameter& parameter : list_expected(problem, motion)) {
    parameters.push_back({{"name", parameter.name},
                          {"unit", parameter.unit},
                          {"value", parameter.value},
                          {"standard_error", parameter.standard_error},
                          {"told", parameter.is_told}});
  }
  for (std::size_t i = 0; i < robot.joint_count(); ++i) {
    const auto at = static_cast<Index>(i);
    json joint = {{"joint", robot.joints[i].name},
                  {"position_share", motion.positions[at]},
                  {"speed_share", motion.speeds[at]},
                  {"effort_share", motion.efforts_share[at]}};
    if (motion.accelerations.size() > 0) {
      joint["acceleration_share"] = motion.accelerations[at];
    }
    joints.push_back(std::move(joint));
  }
  return json({{"robot", robot.name},
               {"criterion",
                excitation_criterion_names()[static_cast<std::size_t>(problem.config().criterion)]},
               {"condition_before", start.condition},
               {"condition", motion.condition},
               {"log_det_before", start.log_det},
               {"log_det", motion.log_det},
               {"rank", problem.rank()},
               {"amplitude_factor", shrinking},
               {"samples", motion.times_s.size()},
               {"joints", joints},
               {"parameters", parameters}})
             .dump(2) +
         "\n";
}

}  // namespace armwright
