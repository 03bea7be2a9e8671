// How many jobs something that works on batches should be handed at a time.
#pragma once

#include <cstddef>

namespace armwright {

struct BatchSize {
  std::size_t granularity = 1;  // a whole number of these leaves no SIMD lane idle
  std::size_t largest = 1;      // more at once gains nothing; a multiple of the granularity
};

// Into how large chunks to cut jobs that threads share out: the largest useful ones, but small
// enough that every thread gets several, so that none waits long for the last. At least 1.
std::size_t calc_chunk(BatchSize size, std::size_t jobs, std::size_t threads);

}  // namespace armwright
