// One quantity that a problem minimises: a term of a weighted sum, or an objective of a front.
// Optimizers for one objective minimise the weighted sum of a front.
#pragma once

#include <cstddef>

namespace armwright {

struct WeightedQuantity {
  std::size_t quantity = 0;  // its place among the quantities of the problem's kind
  double weight = 1;         // >= 0
  double scale = 1;          // > 0; the value that counts 1
};

}  // namespace armwright
