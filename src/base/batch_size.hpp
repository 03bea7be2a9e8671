// How many jobs something that works on batches should be handed at a time.
#pragma once

#include <cstddef>

namespace armwright {

struct BatchSize {
  std::size_t granularity = 1;  // a whole number of these leaves no SIMD lane idle
  std::size_t largest = 1;      // more at once gains nothing; a multiple of the granularity
};

}  // namespace armwright
