#include "optimizers/ceres.hpp"

namespace armwright {

std::vector<OptimizerRow> make_ceres_rows() {
  return {};
}

}  // namespace armwright
