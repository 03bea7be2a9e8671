// What a simulated plant has beside its masses that the controllers know nothing of: friction in
// the joints, an encoder of finite resolution that is read late, and torque that ripples with the
// angle. Engines apply it in every plant substep (of length h) and wherever a controller measures:
//
//   joint torque     u (1 + a sin(n q + phi)) - b qd - c clamp(qd / v_s, -1, 1)
//   measured angle   q at the start of the control period, `delay_substeps` plant steps earlier,
//                    rounded to the nearest multiple of the quantum (the even one of two)
//
// u: the controller's effort (N m, positive along the joint), held for a control period; q (rad)
// and qd (rad/s): the joint's state at the start of the substep; a, n, phi: amplitude (1), cycles
// a turn and phase (rad) of the ripple; b: viscous friction (N m s/rad); c: Coulomb friction
// (N m), with v_s the rate (rad/s) from which on it is at its full size, so that a joint that
// sticks creeps at v_s tau / c under a torque tau < c. Before the start the arm was at rest.
//
// Everything is explicit: stable only while h (b + c / v_s) < M, the inertia (kg m^2) that the
// joint moves with the others free. The peak and root-mean-square efforts and the energy of a
// result are those of u.
#pragma once

#include <vector>

namespace armwright {

// All lists have one number a joint.
struct PlantVariation {
  std::vector<double> viscous_friction_n_m_s_per_rad;  // b
  std::vector<double> coulomb_friction_n_m;            // c
  double friction_transition_rad_per_s = 0.05;         // v_s > 0
  double quantisation_rad = 0;                         // 0: none
  int delay_substeps = 0;
  std::vector<double> torque_ripple;     // a
  std::vector<double> ripple_phase_rad;  // phi
  int ripple_cycles_per_turn = 12;       // n
};

}  // namespace armwright
