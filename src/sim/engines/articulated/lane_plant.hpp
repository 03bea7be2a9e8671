// The plant of a pack of lanes: what stands between motors and links
// (sim/robot/joint_plant.hpp), and the perturbations of sim/tracking/plant_variation.hpp. Each lane
// has its own numbers. While the controllers run, the state holds the measured positions in place
// of the true ones.
#pragma once

#include "sim/dynamics/chain_shape.hpp"
#include "sim/dynamics/joint_laws.hpp"
#include "sim/engines/articulated/kernels.hpp"

namespace armwright::articulated {

// The steps of the plants of a pack of lanes. The functions loop over the joints and are not
// inlined: the kernels are so long that the processor would run out of decoded instructions.
template <class V>
class PlantStep {
 public:
  using T = typename V::Scalar;

  // Stores the true positions in `held`, and replaces them by the measured ones. `newest` is the
  // place of the true positions in the ring of past ones.
  __attribute__((noinline)) static void show_measured(const SegmentCall<T>& call, int newest,
                                                      V* held) {
    const PlantStep plant(call);
    for (int i = 0; i < call.joints; ++i) {
      V& q = plant.state(kQ, i);
      held[i] = q;
      if (call.past != nullptr) {
        q = plant.recall(i, newest);
      } else if (plant.has(kMeasuresMotor, i)) {
        q = plant.state(kMotor, i);
      }
    }
  }
  // Stores the positions that a substep ended with at the place `newest`.
  __attribute__((noinline)) static void remember(const SegmentCall<T>& call, int newest) {
    const PlantStep plant(call);
    for (int i = 0; i < call.joints; ++i) {
      plant.past(newest)[i] = plant.state(plant.has(kMeasuresMotor, i) ? kMotor : kQ, i);
    }
  }
  // Replaces the controllers' efforts by those that act on the links during a substep, and computes
  // the inertia that joins each joint. Moves the motors of elastic joints to the end of the substep.
  // `dry` is memory for one fraction per joint.
  __attribute__((noinline)) static void act(const SegmentCall<T>& call, V substep_s, V* efforts,
                                            V* inertia, Fraction<V>* dry) {
    const PlantStep plant(call);
    // All quotients come before all divisions, so that the processor works on several joints at
    // once.
    for (int i = 0; i < call.joints; ++i) {
      if (plant.has(kHasFriction, i)) {
        dry[i] = plant.calc_dry_friction(i);
      }
    }
    for (int i = 0; i < call.joints; ++i) {
      V effort = efforts[i];
      if (call.past != nullptr) {
        effort = plant.perturb(i, effort);
      }
      if (plant.has(kElastic, i)) {
        effort = plant.pass_spring(i, effort, substep_s, dry);
        inertia[i] = V(0);
      } else {
        inertia[i] = plant.rub(i, plant.state(kRate, i), substep_s, dry, effort);
      }
      if (plant.has(kBalanced, i)) {
        effort += calc_balance(call.balances[i], plant.state(kQ, i), plant.slides(i));
      }
      efforts[i] = effort;
    }
  }

 private:
  ARMWRIGHT_INLINE explicit PlantStep(const SegmentCall<T>& call) : call_(call) {}

  ARMWRIGHT_INLINE bool slides(int joint) const { return (call_.flags[joint] & kPrismatic) != 0; }
  ARMWRIGHT_INLINE bool has(int flags, int joint) const {
    return (call_.drives[joint] & flags) != 0;
  }
  ARMWRIGHT_INLINE V number(PlantField field, int joint) const {
    return reinterpret_cast<const V*>(call_.plant)[field * call_.joints + joint];
  }
  ARMWRIGHT_INLINE V single(PlantSingle field) const {
    return reinterpret_cast<const V*>(call_.plant)[kPlantFields * call_.joints + field];
  }
  ARMWRIGHT_INLINE V& state(StateField field, int joint) const {
    return reinterpret_cast<V*>(call_.state)[field * call_.joints + joint];
  }
  ARMWRIGHT_INLINE V* past(int place) const {
    return reinterpret_cast<V*>(call_.past) + place * call_.joints;
  }

  // Returns the position that the controller measures, delayed and rounded.
  ARMWRIGHT_INLINE V recall(int i, int newest) const {
    alignas(64) T lanes[V::kLanes];
    for (int lane = 0; lane < V::kLanes; ++lane) {
      int place = newest - call_.delay[lane];
      place += place < 0 ? call_.past_length : 0;
      lanes[lane] = call_.past[(place * call_.joints + i) * V::kLanes + lane];
    }
    const V angle = *reinterpret_cast<const V*>(lanes);
    const V quantum = single(kQuantum);
    const V turned = slides(i) ? angle : lanes::wrap(angle);
    return select(quantum > V(0), lanes::round_to_integer(turned / quantum) * quantum, angle);
  }

  // Returns the effort with the perturbation's ripple and friction.
  ARMWRIGHT_INLINE V perturb(int i, V effort) const {
    if (!slides(i)) {
      V sine;
      V cosine;
      lanes::calc_sine_cosine(
          lanes::wrap(state(kQ, i)) * single(kRippleCycles) + number(kRipplePhase, i), sine,
          cosine);
      effort = effort + effort * (number(kRipple, i) * sine);
    }
    const V rate = state(has(kElastic, i) ? kMotorRate : kRate, i);
    const V sliding = max(V(-1), min(V(1), rate * single(kRateScale)));
    return effort - (number(kViscous, i) * rate + number(kCoulomb, i) * sliding);
  }

  // Moves the motor by a substep and returns the spring's effort at its start.
  ARMWRIGHT_INLINE V pass_spring(int i, V effort, V substep_s, const Fraction<V>* dry) const {
    V& place = state(kMotor, i);
    V& rate = state(kMotorRate, i);
    const V spring = number(kStiffness, i) * (place - state(kQ, i)) +
                     number(kDamping, i) * (rate - state(kRate, i));
    effort -= spring;
    const V inertia = rub(i, rate, substep_s, dry, effort);
    rate += substep_s * (effort / inertia);
    place += substep_s * rate;
    return spring;
  }

  // Returns the chord's slope without the viscous friction.
  ARMWRIGHT_INLINE Fraction<V> calc_dry_friction(int i) const {
    return calc_friction_chord(
        FrictionNumbers<V>{number(kBreakaway, i), number(kStribeck, i),
                           number(kInverseTransition, i), number(kInverseStribeck, i)},
        state(has(kElastic, i) ? kMotorRate : kRate, i), has(kHasStribeck, i));
  }
  // Takes the friction at a rate from the effort. Returns the armature with what is implicit in the
  // friction.
  ARMWRIGHT_INLINE V rub(int i, V rate, V substep_s, const Fraction<V>* dry, V& effort) const {
    if (!has(kHasFriction, i)) {
      return number(kArmature, i);
    }
    const V chord = number(kDrag, i) + dry[i].n / dry[i].d;
    effort -= number(kOffset, i) + chord * rate;
    return number(kArmature, i) + substep_s * chord;
  }

  const SegmentCall<T>& call_;
};

template <class V, class Chain, bool kIdeal>
class LanePlant;

template <class V, class Chain>
class LanePlant<V, Chain, false> {
 public:
  using T = typename V::Scalar;

  ARMWRIGHT_INLINE LanePlant(SegmentCall<T>& call, const Chain& chain, V*& scratch)
      : call_(call),
        chain_(chain),
        newest_(call.newest),
        effort_(scratch),
        inertia_(scratch + call.joints),
        held_(scratch + 2 * call.joints),
        dry_(reinterpret_cast<Fraction<V>*>(scratch + 3 * call.joints)) {
    scratch += 5 * call.joints;
  }

  // show_measured() replaces the true positions in the state by those that the controllers measure;
  // show_true() restores them.
  ARMWRIGHT_INLINE void show_measured() const {
    if (call_.measures_apart) {
      PlantStep<V>::show_measured(call_, newest_, held_);
    }
  }
  ARMWRIGHT_INLINE void show_true(V* q) const {
    if (call_.measures_apart) {
      chain_.for_up([&](auto i) __attribute__((always_inline)) { q[i] = held_[i]; });
    }
  }
  // Stores the positions that a substep ended with.
  ARMWRIGHT_INLINE void remember() {
    if (call_.past != nullptr) {
      newest_ = newest_ + 1 == call_.past_length ? 0 : newest_ + 1;
      PlantStep<V>::remember(call_, newest_);
    }
  }

  // Returns the efforts that act on the links during a substep, given those of the controllers.
  // Moves the motors of elastic joints to its end.
  ARMWRIGHT_INLINE const V* calc_effort(const V* effort, V substep_s) {
    chain_.for_up([&](auto i) __attribute__((always_inline)) { effort_[i] = effort[i]; });
    PlantStep<V>::act(call_, substep_s, effort_, inertia_, dry_);
    return effort_;
  }
  // Adds the inertia of the motors of rigid joints, and what is implicit in the friction.
  template <class Dynamics>
  ARMWRIGHT_INLINE void add_inertia(Dynamics& dynamics) const {
    chain_.for_up([&](auto i)
                      __attribute__((always_inline)) { dynamics.add_inertia(i, inertia_[i]); });
  }
  // Returns how far a controller's effort has pushed in the substep: the way of the link, or of the
  // motor of an elastic joint.
  ARMWRIGHT_INLINE V get_pushed_way(int i, V way, V substep_s) const {
    return (call_.drives[i] & kElastic) != 0
               ? substep_s * reinterpret_cast<const V*>(call_.state)[kMotorRate * call_.joints + i]
               : way;
  }

 private:
  SegmentCall<T>& call_;
  Chain chain_;  // a copy: a reference would keep the whole kernel in memory
  int newest_;
  V *effort_, *inertia_, *held_;  // one pack per joint
  Fraction<V>* dry_;              // one per joint
};

// The ideal plant: every function does nothing.
template <class V, class Chain>
class LanePlant<V, Chain, true> {
 public:
  ARMWRIGHT_INLINE LanePlant(SegmentCall<typename V::Scalar>& /*call*/, const Chain& /*chain*/,
                             V*& /*scratch*/) {}
  ARMWRIGHT_INLINE void show_measured() const {}
  ARMWRIGHT_INLINE void show_true(V* /*q*/) const {}
  ARMWRIGHT_INLINE void remember() const {}
  ARMWRIGHT_INLINE const V* calc_effort(const V* effort, V /*substep_s*/) const { return effort; }
  template <class Dynamics>
  ARMWRIGHT_INLINE void add_inertia(Dynamics& /*dynamics*/) const {}
  ARMWRIGHT_INLINE V get_pushed_way(int /*joint*/, V way, V /*substep_s*/) const { return way; }
};

}  // namespace armwright::articulated
