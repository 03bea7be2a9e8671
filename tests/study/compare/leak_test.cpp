// Who drives armwright from a program of their own makes many runs in one process: nothing may stay
// behind, neither memory nor open files nor threads.
#include <gtest/gtest.h>
#include <malloc.h>

#include <filesystem>

#include "study/compare/cell.hpp"
#include "study/compare/study_support.hpp"

namespace armwright {
namespace {

struct Held {
  std::size_t memory_bytes = 0;
  std::size_t files = 0;
  std::size_t threads = 0;
};

std::size_t count_entries(const char* folder) {
  std::size_t entries = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder)) {
    ++entries;
  }
  return entries;
}

Held measure() {
  const struct mallinfo2 heap = ::mallinfo2();
  return {heap.uordblks + heap.hblkhd, count_entries("/proc/self/fd"),
          count_entries("/proc/self/task")};
}

// All of its cells again and again. Sanitizers have an allocator of their own, and find leaks at
// the end by themselves.
TEST_F(StudyTest, AThousandRunsOfTheSmokeStudyInOneProcessLeaveNothingBehind) {
  StudyRequest request;
  request.file = "smoke";
  const StudyPlan plan = make_study_plan(request);
  const std::vector<Cell> cells = list_cells(plan);
  const auto study = temporary_ / "study";
  StopSignal stop;
  const std::size_t passes = 1000 / cells.size() + 1;
  Held before;
  for (std::size_t i = 0; i < passes * cells.size(); ++i) {
    const Cell& cell = cells[i % cells.size()];
    const auto folder = study / make_cell_path(plan, cell);
    std::filesystem::create_directories(folder);
    ASSERT_TRUE(run_cell(plan, cell, study, stop, observer_)) << i;
    std::filesystem::remove_all(folder);
    if (i + 1 == 2 * cells.size()) {  // by then every library has what it keeps for good
      before = measure();
    }
  }
  const Held after = measure();
  // The smallest piece that malloc gives takes 32 bytes: of a leak there would be 28 KiB. What
  // threads have put by for themselves differs by a few.
  EXPECT_LT(after.memory_bytes, before.memory_bytes + (std::size_t{14} << 10));
  EXPECT_EQ(after.files, before.files);
  EXPECT_EQ(after.threads, before.threads);
}

}  // namespace
}  // namespace armwright
