// The algorithms of pagmo.
#pragma once

#include <vector>

#include "optimizers/interface/optimizer.hpp"

namespace armwright {

std::vector<OptimizerRow> make_pagmo_rows();

}  // namespace armwright
