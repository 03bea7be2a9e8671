// The plant of a pack of lanes: what stands between motors and links
// (sim/robot/joint_plant.hpp), and the perturbations of sim/tracking/plant_variation.hpp. Each lane
// has its own numbers. While the controllers run, the state holds the measured positions in place
// of the true ones.
#pragma once

#include "sim/dynamics/chain_shape.hpp"
#include "sim/dynamics/joint_laws.hpp"
#include "sim/engines/articulated/kernels.hpp"

namespace armwright::articulated {

template <class V, class Chain, bool kIdeal>
class LanePlant;

template <class V, class Chain>
class LanePlant<V, Chain, false> {
 public:
  using T = typename V::Scalar;

  ARMWRIGHT_INLINE LanePlant(SegmentCall<T>& call, const Chain& chain, V*& scratch)
      : call_(call), chain_(chain), newest_(call.newest) {
    acting_effort_.place(scratch, call.joints);
    inertia_.place(scratch, call.joints);
    held_.place(scratch, call.joints);
  }

  ARMWRIGHT_INLINE void show_measured(V* q) {
    chain_.for_up([&](auto i) __attribute__((always_inline)) {
      held_[i] = q[i];
      if (is_perturbed()) {
        q[i] = recall(i);
      } else if (has(kMeasuresMotor, i)) {
        q[i] = state(kMotor, i);
      }
    });
  }
  ARMWRIGHT_INLINE void show_true(V* q) const {
    chain_.for_up([&](auto i) __attribute__((always_inline)) { q[i] = held_[i]; });
  }
  // Stores the positions that a substep ended with.
  ARMWRIGHT_INLINE void remember(const V* q) {
    if (!is_perturbed()) {
      return;
    }
    newest_ = newest_ + 1 == call_.past_length ? 0 : newest_ + 1;
    chain_.for_up([&](auto i) __attribute__((always_inline)) {
      past(newest_)[i] = has(kMeasuresMotor, i) ? state(kMotor, i) : q[i];
    });
  }

  // Returns the efforts that act on the links during a substep, given those of the controllers.
  // Moves the motors of elastic joints to its end.
  ARMWRIGHT_INLINE const V* calc_effort(const V* effort, const V* q, const V* rate, V substep_s) {
    chain_.for_up([&](auto i) __attribute__((always_inline)) {
      V acting = effort[i];
      if (is_perturbed()) {
        acting = perturb(i, acting, q, rate);
      }
      if (has(kElastic, i)) {
        acting = pass_spring(i, acting, q[i], rate[i], substep_s);
      } else if (has(kHasFriction, i)) {
        const V chord = calc_chord(i, rate[i]);
        acting -= number(kOffset, i) + chord * rate[i];
        inertia_[i] = number(kArmature, i) + substep_s * chord;
      } else {
        inertia_[i] = number(kArmature, i);
      }
      if (has(kBalanced, i)) {
        acting += calc_balance(call_.balances[i], q[i], chain_.slides(i));
      }
      acting_effort_[i] = acting;
    });
    return &acting_effort_[0];
  }
  // Adds the inertia of the motors of rigid joints, and what is implicit in the friction.
  ARMWRIGHT_INLINE void add_inertia(auto& dynamics) const {
    chain_.for_up([&](auto i) __attribute__((always_inline)) {
      if (has(kHasArmature | kHasFriction, i) && !has(kElastic, i)) {
        dynamics.add_inertia(i, inertia_[i]);
      }
    });
  }
  // Returns how far a controller's effort has pushed in the substep: the way of the link, or of the
  // motor of an elastic joint.
  ARMWRIGHT_INLINE V get_pushed_way(int i, V way, V substep_s) const {
    return has(kElastic, i) ? substep_s * state(kMotorRate, i) : way;
  }

 private:
  ARMWRIGHT_INLINE int joints() const { return chain_.joints(); }
  ARMWRIGHT_INLINE bool is_perturbed() const { return call_.past != nullptr; }
  ARMWRIGHT_INLINE bool has(int flags, int joint) const {
    return (call_.drives[joint] & flags) != 0;
  }
  ARMWRIGHT_INLINE V number(PlantField field, int joint) const {
    return reinterpret_cast<const V*>(call_.plant)[field * joints() + joint];
  }
  ARMWRIGHT_INLINE V single(PlantSingle field) const {
    return reinterpret_cast<const V*>(call_.plant)[kPlantFields * joints() + field];
  }
  ARMWRIGHT_INLINE V& state(StateField field, int joint) const {
    return reinterpret_cast<V*>(call_.state)[field * joints() + joint];
  }
  ARMWRIGHT_INLINE V* past(int place) const {
    return reinterpret_cast<V*>(call_.past) + place * joints();
  }

  // Returns the position that the controller measures, delayed and rounded.
  ARMWRIGHT_INLINE V recall(int i) const {
    alignas(64) T lanes[V::kLanes];
    for (int lane = 0; lane < V::kLanes; ++lane) {
      int place = newest_ - call_.delay[lane];
      place += place < 0 ? call_.past_length : 0;
      lanes[lane] = call_.past[(place * joints() + i) * V::kLanes + lane];
    }
    const V angle = *reinterpret_cast<const V*>(lanes);
    const V quantum = single(kQuantum);
    const V turned = chain_.slides(i) ? angle : lanes::wrap(angle);
    return select(quantum > V(0), lanes::round_to_integer(turned / quantum) * quantum, angle);
  }

  // Returns the effort with the perturbation's ripple and friction.
  ARMWRIGHT_INLINE V perturb(int i, V acting, const V* q, const V* rate) const {
    if (!chain_.slides(i)) {
      V sine;
      V cosine;
      lanes::calc_sine_cosine(lanes::wrap(q[i]) * single(kRippleCycles) + number(kRipplePhase, i),
                              sine, cosine);
      acting = acting + acting * (number(kRipple, i) * sine);
    }
    const V turning = has(kElastic, i) ? state(kMotorRate, i) : rate[i];
    const V sliding = max(V(-1), min(V(1), turning * single(kRateScale)));
    return acting - (number(kViscous, i) * turning + number(kCoulomb, i) * sliding);
  }

  ARMWRIGHT_INLINE V calc_chord(int i, V rate) const {
    return calc_friction_chord(
        FrictionNumbers<V>{number(kDrag, i), number(kBreakaway, i), number(kStribeck, i),
                           number(kInverseTransition, i), number(kInverseStribeck, i)},
        rate, has(kHasStribeck, i));
  }

  // Moves the motor by a substep and returns the spring's effort at its start.
  ARMWRIGHT_INLINE V pass_spring(int i, V acting, V q, V rate, V substep_s) {
    V& place = state(kMotor, i);
    V& speed = state(kMotorRate, i);
    const V spring = number(kStiffness, i) * (place - q) + number(kDamping, i) * (speed - rate);
    V inertia = number(kArmature, i);
    acting -= spring;
    if (has(kHasFriction, i)) {
      const V chord = calc_chord(i, speed);
      acting -= number(kOffset, i) + chord * speed;
      inertia += substep_s * chord;
    }
    speed += substep_s * (acting / inertia);
    place += substep_s * speed;
    return spring;
  }

  SegmentCall<T>& call_;
  const Chain& chain_;
  int newest_;
  PackList<V, Chain::kJoints> acting_effort_, inertia_, held_;
};

// The ideal plant: every function does nothing.
template <class V, class Chain>
class LanePlant<V, Chain, true> {
 public:
  ARMWRIGHT_INLINE LanePlant(SegmentCall<typename V::Scalar>& /*call*/, const Chain& /*chain*/,
                             V*& /*scratch*/) {}
  ARMWRIGHT_INLINE void show_measured(V* /*q*/) const {}
  ARMWRIGHT_INLINE void show_true(V* /*q*/) const {}
  ARMWRIGHT_INLINE void remember(const V* /*q*/) const {}
  ARMWRIGHT_INLINE const V* calc_effort(const V* effort, const V* /*q*/, const V* /*rate*/,
                                        V /*substep_s*/) const {
    return effort;
  }
  ARMWRIGHT_INLINE void add_inertia(auto& /*dynamics*/) const {}
  ARMWRIGHT_INLINE V get_pushed_way(int /*joint*/, V way, V /*substep_s*/) const { return way; }
};

}  // namespace armwright::articulated
