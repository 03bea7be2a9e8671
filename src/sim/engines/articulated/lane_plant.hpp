// The perturbations of sim/tracking/plant_variation.hpp for a pack of lanes; each lane has its own
// numbers. While the controllers run, the state holds the measured positions in place of the true
// ones.
#pragma once

#include "sim/dynamics/chain_shape.hpp"
#include "sim/engines/articulated/kernels.hpp"
#include "sim/simd/lane_math.hpp"

namespace armwright::articulated {

template <class V, class Chain, bool kPerturbed>
class LanePlant;

template <class V, class Chain>
class LanePlant<V, Chain, true> {
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
  ARMWRIGHT_INLINE const V* calc_effort(const V* effort, const V* q, const V* rate) {
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

// The nominal plant: every function does nothing.
template <class V, class Chain>
class LanePlant<V, Chain, false> {
 public:
  ARMWRIGHT_INLINE LanePlant(SegmentCall<typename V::Scalar>& /*call*/, const Chain& /*chain*/,
                             V*& /*scratch*/) {}
  ARMWRIGHT_INLINE void show_measured(V* /*q*/) const {}
  ARMWRIGHT_INLINE void show_true(V* /*q*/) const {}
  ARMWRIGHT_INLINE void remember(const V* /*q*/) {}
  ARMWRIGHT_INLINE const V* calc_effort(const V* effort, const V* /*q*/, const V* /*rate*/) {
    return effort;
  }
};

}  // namespace armwright::articulated
