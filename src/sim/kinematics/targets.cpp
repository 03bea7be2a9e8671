#include "sim/kinematics/targets.hpp"

#include "sim/kinematics/posture_solver.hpp"
#include "sim/simd/simd_level.hpp"

namespace armwright::targets {

MoveFunctions get_move_functions(SimdLevel level) {
#if defined(__x86_64__)
  switch (level) {
    case SimdLevel::avx512:
      return {solve_move_avx512, calc_positions_avx512};
    case SimdLevel::avx2:
      return {solve_move_avx2, calc_positions_avx2};
    case SimdLevel::sse2:
      return {solve_move_sse2, calc_positions_sse2};
    case SimdLevel::scalar:
      break;
  }
#else
  (void)level;  // only `scalar` is supported
#endif
  return {solve_move_scalar, calc_positions_scalar};
}

}  // namespace armwright::targets

namespace armwright::postures {

Solve get_solve(SimdLevel level) {
#if defined(__x86_64__)
  switch (level) {
    case SimdLevel::avx512:
      return solve_avx512;
    case SimdLevel::avx2:
      return solve_avx2;
    case SimdLevel::sse2:
      return solve_sse2;
    case SimdLevel::scalar:
      break;
  }
#else
  (void)level;  // only `scalar` is supported
#endif
  return solve_scalar;
}

}  // namespace armwright::postures
