// The targets with AVX2, without FMA: src/CMakeLists.txt compiles this file for it.
// Nothing may be included here that other files share functions with.
#include "sim/kinematics/target_kernel.hpp"

#if defined(__x86_64__)

namespace armwright::targets {

struct Avx2Level;
// Two at a time: one waits too long for its own results.
using Numbers = lanes::Pair<lanes::Pack<double, 4, Avx2Level>>;

int solve_move_avx2(const ElbowUpArm& arm, const Move& move, int steps, double* angles_rad) {
  return solve_move<Numbers>(arm, move, steps, angles_rad);
}

}  // namespace armwright::targets

#endif
