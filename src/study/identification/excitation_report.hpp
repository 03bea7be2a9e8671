// The files that `armwright excite` leaves in its run's folder, and what a recording of the motion
// would tell.
//
// Recordings are assumed to have the noise of a real robot with good encoders: kPositionNoise in
// positions, and in the effort of each joint kEffortNoise of its range, from the least to the largest
// effort of the motion. Both are standard deviations of normal numbers, independent in each sample.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "problems/identification/excitation_problem.hpp"

namespace armwright {

inline constexpr double kPositionNoise = 1e-5;  // rad or m
inline constexpr double kEffortNoise = 0.01;    // of the effort's range
// Between the points of a trajectory for ROS 2: controllers interpolate by polynomials of fifth degree,
// whose error is far below that of any controller if a harmonic has twenty of them.
inline constexpr double kTrajectoryPoints = 20;

// Returns the number of samples of a motion at a rate.
Eigen::Index count_samples(const ExcitationProblem& problem, double rate_hz);
// Returns the efforts' noise of a recording, one number per joint.
Eigen::VectorXd calc_effort_noise(const Eigen::MatrixXd& efforts);

// Returns the motion as CSV: times, positions, velocities, accelerations and expected efforts, one row
// per sample. Logs have the same names of times, positions and velocities; their efforts are called
// effort_N_n_m or effort_N_n.
std::string write_motion(const ExcitationProblem& problem, const AssessedMotion& motion);
// Returns the motion as a trajectory_msgs/JointTrajectory of ROS 2, in YAML.
std::string write_trajectory(const ExcitationProblem& problem, std::span<const double> x);

// Returns a log of the motion as CSV, as a robot would record it that follows it exactly. Elastic joints
// have the positions of their motors, and link positions.
std::string write_simulated_log(const RobotModel& robot, double gravity_m_per_s2,
                                const AssessedMotion& motion, std::uint64_t noise_seed);

// What a recording at a rate would tell of a parameter.
struct ExpectedParameter {
  std::string name, unit;
  double value = 0;  // the robot's own
  double standard_error = 0;
  bool is_told = true;  // by itself; otherwise only combinations with others are
};
std::vector<ExpectedParameter> list_expected(const ExcitationProblem& problem,
                                             const AssessedMotion& motion);

// Returns excitation.json: conditions, shares of limits, what is told.
std::string to_json(const ExcitationProblem& problem, const AssessedMotion& start,
                    const AssessedMotion& motion, double shrinking);

}  // namespace armwright
