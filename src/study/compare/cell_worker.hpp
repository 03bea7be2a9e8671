// The process that a comparison runs cells in, as seen from inside: what it is told and what it
// tells (study_runner.hpp has the other side).
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

#include "process/parent_link.hpp"
#include "study/compare/cell.hpp"

namespace armwright {

// What a worker tells of its cell: this, a number, a text.
enum class Note : std::uint8_t {
  progress,  // cases
  message,   // text
  batch,     // number of a problem in list_problems(), a batch (executor/case_packets.hpp)
  done,
  broken,   // text
  io_error  // text
};

// What it is answered to a batch: outcomes of some pairs, as often as there are any, then the end,
// or why there are no more.
enum class Answer : std::uint8_t { outcomes, end, failure };

// A worker's life: one cell after the other, by their numbers in `cells`, until it is asked to end.
// It simulates by itself, or lets its parent do that.
void work_on_cells(const StudyPlan& plan, std::span<const Cell> cells,
                   const std::filesystem::path& study, ParentLink& parent, bool parent_simulates);

}  // namespace armwright
