// Determines the progress of a study's cells, for any kind of execution. All information comes from
// the study's folder, which is only read.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "study/compare/study_plan.hpp"
#include "study/matrix/attempt.hpp"

namespace armwright {

enum class CellState : std::uint8_t {
  done,
  failed,   // done, but its optimizer failed
  broken,   // an error ended its last attempt
  running,  // an attempt with a recent sign of life, or a local comparison, runs it
  silent,   // its last attempt has died, or its machine cannot be seen
  left      // not begun, or stopped in an orderly way
};
inline constexpr std::size_t kCellStates = 6;
const char* to_string(CellState state);

struct CellStatus {
  Cell cell;
  CellState state = CellState::left;
  std::optional<AttemptState> attempt;  // the newest one; only for cells that are not done
  std::string writer;                   // process of a local comparison that runs the cell
  std::string error;                    // only for cells that are broken or failed
};

// Returns the process that runs the cell, as "process 12 on HOST (slurm 12_3)"; "?" if it is unknown.
std::string describe_holder(const CellStatus& status);

struct StudyStatus {
  using Counts = std::array<std::size_t, kCellStates>;
  struct Row {
    std::size_t problem = 0;
    std::size_t optimizer = 0;
    Counts counts{};
  };
  std::string writer;  // local comparison that holds the study's lock; empty if there is none
  Counts counts{};
  std::vector<Row> rows;            // problem by problem, optimizer by optimizer
  std::vector<CellStatus> notable;  // neither done nor left, in the order of list_cells()

  std::size_t count(CellState state) const { return counts[static_cast<std::size_t>(state)]; }
};

// Reads the status of all cells. Throws Error{io}; a damaged cell.json gives CellState::broken.
StudyStatus read_study_status(const StudyPlan& plan, const std::filesystem::path& study);

}  // namespace armwright
