#include "engines/parts_kernel.hpp"

#if defined(__x86_64__)
namespace armwright::benchmarks {

struct Avx512Parts;
int run_part_avx512(Part part, const PartsChain& chain, int rounds) {
  return run_part_in_lanes<lanes::Pack<double, 8, Avx512Parts>>(part, chain, rounds);
}

}  // namespace armwright::benchmarks
#endif
