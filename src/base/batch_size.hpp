// How many jobs a batch should have.
#pragma once

#include <cstddef>

namespace armwright {

// The size that suits a worker on batches.
struct BatchSize {
  std::size_t granularity = 1;  // a multiple of it leaves no SIMD lane idle
  std::size_t largest = 1;      // larger batches are not faster; a multiple of the granularity
};

// Returns the size of the chunks into which threads divide their jobs, at least 1: the largest
// useful size, but small enough that every thread gets several chunks and does not wait long for
// the last one.
std::size_t calc_chunk(BatchSize size, std::size_t jobs, std::size_t threads);

}  // namespace armwright
