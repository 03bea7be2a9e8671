// The targets with AVX2, without FMA; src/CMakeLists.txt sets the compiler's options for this file.
// It must not include headers whose functions other files use too, because the linker could merge
// them.
#include "sim/kinematics/posture_kernel.hpp"
#include "sim/kinematics/target_kernel.hpp"

#if defined(__x86_64__)

namespace armwright::targets {

struct Avx2Level;
// Two packs at a time, because a single one waits too long for its own results.
using Numbers = lanes::Pair<lanes::Pack<double, 4, Avx2Level>>;

int solve_move_avx2(const ElbowUpArm& arm, const Move& move, int steps, double* angles_rad) {
  return solve_move<Numbers>(arm, move, steps, angles_rad);
}

void calc_positions_avx2(const Move& move, int steps, double* positions_m) {
  calc_positions<Numbers>(move, steps, positions_m);
}

}  // namespace armwright::targets

namespace armwright::postures {

unsigned solve_avx2(const Chain& chain, Block& block) {
  return solve_lanes<lanes::Pack<double, 4, targets::Avx2Level>>(chain, block);
}

}  // namespace armwright::postures

#endif
