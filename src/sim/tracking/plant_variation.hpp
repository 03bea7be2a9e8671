// Perturbations of a plant that the controllers do not know of: friction in the joints, an encoder
// of finite resolution that is read late, and torque that ripples with the angle. Engines apply
// them in every substep of the physics (of length h) and whenever a controller measures:
//
//   joint effort       u (1 + a sin(n q + phi)) - b qd - c clamp(qd / v_s, -1, 1)
//   measured position  q at the start of the control period, `delay_substeps` substeps earlier,
//                      rounded to the nearest multiple of the quantum (to the even one of two)
//
//   u         the controller's effort (N m or N, positive along the joint), held for a control period
//   q, qd     the joint's position (rad or m) and rate (rad/s or m/s) at the start of the substep
//   a, n, phi amplitude (1), cycles per turn and phase (rad) of the ripple; revolute joints only
//   b         viscous friction (N m s/rad or N s/m)
//   c         Coulomb friction (N m or N)
//   v_s       the rate (rad/s or m/s) from which on Coulomb friction has its full size; a joint that
//             sticks creeps at v_s tau / c under an effort tau < c
// Before the start the arm was at rest.
//
// All terms are explicit, so the simulation is stable only while h (b + c / v_s) < M, the inertia
// (kg m^2 or kg) that the joint moves while the others are free. The peak and root mean square
// efforts and the energy of a result are those of u.
#pragma once

#include <vector>

namespace armwright {

// All lists have one number per joint.
struct PlantVariation {
  std::vector<double> viscous_friction;    // b
  std::vector<double> coulomb_friction;    // c
  double friction_transition_rate = 0.05;  // v_s > 0
  double quantum = 0;                      // rad or m; 0: positions are exact
  int delay_substeps = 0;
  std::vector<double> torque_ripple;     // a
  std::vector<double> ripple_phase_rad;  // phi
  int ripple_cycles_per_turn = 12;       // n
};

}  // namespace armwright
