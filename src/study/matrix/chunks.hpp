// The unfinished cells of a study in chunks that are worth a job of a cluster's: starting one costs
// a batch system seconds.
#pragma once

#include <span>
#include <vector>

#include "study/compare/study_plan.hpp"

namespace armwright {

// Slurm's arrays end at index 1000 unless it is told otherwise (MaxArraySize).
inline constexpr std::size_t kMostChunks = 1000;

struct Chunk {
  std::vector<Cell> cells;  // consecutive ones
  double expected_s = 0;
};

// Each of at least `least_s` of expected time (if there is as much at all), longer where there
// would be more than `most` chunks otherwise. `durations_s`: of a cell of each problem.
std::vector<Chunk> plan_chunks(std::span<const Cell> cells, std::span<const double> durations_s,
                               double least_s, std::size_t most = kMostChunks);

}  // namespace armwright
