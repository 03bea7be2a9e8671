// One tracking simulation on numbers that carry derivatives. It runs the code that simulates
// everything else, so the derivatives are those of the engine's results, step by step. They are not
// the derivatives of the continuous motion.
//
// The file has, in this order, a lane of such numbers (NumberLane), one type of such numbers
// (Dual), and the simulation. Another type, such as ceres::Jet, works as well if it has a Carrier.
#pragma once

#include <vector>

#include "sim/dynamics/chain_model.hpp"
#include "sim/simd/lane_math.hpp"
#include "sim/tracking/simulation.hpp"

namespace armwright::lanes {

// The operations that NumberLane needs of a number type beside + - * / and construction from a
// double. To be specialised for each type:
//   static double get_value(const Number&);
//   static Number calc(double value, double slope, const Number& x);
// calc() returns f(x): its value, and as derivatives `slope` times those of x.
template <class Number>
struct Carrier;

// A lane type (lane_pack.hpp) with one lane. Where the dynamics have a kink, the derivatives are
// those of the branch that the value takes:
//   min, max, select   those of the number that is chosen; of two equal numbers, the second
//   abs                those of the side; at zero, of positive numbers
//   wrap               those of the argument: the turns that are left out are constant
//   round_to_integer   0
//   comparisons        compare the values alone; a count of them has no derivative
// The values are the same as on a lane of double.
template <class Number>
struct NumberLane {
  using Scalar = NumberLane;
  static constexpr int kLanes = 1;
  Number v;

  NumberLane() = default;
  ARMWRIGHT_INLINE NumberLane(double constant) : v(constant) {}
  ARMWRIGHT_INLINE explicit NumberLane(const Number& number) : v(number) {}
  ARMWRIGHT_INLINE double value() const { return Carrier<Number>::get_value(v); }
};

#define ARMWRIGHT_NUMBER \
  template <class N>     \
  ARMWRIGHT_INLINE
ARMWRIGHT_NUMBER NumberLane<N> operator+(const NumberLane<N>& a, const NumberLane<N>& b) {
  return NumberLane<N>(a.v + b.v);
}
ARMWRIGHT_NUMBER NumberLane<N> operator-(const NumberLane<N>& a, const NumberLane<N>& b) {
  return NumberLane<N>(a.v - b.v);
}
ARMWRIGHT_NUMBER NumberLane<N> operator*(const NumberLane<N>& a, const NumberLane<N>& b) {
  return NumberLane<N>(a.v * b.v);
}
ARMWRIGHT_NUMBER NumberLane<N> operator/(const NumberLane<N>& a, const NumberLane<N>& b) {
  return NumberLane<N>(a.v / b.v);
}
ARMWRIGHT_NUMBER NumberLane<N> operator-(const NumberLane<N>& a) {
  return NumberLane<N>(-a.v);
}
ARMWRIGHT_NUMBER NumberLane<N>& operator+=(NumberLane<N>& a, const NumberLane<N>& b) {
  return a = a + b;
}
ARMWRIGHT_NUMBER NumberLane<N>& operator-=(NumberLane<N>& a, const NumberLane<N>& b) {
  return a = a - b;
}
ARMWRIGHT_NUMBER bool operator<(const NumberLane<N>& a, const NumberLane<N>& b) {
  return a.value() < b.value();
}
ARMWRIGHT_NUMBER bool operator>(const NumberLane<N>& a, const NumberLane<N>& b) {
  return a.value() > b.value();
}
ARMWRIGHT_NUMBER NumberLane<N> select(bool mask, const NumberLane<N>& yes,
                                      const NumberLane<N>& no) {
  return mask ? yes : no;
}
ARMWRIGHT_NUMBER NumberLane<N> abs(const NumberLane<N>& a) {
  return a.value() < 0 ? -a : a;
}
ARMWRIGHT_NUMBER NumberLane<N> min(const NumberLane<N>& a, const NumberLane<N>& b) {
  return a < b ? a : b;
}
ARMWRIGHT_NUMBER NumberLane<N> max(const NumberLane<N>& a, const NumberLane<N>& b) {
  return a > b ? a : b;
}
ARMWRIGHT_NUMBER std::uint32_t find_less(const NumberLane<N>& a, const NumberLane<N>& b) {
  return a < b ? 1 : 0;
}

// The general functions of lane_math.hpp round, and rounding would lose the derivatives.
struct NoRounding {};
template <class N>
inline constexpr NoRounding kRounder<NumberLane<N>>{};

struct NumberLevel;
ARMWRIGHT_NUMBER NumberLane<N> wrap(const NumberLane<N>& x) {
  const auto wrapped = wrap(Single<double, NumberLevel>(x.value()));
  return NumberLane<N>(Carrier<N>::calc(wrapped.v, 1, x.v));
}
ARMWRIGHT_NUMBER NumberLane<N> round_to_integer(const NumberLane<N>& x) {
  return NumberLane<N>(round_to_integer(Single<double, NumberLevel>(x.value())).v);
}
ARMWRIGHT_NUMBER int to_integer(const NumberLane<N>& x) {
  return static_cast<int>(x.value());
}
ARMWRIGHT_NUMBER void calc_sine_cosine(const NumberLane<N>& x, NumberLane<N>& sine,
                                       NumberLane<N>& cosine) {
  Single<double, NumberLevel> s;
  Single<double, NumberLevel> c;
  calc_sine_cosine(Single<double, NumberLevel>(x.value()), s, c);
  sine = NumberLane<N>(Carrier<N>::calc(s.v, c.v, x.v));
  cosine = NumberLane<N>(Carrier<N>::calc(c.v, -s.v, x.v));
}
#undef ARMWRIGHT_NUMBER

// A number with its derivatives along some directions. Every operation computes them all (forward
// accumulation; Wengert 1964, A simple automatic derivative evaluation program). It is like
// ceres::Jet, but needs no library, and the derivatives lie in a pack of SIMD lanes.
//
// P: a pack of doubles, one lane per direction.
template <class P>
struct Dual {
  double value;
  P slopes;

  Dual() = default;
  ARMWRIGHT_INLINE Dual(double constant) : value(constant), slopes(0.0) {}
  ARMWRIGHT_INLINE Dual(double v, P s) : value(v), slopes(s) {}
};

#define ARMWRIGHT_DUAL \
  template <class P>   \
  ARMWRIGHT_INLINE Dual<P>
ARMWRIGHT_DUAL operator+(const Dual<P>& a, const Dual<P>& b) {
  return {a.value + b.value, a.slopes + b.slopes};
}
ARMWRIGHT_DUAL operator-(const Dual<P>& a, const Dual<P>& b) {
  return {a.value - b.value, a.slopes - b.slopes};
}
ARMWRIGHT_DUAL operator*(const Dual<P>& a, const Dual<P>& b) {
  return {a.value * b.value, P(a.value) * b.slopes + a.slopes * P(b.value)};
}
ARMWRIGHT_DUAL operator/(const Dual<P>& a, const Dual<P>& b) {
  const double inverse = 1 / b.value;
  const double quotient = a.value / b.value;
  return {quotient, (a.slopes - P(quotient) * b.slopes) * P(inverse)};
}
ARMWRIGHT_DUAL operator-(const Dual<P>& a) {
  return {-a.value, -a.slopes};
}
#undef ARMWRIGHT_DUAL

template <class P>
struct Carrier<Dual<P>> {
  ARMWRIGHT_INLINE static double get_value(const Dual<P>& number) { return number.value; }
  ARMWRIGHT_INLINE static Dual<P> calc(double value, double slope, const Dual<P>& number) {
    return {value, P(slope) * number.slopes};
  }
};

}  // namespace armwright::lanes

// The dynamics find the functions above only if those are declared first. Therefore this include is
// not at the top; if the dynamics are included earlier, nothing compiles.
#include "sim/engines/articulated/lane_kernel.hpp"
#include "sim/engines/articulated/plant_numbers.hpp"

namespace armwright::articulated {

template <class N>
inline constexpr double kFarthest<lanes::NumberLane<N>> = kFarthest<double>;

// A JointDrive on such numbers.
template <class Number>
struct NumberDrive {
  std::vector<Number> gains;  // in the order of the controller's ControllerRow::gains
  Number effort_min, effort_max;
};

// Returns the squared errors (m^2) of the job's points. They end at the first point that is cut off
// or diverges. Gains and limits are those of `drives`, one per joint, not those of the job's
// design.
template <class Number>
std::vector<Number> calc_squared_errors(const TrackingSetup& setup, const TrackingJob& job,
                                        const std::vector<NumberDrive<Number>>& drives) {
  using V = lanes::NumberLane<Number>;
  const TrackingSetup& own = job.choose_setup(setup);
  const ChainModel& chain = own.chain();
  const int n = chain.joints();
  const std::vector<V> model(chain.numbers().begin(), chain.numbers().end());
  const ControllerRow& controller = find_controller(job.design->controller);
  const ArmDrives& arm_drives = own.task().drives;
  const CommandClock clock =
      arm_drives.make_clock(own.task().control_period_s, own.task().physics.substeps);
  const int law_packs =
      calc_control_packs(n, controller.states, static_cast<int>(controller.gains.size()));
  const int control_packs = law_packs + (arm_drives.has_loops() ? calc_drive_packs(n, clock) : 0);
  std::vector<V> state(static_cast<std::size_t>(calc_state_packs(n) + control_packs), V(0));
  std::vector<V> final_state = state;
  std::vector<V> scratch(static_cast<std::size_t>(calc_scratch_packs(n)), V(0));
  V* const loops = state.data() + calc_state_packs(n) + law_packs;  // if there are any
  if (arm_drives.has_loops()) {
    set_drive_packs(own, job, clock,
                    [&](std::size_t pack, double value) { loops[pack] = V(value); });
  }
  for (int i = 0; i < n; ++i) {
    const auto set = [&](StateField field, const V& value) {
      state[static_cast<std::size_t>(field * n + i)] = value;
    };
    const NumberDrive<Number>& drive = drives[static_cast<std::size_t>(i)];
    set(kQ, V(job.targets->start_positions[static_cast<std::size_t>(i)]));
    set(kMotor, V(job.targets->start_positions[static_cast<std::size_t>(i)]));
    set(kIntegrating, V(1));
    if (arm_drives.has_loops()) {
      const EffortLimits limits =
          arm_drives.get_command_limits(own.robot().joints[static_cast<std::size_t>(i)], {});
      set(kEffortMin, V(limits.min));
      set(kEffortMax, V(limits.max));
      loops[kMotorMin * n + i] = V(drive.effort_min);
      loops[kMotorMax * n + i] = V(drive.effort_max);
    } else {
      set(kEffortMin, V(drive.effort_min));
      set(kEffortMax, V(drive.effort_max));
    }
    V* const control = state.data() + calc_state_packs(n) + i;
    V* const gains = control + controller.states * n;
    for (std::size_t gain = 0; gain < drive.gains.size(); ++gain) {
      gains[static_cast<int>(gain) * n] = V(drive.gains[gain]);
    }
    if (!job.targets->holding_effort.empty()) {
      const auto hold = controllers::find_hold<V>(controller.law, controllers::AllLaws{});
      hold(V(job.targets->holding_effort[static_cast<std::size_t>(i)]), V(drive.effort_min),
           V(drive.effort_max), {gains, n}, {control, n});
    }
  }
  const std::vector<Joint>& joints = own.robot().joints;
  std::vector<V> plant;
  std::vector<std::uint8_t> flags;  // DriveFlag bits
  std::vector<BalanceGrid> balances;
  if (own.robot().has_plant() || arm_drives.has_loops()) {
    plant.assign(static_cast<std::size_t>(calc_plant_packs(n)), V(0));
    for (int i = 0; i < n; ++i) {
      const JointPlant& its = joints[static_cast<std::size_t>(i)].plant;
      set_plant_numbers(its, [&](PlantField field, double value) {
        plant[static_cast<std::size_t>(field * n + i)] = V(value);
      });
      flags.push_back(get_drive_flags(its));
      balances.push_back(make_balance_grid(joints[static_cast<std::size_t>(i)]));
    }
  }
  V* const singles = state.data() + kStateFields * n;
  singles[kCutoffSquared] = V(job.cutoff_m * job.cutoff_m);

  std::vector<Number> squares;
  for (const Segment& segment : job.targets->segments) {
    const auto set_point = [&](int field, const Eigen::Vector3d& at_m) {
      const Eigen::Vector3d point = chain.base_pose().inverse() * at_m;
      for (int axis = 0; axis < 3; ++axis) {
        singles[field + axis] = V(point[axis]);
      }
    };
    set_point(kPointX, segment.to_m);
    const auto tool_points = job.targets->tool_points(squares.size());
    for (std::size_t k = 0; k < tool_points.size(); ++k) {
      set_point(kToolTargetX + 3 * static_cast<int>(k), tool_points[k]);
    }
    const double* const targets = job.targets->positions(segment.first_step).data();
    const double* const feed_forward = controller.feed_forward == FeedForward::none
                                           ? nullptr
                                           : job.targets->feed_forward(segment.first_step).data();
    SegmentCall<V> call;
    call.joints = n;
    call.flags = chain.flags().data();
    call.tilted_gravity = chain.tilted_gravity();
    call.prismatic = chain.prismatic();
    call.model = model.data();
    call.state = state.data();
    call.control_packs = control_packs;
    call.control = find_control<V>(controller.law, controllers::AllLaws{});
    if (arm_drives.has_loops()) {
      call.loops = loops;
      call.clock = clock;
      call.clock.substep = static_cast<long>(segment.first_step) * clock.substeps;
    }
    call.scratch = scratch.data();
    call.steps = segment.steps;
    call.window_start = segment.window_start;
    call.tool_points = static_cast<int>(tool_points.size());
    call.substeps = own.task().physics.substeps;
    call.period_s = V(own.task().control_period_s);
    call.first_step_of_case = &segment == &job.targets->segments.front();
    call.shared_targets = true;
    call.targets = &targets;
    call.feed_forward = &feed_forward;
    call.alive = 1;
    call.final_state = final_state.data();
    call.plant = plant.empty() ? nullptr : plant.data();
    set_drives(flags, arm_drives, false, call);
    call.balances = balances.data();
    // There are fewer kernels than for simulations because each takes long to compile.
    if (call.loops != nullptr) {
      SegmentKernel<V, AnyChain, PlantKind::driven>::run(call);
    } else if (call.plant != nullptr) {
      SegmentKernel<V, AnyChain, PlantKind::full>::run(call);
    } else if (is_palletiser(call)) {
      SegmentKernel<V, Palletiser>::run(call);
    } else {
      SegmentKernel<V, AnyChain>::run(call);
    }
    if (call.event[0] != LaneEvent::none) {
      break;
    }
    squares.push_back(singles[kWorstSquared].v);
  }
  return squares;
}

}  // namespace armwright::articulated
