#include "engines/parts_kernel.hpp"

#if defined(__x86_64__)
namespace armwright::benchmarks {

struct Avx2Parts;
int run_part_avx2(Part part, const PartsChain& chain, int rounds) {
  return run_part_in_lanes<lanes::Pair<lanes::Pack<double, 4, Avx2Parts>>>(part, chain, rounds);
}

}  // namespace armwright::benchmarks
#endif
