#include "study/matrix/study_status.hpp"

#include <fmt/format.h>

#include "base/error.hpp"
#include "study/compare/cell.hpp"
#include "study/run/run_lock.hpp"

namespace armwright {
namespace {

CellStatus read_unfinished(const StudyPlan& plan, const Cell& cell,
                           const std::filesystem::path& study, bool is_study_held) {
  CellStatus status;
  status.cell = cell;
  if (is_study_held) {
    status.writer = find_writer(study / make_cell_path(plan, cell));
    if (!status.writer.empty()) {
      status.state = CellState::running;
      return status;
    }
  }
  const auto attempts = make_attempts_path(plan, cell, study);
  const std::vector<int> tokens = list_tokens(attempts);
  if (tokens.empty()) {
    return status;
  }
  status.attempt = read_attempt(attempts, tokens.back());
  const AttemptState& last = *status.attempt;
  if (!last.error.empty()) {
    status.state = CellState::broken;
    status.error = last.error;
  } else if (last.silence_s) {
    status.state = *last.silence_s < kLongestSilence_s ? CellState::running : CellState::silent;
  }
  return status;
}

CellStatus read_cell_status(const StudyPlan& plan, const Cell& cell,
                            const std::filesystem::path& study, bool is_study_held) {
  CellStatus status;
  status.cell = cell;
  try {
    const auto outcome = load_cell(plan, cell, study);
    if (!outcome) {
      return read_unfinished(plan, cell, study, is_study_held);
    }
    status.state = outcome->failure.empty() ? CellState::done : CellState::failed;
    status.error = outcome->failure;
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::bad_data) {
      throw;
    }
    status.state = CellState::broken;
    status.error = error.what();
  }
  return status;
}

}  // namespace

const char* to_string(CellState state) {
  constexpr const char* kNames[] = {"done", "failed", "broken", "running", "silent", "left"};
  static_assert(std::size(kNames) == kCellStates);
  return kNames[static_cast<std::size_t>(state)];
}

std::string describe_holder(const CellStatus& status) {
  if (!status.writer.empty()) {
    return status.writer;
  }
  if (!status.attempt || !status.attempt->record) {
    return "?";
  }
  const AttemptRecord& record = *status.attempt->record;
  return fmt::format("process {} on {}{}", record.pid, record.host,
                     record.job.empty() ? "" : " (" + record.job + ")");
}

StudyStatus read_study_status(const StudyPlan& plan, const std::filesystem::path& study) {
  StudyStatus status;
  status.writer = find_writer(study);
  for (std::size_t problem = 0; problem < plan.problems.size(); ++problem) {
    for (std::size_t optimizer = 0; optimizer < plan.optimizers.size(); ++optimizer) {
      status.rows.push_back({problem, optimizer, {}});
    }
  }
  for (const Cell& cell : list_cells(plan)) {
    CellStatus one = read_cell_status(plan, cell, study, !status.writer.empty());
    const auto state = static_cast<std::size_t>(one.state);
    ++status.counts[state];
    ++status.rows[cell.problem * plan.optimizers.size() + cell.optimizer].counts[state];
    if (one.state != CellState::done && one.state != CellState::left) {
      status.notable.push_back(std::move(one));
    }
  }
  return status;
}

}  // namespace armwright
