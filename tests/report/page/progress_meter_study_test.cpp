// The progress of a study whose cells other processes run: each failure is listed once, and a cell
// that an error ended is no work left.
#include <gmock/gmock.h>

#include "report/page/progress_meter.hpp"
#include "study/journal/journal.hpp"
#include "study/matrix/matrix_support.hpp"

namespace armwright {
namespace {

using nlohmann::json;
using testing::ElementsAre;

class ProgressMeterTest : public MatrixTest {
 protected:
  // Appends evaluations that failed, with one case each, to the journal of the attempt's run.
  static void append(const Attempt& attempt, std::uint64_t first, std::uint64_t last) {
    std::filesystem::create_directories(attempt.run());
    JournalContent content;
    Journal journal(attempt.run() / "journal", content);
    for (std::uint64_t index = first; index <= last; ++index) {
      EvaluationRecord record;
      record.index = index;
      record.cases.numbers = {0};
      record.evaluation.status = EvaluationStatus::diverged;
      journal.append(record);
    }
    journal.close();
  }

  std::vector<std::string> list_failures(const json& watched) const {
    std::vector<std::string> places;
    for (const json& one : watched.at("failures")) {
      places.push_back(one.at("where").get<std::string>());
    }
    return places;
  }

  ProgressMeter meter_;
};

TEST_F(ProgressMeterTest, AResumedCellListsNoFailureAgain) {
  const Attempt other(attempts(cell("1")), study_, 0);
  const Attempt first(attempts(cell("0")), study_, 0);
  append(first, 0, 7);
  meter_.observe_study(plan_, {}, study_);
  append(other, 0, 0);
  meter_.observe_study(plan_, {}, study_);
  const Attempt second(attempts(cell("0")), study_, 0);
  std::filesystem::copy(first.run(), second.run());
  append(second, 8, 8);
  const json watched = meter_.observe_study(plan_, {}, study_);
  EXPECT_EQ(watched.at("simulations"), 10);
  EXPECT_EQ(watched.at("failed_evaluations"), 10);
  EXPECT_THAT(list_failures(watched),
              ElementsAre("sphere/ga/r01, evaluation 9", "sphere/random/r01, evaluation 1",
                          "sphere/ga/r01, evaluation 8", "sphere/ga/r01, evaluation 7",
                          "sphere/ga/r01, evaluation 6", "sphere/ga/r01, evaluation 5"));

  const Attempt third(attempts(cell("0")), study_, 0);  // it lost the journal
  append(third, 0, 2);
  const json again = meter_.observe_study(plan_, {}, study_);
  EXPECT_EQ(again.at("failed_evaluations"), 4);
  EXPECT_EQ(list_failures(again), list_failures(watched));
}

TEST_F(ProgressMeterTest, ABrokenCellIsNoWorkLeft) {
  const auto cells = list_cells(plan_);
  std::vector<Attempt> others;
  for (std::size_t i = 1; i < cells.size(); ++i) {
    others.emplace_back(attempts(cells[i]), study_, 0).record_error("a wheel came off");
  }
  const Attempt running(attempts(cells[0]), study_, 0);
  meter_.observe_study(plan_, {}, study_);
  running.tell_alive(static_cast<std::uint64_t>(plan_.budget));
  EXPECT_EQ(meter_.observe_study(plan_, {}, study_).at("left_s"), 0);
}

TEST_F(ProgressMeterTest, AJournalOfTheSameSizeIsNotReadAgain) {
  const Attempt attempt(attempts(cell("0")), study_, 0);
  append(attempt, 0, 2);
  meter_.observe_study(plan_, {}, study_);
  const auto journal = attempt.run() / "journal";
  const std::string damaged(std::filesystem::file_size(journal), 'x');
  std::ofstream(journal) << damaged;
  EXPECT_EQ(meter_.observe_study(plan_, {}, study_).at("running").at(0).at("done"), 3);
}

}  // namespace
}  // namespace armwright
