// One segment of the tracking timeline for a pack of lanes, with the order of steps of TrackingLoop
// (tracking_loop.hpp). In each control period, the controllers compute efforts (or commands of
// drives) from the positions at its start, the plant takes its steps with these held (semi-implicit Euler: qd += h
// qdd(q, qd); q += h qd), and the measures are taken at its end.
#pragma once

#include <type_traits>

#include "sim/dynamics/chain_dynamics.hpp"
#include "sim/engines/articulated/lane_control.hpp"
#include "sim/engines/articulated/lane_plant.hpp"

namespace armwright::articulated {

// A lane has diverged if the sum of positions (rad or m) and rates over the joints reaches this. No
// working arm comes near it. It lies within the range of the sine.
template <class T>
inline constexpr T kFarthest = T{1e6};
template <>
inline constexpr float kFarthest<float> = 1e4F;

// Simulates the segment. kIdeal: the plants have no part of LanePlant.
template <class V, class Chain, PlantKind kPlant = PlantKind::ideal>
class SegmentKernel {
 public:
  using T = typename V::Scalar;

  static void run(SegmentCall<T>& call) {
    SegmentKernel kernel(call);
    kernel.go();
  }

 private:
  ARMWRIGHT_INLINE explicit SegmentKernel(SegmentCall<T>& call)
      : call_(call),
        state_(reinterpret_cast<V*>(call.state)),
        scratch_(reinterpret_cast<V*>(call.scratch)),
        chain_(call.joints, call.flags, call.tilted_gravity),
        dynamics_(chain_, reinterpret_cast<const V*>(call.model), scratch_),
        plant_(call, chain_, scratch_) {
    effort_.place(scratch_, call.joints);
    acceleration_.place(scratch_, call.joints);
    way_.place(scratch_, call.joints);
  }

  ARMWRIGHT_INLINE int joints() const { return chain_.joints(); }
  ARMWRIGHT_INLINE V* field(StateField field) const { return state_ + field * joints(); }
  ARMWRIGHT_INLINE V* state_singles() const { return state_ + kStateFields * joints(); }
  ARMWRIGHT_INLINE V& single(StateSingle field) const { return state_singles()[field]; }
  ARMWRIGHT_INLINE void go() {
    V* const q = field(kQ);
    V* const rate = field(kRate);
    const V substep_s = call_.period_s / static_cast<T>(call_.substeps);
    const bool recording = call_.records != nullptr;
    single(kWorstSquared) = V(0);
    dynamics_.set_posture(q, false);
    for (int step = 0; step < call_.steps; ++step) {
      plant_.show_measured(q);
      control(step);
      plant_.show_true(q);
      const bool measuring = recording || step >= call_.window_start;
      for (int substep = 1; substep <= call_.substeps; ++substep) {
        dynamics_.calc_equations(q, rate);
        if constexpr (kPlant == PlantKind::driven) {
          plant_.begin_drives(&effort_[0], dynamics_, substep_s);
        }
        const V* const acting = plant_.calc_effort(&effort_[0], q, rate, substep_s);
        plant_.add_inertia(dynamics_);
        dynamics_.solve(acting, &acceleration_[0]);
        chain_.for_up([&](auto i) __attribute__((always_inline)) {
          rate[i] += substep_s * acceleration_[i];
          const V way = substep_s * rate[i];
          q[i] += way;
          way_[i] = substep == 1 ? way : way_[i] + way;
        });
        plant_.remember(q);
        dynamics_.set_posture(q, measuring && substep == call_.substeps);
      }
      if (!check(step)) {
        return;
      }
      if constexpr (kPlant == PlantKind::driven) {
        plant_.add_measures(&effort_[0]);
      } else {
        plant_.take_motor_ways(way_);
        add_measures();
      }
      if (measuring) {
        const Vec3<V> tip = dynamics_.calc_tip(q);
        if (recording) {
          record(step, tip);
        }
        if (step >= call_.window_start && !measure(step, tip)) {
          return;
        }
      }
    }
  }

  ARMWRIGHT_INLINE void control(int step) {
    if (!call_.shared_targets) {  // more streams than the CPU prefetches by itself
      const int ahead = step + kStepsAhead < call_.steps ? step + kStepsAhead : call_.steps - 1;
      for (int lane = 0; lane < V::kLanes; ++lane) {
        __builtin_prefetch(call_.targets[lane] + ahead * joints());
      }
    }
    if (call_.control != nullptr) [[unlikely]] {
      call_.control(call_, step);
      chain_.for_up([&](auto i) __attribute__((always_inline)) { effort_[i] = field(kEffort)[i]; });
      return;
    }
    const V period_s = call_.period_s;
    const V frequency_hz = T{1} / call_.period_s;
    chain_.for_up([&](auto i) __attribute__((always_inline)) {
      effort_[i] = control_joint<V, controllers::Pid>(call_, state_, joints(), i, !chain_.slides(i),
                                                      step, period_s, frequency_hz);
    });
  }

  // Takes out lanes that have diverged. Returns false if no lane is left.
  ARMWRIGHT_INLINE bool check(int step) {
    V sum = V(0);
    chain_.for_up([&](auto i) __attribute__((always_inline)) {
      sum += abs(field(kQ)[i]) + abs(field(kRate)[i]);
    });
    const std::uint32_t lost = call_.alive & ~find_less(sum, V(kFarthest<T>));
    if (lost == 0) [[likely]] {
      return true;
    }
    return retire(call_, lost, LaneEvent::diverged, step) && refresh();
  }

  ARMWRIGHT_INLINE void add_measures() {
    V energy = V(0);
    chain_.for_up([&](auto i) __attribute__((always_inline)) {
      const V effort = effort_[i];
      field(kPeakEffort)[i] = max(field(kPeakEffort)[i], abs(effort));
      field(kSquaredEffort)[i] += effort * effort;
      field(kClampedSteps)[i] += V(1) - field(kIntegrating)[i];
      energy += max(V(0), effort * way_[i]);
    });
    single(kEnergy) += energy;
  }

  // Measures the error and takes out lanes beyond their cut-off. Returns false if no lane is left.
  ARMWRIGHT_INLINE bool measure(int step, const Vec3<V>& tip) {
    const V squared = call_.tool_points == 0 ? calc_squared_distance(tip, state_singles() + kPointX)
                                             : calc_tool_error();
    single(kWorstSquared) = max(single(kWorstSquared), squared);
    const std::uint32_t beyond =
        call_.alive & find_less(single(kCutoffSquared), single(kWorstSquared));
    if (beyond == 0) [[likely]] {
      return true;
    }
    return retire(call_, beyond, LaneEvent::cut_off, step) && refresh();
  }

  ARMWRIGHT_INLINE static V calc_squared_distance(const Vec3<V>& point, const V* target) {
    const V x = point.x - target[0];
    const V y = point.y - target[1];
    const V z = point.z - target[2];
    return x * x + y * y + z * z;
  }

  // Returns the mean squared distance over the tool points.
  ARMWRIGHT_INLINE V calc_tool_error() const {
    V sum = V(0);
    for (int point = 0; point < call_.tool_points; ++point) {
      sum += calc_squared_distance(dynamics_.calc_tool_point(field(kQ), point),
                                   state_singles() + kToolTargetX + 3 * point);
    }
    return sum * V(T{1} / static_cast<T>(call_.tool_points));
  }

  ARMWRIGHT_INLINE void record(int step, const Vec3<V>& tip) {
    const int packs = calc_record_packs(joints());
    V* out = reinterpret_cast<V*>(call_.records) + static_cast<long>(step) * packs;
    for (int i = 0; i < joints(); ++i) {
      out[i] = field(kQ)[i];
      out[joints() + i] = effort_[i];
    }
    out[2 * joints()] = tip.x;
    out[2 * joints() + 1] = tip.y;
    out[2 * joints() + 2] = tip.z;
  }

  // Recomputes the posture after lanes were taken out. For the remaining lanes it is the same to
  // the last bit; a test with two hundred jobs in different batches checks this.
  ARMWRIGHT_INLINE bool refresh() {
    dynamics_.set_posture(field(kQ), true);
    return true;
  }

  // Takes lanes out: stores their present state in final_state, and sets them to rest without
  // controllers. Returns whether a lane is left. The caller ignores events of lanes that are not
  // alive. The function is static so that the kernel object need not lie in memory.
  __attribute__((noinline)) static bool retire(SegmentCall<T>& call, std::uint32_t which,
                                               LaneEvent event, int step) {
    constexpr int kLanes = V::kLanes;
    const int packs = calc_state_packs(call.joints) + call.control_packs;
    for (int lane = 0; lane < kLanes; ++lane) {
      if ((which >> lane & 1) == 0) {
        continue;
      }
      call.event[lane] = event;
      call.event_step[lane] = step;
      for (int pack = 0; pack < packs; ++pack) {
        T& number = call.state[pack * kLanes + lane];
        call.final_state[pack * kLanes + lane] = number;
        number = 0;
      }
    }
    call.alive &= ~which;
    return call.alive != 0;
  }

  static constexpr int kStepsAhead = 12;

  SegmentCall<T>& call_;
  V* state_;
  V* scratch_;
  Chain chain_;
  ChainDynamics<V, Chain> dynamics_;
  LanePlant<V, Chain, kPlant> plant_;
  PackList<V, Chain::kJoints> effort_, acceleration_, way_;
};

// Straight-line code for each known length runs 1.3 times as fast as the code for any length, which
// is the same code with loops, but takes the compiler four times as long. So of the levels of x86
// only those of today's processors have it. The address sanitizer would need half an hour for it.
#if (defined(__AVX2__) || !defined(__x86_64__)) && !defined(__SANITIZE_ADDRESS__)
inline constexpr bool kHasKnownLengths = true;
#else
inline constexpr bool kHasKnownLengths = false;
#endif
using AnyChain = ChainShape<0, kAnyShape, true>;
using Palletiser =
    std::conditional_t<kHasKnownLengths, ChainShape<4, kPalletiser, false>, AnyChain>;

template <class T>
bool is_palletiser(const SegmentCall<T>& call) {
  return call.joints == 4 && !call.prismatic && !call.tilted_gravity &&
         has_shape(call.flags, 4, kPalletiser);
}

// Runs the kernel for the shape above, or for chains of one to eight revolute joints.
template <class V>
void run_known_length(SegmentCall<typename V::Scalar>& call) {
  if (is_palletiser(call)) {
    return SegmentKernel<V, Palletiser>::run(call);
  }
  switch (call.joints) {
    case 1:
      return SegmentKernel<V, ChainShape<1, kAnyShape, false>>::run(call);
    case 2:
      return SegmentKernel<V, ChainShape<2, kAnyShape, false>>::run(call);
    case 3:
      return SegmentKernel<V, ChainShape<3, kAnyShape, false>>::run(call);
    case 4:
      return SegmentKernel<V, ChainShape<4, kAnyShape, false>>::run(call);
    case 5:
      return SegmentKernel<V, ChainShape<5, kAnyShape, false>>::run(call);
    case 6:
      return SegmentKernel<V, ChainShape<6, kAnyShape, false>>::run(call);
    case 7:
      return SegmentKernel<V, ChainShape<7, kAnyShape, false>>::run(call);
    case 8:
      return SegmentKernel<V, ChainShape<8, kAnyShape, false>>::run(call);
  }
}

// Runs ideal joints, with or without a perturbation.
template <class V>
void run_segment(SegmentCall<typename V::Scalar>& call) {
  if (call.plant != nullptr) {  // fewer kernels, because each takes long to compile
    return is_palletiser(call) ? SegmentKernel<V, Palletiser, PlantKind::perturbed>::run(call)
                               : SegmentKernel<V, AnyChain, PlantKind::perturbed>::run(call);
  }
  constexpr int kLongestKnown = 8;
  if constexpr (kHasKnownLengths) {
    if (!call.prismatic && call.joints <= kLongestKnown) {
      return run_known_length<V>(call);
    }
  }
  SegmentKernel<V, AnyChain>::run(call);
}

template <class V, PlantKind kKind>
void run_plant_kind(SegmentCall<typename V::Scalar>& call) {
  if (is_palletiser(call)) {
    return SegmentKernel<V, Palletiser, kKind>::run(call);
  }
  if constexpr (kHasKnownLengths) {
    if (!call.prismatic && call.joints == 6) {
      return SegmentKernel<V, ChainShape<6, kAnyShape, false>, kKind>::run(call);
    }
    if (!call.prismatic && call.joints == 7) {
      return SegmentKernel<V, ChainShape<7, kAnyShape, false>, kKind>::run(call);
    }
  }
  SegmentKernel<V, AnyChain, kKind>::run(call);
}

// Runs joints that have plants.
template <class V>
void run_plant(SegmentCall<typename V::Scalar>& call) {
  if (call.loops != nullptr) {  // one kernel, because each takes long to compile
    SegmentKernel<V, AnyChain, PlantKind::driven>::run(call);
  } else if (call.elastic || call.past != nullptr) {
    run_plant_kind<V, PlantKind::full>(call);
  } else {
    run_plant_kind<V, PlantKind::rigid>(call);
  }
}

}  // namespace armwright::articulated
