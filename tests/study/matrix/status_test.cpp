// The status of cells that run on any machine, and the merging of cells from several folders.
#include <chrono>
#include <thread>

#include "base/remove_checksums.hpp"
#include "study/matrix/matrix_support.hpp"
#include "study/matrix/study_merge.hpp"
#include "study/matrix/study_status.hpp"

namespace armwright {
namespace {

using testing::HasSubstr;

class StudyStatusTest : public MatrixTest {
 protected:
  StudyStatus read() { return read_study_status(plan_, study_); }
  const CellStatus& find(const StudyStatus& status, const std::string& name) {
    for (const CellStatus& one : status.notable) {
      if (make_cell_name(plan_, one.cell) == name) {
        return one;
      }
    }
    throw std::runtime_error(name + " is nothing to be noted");
  }
};

TEST_F(StudyStatusTest, TellsWhatBecomesOfEveryCell) {
  run_in(cell("0"), place(cell("0")));
  const Attempt alive(attempts(cell("1")), study_, 0);
  alive.tell_alive(17);
  const Attempt dead(attempts(cell("2")), study_, 0);
  std::filesystem::last_write_time(
      attempts(cell("2")) / "001/alive",
      std::filesystem::file_time_type::clock::now() - std::chrono::minutes(5));
  const Attempt broken(attempts(cell("3")), study_, 0);
  broken.record_error("a wheel came off");
  broken.end_in_order();
  const Attempt ended(attempts(cell("4")), study_, 0);
  ended.end_in_order();
  std::filesystem::create_directories(place(cell("5")));
  std::ofstream(place(cell("5")) / "cell.json") << "{";

  const StudyStatus status = read();
  EXPECT_EQ(status.count(CellState::done), 1U);
  EXPECT_EQ(status.count(CellState::failed), 0U);
  EXPECT_EQ(status.count(CellState::running), 1U);
  EXPECT_EQ(status.count(CellState::silent), 1U);
  EXPECT_EQ(status.count(CellState::broken), 2U);
  EXPECT_EQ(status.count(CellState::left), 3U);
  ASSERT_EQ(status.rows.size(), 4U);
  EXPECT_EQ(status.rows[0].counts[static_cast<std::size_t>(CellState::done)], 1U);
  const CellStatus& running = find(status, "sphere/random/r01");
  EXPECT_EQ(running.attempt->cases, 17U);
  EXPECT_EQ(running.attempt->record->pid, ::getpid());
  EXPECT_GE(*find(status, "rosenbrock/ga/r01").attempt->silence_s, 290);
  EXPECT_EQ(find(status, "rosenbrock/random/r01").error, "a wheel came off");
  EXPECT_THAT(find(status, "sphere/random/r02").error, HasSubstr("cell.json"));
}

TEST_F(StudyStatusTest, SeesALocalComparison) {
  const StudyFolder held(study_, plan_);
  std::filesystem::create_directories(place(cell("2")));
  const RunLock lock{Folder(place(cell("2")))};
  const StudyStatus status = read();
  EXPECT_THAT(status.writer, HasSubstr("process "));
  EXPECT_EQ(status.count(CellState::running), 1U);
  EXPECT_THAT(find(status, "rosenbrock/ga/r01").writer, HasSubstr("process "));
}

class MergeTest : public MatrixTest {
 protected:
  std::size_t merge(const std::vector<std::filesystem::path>& others) {
    StopSignal stop;
    return import_cells(plan_, study_, others, stop);
  }
};

TEST_F(MergeTest, CopiesWhatIsFinishedElsewhereAndNothingTwice) {
  const auto other = temporary_ / "other";
  const auto third = temporary_ / "third";
  const StudyFolder made(other, plan_);
  const StudyFolder made_too(third, plan_);
  run_in(cell("0"), study_ / make_cell_path(plan_, cell("0")));
  run_in(cell("0"), other / make_cell_path(plan_, cell("0")));
  run_in(cell("1"), other / make_cell_path(plan_, cell("1")));
  run_in(cell("2"), other / make_cell_path(plan_, cell("2")));
  run_in(cell("2"), third / make_cell_path(plan_, cell("2")));
  std::filesystem::create_directories(third / make_cell_path(plan_, cell("3")));
  std::filesystem::create_directories(place(cell("2")));
  std::ofstream(place(cell("2")) / "journal") << "begun";
  EXPECT_EQ(merge({other, third}), 2U);
  for (const char* name : {"0", "1", "2"}) {
    EXPECT_TRUE(load_cell(plan_, cell(name), study_));
  }
  EXPECT_EQ(read_file(place(cell("1")) / "journal", 1 << 20),
            read_file(other / make_cell_path(plan_, cell("1")) / "journal", 1 << 20));
  EXPECT_FALSE(std::filesystem::exists(place(cell("3"))));
  EXPECT_EQ(merge({other, third}), 0U);

  const Attempt left(attempts(cell("4")), study_, 0);
  remove_spent_attempts(plan_, study_);
  EXPECT_FALSE(std::filesystem::exists(attempts(cell("1"))));
  EXPECT_TRUE(std::filesystem::exists(attempts(cell("4")) / "001"));
  std::filesystem::remove_all(attempts(cell("4")));
  std::filesystem::create_directories(attempts(cell("0")));
  remove_spent_attempts(plan_, study_);
}

TEST_F(MergeTest, RefusesByNameWhatDiffersAndCopiesNothing) {
  const auto other = temporary_ / "other";
  const StudyFolder made(other, plan_);
  run_in(cell("0"), place(cell("0")));
  run_in(cell("0"), other / make_cell_path(plan_, cell("0")));
  run_in(cell("1"), other / make_cell_path(plan_, cell("1")));
  const auto file = other / make_cell_path(plan_, cell("0")) / "cell.json";
  std::string text = read_file(file, 1 << 20);
  text.replace(text.find("\"evaluations\": 60"), 17, "\"evaluations\": 61");
  std::ofstream(file) << text;
  EXPECT_THAT(error_of(ErrorKind::bad_data, [&] { merge({other}); }),
              HasSubstr("cell.json: was changed after it was written"));
  remove_checksums(other);
  EXPECT_THAT(error_of(ErrorKind::bad_data, [&] { merge({other}); }),
              HasSubstr("sphere/ga/r01: " + place(cell("0")).string()));
  EXPECT_FALSE(std::filesystem::exists(place(cell("1"))));
}

TEST_F(MergeTest, RefusesCellsOfOtherSettings) {
  StudyPlan longer = plan_;
  longer.budget = 70;
  const auto other = temporary_ / "other";
  const StudyFolder made(other, longer);
  StopSignal stop;
  run_cell(longer, cell("1"), other, stop, observer_);
  EXPECT_THAT(error_of(ErrorKind::bad_data, [&] { merge({other}); }),
              HasSubstr("was run with other settings: run.budget: recorded 70, now 60"));
  EXPECT_THAT(usage_error_of([&] { merge({temporary_ / "nothing"}); }),
              HasSubstr("there is no folder '"));
}

}  // namespace
}  // namespace armwright
