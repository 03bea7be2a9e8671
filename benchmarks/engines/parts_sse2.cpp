#include "engines/parts_kernel.hpp"

#if defined(__x86_64__)
namespace armwright::benchmarks {

struct Sse2Parts;
int run_part_sse2(Part part, const PartsChain& chain, int rounds) {
  return run_part_in_lanes<lanes::Pack<double, 2, Sse2Parts>>(part, chain, rounds);
}

}  // namespace armwright::benchmarks
#endif
