// The worker process of a comparison: its messages and its main loop. study_runner.hpp has the
// parent's side.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

#include "process/parent_link.hpp"
#include "study/compare/cell.hpp"

namespace armwright {

// Kind of a worker's message. A message has this kind, one number and one text.
enum class Note : std::uint8_t {
  progress,  // number: simulated cases
  message,   // text: a message for the user
  batch,     // number: index of a problem in list_problems(); text: a batch to simulate
             // (executor/case_packets.hpp)
  done,
  broken,   // text: the error that ended the cell
  io_error  // text: the error that ends the whole study
};

// Kind of the parent's replies to a batch. Any number of `outcomes` come first, each with the
// outcomes of some pairs. The last reply is `end`, or `failure` with the reason.
enum class Answer : std::uint8_t { outcomes, end, failure };

// Runs the cells that the parent orders, one after the other, until the parent asks it to end. The
// parent names a cell by its index in `cells`. If `parent_simulates`, the worker sends its batches
// to the parent; otherwise it simulates them itself. Errors of a cell are sent to the parent.
void work_on_cells(const StudyPlan& plan, std::span<const Cell> cells,
                   const std::filesystem::path& study, ParentLink& parent, bool parent_simulates);

}  // namespace armwright
