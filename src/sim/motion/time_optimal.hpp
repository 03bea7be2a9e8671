// The least time in which an arm can follow a given path within its limits, from rest to rest: a
// bound that no controller beats on this path.
//
// With the place s in [0, 1] on the path q(s), x = s'^2 and u = s'', the efforts are linear in u and x:
//   tau = A(s) u + B(s) x + G(s),   A = M q_s,   B = M q_ss + C(q, q_s) q_s.
// Limits on efforts, rates (q_s^2 x <= v^2) and accelerations (q_s u + q_ss x) are thus lines in the
// (u, x) plane. On a grid of places, sets of controllable x are computed from the end backwards, and
// the largest x within them from the beginning forwards (Pham and Pham 2018, A new approach to
// time-optimal path parameterization based on reachability analysis, IEEE Transactions on Robotics
// 34, 645-659). Between two places, u is constant. The limits hold at the places of the grid.
//
// Rotors, Coulomb friction, offsets and counterbalances (joint_plant.hpp) count; viscous friction does
// not, because it is not linear in x. Elastic joints count as rigid. Units: rad or m per joint; s, N m
// or N.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/motion/motion_curve.hpp"
#include "sim/robot/robot_model.hpp"

namespace armwright {

// The limits of the joints' motion, one number per joint; infinite ones limit nothing.
struct JointLimits {
  std::vector<double> speed, acceleration, jerk, effort;
};

// A place on a path, and the first two derivatives by s, one number per joint.
struct PathPlace {
  Eigen::VectorXd q, q_s, q_ss;
};

// Returns the path's places from joint positions at even s (one row per joint, one column per place, at
// least five): differences of five places, of fourth order in q_s and of third order or more in q_ss.
std::vector<PathPlace> sample_path(const Eigen::MatrixXd& positions);

// Returns the places of a motion between two times (s) at which it rests, at even distances of the way
// of its joints: s is the way from `from_s` on, sigma = integral of |q'| dt, over the whole way. Near a
// rest the direction of motion is that shortly after or before.
std::vector<PathPlace> measure_path(const MotionCurve& curve, double from_s, double to_s,
                                    std::size_t intervals);

struct LeastTime {
  double duration_s = 0;        // 0 also if nothing limits the motion
  std::vector<double> times_s;  // when the arm is at each place
  std::vector<double> rates;    // s' there
  // Set if no speed suits the path: where, and which joint's limit leaves none.
  std::optional<std::size_t> stuck_place;
  std::size_t stuck_joint = 0;
};
// Returns the least time. `limits.jerk` is not used. If the efforts cannot even hold the arm at some
// place, `stuck_place` names it and the time is 0.
LeastTime calc_least_time(const RobotModel& robot, double gravity_m_per_s2,
                          const std::vector<PathPlace>& path, const JointLimits& limits);
// Returns the motion along paths that follow each other, from rest to rest on each, in their least
// times. Accelerations jump between places, where u does.
MotionCurve make_fastest_motion(std::span<const std::vector<PathPlace>> paths,
                                std::span<const LeastTime> times);

}  // namespace armwright
