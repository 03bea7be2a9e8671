#include "engines/parts.hpp"

namespace armwright::benchmarks {

int run_part(SimdLevel level, Part part, const PartsChain& chain, int rounds) {
#if defined(__x86_64__)
  switch (level) {
    case SimdLevel::avx512:
      return run_part_avx512(part, chain, rounds);
    case SimdLevel::avx2:
      return run_part_avx2(part, chain, rounds);
    case SimdLevel::sse2:
      return run_part_sse2(part, chain, rounds);
    case SimdLevel::scalar:
      break;
  }
#else
  (void)level;
#endif
  return run_part_scalar(part, chain, rounds);
}

}  // namespace armwright::benchmarks
