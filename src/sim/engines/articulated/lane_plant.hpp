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
  rigid,      // rotors, friction and counterbalances
  full,       // all but drives
  driven,     // all, and controllers command drives
};

// The plant of one kind. Its functions take the true positions and rates of the joints. This one
// is for the kinds `rigid`, `full` and `driven`.
template <class V, class Chain, PlantKind kKind>
class LanePlant {
  static constexpr bool kDriven = kKind == PlantKind::driven;
  static constexpr bool kFull = kKind == PlantKind::full || kDriven;

 public:
  using T = typename V::Scalar;

  ARMWRIGHT_INLINE LanePlant(SegmentCall<T>& call, const Chain& chain, V*& scratch)
      : call_(call), chain_(chain) {
    effort_.place(scratch, call.joints);
    inertia_.place(scratch, call.joints);
    rare_ = scratch;
    scratch += kRarePacks * call.joints;
    if (kFull && call.elastic) {
      for (int i = 0; i < call.joints; ++i) {
        motor_ways()[i] = V(0);
      }
    }
  }

  // show_measured() replaces the true positions in the state by those that the controllers measure;
  // show_true() restores them.
  ARMWRIGHT_INLINE void show_measured(V* /*q*/) const {
    if (kFull && call_.measures_apart) {
      show_measured(call_, rare_);
    }
  }
  ARMWRIGHT_INLINE void show_true(V* q) const {
    if (kFull && call_.measures_apart) {
      chain_.for_up([&](auto i) __attribute__((always_inline)) { q[i] = rare_[i]; });
    }
  }
  // Stores the positions that a substep ended with.
  ARMWRIGHT_INLINE void remember(const V* /*q*/) const {
    if (kFull && call_.past != nullptr) {
      remember(call_, rare_);
    }
    if constexpr (kDriven) {
      end_drives();
    }
  }

  // Lets the drives begin a substep with what the controllers command, for the kind `driven`. Call
  // it before calc_effort(), with the present equations.
  template <class Dynamics>
  ARMWRIGHT_INLINE void begin_drives(const V* commands, const Dynamics& dynamics, V substep_s) {
    const DriveLoops<V> drives = get_drives();
    for (int i = 0; i < call_.joints; ++i) {
      drives.command(i, commands[i]);
      const V rate = get_motor_rate(i);
      V own = number(kArmature, i);
      V bias = dynamics.bias(i);
      const V inertia = dynamics.mass(i, i) + own;
      if (has(kElastic, i)) {
        bias = number(kStiffness, i) * (get_state(call_, kMotor, i) - get_state(call_, kQ, i)) +
               number(kDamping, i) * (rate - get_state(call_, kRate, i));
      } else {
        own = inertia;
        if (has(kBalanced, i)) {
          bias -= calc_balance(call_.balances[i], get_state(call_, kQ, i), chain_.slides(i));
        }
      }
      V friction = V(0);
      rub(i, rate, substep_s, friction);
      const bool motor = has(kMeasuresMotor, i);
      rare_[call_.joints + i] =
          drives.begin(i, get_state(call_, motor ? kMotor : kQ, i), rate, inertia, own,
                       bias - friction, chain_.slides(i), substep_s);
    }
  }

  // Returns the efforts that act on the links during a substep, given what the controllers command.
  // Computes the inertia that joins each joint, and moves the motors of elastic joints to the end
  // of the substep.
  ARMWRIGHT_INLINE const V* calc_effort(const V* effort, const V* q, const V* rate, V substep_s) {
    const V* const applied = kDriven ? rare_ + call_.joints : effort;
    chain_.for_up([&](auto i) __attribute__((always_inline)) { effort_[i] = applied[i]; });
    if (kFull && call_.past != nullptr) {
      V* const perturbed = rare_ + call_.joints;
      chain_.for_up([&](auto i) __attribute__((always_inline)) { perturbed[i] = effort_[i]; });
      perturb(call_, rare_, substep_s);
      chain_.for_up([&](auto i) __attribute__((always_inline)) { effort_[i] = perturbed[i]; });
    }
    chain_.for_up([&](auto i) __attribute__((always_inline)) {
      if (kFull && has(kElastic, i)) {
        effort_[i] = pass_spring(i, effort_[i], q[i], rate[i], substep_s);
        inertia_[i] = V(0);
      } else {
        inertia_[i] = rub(i, rate[i], substep_s, effort_[i]);
        if constexpr (kDriven) {
          inertia_[i] += get_drives().get_inertia(i, substep_s);
        }
      }
      if (has(kBalanced, i)) {
        effort_[i] += calc_balance(call_.balances[i], q[i], chain_.slides(i));
      }
    });
    return &effort_[0];
  }
  // Adds the inertia of the motors of rigid joints, and what is implicit in friction and drives.
  template <class Dynamics>
  ARMWRIGHT_INLINE void add_inertia(Dynamics& dynamics) const {
    chain_.for_up([&](auto i)
                      __attribute__((always_inline)) { dynamics.add_inertia(i, inertia_[i]); });
  }
  // Replaces the ways of elastic joints' links in the control period by those of their motors, which
  // the controllers' efforts push.
  template <class Ways>
  ARMWRIGHT_INLINE void take_motor_ways(Ways& ways) const {
    if (kFull && call_.elastic) {
      chain_.for_up([&](auto i) __attribute__((always_inline)) {
        ways[i] = has(kElastic, i) ? motor_ways()[i] : ways[i];
        motor_ways()[i] = V(0);
      });
    }
  }
  // Adds the measures of a control period's efforts to the state, and replaces the commands by the
  // drives' last efforts.
  ARMWRIGHT_INLINE void add_measures(V* commands) const {
    const DriveLoops<V> drives = get_drives();
    const V share = T{1} / static_cast<T>(call_.substeps);
    V& energy = reinterpret_cast<V*>(call_.state)[kStateFields * call_.joints + kEnergy];
    for (int i = 0; i < call_.joints; ++i) {
      V& peak = get_state(call_, kPeakEffort, i);
      peak = max(peak, drives.get(kPeriodPeak, i));
      get_state(call_, kSquaredEffort, i) += share * drives.get(kPeriodSquares, i);
      get_state(call_, kClampedSteps, i) += share * drives.get(kPeriodClamped, i);
      energy += drives.get(kPeriodWork, i);
      commands[i] = drives.get(kMotorEffort, i);
      drives.clear_measures(i);
    }
  }

 private:
  using AnyChain = ChainShape<0, kAnyShape, true>;
  using Perturbed = LanePlant<V, AnyChain, PlantKind::perturbed>;

  ARMWRIGHT_INLINE bool has(int flags, int joint) const {
    return (call_.drives[joint] & flags) != 0;
  }
  ARMWRIGHT_INLINE V number(PlantField field, int joint) const {
    return reinterpret_cast<const V*>(call_.plant)[field * chain_.joints() + joint];
  }
  ARMWRIGHT_INLINE static V& get_state(const SegmentCall<T>& call, StateField field, int joint) {
    return reinterpret_cast<V*>(call.state)[field * call.joints + joint];
  }

  // Moves the motor by a substep and returns the spring's effort at its start.
  ARMWRIGHT_INLINE V pass_spring(int i, V effort, V q, V link_rate, V substep_s) const {
    V& place = get_state(call_, kMotor, i);
    V& rate = get_state(call_, kMotorRate, i);
    const V spring = number(kStiffness, i) * (place - q) + number(kDamping, i) * (rate - link_rate);
    effort -= spring;
    V inertia = rub(i, rate, substep_s, effort);
    if constexpr (kDriven) {
      inertia += get_drives().get_inertia(i, substep_s);
    }
    rate += substep_s * (effort / inertia);
    const V way = substep_s * rate;
    place += way;
    motor_ways()[i] += way;
    return spring;
  }

  // Takes the friction at a rate from the effort. Returns the armature with what is implicit in the
  // friction.
  ARMWRIGHT_INLINE V rub(int i, V rate, V substep_s, V& effort) const {
    if (!has(kHasFriction, i)) {
      return number(kArmature, i);
    }
    const Fraction<V> dry = calc_friction_chord(
        FrictionNumbers<V>{number(kBreakaway, i), number(kStribeck, i),
                           number(kInverseTransition, i), number(kInverseStribeck, i)},
        rate, has(kHasStribeck, i));
    const V chord = number(kDrag, i) + dry.n / dry.d;
    effort -= number(kOffset, i) + chord * rate;
    return number(kArmature, i) + substep_s * chord;
  }

  ARMWRIGHT_INLINE DriveLoops<V> get_drives() const {
    return {reinterpret_cast<V*>(call_.loops), call_.joints, call_.clock};
  }
  ARMWRIGHT_INLINE V get_motor_rate(int i) const {
    return get_state(call_, has(kElastic, i) ? kMotorRate : kRate, i);
  }
  ARMWRIGHT_INLINE void end_drives() const {
    const DriveLoops<V> drives = get_drives();
    const V substep_s = call_.period_s / static_cast<T>(call_.substeps);
    for (int i = 0; i < call_.joints; ++i) {
      drives.end(i, get_motor_rate(i), substep_s);
    }
    ++call_.clock.substep;
  }

  // The compiler inlines none of these functions, because few plants need them. They are static: if
  // they had a pointer to this object, the compiler would keep it in memory.
  __attribute__((noinline)) static void show_measured(SegmentCall<T>& call, V* held) {
    V* const q = &get_state(call, kQ, 0);
    for (int i = 0; i < call.joints; ++i) {
      held[i] = q[i];
    }
    copy_measured(call, q);
    if (call.past != nullptr) {
      const AnyChain chain(call.joints, call.flags, call.tilted_gravity);
      V* scratch = held + 2 * call.joints;
      Perturbed(call, chain, scratch).show_measured(q);
    }
    if constexpr (kDriven) {
      const DriveLoops<V> drives(reinterpret_cast<V*>(call.loops), call.joints, call.clock);
      for (int i = 0; i < call.joints; ++i) {
        q[i] = drives.measure(i, q[i], (call.flags[i] & kPrismatic) != 0);
      }
    }
  }
  __attribute__((noinline)) static void remember(SegmentCall<T>& call, V* measured) {
    copy_measured(call, measured);
    const AnyChain chain(call.joints, call.flags, call.tilted_gravity);
    V* scratch = measured + 2 * call.joints;
    Perturbed perturbed(call, chain, scratch);
    perturbed.remember(measured);
    call.newest = perturbed.newest();
  }
  // Perturbs the efforts, the second field of the memory.
  __attribute__((noinline)) static void perturb(SegmentCall<T>& call, V* memory, V substep_s) {
    V* const rates = memory;
    V* const efforts = memory + call.joints;
    for (int i = 0; i < call.joints; ++i) {
      const bool elastic = (call.drives[i] & kElastic) != 0;
      rates[i] = get_state(call, elastic ? kMotorRate : kRate, i);
    }
    const AnyChain chain(call.joints, call.flags, call.tilted_gravity);
    V* scratch = memory + 2 * call.joints;
    Perturbed perturbed(call, chain, scratch);
    const V* const acting =
        perturbed.calc_effort(efforts, &get_state(call, kQ, 0), rates, substep_s);
    for (int i = 0; i < call.joints; ++i) {
      efforts[i] = acting[i];
    }
  }
  // Copies the positions of the measured sides.
  static void copy_measured(const SegmentCall<T>& call, V* positions) {
    for (int i = 0; i < call.joints; ++i) {
      const bool motor = (call.drives[i] & kMeasuresMotor) != 0;
      positions[i] = get_state(call, motor ? kMotor : kQ, i);
    }
  }

  // Fields of the rare memory: positions or rates, efforts, what Perturbed needs, motors' ways.
  static constexpr int kRarePacks = 4;
  ARMWRIGHT_INLINE V* motor_ways() const { return rare_ + 3 * call_.joints; }

  SegmentCall<T>& call_;
  Chain chain_;  // a copy: a reference would keep the whole kernel in memory
  PackList<V, Chain::kJoints> effort_, inertia_;
  V* rare_;
};

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
  template <class Ways>
  ARMWRIGHT_INLINE void take_motor_ways(Ways& /*ways*/) const {}
  ARMWRIGHT_INLINE int newest() const { return newest_; }

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
  template <class Ways>
  ARMWRIGHT_INLINE void take_motor_ways(Ways& /*ways*/) const {}
};

}  // namespace armwright::articulated
