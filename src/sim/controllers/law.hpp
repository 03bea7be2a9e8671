// The parts of a control law. A law is a struct in a file of this folder and a row of
// law_table.hpp. The same code runs on one number (TrackingLoop), on packs of SIMD lanes and on
// numbers that carry derivatives. A law has these members:
//   kName, kSummary, kFormula    texts
//   kGains                       its design variables, an array of Gain
//   kInterface                   what it commands
//   kStates                      count of numbers that it keeps from step to step, all 0 at first
//   kFeedForward                 which efforts it needs in `feed_forward`
//   convert(PidStart, own)       computes start values of its gains from those of a PID
//   calc(in, gain, state)        returns the wanted command and updates its state
// A law of efforts with an integral also has this member:
//   hold(effort, gain, state)    sets the state before the first step, of which all is 0. From then on
//                                calc() returns `effort` while setpoint and measurement stay equal and
//                                `feed_forward` is `effort`. An integral whose gain is 0 stays 0.
// The command is an effort, or what a drive takes (kInterface). All commands are clamped alike:
// u = min(max, max(min, wanted)). Anti-windup: `integrating` is 0
// after a clamped step, otherwise 1, and every integral is summed as
//   integral + integrating x h x integrand.
// Lanes cannot branch on numbers: use select(), min() and max() instead.
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

// The input of a law: one joint in one control period. Positions in rad and efforts in N m for a
// revolute joint, in m and N for a prismatic one.
template <class V>
struct LawInput {
  using Value = V;
  V setpoint;     // the target at the end of the period
  V measurement;  // at the start of the period; lanes count turns, other engines do not
  V error;        // setpoint - measurement; within half a turn if the joint is revolute
  V feed_forward;
  V integrating;
  V effort_limit;  // the larger of both limits
  V period_s, frequency_hz;
  bool turns;  // the joint is revolute
  bool first;  // this is the first control period of the test case

  // Returns a difference of two positions, the short way round if the joint is revolute.
  ARMWRIGHT_INLINE V wrap_turns(V difference) const {
    using lanes::wrap;
    return turns ? wrap(difference) : difference;
  }
  ARMWRIGHT_INLINE V calc_rate(V change) const { return change * frequency_hz; }
  ARMWRIGHT_INLINE V integrate(V integral, V integrand) const {
    return integral + integrating * (integrand * period_s);
  }
};

// Returns the change of a value since the step before (0 in the first step), and stores the value
// as the previous one.
template <class In, class V = typename In::Value>
ARMWRIGHT_INLINE V update_change(const In& in, V value, V& previous) {
  if (in.first) {
    previous = value;
  }
  const V change = value - previous;
  previous = value;
  return change;
}

// Returns P e + I sum(e) h + D (e - e_prev) / h. The state is the sum and e_prev.
template <class In, class V = typename In::Value>
ARMWRIGHT_INLINE V calc_pid(const In& in, V p, V i, V d, Fields<V> state) {
  const V integral = in.integrate(state[0], in.error);
  const V rate = in.calc_rate(update_change(in, in.error, state[1]));
  state[0] = integral;
  return p * in.error + i * integral + d * rate;
}

// Returns the integral that its gain turns into this effort; 0 if the gain is 0.
template <class V>
ARMWRIGHT_INLINE V calc_integral(V effort, V gain) {
  return select(abs(gain) > V(0), effort / gain, V(0));
}

// Sets the state of a joint's controller before the first step so that it holds `effort`, as far as
// the limits and the law allow. The state of a law without hold() stays 0.
template <class Law, class V>
void hold_effort(V effort, V low, V high, Fields<V> gain, Fields<V> state) {
  if constexpr (requires { Law::hold(effort, gain, state); }) {
    Law::hold(min(high, max(low, effort)), gain, state);
  }
}

}  // namespace armwright::controllers
