#include "optimizers/latin_hypercube.hpp"

namespace armwright {

std::vector<OptimizerRow> make_latin_hypercube_rows() {
  return {};
}

}  // namespace armwright
