// The plant of a joint lies between its motor and its link: rotor inertia, friction, elasticity and
// counterbalance. With q the joint's position, v its rate, and u the effort of its controller, a
// rigid joint obeys
//   M(q) qdd + b(q, v) = u + s(q) - A qdd - f(v),
//   f(v) = o + d v + (c + s_t) tanh(v / v_w) - s_t tanh(v / v_s).
// A is the rotor's inertia times the gear ratio squared, d the viscous friction, c the Coulomb
// friction, c + s_t the friction at breakaway, and o a constant offset. Friction rises to c + s_t
// within about v_w and falls to c until about v_s (Stribeck). This form has that of Weigand et al.
// (2021), f_c sgn(v) + f_a tanh(f_b v), with f_a = -s_t, f_b = 1 / v_s and f_c = c + s_t. A joint
// that sticks creeps at v_w artanh(tau / (c + s_t)) under an effort tau.
//
// An elastic joint has a motor at the angle p (in units of q) and a spring of stiffness k and
// damping z between motor and link; friction acts on the motor (Spong 1987, Modeling and control of
// elastic joint robots):
//   A pdd = u - f(pd) - e,   M(q) qdd + b(q, v) = e + s(q),   e = k (p - q) + z (pd - v).
//
// An unactuated joint has no motor. A spring of stiffness k that is relaxed at 0, and a damping z,
// act on it in place of u:
//   M(q) qdd + b(q, v) = -k q - z v - A qdd - f(v).
// A chain of links on such joints stands for a flexible link. It has an entry like any other joint
// in designs and target tables, where its gains, effort limits and targets are 0. The spring is kept
// as a counterbalance and z as viscous friction, so it has no code of its own in engines.
//
// Units: rad, rad/s and N m for a revolute joint, m, m/s and N for a prismatic one.
#pragma once

#include <cstddef>
#include <vector>

namespace armwright {

// The effort s(q) of a spring or gas spring that acts beside the motor. It is given at even
// distances from `lower` to `upper`, is straight between these positions, and keeps its value beyond
// both ends. The efforts are those of a model times scale (1 + slope z), with z from -1 at `lower` to
// 1 at `upper`: the corrections that an identification finds (sim/identification).
struct Counterbalance {
  double lower = 0, upper = 0;  // rad or m
  std::vector<double> efforts;  // N m or N, corrected; at least two; empty: no counterbalance
  double scale = 1, slope = 0;  // scale > 0, |slope| < 1

  // Corrects the model in another way.
  void correct(double new_scale, double new_slope) {
    for (std::size_t i = 0; i < efforts.size(); ++i) {
      const double z = 2 * static_cast<double>(i) / static_cast<double>(efforts.size() - 1) - 1;
      efforts[i] *= new_scale * (1 + new_slope * z) / (scale * (1 + slope * z));
    }
    scale = new_scale;
    slope = new_slope;
  }

  bool operator==(const Counterbalance&) const = default;
};

// The position that the controller of an elastic joint measures.
enum class MeasuredSide { motor, link };

struct JointPlant {
  double armature = 0;            // A, kg m^2 or kg
  double gear_ratio = 0;          // motor's angle per joint position, for logs; 0: not known
  double viscous = 0;             // d, N m s/rad or N s/m
  double coulomb = 0;             // c, N m or N
  double stribeck = 0;            // s_t, N m or N; at least -c
  double transition_rate = 0.01;  // v_w > 0, rad/s or m/s
  double stribeck_rate = 0.1;     // v_s >= v_w, rad/s or m/s
  double offset = 0;              // o, N m or N
  // k, N m/rad or N/m; 0: the joint is rigid. Needs armature > 0, except of an unactuated joint.
  double stiffness = 0;
  double damping = 0;  // z, N m s/rad or N s/m
  MeasuredSide measured = MeasuredSide::motor;
  Counterbalance counterbalance;
  bool unactuated = false;  // set_unactuated() sets it

  bool operator==(const JointPlant&) const = default;
  bool is_elastic() const { return stiffness > 0 && !unactuated; }
  bool has_friction() const {
    return get_drag() > 0 || coulomb > 0 || stribeck != 0 || offset != 0;
  }
  // Returns the viscous friction between the joint's two links.
  double get_drag() const { return unactuated ? viscous + damping : viscous; }
  // Returns whether nothing stands between motor and link.
  bool is_ideal() const {
    return armature == 0 && !has_friction() && !is_elastic() && counterbalance.efforts.empty() &&
           !unactuated;
  }
  // Takes the motor away. The spring's effort is straight up to +-`widest` (rad or m).
  void set_unactuated(double own_stiffness, double own_damping, double widest) {
    unactuated = true;
    stiffness = own_stiffness;
    damping = own_damping;
    const double most = stiffness * widest;
    counterbalance = {-widest, widest, {most, 0, -most}};
  }
};

// Multiplies all friction of a joint, also its offset.
inline void scale_friction(JointPlant& plant, double factor) {
  for (double* part : {&plant.viscous, &plant.coulomb, &plant.stribeck, &plant.offset}) {
    *part *= factor;
  }
}

// Multiplies the stiffness and the damping of a joint's spring.
inline void scale_stiffness(JointPlant& plant, double factor) {
  plant.stiffness *= factor;
  plant.damping *= factor;
  if (plant.unactuated) {
    for (double& effort : plant.counterbalance.efforts) {
      effort *= factor;
    }
  }
}

}  // namespace armwright
