#include "optimizers/pagmo.hpp"

namespace armwright {

std::vector<OptimizerRow> make_pagmo_rows() {
  return {};
}

}  // namespace armwright
