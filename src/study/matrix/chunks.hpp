// Groups the unfinished cells of a study into chunks, one per job of a cluster, and writes the
// script that runs them. A chunk has several cells because a batch system needs seconds to start a
// job.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "study/compare/study_plan.hpp"

namespace armwright {

// Slurm limits the index of a job array to 1000 by default (MaxArraySize).
inline constexpr std::size_t kMostChunks = 1000;

struct Chunk {
  std::vector<Cell> cells;  // consecutive cells of the list
  double expected_s = 0;
};

// Returns the duration of one cell of each problem, in one thread. The times come from a few
// simulations of the problem's start. Cells of optimizers that compute much take longer.
std::vector<double> measure_cell_durations_s(const StudyPlan& plan);

// Returns the largest memory of a process that runs cells of the plan. Does not include the memory
// of optimizers and of plugin processes (docs/clusters.md).
double estimate_cell_memory_mib(const StudyPlan& plan);

// Divides the cells into chunks with an expected time of at least `least_s` each, unless all cells
// together take less. Chunks are longer if there would be more than `most` of them.
// `durations_s` has the duration of one cell per problem.
std::vector<Chunk> plan_chunks(std::span<const Cell> cells, std::span<const double> durations_s,
                               double least_s, std::size_t most = kMostChunks);

struct CellScriptRequest {
  std::filesystem::path study;
  std::filesystem::path program;       // absolute path of armwright
  std::filesystem::path folder;        // working folder; plans may name files relative to it
  std::optional<std::string> configs;  // value of ARMWRIGHT_CONFIGS
  unsigned jobs = 1;                   // threads per cell
};

// Returns a bash script that runs the chunks. It works on its own, as the entries of a batch
// system's job array, and under GNU parallel.
std::string make_cell_script(const StudyPlan& plan, std::span<const Chunk> chunks,
                             const CellScriptRequest& request);

}  // namespace armwright
