#include "study/survey/journal_survey.hpp"

#include <fcntl.h>
#include <unistd.h>

#include "base/file_descriptor.hpp"
#include "study/journal/journal_format.hpp"
#include "study/journal_test_support.hpp"

namespace armwright {
namespace {

using namespace journal_testing;
using testing::HasSubstr;

class JournalSurveyTest : public testing::Test {
 protected:
  // Twelve evaluations, and the record that ends the run.
  void SetUp() override {
    JournalContent content;
    Journal journal(file_, content);
    ends_ = {std::filesystem::file_size(file_)};
    for (std::size_t i = 0; i < kRecords; ++i) {
      journal.append(make_record(i));
      journal.flush();
      ends_.push_back(std::filesystem::file_size(file_));
    }
    journal.append(EndRecord{"budget", kRecords});
    journal.close();
  }

  void flip(std::size_t offset) {
    std::string bytes = read_bytes(file_);
    bytes[offset] = static_cast<char>(bytes[offset] ^ 0x20);
    write_bytes(file_, bytes);
  }
  // The second byte of a record's payload.
  std::size_t inside(std::size_t record) const { return ends_[record] + 20; }

  // Reads the repaired journal like any journal.
  JournalContent repair(JournalRepair& done) {
    const auto target = folder_ / "repaired";
    const FileDescriptor fd(::open(target.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644));
    done = repair_journal(file_, survey_journal(file_), fd.get());
    return read_journal(target);
  }

  static constexpr std::size_t kRecords = 12;
  TemporaryFolder folder_;
  std::filesystem::path file_ = folder_ / "journal";
  std::vector<std::size_t> ends_;
};

TEST_F(JournalSurveyTest, AnIntactJournalIsIntact) {
  std::uint64_t shown = 0;
  const JournalSurvey survey =
      survey_journal(file_, [&](const EvaluationRecord& record) { shown += record.index; });
  EXPECT_FALSE(survey.is_damaged());
  EXPECT_EQ(survey.records, kRecords + 1);
  EXPECT_EQ(survey.evaluations.size(), kRecords);
  EXPECT_EQ(shown, 66u);
  EXPECT_EQ(survey.counts.cases, 2 * kRecords);
  EXPECT_EQ(survey.counts.clipped, kRecords / 2);
  EXPECT_EQ(survey.counts.failed, kRecords);
  ASSERT_TRUE(survey.end);
  EXPECT_EQ(survey.end->reason, "budget");
  EXPECT_TRUE(survey.list_lost().empty());
  EXPECT_TRUE(survey.list_gaps().empty());
}

TEST_F(JournalSurveyTest, EveryDamagedStretchIsNamed) {
  flip(inside(2));
  flip(inside(3));
  flip(inside(8));
  const JournalSurvey survey = survey_journal(file_);
  ASSERT_EQ(survey.damage.size(), 2u);
  EXPECT_EQ(survey.damage[0].offset, ends_[2]);
  EXPECT_EQ(survey.damage[0].bytes, ends_[4] - ends_[2]);
  EXPECT_EQ(survey.damage[0].records_before, 2u);
  EXPECT_EQ(survey.damage[0].records_behind, 4u);
  EXPECT_EQ(survey.damage[0].fault, "its checksum is wrong");
  EXPECT_EQ(survey.damage[1].offset, ends_[8]);
  EXPECT_EQ(survey.damage[1].records_before, 6u);
  EXPECT_EQ(survey.damage[1].records_behind, 4u);  // including the end record
  EXPECT_EQ(describe(survey.list_lost()), "2 to 3, 8");
  EXPECT_TRUE(survey.is_damaged());
}

TEST_F(JournalSurveyTest, ATornEndIsNoDamage) {
  write_bytes(file_, read_bytes(file_).substr(0, ends_[9] + 30));
  const JournalSurvey survey = survey_journal(file_);
  EXPECT_FALSE(survey.is_damaged());
  EXPECT_EQ(survey.torn_offset, ends_[9]);
  EXPECT_EQ(survey.torn_bytes, 30u);
  EXPECT_EQ(survey.evaluations.size(), 9u);
  EXPECT_TRUE(survey.list_lost().empty());
}

TEST_F(JournalSurveyTest, ItCutsNowhereItCannotBeAskedAbout) {
  const std::string bytes = read_bytes(file_);
  for (std::size_t length = 0; length <= bytes.size(); ++length) {
    write_bytes(file_, bytes.substr(0, length));
    const JournalSurvey survey = survey_journal(file_);
    EXPECT_FALSE(survey.is_damaged()) << length;
    std::size_t whole = 0;
    while (whole < kRecords && ends_[whole + 1] <= length) {
      ++whole;
    }
    EXPECT_EQ(survey.evaluations.size(), whole) << length;
    EXPECT_EQ(survey.end.has_value(), length == bytes.size());
  }
}

TEST_F(JournalSurveyTest, OneFlippedByteCostsOneRecordWhereverItIs) {
  const std::string bytes = read_bytes(file_);
  for (std::size_t offset = 0; offset < bytes.size(); ++offset) {
    std::string damaged = bytes;
    damaged[offset] = static_cast<char>(damaged[offset] ^ 0x5A);
    write_bytes(file_, damaged);
    const JournalSurvey survey = survey_journal(file_);
    const bool in_magic = offset < ends_[0];
    const bool in_end = offset >= ends_[kRecords];
    ASSERT_EQ(survey.evaluations.size(), kRecords - (in_magic || in_end ? 0 : 1)) << offset;
    // A damaged last record could also be left by a kill.
    EXPECT_EQ(survey.is_damaged(), !in_end) << offset;
    JournalRepair done;
    const JournalContent repaired = repair(done);
    EXPECT_EQ(repaired.training.size(), survey.evaluations.size());
    EXPECT_EQ(done.records_kept, survey.evaluations.size());
    EXPECT_FALSE(repaired.ended);
    EXPECT_EQ(repaired.torn_bytes, 0u);
  }
}

TEST_F(JournalSurveyTest, ZeroedBlocksAreLeftOut) {
  std::string bytes = read_bytes(file_);
  std::fill(bytes.begin() + static_cast<std::ptrdiff_t>(ends_[4] + 3),
            bytes.begin() + static_cast<std::ptrdiff_t>(ends_[7] + 1), '\0');
  write_bytes(file_, bytes);
  EXPECT_EQ(describe(survey_journal(file_).list_lost()), "4 to 7");
  JournalRepair done;
  const JournalContent repaired = repair(done);
  EXPECT_EQ(repaired.training.size(), kRecords - 4);
  EXPECT_EQ(done.bytes_dropped, ends_[8] - ends_[4]);
  EXPECT_EQ(done.records_dropped, 1u);  // the end record
}

TEST_F(JournalSurveyTest, WhatContradictsItselfIsNotBelieved) {
  std::string bytes = read_bytes(file_).substr(0, ends_[kRecords]);
  EvaluationRecord other = make_record(5);
  other.evaluation.objectives = {-1};
  journal_format::encode(other, bytes);
  journal_format::encode(make_record(3), bytes);  // with equal content
  write_bytes(file_, bytes);
  const JournalSurvey survey = survey_journal(file_);
  EXPECT_EQ(survey.contradictory, std::vector<std::uint64_t>{5});
  EXPECT_EQ(survey.repeated, 1u);
  EXPECT_TRUE(survey.is_damaged());
  JournalRepair done;
  const JournalContent repaired = repair(done);
  EXPECT_EQ(repaired.training.size(), kRecords - 1);
  EXPECT_EQ(done.records_dropped, 2u);
}

TEST_F(JournalSurveyTest, RecordsBehindTheEndAreDamage) {
  std::string bytes = read_bytes(file_);
  journal_format::encode(make_record(kRecords), bytes);
  write_bytes(file_, bytes);
  EXPECT_EQ(survey_journal(file_).records_behind_end, 1u);
  EXPECT_TRUE(survey_journal(file_).is_damaged());
  JournalRepair done;
  EXPECT_EQ(repair(done).training.size(), kRecords + 1);
}

TEST_F(JournalSurveyTest, RecordsThatAreGoneWithoutATraceAreMissedByTheEnd) {
  std::string bytes = read_bytes(file_);
  bytes.erase(ends_[6], ends_[7] - ends_[6]);
  write_bytes(file_, bytes);
  const JournalSurvey survey = survey_journal(file_);
  EXPECT_TRUE(survey.damage.empty());
  EXPECT_TRUE(survey.is_damaged());
  EXPECT_EQ(describe(survey.list_lost()), "6");
}

TEST_F(JournalSurveyTest, GapsOfAnInterruptionAreNoDamage) {
  std::string bytes = read_bytes(file_).substr(0, ends_[kRecords]);
  bytes.erase(ends_[6], ends_[7] - ends_[6]);
  write_bytes(file_, bytes);
  const JournalSurvey survey = survey_journal(file_);
  EXPECT_FALSE(survey.is_damaged());
  EXPECT_EQ(describe(survey.list_gaps()), "6");
}

TEST_F(JournalSurveyTest, WhatIsNoJournalIsRefused) {
  write_bytes(file_, "name = \"something else\" and long enough to hold a record\n");
  const Error error = catch_error([&] { survey_journal(file_); });
  EXPECT_EQ(error.kind(), ErrorKind::bad_data);
  EXPECT_THAT(error.what(), HasSubstr("holds no intact record"));
  EXPECT_EQ(catch_error([&] { survey_journal(folder_ / "none"); }).kind(), ErrorKind::io);
}

TEST_F(JournalSurveyTest, LateRecommendationsOutliveARepair) {
  std::filesystem::remove(file_);
  {
    JournalContent content;
    Journal journal(file_, content);
    journal.append(make_record(0));
    journal.append(LateRecommendations{1, {1, 2}});
    journal.append(make_record(1));
    journal.close();
  }
  const JournalSurvey survey = survey_journal(file_);
  EXPECT_FALSE(survey.is_damaged());
  EXPECT_EQ(survey.records, 3u);
  EXPECT_EQ(survey.evaluations.size(), 2u);
  flip(28);  // in the first record
  JournalRepair done;
  const JournalContent repaired = repair(done);
  EXPECT_EQ(done.records_kept, 2u);
  ASSERT_TRUE(repaired.late.has_value());
  EXPECT_EQ(repaired.late->x, (std::vector<double>{1, 2}));
}

TEST_F(JournalSurveyTest, ARepairKeepsThatARunWasContinued) {
  std::filesystem::remove(file_);
  {
    JournalContent content;
    Journal journal(file_, content);
    journal.append(make_record(0));
    journal.append(LateRecommendations{1, {1, 2}});
    journal.append(EndRecord{"budget", 1});
    journal.append(ContinueRecord{20, 1});
    journal.append(make_record(1));
    journal.close();
  }
  flip(28);  // in the first record
  JournalRepair done;
  const JournalContent repaired = repair(done);
  EXPECT_EQ(done.records_kept, 3u);
  EXPECT_FALSE(repaired.late.has_value()) << "it is of the smaller budget";
  EXPECT_FALSE(repaired.ended);
}

TEST_F(JournalSurveyTest, RecordsWithAProposalOutliveARepair) {
  std::size_t damaged = 0;
  {
    std::filesystem::remove(file_);
    JournalContent content;
    Journal journal(file_, content);
    for (std::uint64_t i = 0; i < 6; ++i) {
      EvaluationRecord record = make_record(i);
      record.proposed = {0.5, 1.5, 2.5};
      record.with_jacobian = i % 2 == 1;
      if (i == 2) {
        journal.flush();
        damaged = std::filesystem::file_size(file_) + 20;
      }
      journal.append(record);
    }
    journal.close();
  }
  flip(damaged);
  JournalRepair done;
  const JournalContent content = repair(done);
  ASSERT_EQ(content.training.size(), 5u);
  EXPECT_EQ(content.training.get_index(2), 3u) << "the record behind the damage is found";
  for (const EvaluationRecord& record : content.training) {
    EXPECT_EQ(record.proposed, (std::vector<double>{0.5, 1.5, 2.5}));
    EXPECT_EQ(record.with_jacobian, record.index % 2 == 1);
  }
}

}  // namespace
}  // namespace armwright
