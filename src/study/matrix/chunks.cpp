#include "study/matrix/chunks.hpp"

#include <algorithm>

namespace armwright {
namespace {

std::vector<Chunk> cut_chunks(std::span<const Cell> cells, std::span<const double> durations_s,
                              double least_s, std::size_t least_cells) {
  std::vector<Chunk> chunks;
  Chunk open;
  for (const Cell& cell : cells) {
    open.cells.push_back(cell);
    open.expected_s += durations_s[cell.problem];
    if (open.expected_s >= least_s && open.cells.size() >= least_cells) {
      chunks.push_back(std::move(open));
      open = {};
    }
  }
  if (!open.cells.empty() && chunks.empty()) {
    chunks.push_back(std::move(open));
  } else if (!open.cells.empty()) {  // too short for one of its own
    Chunk& last = chunks.back();
    last.cells.insert(last.cells.end(), open.cells.begin(), open.cells.end());
    last.expected_s += open.expected_s;
  }
  return chunks;
}

}  // namespace

std::vector<Chunk> plan_chunks(std::span<const Cell> cells, std::span<const double> durations_s,
                               double least_s, std::size_t most) {
  double total_s = 0;
  for (const Cell& cell : cells) {
    total_s += durations_s[cell.problem];
  }
  // Chunks of `most`-ths of the whole can be too many only by how cells fall; cells that take no
  // time at all are counted instead.
  double enough_s = std::max(least_s, total_s / static_cast<double>(most));
  std::vector<Chunk> chunks = cut_chunks(cells, durations_s, enough_s, 1);
  if (chunks.size() > most) {
    chunks = cut_chunks(cells, durations_s, enough_s, (cells.size() + most - 1) / most);
  }
  return chunks;
}

}  // namespace armwright
