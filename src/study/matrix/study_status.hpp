// How far the cells of a study are, whoever runs them: from its folder alone, which is only read.
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
  failed,   // done, but its optimizer has failed
  broken,   // its last attempt ended with an error
  running,  // by an attempt whose sign of life is young, or by a local comparison
  silent,   // its last attempt has died, or its machine cannot be seen
  left      // not begun, or stopped in order
};
inline constexpr std::size_t kCellStates = 6;
const char* to_string(CellState state);

struct CellStatus {
  Cell cell;
  CellState state = CellState::left;
  std::optional<AttemptState> attempt;  // the newest, of a cell that is not done
  std::string writer;                   // a local comparison's process
  std::string error;                    // of one that is broken, or whose optimizer has failed
};

struct StudyStatus {
  using Counts = std::array<std::size_t, kCellStates>;
  struct Row {
    std::size_t problem = 0;
    std::size_t optimizer = 0;
    Counts counts{};
  };
  std::string writer;  // who holds the study: a local comparison
  Counts counts{};
  std::vector<Row> rows;            // problem by problem, optimizer by optimizer
  std::vector<CellStatus> notable;  // neither done nor left, in the order of list_cells()

  std::size_t count(CellState state) const { return counts[static_cast<std::size_t>(state)]; }
};

StudyStatus read_study_status(const StudyPlan& plan, const std::filesystem::path& study);

}  // namespace armwright
