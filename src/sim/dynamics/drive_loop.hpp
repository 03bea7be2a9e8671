// The inner loops of drives that take speeds or positions from their controllers, on lanes. In each
// substep of length h, the drive of a joint at the position q with the rate v computes
//   v_ref = clamp(c, -v_max, v_max)                          if it takes speeds
//   v_ref = clamp(w/4 (s - q) + s', -v_max, v_max)           if it takes positions
//   u = clamp(w m (v_ref - v) + I, u_min, u_max),   I += w^2/4 m (v_ref - v) h
// c is the command of the controller that is `delay` substeps old. w is the bandwidth, and m the
// inertia that the joint moves in its present posture while the other joints are held, with its
// rotor. So a joint that moves alone has both poles of its rate at -w / 2, wherever it is. The drive
// interpolates positions: at each new command, its setpoint s begins to move at the rate s' that
// brings it to the command within one control period. I stays as it is for one substep after a
// clamped one, and begins at the effort that holds the arm.
//
// A real drive computes many times per substep. Therefore u is that at the end of the substep:
// u = u_0 - w m (v_(n+1) - v_n), with u_0 the effort at its start. The step is implicit in this part
// (an inertia h w m that joins the joint), hence stable for any posture of a coupled arm. Whether u
// is clamped is decided before the step, as if the other joints kept their rates; u is then the
// limit. A joint that is not clamped may therefore exceed its limit by the part of u that other
// joints cause within one substep.
//
// Units: rad, rad/s and N m for a revolute joint, m, m/s and N for a prismatic one.
//
// This header is compiled for every instruction set (lane_pack.hpp), so it must not use templates
// of the standard library.
#pragma once

#include "sim/simd/lane_math.hpp"

namespace armwright::articulated {

// The numbers of one joint's drive.
enum DriveField : int {
  kBandwidth,   // w, rad/s
  kSpeedLimit,  // v_max
  kMotorMin,    // u_min
  kMotorMax,    // u_max
  kResolution,  // of the measured position; 0: it is exact
  kIntegralEffort,
  kIntegralFree,  // 1, or 0 after a clamped substep
  kSetpoint,      // s
  kSetpointRate,  // s'
  kRateBefore,    // v_n
  kMotorDamping,  // w m, or 0 in a clamped substep
  kMotorEffort,   // u_0 or the limit, and u after the substep
  // The measures of the present control period: the largest |u|, the sum of u^2, the count of
  // clamped substeps, and the positive work.
  kPeriodPeak,
  kPeriodSquares,
  kPeriodClamped,
  kPeriodWork,
  kDriveFields
};

// When commands take effect: the same for all joints and lanes.
struct CommandClock {
  int substeps = 1;        // per control period
  int delay = 0;           // in substeps
  bool positions = false;  // whether drives take positions instead of speeds
  long substep = 0;        // the present one, counted from the start of the case

  // Returns the number of control periods whose commands are kept.
  constexpr int slots() const { return (delay + substeps - 1) / substeps + 1; }
};

constexpr int calc_drive_packs(int joints, const CommandClock& clock) {
  return joints * (kDriveFields + clock.slots());
}

// The drives of an arm. Their memory has calc_drive_packs() packs, first a field per DriveField and
// then a field per kept command, and belongs to the caller. Before the first command arrives, that
// of the start acts.
template <class V>
class DriveLoops {
 public:
  using T = typename V::Scalar;

  ARMWRIGHT_INLINE DriveLoops(V* memory, int joints, const CommandClock& clock)
      : memory_(memory), joints_(joints), clock_(clock) {
    const long since = clock.substep - clock.delay;
    // The latest period whose command has arrived; negative before the first one.
    const long period = since >= 0 ? since / clock.substeps : -1 - (-since - 1) / clock.substeps;
    arrives_ = since == period * clock.substeps;
    slot_ = static_cast<int>(period % clock.slots());
    slot_ += slot_ < 0 ? clock.slots() : 0;
  }

  ARMWRIGHT_INLINE V& get(DriveField field, int joint) const {
    return memory_[field * joints_ + joint];
  }
  // Stores the command of a joint in the control period that begins with the clock's substep.
  ARMWRIGHT_INLINE void command(int joint, V value) const {
    if (clock_.substep % clock_.substeps == 0) {
      const long period = clock_.substep / clock_.substeps;
      get_command(static_cast<int>(period % clock_.slots()), joint) = value;
    }
  }

  // Returns a position as the drive measures it.
  ARMWRIGHT_INLINE V measure(int joint, V position, bool slides) const {
    const V quantum = get(kResolution, joint);
    const V turned = slides ? position : lanes::wrap(position);
    return select(quantum > V(0), lanes::round_to_integer(turned / quantum) * quantum, position);
  }

  // Begins the clock's substep. `inertia` is m, `own` what the motor moves at once: m, or the rotor
  // of an elastic joint. `bias` is the effort that lets the motor keep its rate. Returns the effort
  // to apply: u_0, or the limit if u is clamped. get_inertia() is what the step must add to `own`.
  ARMWRIGHT_INLINE V begin(int joint, V position, V rate, V inertia, V own, V bias, bool slides,
                           V substep_s) const {
    const V bandwidth = get(kBandwidth, joint);
    const V quarter = V(static_cast<T>(0.25)) * bandwidth;
    V wanted_rate = get_command(slot_, joint);
    if (clock_.positions) {
      V& setpoint = get(kSetpoint, joint);
      V& setpoint_rate = get(kSetpointRate, joint);
      if (arrives_) {
        setpoint_rate = calc_difference(wanted_rate, setpoint, slides) /
                        (substep_s * V(static_cast<T>(clock_.substeps)));
      }
      wanted_rate = quarter * calc_difference(setpoint, measure(joint, position, slides), slides) +
                    setpoint_rate;
      setpoint += substep_s * setpoint_rate;
    }
    const V fastest = get(kSpeedLimit, joint);
    const V error = min(fastest, max(V(0) - fastest, wanted_rate)) - rate;
    const V damping = bandwidth * inertia;
    V& integral = get(kIntegralEffort, joint);
    V& free = get(kIntegralFree, joint);
    integral += free * (quarter * damping * (error * substep_s));
    const V wanted = damping * error + integral;
    const V share = damping * substep_s / own;
    const V settled = (wanted + share * bias) / (V(1) + share);  // u if the other joints are steady
    const V low = get(kMotorMin, joint);
    const V high = get(kMotorMax, joint);
    free = select(settled < low, V(0), select(settled > high, V(0), V(1)));
    const V clamped = V(1) - free;
    get(kPeriodClamped, joint) += clamped;
    get(kRateBefore, joint) = rate;
    get(kMotorDamping, joint) = free * damping;
    // NaN counts as free and stays NaN.
    const V effort = select(free < V(static_cast<T>(0.5)), min(high, max(low, settled)), wanted);
    get(kMotorEffort, joint) = effort;
    return effort;
  }
  ARMWRIGHT_INLINE V get_inertia(int joint, V substep_s) const {
    return substep_s * get(kMotorDamping, joint);
  }
  // Ends the substep, in which the joint's motor came to `rate`: computes u and the measures.
  ARMWRIGHT_INLINE void end(int joint, V rate, V substep_s) const {
    V& effort = get(kMotorEffort, joint);
    effort -= get(kMotorDamping, joint) * (rate - get(kRateBefore, joint));
    get(kPeriodPeak, joint) = max(get(kPeriodPeak, joint), abs(effort));
    get(kPeriodSquares, joint) += effort * effort;
    get(kPeriodWork, joint) += max(V(0), effort * (substep_s * rate));
  }
  // Lets the measures of the next control period begin.
  ARMWRIGHT_INLINE void clear_measures(int joint) const {
    get(kPeriodPeak, joint) = V(0);
    get(kPeriodSquares, joint) = V(0);
    get(kPeriodClamped, joint) = V(0);
    get(kPeriodWork, joint) = V(0);
  }

 private:
  ARMWRIGHT_INLINE V& get_command(int slot, int joint) const {
    return memory_[(kDriveFields + slot) * joints_ + joint];
  }
  ARMWRIGHT_INLINE static V calc_difference(V to, V from, bool slides) {
    return slides ? to - from : lanes::wrap(to - from);
  }

  V* memory_;
  int joints_;
  const CommandClock& clock_;
  int slot_;      // of the command that acts in the clock's substep
  bool arrives_;  // whether it begins to act in this substep
};

}  // namespace armwright::articulated
