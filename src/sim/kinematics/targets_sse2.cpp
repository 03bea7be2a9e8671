// The targets with SSE2, which every x86-64 CPU supports.
#include "sim/kinematics/posture_kernel.hpp"
#include "sim/kinematics/target_kernel.hpp"

#if defined(__x86_64__)

namespace armwright::targets {

struct Sse2Level;
// Two packs at a time, because a single one waits too long for its own results.
using Numbers = lanes::Pair<lanes::Pack<double, 2, Sse2Level>>;

int solve_move_sse2(const ElbowUpArm& arm, const Move& move, int steps, double* angles_rad) {
  return solve_move<Numbers>(arm, move, steps, angles_rad);
}

void calc_positions_sse2(const Move& move, int steps, double* positions_m) {
  calc_positions<Numbers>(move, steps, positions_m);
}

}  // namespace armwright::targets

namespace armwright::postures {

unsigned solve_sse2(const Chain& chain, Block& block) {
  return solve_lanes<lanes::Pack<double, 2, targets::Sse2Level>>(chain, block);
}

}  // namespace armwright::postures

#endif
