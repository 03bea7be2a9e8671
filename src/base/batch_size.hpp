// The rule by which the threads of one process share a batch: how many jobs a chunk has. A chunk is
// the part of a batch that one thread or worker gets at once, as one call of Problem::simulate() or
// PhysicsEngine::simulate().
#pragma once

#include <cstddef>

namespace armwright {

// The sizes of chunks that are simulated fastest, in jobs.
struct BatchSize {
  std::size_t granularity = 1;  // a multiple of it leaves no SIMD lane idle
  std::size_t largest = 1;      // larger chunks are not faster; a multiple of the granularity
};

// Returns the size of the chunks into which threads divide their jobs, at least 1: the largest
// useful size, but small enough that every thread gets several chunks and does not wait long for
// the last one.
std::size_t calc_chunk(BatchSize size, std::size_t jobs, std::size_t threads);

}  // namespace armwright
