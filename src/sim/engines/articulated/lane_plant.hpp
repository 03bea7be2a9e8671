// The plant of a pack of lanes: what stands between motors and links
// (sim/robot/joint_plant.hpp), and the perturbations of sim/tracking/plant_variation.hpp. Each lane
// has its own numbers. While the controllers run, the state holds the measured positions in place
// of the true ones.
#pragma once

#include "sim/dynamics/chain_shape.hpp"
#include "sim/dynamics/joint_laws.hpp"
#include "sim/engines/articulated/kernels.hpp"

namespace armwright::articulated {

// The parts of a plant that a segment's kernel can have.
enum class PlantKind {
  ideal,      // none
  perturbed,  // a PlantVariation of ideal joints
  full,       // all
};

// The plant of one kind. Its functions take the true positions and rates of the joints.
template <class V, class Chain, PlantKind kKind>
class LanePlant;

// Versions of armwright agree in the last bit on perturbed plants. Which products the compiler
// fuses depends on the whole kernel, so this class stays as it was in version 1.0.
template <class V, class Chain>
class LanePlant<V, Chain, PlantKind::perturbed> {
 public:
  using T = typename V::Scalar;

  ARMWRIGHT_INLINE LanePlant(SegmentCall<T>& call, const Chain& chain, V*& scratch)
      : call_(call), chain_(chain), newest_(call.newest) {
    acting_effort_.place(scratch, call.joints);
  }

  ARMWRIGHT_INLINE void show_measured(V* q) const {
    chain_.for_up([&](auto i) __attribute__((always_inline)) {
      alignas(64) T lanes[V::kLanes];
      for (int lane = 0; lane < V::kLanes; ++lane) {
        int place = newest_ - call_.delay[lane];
        place += place < 0 ? call_.past_length : 0;
        lanes[lane] = call_.past[(place * joints() + i) * V::kLanes + lane];
      }
      const V angle = *reinterpret_cast<const V*>(lanes);
      const V quantum = single(kQuantum);
      const V turned = chain_.slides(i) ? angle : lanes::wrap(angle);
      q[i] = select(quantum > V(0), lanes::round_to_integer(turned / quantum) * quantum, angle);
    });
  }
  ARMWRIGHT_INLINE void show_true(V* q) const {
    chain_.for_up([&](auto i) __attribute__((always_inline)) { q[i] = past(newest_)[i]; });
  }
  // Stores the positions that a substep ended with.
  ARMWRIGHT_INLINE void remember(const V* q) {
    newest_ = newest_ + 1 == call_.past_length ? 0 : newest_ + 1;
    chain_.for_up([&](auto i) __attribute__((always_inline)) { past(newest_)[i] = q[i]; });
  }

  // Returns the efforts that act on the joints, given those of the controllers.
  ARMWRIGHT_INLINE const V* calc_effort(const V* effort, const V* q, const V* rate,
                                        V /*substep_s*/) {
    chain_.for_up([&](auto i) __attribute__((always_inline)) {
      V acting = effort[i];
      if (!chain_.slides(i)) {
        V sine;
        V cosine;
        lanes::calc_sine_cosine(lanes::wrap(q[i]) * single(kRippleCycles) + field(kRipplePhase, i),
                                sine, cosine);
        acting = acting + acting * (field(kRipple, i) * sine);
      }
      const V sliding = max(V(-1), min(V(1), rate[i] * single(kRateScale)));
      acting_effort_[i] = acting - (field(kViscous, i) * rate[i] + field(kCoulomb, i) * sliding);
    });
    return &acting_effort_[0];
  }
  template <class Dynamics>
  ARMWRIGHT_INLINE void add_inertia(Dynamics& /*dynamics*/) const {}
  ARMWRIGHT_INLINE void take_motor_ways(V* /*way*/) const {}

 private:
  ARMWRIGHT_INLINE int joints() const { return chain_.joints(); }
  ARMWRIGHT_INLINE V field(PlantField field, int joint) const {
    return reinterpret_cast<const V*>(call_.plant)[field * joints() + joint];
  }
  ARMWRIGHT_INLINE V single(PlantSingle field) const {
    return reinterpret_cast<const V*>(call_.plant)[kPlantFields * joints() + field];
  }
  ARMWRIGHT_INLINE V* past(int place) const {
    return reinterpret_cast<V*>(call_.past) + place * joints();
  }

  SegmentCall<T>& call_;
  const Chain& chain_;
  int newest_;
  PackList<V, Chain::kJoints> acting_effort_;
};

// The steps of the plants of a pack of lanes. The functions loop over the joints and are not
// inlined: the kernels are so long that the processor would run out of decoded instructions.
template <class V>
class PlantStep {
 public:
  using T = typename V::Scalar;
  using Perturbed = LanePlant<V, ChainShape<0, kAnyShape, true>, PlantKind::perturbed>;

  // Stores the true positions in `held`, and replaces them by the measured ones.
  __attribute__((noinline)) static void show_measured(const SegmentCall<T>& call,
                                                      const Perturbed& perturbed, V* held) {
    const PlantStep plant(call);
    for (int i = 0; i < call.joints; ++i) {
      held[i] = plant.state(kQ, i);
    }
    plant.copy_measured(&plant.state(kQ, 0));
    if (call.past != nullptr) {
      perturbed.show_measured(&plant.state(kQ, 0));
    }
  }
  // Stores the positions that a substep ended with. `memory` is for one pack per joint.
  __attribute__((noinline)) static void remember(const SegmentCall<T>& call, Perturbed& perturbed,
                                                 V* memory) {
    PlantStep(call).copy_measured(memory);
    perturbed.remember(memory);
  }
  // Replaces the controllers' efforts by those that act on the links during a substep, and computes
  // the inertia that joins each joint. Moves the motors of elastic joints to the end of the substep,
  // and adds that to their `ways`. `dry` is memory for one fraction per joint.
  __attribute__((noinline)) static void act(const SegmentCall<T>& call, Perturbed& perturbed,
                                            V substep_s, V* efforts, V* inertia, V* ways,
                                            Fraction<V>* dry) {
    const PlantStep plant(call);
    const V* wanted = efforts;
    if (call.past != nullptr) {
      V* const rates = inertia;
      for (int i = 0; i < call.joints; ++i) {
        rates[i] = plant.state(plant.has(kElastic, i) ? kMotorRate : kRate, i);
      }
      wanted = perturbed.calc_effort(efforts, &plant.state(kQ, 0), rates, substep_s);
    }
    // All quotients come before all divisions, so that the processor works on several joints at
    // once.
    for (int i = 0; i < call.joints; ++i) {
      if (plant.has(kHasFriction, i)) {
        dry[i] = plant.calc_dry_friction(i);
      }
    }
    for (int i = 0; i < call.joints; ++i) {
      V effort = wanted[i];
      if (plant.has(kElastic, i)) {
        effort = plant.pass_spring(i, effort, substep_s, dry, ways[i]);
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
  __attribute__((noinline)) static void take_motor_ways(const SegmentCall<T>& call, V* motor_way,
                                                        V* way) {
    for (int i = 0; i < call.joints; ++i) {
      if ((call.drives[i] & kElastic) != 0) {
        way[i] = motor_way[i];
        motor_way[i] = V(0);
      }
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
  ARMWRIGHT_INLINE V& state(StateField field, int joint) const {
    return reinterpret_cast<V*>(call_.state)[field * call_.joints + joint];
  }
  // Copies the positions of the measured sides.
  ARMWRIGHT_INLINE void copy_measured(V* positions) const {
    for (int i = 0; i < call_.joints; ++i) {
      positions[i] = state(has(kMeasuresMotor, i) ? kMotor : kQ, i);
    }
  }

  // Moves the motor by a substep and returns the spring's effort at its start.
  ARMWRIGHT_INLINE V pass_spring(int i, V effort, V substep_s, const Fraction<V>* dry,
                                 V& way) const {
    V& place = state(kMotor, i);
    V& rate = state(kMotorRate, i);
    const V spring = number(kStiffness, i) * (place - state(kQ, i)) +
                     number(kDamping, i) * (rate - state(kRate, i));
    effort -= spring;
    const V inertia = rub(i, rate, substep_s, dry, effort);
    rate += substep_s * (effort / inertia);
    const V moved = substep_s * rate;
    place += moved;
    way += moved;
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

template <class V, class Chain>
class LanePlant<V, Chain, PlantKind::full> {
 public:
  using T = typename V::Scalar;

  ARMWRIGHT_INLINE LanePlant(SegmentCall<T>& call, const Chain& chain, V*& scratch)
      : call_(call),
        chain_(chain),
        any_chain_(call.joints, call.flags, call.tilted_gravity),
        perturbed_(call, any_chain_, scratch),
        effort_(scratch),
        inertia_(scratch + call.joints),
        held_(scratch + 2 * call.joints),
        motor_way_(scratch + 3 * call.joints),
        dry_(reinterpret_cast<Fraction<V>*>(scratch + 4 * call.joints)) {
    chain_.for_up([&](auto i) __attribute__((always_inline)) { motor_way_[i] = V(0); });
    scratch += 6 * call.joints;
  }

  // show_measured() replaces the true positions in the state by those that the controllers measure;
  // show_true() restores them.
  ARMWRIGHT_INLINE void show_measured(V* /*q*/) const {
    if (call_.measures_apart) {
      PlantStep<V>::show_measured(call_, perturbed_, held_);
    }
  }
  ARMWRIGHT_INLINE void show_true(V* q) const {
    if (call_.measures_apart) {
      chain_.for_up([&](auto i) __attribute__((always_inline)) { q[i] = held_[i]; });
    }
  }
  // Stores the positions that a substep ended with.
  ARMWRIGHT_INLINE void remember(const V* /*q*/) {
    if (call_.past != nullptr) {
      PlantStep<V>::remember(call_, perturbed_, held_);
    }
  }

  // Returns the efforts that act on the links during a substep, given those of the controllers.
  // Moves the motors of elastic joints to its end.
  ARMWRIGHT_INLINE const V* calc_effort(const V* effort, const V* /*q*/, const V* /*rate*/,
                                        V substep_s) {
    chain_.for_up([&](auto i) __attribute__((always_inline)) { effort_[i] = effort[i]; });
    PlantStep<V>::act(call_, perturbed_, substep_s, effort_, inertia_, motor_way_, dry_);
    return effort_;
  }
  // Adds the inertia of the motors of rigid joints, and what is implicit in the friction.
  template <class Dynamics>
  ARMWRIGHT_INLINE void add_inertia(Dynamics& dynamics) const {
    chain_.for_up([&](auto i)
                      __attribute__((always_inline)) { dynamics.add_inertia(i, inertia_[i]); });
  }
  // Replaces the ways of elastic joints' links in the control period by those of their motors, which
  // the controllers' efforts push.
  ARMWRIGHT_INLINE void take_motor_ways(V* way) const {
    if (call_.elastic) {
      PlantStep<V>::take_motor_ways(call_, motor_way_, way);
    }
  }

 private:
  SegmentCall<T>& call_;
  Chain chain_;  // a copy: a reference would keep the whole kernel in memory
  ChainShape<0, kAnyShape, true> any_chain_;
  typename PlantStep<V>::Perturbed perturbed_;
  V *effort_, *inertia_, *held_, *motor_way_;  // one pack per joint
  Fraction<V>* dry_;                           // one per joint
};

// The ideal plant: every function does nothing.
template <class V, class Chain>
class LanePlant<V, Chain, PlantKind::ideal> {
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
  template <class Dynamics>
  ARMWRIGHT_INLINE void add_inertia(Dynamics& /*dynamics*/) const {}
  ARMWRIGHT_INLINE void take_motor_ways(V* /*way*/) const {}
};

}  // namespace armwright::articulated
