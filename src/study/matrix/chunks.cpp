#include "study/matrix/chunks.hpp"

#include <algorithm>

namespace armwright {
namespace {

std::vector<Chunk> cut_chunks(std::span<const Cell> cells, std::span<const double> durations_s,
                              double least_s) {
  std::vector<Chunk> chunks;
  Chunk open;
  for (const Cell& cell : cells) {
    open.cells.push_back(cell);
    open.expected_s += durations_s[cell.problem];
    if (open.expected_s >= least_s) {
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
  // Of pieces that are each a `most`-th of the whole, or more, there are never more than that.
  return cut_chunks(cells, durations_s, std::max(least_s, total_s / static_cast<double>(most)));
}

}  // namespace armwright
