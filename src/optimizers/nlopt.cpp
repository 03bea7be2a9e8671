#include "optimizers/nlopt.hpp"

namespace armwright {

std::vector<OptimizerRow> make_nlopt_rows() {
  return {};
}

}  // namespace armwright
