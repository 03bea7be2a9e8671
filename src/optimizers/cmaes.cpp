#include "optimizers/cmaes.hpp"

namespace armwright {

std::vector<OptimizerRow> make_cmaes_rows() {
  return {};
}

}  // namespace armwright
