// What a control law is made of. A law is a struct of its own file in this folder and a row of
// laws.hpp; the same code runs on one number (TrackingLoop), on packs of SIMD lanes and on numbers
// that carry derivatives. It has
//   kName, kSummary, kFormula    texts
//   kGains                       its design variables, an array of Gain
//   kStates                      how many numbers it keeps from step to step, all 0 at first
//   kFeedForward                 which table it wants in `feed_forward`
//   convert(PidStart, own)       its own gains, made of a PID's
//   calc(in, gain, state)        the effort that it wants; updates its state
// Clamping is done for all alike: u = min(max, max(min, wanted)). Anti-windup: after a clamped step
// `integrating` is 0, otherwise 1, and every integral is summed as integral + integrating x h x
// integrand. For lanes there are no branches on numbers: select(), min() and max() instead.
#pragma once

#include "sim/controllers/law_types.hpp"
#include "sim/simd/lane_math.hpp"

namespace armwright::controllers {

template <class Law>
inline constexpr int kGainCount = static_cast<int>(sizeof(Law::kGains) / sizeof(Gain));

// The gains or states of one joint, which lie `stride` numbers apart.
template <class V>
struct Fields {
  V* first;
  int stride;
  ARMWRIGHT_INLINE V& operator[](int k) const { return first[k * stride]; }
};

// One joint in one control period. Angles in rad and efforts in N m; m and N if it slides.
template <class V>
struct LawInput {
  using Value = V;
  V setpoint;     // the target at the end of the period
  V measurement;  // at its start; lanes count turns, other engines do not
  V error;        // setpoint - measurement, wrapped to half a turn if the joint turns
  V feed_forward;
  V integrating;
  V effort_limit;  // the larger of both limits
  V period_s, frequency_hz;
  bool turns;
  bool first;  // of the test case

  // A difference of two positions, the short way round.
  ARMWRIGHT_INLINE V wrap_turns(V difference) const {
    using lanes::wrap;
    return turns ? wrap(difference) : difference;
  }
  ARMWRIGHT_INLINE V calc_rate(V change) const { return change * frequency_hz; }
  ARMWRIGHT_INLINE V integrate(V integral, V integrand) const {
    return integral + integrating * (integrand * period_s);
  }
};

// By how much a value has changed since the step before; 0 in the first.
template <class In, class V = typename In::Value>
ARMWRIGHT_INLINE V take_change(const In& in, V value, V& previous) {
  if (in.first) {
    previous = value;
  }
  const V change = value - previous;
  previous = value;
  return change;
}

// P e + I sum(e) h + D (e - e_prev) / h; the state is the sum and e_prev.
template <class In, class V = typename In::Value>
ARMWRIGHT_INLINE V calc_pid(const In& in, V p, V i, V d, Fields<V> state) {
  const V integral = in.integrate(state[0], in.error);
  const V rate = in.calc_rate(take_change(in, in.error, state[1]));
  state[0] = integral;
  return p * in.error + i * integral + d * rate;
}

}  // namespace armwright::controllers
