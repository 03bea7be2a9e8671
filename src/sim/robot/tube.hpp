// Links that are straight tubes of one material, for the design of sections: their masses, and how far
// an arm made of them sags. With the outer diameter D, the wall w, d = D - 2 w and the length L,
//   A = pi (D^2 - d^2) / 4,   I = pi (D^4 - d^4) / 64,   m = rho A L.
// Moments of inertia about the tube's middle are m (L^2 / 12 + (D^2 + d^2) / 16) across its axis and
// m (D^2 + d^2) / 8 about it.
//
// The deflection is that of the tip of the stretched arm under gravity across it, with every joint
// locked: link i is a cantilever (Euler and Bernoulli) with the weight u_i = rho A_i g per length, the
// force F_i and the moment M_i of everything beyond its end, and turns what it carries:
//   w_i = u L^4 / 8EI + F L^3 / 3EI + M L^2 / 2EI,   phi_i = u L^3 / 6EI + F L^2 / 2EI + M L / EI,
//   deflection = sum_i (w_i + phi_i (L_(i+1) + ... + L_n)).
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "sim/robot/robot_model.hpp"

namespace armwright {

struct TubeMaterial {
  double youngs_modulus_pa = 70e9;  // E; aluminium
  double density_kg_per_m3 = 2700;  // rho
};

struct Tube {
  double diameter_m = 0;  // D, outside
  double wall_m = 0;      // w; from D / 2 on, the tube is a bar

  bool operator==(const Tube&) const = default;
  double bore_m() const { return std::max(0.0, diameter_m - 2 * wall_m); }  // d
  double section_m2() const;                                                // A
  double second_moment_m4() const;                                          // I
};

// The bounds of a number that is a variable.
struct VariableBounds {
  double lower = 0, upper = 0;
};

// The tubes that an arm is made of, and the bounds (m) of the sizes that are variables.
struct ArmTubes {
  TubeMaterial material;
  std::vector<Tube> tubes;  // one per link; empty: links keep the masses of the robot's file
  std::optional<VariableBounds> length_m, diameter_m, wall_m;
  std::optional<double> deflection_limit_m;  // nothing: no limit
};

// Return the pose, in the link's frame, of the link's end: of the next joint, or of the tip.
Eigen::Isometry3d& get_link_end(RobotModel& robot, std::size_t link);
const Eigen::Isometry3d& get_link_end(const RobotModel& robot, std::size_t link);
// Returns the length (m) of a link: from its joint to the next one, or to the tip.
double get_link_length_m(const RobotModel& robot, std::size_t link);

// Makes the link a tube between its joint and the next one, with nothing else on it, except that the
// last link carries the payload of the robot, if it has one. The link's length must be above 0.
void make_tube(RobotModel& robot, std::size_t link, const Tube& tube, const TubeMaterial& material);

// Returns the deflection (m) of an arm whose links are these tubes, with a point mass at the tip.
double calc_deflection_m(std::span<const Tube> tubes, std::span<const double> lengths_m,
                         const TubeMaterial& material, double payload_kg, double gravity_m_per_s2);

}  // namespace armwright
