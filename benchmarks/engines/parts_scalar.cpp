#include "engines/parts_kernel.hpp"

namespace armwright::benchmarks {

struct ScalarParts;
int run_part_scalar(Part part, const PartsChain& chain, int rounds) {
  return run_part_in_lanes<lanes::Single<double, ScalarParts>>(part, chain, rounds);
}

}  // namespace armwright::benchmarks
