// Fuzzy laws: a table of rules says what to do for a large or small error and rate.
//   x1 = clamp(e / E, -1, 1),  x2 = clamp(e' / R, -1, 1),  e' = (e - e_prev) / h,
//   y = sum over k, l of mu_k(x1) mu_l(x2) w_kl,  mu_k(x) = max(0, 1 - 2 |x - c_k|),
// with the five triangular sets nb, ns, ze, ps, pb (negative big ... positive big) at c = -1, -0.5, 0, 0.5, 1.
// This is zero-order inference of Takagi and Sugeno 1985 (Fuzzy identification of systems): y is the
// mean of the rules' numbers w_kl, weighed by how far each rule holds. Tables are odd, w_{-k,-l} = -w_kl, so 12
// weights decide and y(0, 0) = 0.
//   fuzzy            u = L y
//   fuzzy_reference  a PID of the error e + S y: the table moves the setpoint, as in
//                    Abdessemed and Benmahammed 2001 (A two-layer robot controller design using
//                    evolutionary algorithms). Their sets and rules are not public; these are ours.
// A table w_kl = alpha c_k + beta c_l gives y = alpha x1 + beta x2 exactly. So a PID becomes `fuzzy`
// with its P and D as they are, up to an effort of 2 L from each of them, and without its I. It becomes
// `fuzzy_reference` with weights of 0, which is the PID. A span of 0 counts as 1e-30.
#pragma once

#include "sim/controllers/law.hpp"

namespace armwright::controllers {

// The table and its inference. Gains: spans E and R, then the weights in the order of kWeights.
struct FuzzyTable {
  static constexpr double kRange = 2;  // how far from its start a weight may go
  static constexpr int kWeightCount = 12;
  static constexpr int kCount = 2 + kWeightCount;
  static constexpr Gain kErrorSpan = {"span_error", "span_error_rad", "rad"};
  static constexpr Gain kRateSpan = {"span_rate", "span_rate_rad_per_s", "rad/s"};
  // Named w_ERROR_RATE. The other half has the opposite signs.
  static constexpr Gain kWeights[kWeightCount] = {
      {"w_ze_ps", "w_ze_ps", "1", kRange, true}, {"w_ze_pb", "w_ze_pb", "1", kRange, true},
      {"w_ps_nb", "w_ps_nb", "1", kRange, true}, {"w_ps_ns", "w_ps_ns", "1", kRange, true},
      {"w_ps_ze", "w_ps_ze", "1", kRange, true}, {"w_ps_ps", "w_ps_ps", "1", kRange, true},
      {"w_ps_pb", "w_ps_pb", "1", kRange, true}, {"w_pb_nb", "w_pb_nb", "1", kRange, true},
      {"w_pb_ns", "w_pb_ns", "1", kRange, true}, {"w_pb_ze", "w_pb_ze", "1", kRange, true},
      {"w_pb_ps", "w_pb_ps", "1", kRange, true}, {"w_pb_pb", "w_pb_pb", "1", kRange, true}};

  // How far the five sets hold.
  template <class V>
  struct Sets {
    V nb, ns, ze, ps, pb;
  };

  // Returns the sets of clamp(value / span, -1, 1). At x = 0, where all have a kink, numbers that
  // carry derivatives take the branch of x > 0. NaN stays NaN: min and max return their second argument
  // if they cannot compare.
  template <class V>
  ARMWRIGHT_INLINE static Sets<V> calc_sets(V value, V span) {
    using T = typename V::Scalar;
    const V zero(0), one(1), tiny(static_cast<T>(1e-30));
    const V twice = (value + value) / max(tiny, span);
    const V above = min(V(2), max(zero, twice));
    const V below = min(V(2), max(zero - twice, zero));
    Sets<V> sets;
    sets.pb = max(zero, above - one);
    sets.ps = min(one, above) - sets.pb;
    sets.nb = max(zero, below - one);
    sets.ns = min(one, below) - sets.nb;
    sets.ze = one - min(one, above) - min(one, below);
    return sets;
  }

  // Returns y. `gain` begins at the error's span.
  template <class V>
  ARMWRIGHT_INLINE static V calc(V error, V rate, Fields<V> gain) {
    const Sets<V> e = calc_sets(error, gain[0]);
    const Sets<V> r = calc_sets(rate, gain[1]);
    const Fields<V> w = {&gain[2], gain.stride};
    const V columns[] = {r.nb, r.ns, r.ze, r.ps, r.pb};
    V y = e.ze * (w[0] * (r.ps - r.ns) + w[1] * (r.pb - r.nb));
    for (int l = 0; l < 5; ++l) {
      y += w[2 + l] * (e.ps * columns[l] - e.ns * columns[4 - l]) +
           w[7 + l] * (e.pb * columns[l] - e.nb * columns[4 - l]);
    }
    return y;
  }

  // Writes the weights alpha c_k + beta c_l.
  static void set_linear(double alpha, double beta, double* weights) {
    constexpr double kCentres[] = {-1, -0.5, 0, 0.5, 1};
    weights[0] = beta * kCentres[3];
    weights[1] = beta * kCentres[4];
    for (int l = 0; l < 5; ++l) {
      weights[2 + l] = alpha * kCentres[3] + beta * kCentres[l];
      weights[7 + l] = alpha * kCentres[4] + beta * kCentres[l];
    }
  }
};

struct Fuzzy {
  static constexpr const char* kName = "fuzzy";
  static constexpr const char* kSummary =
      "a table of fuzzy rules per joint, from the error and its rate; no integral";
  static constexpr const char* kFormula =
      "u = span_effort y, y = sum_kl mu_k(e / span_error) mu_l((e - e_prev) / h / span_rate) "
      "w_k_l, "
      "k and l = nb, ns, ze, ps, pb at -1, -0.5, 0, 0.5, 1, w_-k_-l = -w_k_l";
  static constexpr Gain kGains[] = {FuzzyTable::kErrorSpan,
                                    FuzzyTable::kRateSpan,
                                    FuzzyTable::kWeights[0],
                                    FuzzyTable::kWeights[1],
                                    FuzzyTable::kWeights[2],
                                    FuzzyTable::kWeights[3],
                                    FuzzyTable::kWeights[4],
                                    FuzzyTable::kWeights[5],
                                    FuzzyTable::kWeights[6],
                                    FuzzyTable::kWeights[7],
                                    FuzzyTable::kWeights[8],
                                    FuzzyTable::kWeights[9],
                                    FuzzyTable::kWeights[10],
                                    FuzzyTable::kWeights[11],
                                    {"span_effort", "span_effort_n_m", "N m"}};
  static constexpr ControlInterface kInterface = ControlInterface::effort;
  static constexpr int kStates = 1;
  static constexpr FeedForward kFeedForward = FeedForward::none;

  static void convert(const PidStart& pid, double* own) {
    constexpr double kSteepness = 2;  // each part is exact up to twice the effort limit
    own[0] = kSteepness * pid.effort_limit / pid.p;
    own[1] = kSteepness * pid.effort_limit / pid.d;
    FuzzyTable::set_linear(kSteepness, kSteepness, own + 2);
    own[FuzzyTable::kCount] = pid.effort_limit;
  }

  template <class In, class V = typename In::Value>
  ARMWRIGHT_INLINE static V calc(const In& in, Fields<V> gain, Fields<V> state) {
    const V rate = in.calc_rate(update_change(in, in.error, state[0]));
    return gain[FuzzyTable::kCount] * FuzzyTable::calc(in.error, rate, gain);
  }
};

struct FuzzyReference {
  static constexpr const char* kName = "fuzzy_reference";
  static constexpr const char* kSummary =
      "PID whose setpoint a table of fuzzy rules moves, from the error and its rate";
  static constexpr const char* kFormula =
      "u = p f + i sum(f) h + d (f - f_prev) / h, f = e + span_shift y, y as in fuzzy";
  static constexpr Gain kGains[] = {{"p", "p_n_m_per_rad", "N m/rad"},
                                    {"i", "i_n_m_per_rad_s", "N m/(rad s)"},
                                    {"d", "d_n_m_s_per_rad", "N m s/rad"},
                                    FuzzyTable::kErrorSpan,
                                    FuzzyTable::kRateSpan,
                                    FuzzyTable::kWeights[0],
                                    FuzzyTable::kWeights[1],
                                    FuzzyTable::kWeights[2],
                                    FuzzyTable::kWeights[3],
                                    FuzzyTable::kWeights[4],
                                    FuzzyTable::kWeights[5],
                                    FuzzyTable::kWeights[6],
                                    FuzzyTable::kWeights[7],
                                    FuzzyTable::kWeights[8],
                                    FuzzyTable::kWeights[9],
                                    FuzzyTable::kWeights[10],
                                    FuzzyTable::kWeights[11],
                                    {"span_shift", "span_shift_rad", "rad"}};
  static constexpr ControlInterface kInterface = ControlInterface::effort;
  static constexpr int kStates = 3;
  static constexpr FeedForward kFeedForward = FeedForward::none;

  // The table ends where P or D would take a tenth of the effort limit, and moves the setpoint by as much as its
  // largest error.
  static void convert(const PidStart& pid, double* own) {
    constexpr double kShare = 0.1;
    own[0] = pid.p;
    own[1] = pid.i;
    own[2] = pid.d;
    own[3] = kShare * pid.effort_limit / pid.p;
    own[4] = kShare * pid.effort_limit / pid.d;
    FuzzyTable::set_linear(0, 0, own + 5);
    own[3 + FuzzyTable::kCount] = own[3];
  }

  template <class V>
  static void hold(V effort, Fields<V> gain, Fields<V> state) {
    state[0] = calc_integral(effort, gain[1]);
  }

  template <class In, class V = typename In::Value>
  ARMWRIGHT_INLINE static V calc(const In& in, Fields<V> gain, Fields<V> state) {
    const V rate = in.calc_rate(update_change(in, in.error, state[2]));
    In moved = in;
    moved.error = in.error + gain[3 + FuzzyTable::kCount] *
                                 FuzzyTable::calc(in.error, rate, Fields<V>{&gain[3], gain.stride});
    return calc_pid(moved, gain[0], gain[1], gain[2], state);
  }
};

}  // namespace armwright::controllers
