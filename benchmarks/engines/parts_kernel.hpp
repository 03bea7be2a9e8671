// The parts for one lane type; see parts.hpp.
#pragma once

#include "engines/parts.hpp"
#include "sim/dynamics/chain_dynamics.hpp"

namespace armwright::benchmarks {

template <class V>
int run_part_in_lanes(Part part, const PartsChain& chain, int rounds) {
  using namespace articulated;
  using Shape = ChainShape<4, kPalletiser, false>;
  constexpr int kJoints = 4;
  V model[calc_model_packs(kJoints)];
  for (int i = 0; i < calc_model_packs(kJoints); ++i) {
    model[i] = V(chain.numbers[i]);
  }
  V* scratch = nullptr;  // a chain of known length needs none
  ChainDynamics<V, Shape> dynamics(Shape(chain.joints, chain.flags, chain.tilted_gravity), model,
                                   scratch);
  V q[kJoints] = {V(0.1), V(0.2), V(0.3), V(0.4)};
  V rate[kJoints] = {V(0.5), V(0.6), V(0.7), V(0.8)};
  V effort[kJoints] = {V(1), V(2), V(3), V(4)};
  V acceleration[kJoints];
  dynamics.set_posture(q, true);
  for (int round = 0; round < rounds; ++round) {
    switch (part) {
      case Part::sine_cosine:
        for (int i = 1; i < kJoints; ++i) {
          V sine, cosine;
          lanes::calc_sine_cosine(q[i], sine, cosine);
          q[i] += (sine + cosine) * V(1e-9);
        }
        break;
      case Part::dynamics:
        dynamics.calc_equations(q, rate);
        dynamics.solve(effort, acceleration);
        for (int i = 0; i < kJoints; ++i) {
          rate[i] += acceleration[i] * V(1e-9);
        }
        break;
      case Part::posture_and_tip: {
        dynamics.set_posture(q, true);
        const Vec3<V> tip = dynamics.calc_tip(q);
        for (int i = 0; i < kJoints; ++i) {
          q[i] += (tip.x + tip.y + tip.z) * V(1e-9);
        }
        break;
      }
    }
  }
  // Use the results, so that the compiler does not remove their computation.
  volatile double sink = 0;
  for (int i = 0; i < kJoints; ++i) {
    sink =
        sink + *reinterpret_cast<const double*>(&q[i]) + *reinterpret_cast<const double*>(&rate[i]);
  }
  return V::kLanes;
}

}  // namespace armwright::benchmarks
