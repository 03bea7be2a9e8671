// The targets with AVX-512 (F, VL, DQ, BW), without fused multiply-add; src/CMakeLists.txt sets the
// compiler's options for this file. It must not include headers whose functions other files use
// too, because the linker could merge them.
#include "sim/kinematics/posture_kernel.hpp"
#include "sim/kinematics/target_kernel.hpp"

#if defined(__x86_64__)

namespace armwright::targets {

struct Avx512Level;
using Numbers = lanes::Pack<double, 8, Avx512Level>;

int solve_move_avx512(const ElbowUpArm& arm, const Move& move, int steps, double* angles_rad) {
  return solve_move<Numbers>(arm, move, steps, angles_rad);
}

void calc_positions_avx512(const Move& move, int steps, double* positions_m) {
  calc_positions<Numbers>(move, steps, positions_m);
}

}  // namespace armwright::targets

namespace armwright::postures {

unsigned solve_avx512(const Chain& chain, Block& block) {
  return solve_lanes<targets::Numbers>(chain, block);
}

}  // namespace armwright::postures

#endif
