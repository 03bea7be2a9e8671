// Tests that a journal reads back as written, and how torn ends and damage are told apart.
#include "study/journal/journal.hpp"

#include <sys/stat.h>

#include <cmath>
#include <thread>

#include "base/hash.hpp"
#include "study/journal_test_support.hpp"
#include "study/survey/journal_survey.hpp"

namespace armwright {
namespace {

using namespace journal_testing;
using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST(Journal, KeepsEveryFieldBitByBit) {
  const TemporaryFolder folder;
  const double infinity = std::numeric_limits<double>::infinity();
  EvaluationRecord record = make_record(3);
  record.generation = 0xfedcba9876543210;
  record.cases.set = std::string("train/\0\xff\n", 9);
  record.evaluation.failed_cases = -2147483647;
  record.x = {0.0, -0.0, infinity, -infinity, 5e-324, 0.1};
  // A quiet NaN with a payload and a sign: all bits must be kept.
  record.evaluation.case_errors = {std::bit_cast<double>(0xfff8000000c0ffee), std::nan("")};
  EvaluationRecord empty;
  empty.index = 1;
  EvaluationRecord rounded = make_record(4);
  rounded.proposed = {0.4, -3.7, 1e-300};
  EvaluationRecord differentiated = rounded;
  differentiated.index = 5;
  differentiated.with_jacobian = true;
  differentiated.evaluation.jacobian = {1, 2, 3, 4, 5, 6};
  EvaluationRecord judged = make_record(0);
  judged.cases.role = CaseRole::test;
  EvaluationRecord validated = make_record(8);
  validated.cases.role = CaseRole::validation;
  {
    JournalContent content;
    Journal journal(folder / "journal", content);
    EXPECT_TRUE(content.training.empty());
    EXPECT_EQ(content.torn_bytes, 0);
    for (const auto* const each :
         {&record, &validated, &empty, &judged, &differentiated, &rounded}) {
      journal.append(*each);
    }
    journal.append(LateRecommendations{2, {1.5, -2.5, 1e-300, 4}});
    journal.append(EndRecord{"budget", 12345678901});
    journal.close();
  }
  const JournalContent content = read_journal(folder / "journal");
  ASSERT_TRUE(content.late.has_value());
  EXPECT_EQ(content.late->count, 2u);
  EXPECT_EQ(content.late->x, (std::vector<double>{1.5, -2.5, 1e-300, 4}));
  ASSERT_EQ(content.training.size(), 4);
  expect_same(content.training[0], empty);  // sorted by index
  expect_same(content.training[1], record);
  expect_same(content.training[2], rounded);
  expect_same(content.training[3], differentiated);
  ASSERT_EQ(content.judgements.size(), 2);
  expect_same(content.judgements[0], validated);  // in the order written
  expect_same(content.judgements[1], judged);
  EXPECT_TRUE(content.ended);
  EXPECT_EQ(content.end.reason, "budget");
  EXPECT_EQ(content.end.evaluations, 12345678901);
  EXPECT_EQ(content.torn_bytes, 0);
}

TEST(Journal, KeepsEveryStatus) {
  const TemporaryFolder folder;
  const auto last = static_cast<std::uint8_t>(EvaluationStatus::abandoned);
  {
    JournalContent content;
    Journal journal(folder / "journal", content);
    for (std::uint8_t status = 0; status <= last; ++status) {
      EvaluationRecord record;
      record.index = status;
      record.evaluation.status = static_cast<EvaluationStatus>(status);
      journal.append(record);
    }
  }
  const JournalContent content = read_journal(folder / "journal");
  ASSERT_EQ(content.training.size(), last + 1U);
  for (std::uint8_t status = 0; status <= last; ++status) {
    EXPECT_EQ(content.training[status].evaluation.status, static_cast<EvaluationStatus>(status));
  }
}

// Later versions must be able to read the bytes on disk, so the test spells them out.
TEST(Journal, FileHasTheDocumentedBytes) {
  const TemporaryFolder folder;
  {
    JournalContent content;
    Journal journal(folder / "journal", content);
    EvaluationRecord record;
    record.index = 258;
    record.generation = 3;
    record.clipped = true;
    record.cases = {CaseRole::test, "ab", {4}};
    record.x = {1.0};
    record.evaluation.status = EvaluationStatus::timed_out;
    record.evaluation.failed_cases = 5;
    record.evaluation.reason = "c";
    record.evaluation.metrics = {-2.0};
    journal.append(record);
    record.proposed = {1.5};
    journal.append(record);
    record.with_jacobian = true;
    record.evaluation.jacobian = {2.0};
    journal.append(record);
    journal.append(EndRecord{"ok", 6});
  }
  const auto little = [](std::uint64_t value, int bytes) {
    std::string text;
    for (int i = 0; i < bytes; ++i) {
      text += static_cast<char>(value >> (8 * i) & 0xff);
    }
    return text;
  };
  const auto framed = [&](const std::string& payload) {
    return little(payload.size(), 4) + little(calc_crc32(payload), 4) + payload;
  };
  const std::string fields =
      std::string("\x01\x02\x03", 3) + little(5, 4) + little(258, 8) + little(3, 8) + little(2, 4) +
      "ab" + little(1, 4) + little(4, 8) +                                 // set, numbers
      little(1, 4) + little(0x3ff0000000000000, 8) + little(1, 4) + "c" +  // x, reason
      little(0, 4) + little(0, 4) + little(0, 4) +  // objectives, constraints, case errors
      little(1, 4) + little(0xc000000000000000, 8) + little(0, 4);  // metrics, residuals
  const std::string end = "\x02" + little(6, 8) + little(2, 4) + "ok";
  const std::string proposal = little(1, 4) + little(0x3ff8000000000000, 8);
  const std::string jacobian = little(1, 4) + little(0x4000000000000000, 8);
  EXPECT_EQ(read_bytes(folder / "journal"),
            "AWJRNL01" + framed("\x01" + fields) + framed("\x05" + fields + proposal) +
                framed("\x06" + fields + jacobian + proposal) + framed(end));
}

// The program of docs/reliability.md.
TEST(Journal, GrowsByTheBytesThatAreStated) {
  const TemporaryFolder folder;
  const auto ends = write_journal(folder / "journal", 3);
  for (std::uint64_t i = 0; i < 3; ++i) {
    const EvaluationRecord record = make_record(i);
    const Evaluation& evaluation = record.evaluation;
    const std::size_t numbers = record.cases.numbers.size() + record.x.size() +
                                evaluation.objectives.size() + evaluation.constraint_values.size() +
                                evaluation.case_errors.size() + evaluation.metrics.size() +
                                evaluation.residuals.size();
    EXPECT_EQ(ends[i + 1] - ends[i],
              68 + record.cases.set.size() + evaluation.reason.size() + 8 * numbers);
  }
}

TEST(Journal, GrowsAcrossReopenings) {
  const TemporaryFolder folder;
  for (std::uint64_t i = 0; i < 4; ++i) {
    JournalContent content;
    Journal journal(folder / "journal", content);
    expect_first_records(content, i);
    EXPECT_FALSE(content.ended);
    journal.append(make_record(i));
  }
  expect_first_records(read_journal(folder / "journal"), 4);
}

TEST(Journal, TakesRecordsFromManyThreads) {
  const TemporaryFolder folder;
  {
    JournalContent content;
    Journal journal(folder / "journal", content);
    std::vector<std::jthread> threads;
    for (std::uint64_t t = 0; t < 4; ++t) {
      threads.emplace_back([&journal, t] {
        for (std::uint64_t i = t; i < 2000; i += 4) {
          journal.append(make_record(i));
          if (i % 100 == t) {
            journal.flush();
          }
        }
      });
    }
  }
  expect_first_records(read_journal(folder / "journal"), 2000);
}

// A journal of several read buffers (1 MiB) and many write buffers (256 KiB), with records across
// their ends.
TEST(Journal, HoldsMoreThanItsBuffers) {
  const TemporaryFolder folder;
  EvaluationRecord large = make_record(1);
  large.evaluation.residuals.assign(300'000, 0.5);  // 2.4 MB
  {
    JournalContent content;
    Journal journal(folder / "journal", content);
    journal.append(make_record(0));
    journal.append(large);
    for (std::uint64_t i = 2; i < 8000; ++i) {
      journal.append(make_record(i));
    }
  }
  const JournalContent content = read_journal(folder / "journal");
  ASSERT_EQ(content.training.size(), 8000);
  expect_same(content.training[1], large);
  expect_same(content.training[7999], make_record(7999));
}

TEST(Journal, EveryTruncationLeavesTheWholeRecords) {
  const TemporaryFolder folder;
  const auto ends = write_journal(folder / "whole", 3);
  const std::string bytes = read_bytes(folder / "whole");
  ASSERT_EQ(bytes.size(), ends.back());
  for (std::size_t cut = 0; cut <= bytes.size(); ++cut) {
    SCOPED_TRACE("cut at byte " + std::to_string(cut));
    const auto file = folder / ("cut-" + std::to_string(cut));
    write_bytes(file, bytes.substr(0, cut));
    std::size_t whole = 0;
    while (whole + 1 < ends.size() && ends[whole + 1] <= cut) {
      ++whole;
    }
    const std::size_t good_bytes = cut < ends[0] ? 0 : ends[whole];

    const JournalContent read = read_journal(file);
    expect_first_records(read, whole);
    EXPECT_EQ(read.torn_bytes, cut - good_bytes);
    EXPECT_EQ(read_bytes(file), bytes.substr(0, cut)) << "reading changed the file";

    {
      JournalContent content;
      Journal journal(file, content);
      expect_first_records(content, whole);
      EXPECT_EQ(content.torn_bytes, cut - good_bytes);
      for (std::size_t i = whole; i < 3; ++i) {
        journal.append(make_record(i));
      }
      journal.close();
    }
    EXPECT_EQ(read_bytes(file), bytes);
    const std::filesystem::path torn = file.string() + ".torn-1";
    EXPECT_EQ(std::filesystem::exists(torn), cut != good_bytes);
    EXPECT_EQ(read_bytes(torn), bytes.substr(good_bytes, cut - good_bytes));
  }
}

TEST(Journal, TornEndsNeverOverwriteEachOther) {
  const TemporaryFolder folder;
  const auto file = folder / "journal";
  const auto ends = write_journal(file, 1);
  for (const std::string torn : {"first", "second", "third"}) {
    write_bytes(file, read_bytes(file) + torn);
    JournalContent content;
    const Journal journal(file, content);
    EXPECT_EQ(content.torn_bytes, torn.size());
    EXPECT_EQ(std::filesystem::file_size(file), ends.back());
  }
  EXPECT_EQ(read_bytes(folder / "journal.torn-1"), "first");
  EXPECT_EQ(read_bytes(folder / "journal.torn-2"), "second");
  EXPECT_EQ(read_bytes(folder / "journal.torn-3"), "third");
}

// A power cut may leave blocks of zeros where data had not reached the disk.
TEST(Journal, ZerosAtTheEndAreATornEnd) {
  const TemporaryFolder folder;
  write_journal(folder / "journal", 2);
  write_bytes(folder / "journal", read_bytes(folder / "journal") + std::string(3 << 20, '\0'));
  const JournalContent content = read_journal(folder / "journal");
  expect_first_records(content, 2);
  EXPECT_EQ(content.torn_bytes, 3U << 20);
}

TEST(Journal, EveryFlippedByteIsNoticed) {
  const TemporaryFolder folder;
  const auto ends = write_journal(folder / "whole", 3);
  const std::string bytes = read_bytes(folder / "whole");
  const auto file = folder / "journal";
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    SCOPED_TRACE("flipped byte " + std::to_string(at));
    std::string flipped = bytes;
    flipped[at] = static_cast<char>(flipped[at] ^ (1 << at % 8));
    write_bytes(file, flipped);
    if (at >= ends[2]) {  // the last record
      const JournalContent content = read_journal(file);
      expect_first_records(content, 2);
      EXPECT_EQ(content.torn_bytes, ends[3] - ends[2]);
      continue;
    }
    for (const bool writing : {false, true}) {
      const Error error = catch_error([&] {
        JournalContent content;
        if (writing) {
          const Journal journal(file, content);
        } else {
          content = read_journal(file);
        }
      });
      EXPECT_EQ(error.kind(), ErrorKind::bad_data);
      if (at < ends[0]) {
        EXPECT_THAT(error.what(), AllOf(StartsWith(file.string() + ": is not an armwright journal"),
                                        HasSubstr("AWJRNL01")));
        continue;
      }
      const std::size_t number = at < ends[1] ? 0 : 1;
      EXPECT_THAT(
          error.what(),
          AllOf(StartsWith(file.string() + ": record " + std::to_string(number + 1) + " at byte"),
                HasSubstr("at byte " + std::to_string(ends[number]) + " is damaged"),
                HasSubstr("intact one follows at byte " + std::to_string(ends[number + 1])),
                HasSubstr("The journal was left untouched")));
    }
    EXPECT_EQ(read_bytes(file), flipped) << "a damaged journal was changed";
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "journal.torn-1"));
}

// Lengths that claim up to 32 GiB (4 Gi numbers) are refused before memory is allocated.
TEST(Journal, HugeLengthsAreDamage) {
  const TemporaryFolder folder;
  const auto ends = write_journal(folder / "journal", 2);
  const std::string bytes = read_bytes(folder / "journal");
  for (const std::size_t field : {ends[0], ends[0] + 8 + 24, ends[0] + 8 + 24 + 4 + 7}) {
    std::string damaged = bytes;
    damaged.replace(field, 4, "\xff\xff\xff\xff");
    // The checksum is right, so only the length can be refused.
    const std::uint32_t checksum =
        calc_crc32(std::string_view(damaged).substr(ends[0] + 8, ends[1] - ends[0] - 8));
    damaged.replace(ends[0] + 4, 4, reinterpret_cast<const char*>(&checksum), 4);
    write_bytes(folder / "journal", damaged);
    const Error error = catch_error([&] { read_journal(folder / "journal"); });
    EXPECT_EQ(error.kind(), ErrorKind::bad_data);
    EXPECT_THAT(error.what(), HasSubstr(field == ends[0] ? "its length is impossible"
                                                         : "its content makes no sense"));
  }
}

// Every 64 bytes there is something that could be a record: its last list is as long as the rest of
// the file, and its checksum is wrong. Reading to the end from each of them would take minutes.
TEST(Journal, ThatIsMadeToBeReadForEverIsRefused) {
  const TemporaryFolder folder;
  const auto file = folder / "journal";
  write_journal(file, 1);
  std::string bytes = read_bytes(file);
  constexpr std::size_t kSize = std::size_t{8} << 20;
  const auto append = [&](std::uint32_t number) {
    bytes.append(reinterpret_cast<const char*>(&number), 4);
  };
  constexpr std::size_t kEndHead = 8 + 13;  // a frame, and the fields before an end's reason
  while (bytes.size() + 64 < kSize) {
    const auto rest = static_cast<std::uint32_t>(kSize - bytes.size() - kEndHead);
    append(rest + 13);
    append(0);
    bytes += '\x02';
    bytes.append(8, '\0');
    append(rest);
    bytes.resize(bytes.size() + 64 - kEndHead);
  }
  bytes.resize(kSize);
  write_bytes(file, bytes);
  const Error error = catch_error([&] { read_journal(file); });
  EXPECT_EQ(error.kind(), ErrorKind::bad_data);
  EXPECT_THAT(error.what(),
              AllOf(StartsWith(file.string() + ": record 2 at byte"),
                    HasSubstr("the search for intact ones was given up"), HasSubstr("--repair")));
  const JournalSurvey survey = survey_journal(file, {});
  EXPECT_EQ(survey.records, 1U);
  ASSERT_EQ(survey.damage.size(), 1U);
  EXPECT_EQ(survey.damage[0].offset + survey.damage[0].bytes, kSize);
  EXPECT_THAT(survey.damage[0].fault, HasSubstr("was given up"));
  EXPECT_TRUE(survey.is_damaged());
  EXPECT_EQ(read_bytes(file), bytes);
}

// This version never writes a record with a right checksum and bytes left over.
TEST(Journal, APayloadIsUsedUp) {
  const TemporaryFolder folder;
  const auto file = folder / "journal";
  const auto ends = write_journal(file, 2);
  std::string bytes = read_bytes(file);
  const std::string payload = bytes.substr(ends[1] + 8) + '\0';
  const auto length = static_cast<std::uint32_t>(payload.size());
  const std::uint32_t checksum = calc_crc32(payload);
  bytes.resize(ends[1]);
  bytes.append(reinterpret_cast<const char*>(&length), 4);
  bytes.append(reinterpret_cast<const char*>(&checksum), 4);
  write_bytes(file, bytes + payload);
  const JournalContent content = read_journal(file);
  expect_first_records(content, 1);
  EXPECT_EQ(content.torn_bytes, ends[2] + 1 - ends[1]);
}

TEST(Journal, RepeatedRecordsCountOnceAndContradictionsAreRefused) {
  const TemporaryFolder folder;
  const auto file = folder / "journal";
  {
    JournalContent content;
    Journal journal(file, content);
    for (const std::uint64_t index : {2, 0, 1, 0, 2}) {
      journal.append(make_record(index));
    }
  }
  expect_first_records(read_journal(file), 3);
  {
    JournalContent content;
    Journal journal(file, content);
    expect_first_records(content, 3);
    EvaluationRecord judged = make_record(1);
    judged.cases.role = CaseRole::test;
    judged.x = {9};  // another role may reuse an index
    journal.append(judged);
  }
  EXPECT_EQ(read_journal(file).judgements.size(), 1);
  {
    JournalContent content;
    Journal journal(file, content);
    EvaluationRecord other = make_record(1);
    other.evaluation.case_errors[0] += 1e-15;
    journal.append(other);
  }
  const Error error = catch_error([&] { read_journal(file); });
  EXPECT_EQ(error.kind(), ErrorKind::bad_data);
  EXPECT_THAT(error.what(), HasSubstr("evaluation 1 is recorded twice with different content"));
}

TEST(Journal, NothingFollowsTheEnd) {
  const TemporaryFolder folder;
  const auto file = folder / "journal";
  std::string alone;
  {
    write_journal(folder / "other", 1);
    alone = read_bytes(folder / "other").substr(8);
    JournalContent content;
    Journal journal(file, content);
    journal.append(EndRecord{"budget", 0});
    EXPECT_THROW(journal.append(make_record(0)), std::logic_error);
  }
  {
    JournalContent content;
    Journal journal(file, content);
    EXPECT_TRUE(content.ended);
    EXPECT_THROW(journal.append(EndRecord{"budget", 0}), std::logic_error);
  }
  write_bytes(file, read_bytes(file) + alone);
  const Error error = catch_error([&] { read_journal(file); });
  EXPECT_EQ(error.kind(), ErrorKind::bad_data);
  EXPECT_THAT(error.what(), HasSubstr("record 2 at byte 35 follows the record that ends"));
}

TEST(Journal, AContinuedRunLeavesItsEndAndLateRecommendationsBehind) {
  const TemporaryFolder folder;
  const auto file = folder / "journal";
  {
    JournalContent content;
    Journal journal(file, content);
    journal.append(make_record(0));
    journal.append(LateRecommendations{1, {1, 2}});
    journal.append(EndRecord{"budget", 1});
  }
  {
    JournalContent content;
    Journal journal(file, content);
    ASSERT_TRUE(content.ended);
    journal.append(ContinueRecord{20, 1});
    // It is in the file already.
    EXPECT_FALSE(read_journal(file).ended);
    journal.append(make_record(1));
  }
  const JournalContent continued = read_journal(file);
  EXPECT_FALSE(continued.ended);
  EXPECT_FALSE(continued.late.has_value());
  EXPECT_EQ(continued.training.size(), 2u);
  const JournalSurvey open = survey_journal(file);
  EXPECT_FALSE(open.end.has_value());
  EXPECT_TRUE(open.is_continued);
  EXPECT_FALSE(open.is_damaged());
  EXPECT_EQ(open.records, 5u);
  {
    JournalContent content;
    Journal journal(file, content);
    journal.append(LateRecommendations{1, {3, 4}});
    journal.append(EndRecord{"budget", 2});
    EXPECT_THROW(journal.append(make_record(2)), std::logic_error);
  }
  const JournalContent ended = read_journal(file);
  EXPECT_TRUE(ended.ended);
  EXPECT_EQ(ended.end.evaluations, 2u);
  EXPECT_EQ(ended.late->x, (std::vector<double>{3, 4}));
  EXPECT_EQ(survey_journal(file).end->evaluations, 2u);
}

TEST(Journal, ARecordBeyondTheLimitIsRefusedAndHarmsNothing) {
  const TemporaryFolder folder;
  const auto file = folder / "journal";
  JournalContent content;
  Journal journal(file, content);
  journal.append(make_record(0));
  EvaluationRecord large = make_record(1);
  large.evaluation.residuals.resize((64U << 20) / 8);
  const Error error = catch_error([&] { journal.append(large); });
  EXPECT_EQ(error.kind(), ErrorKind::bad_data);
  EXPECT_THAT(error.what(), AllOf(StartsWith(file.string()), HasSubstr("at most 67108864 bytes"),
                                  HasSubstr("fewer cases")));
  journal.append(make_record(1));
  journal.close();
  expect_first_records(read_journal(file), 2);
}

TEST(Journal, FilesThatCannotBeJournals) {
  const TemporaryFolder folder;
  const auto open = [](const std::filesystem::path& file) {
    return catch_error([&] {
      JournalContent content;
      const Journal journal(file, content);
    });
  };
  const auto missing = folder / "missing/journal";
  Error error = open(missing);
  EXPECT_EQ(error.kind(), ErrorKind::io);
  EXPECT_EQ(error.what(), missing.parent_path().string() +
                              ": cannot open this folder: No such file or directory");
  error = catch_error([&] { read_journal(missing); });
  EXPECT_EQ(error.kind(), ErrorKind::io);
  EXPECT_EQ(error.what(), missing.string() + ": cannot open it: No such file or directory");

  error = open(folder.path());
  EXPECT_EQ(error.kind(), ErrorKind::io);
  EXPECT_THAT(error.what(), EndsWith("cannot open it: Is a directory"));

  const auto pipe = folder / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  for (const Error& refused : {open(pipe), catch_error([&] { read_journal(pipe); })}) {
    EXPECT_EQ(refused.kind(), ErrorKind::bad_data);
    EXPECT_THAT(refused.what(), HasSubstr("pipe: is a named pipe"));
  }

  write_bytes(folder / "text", "AWJRNLxx and more");
  error = open(folder / "text");
  EXPECT_EQ(error.kind(), ErrorKind::bad_data);
  EXPECT_THAT(error.what(), HasSubstr("is not an armwright journal"));
  EXPECT_EQ(read_bytes(folder / "text"), "AWJRNLxx and more");
  write_bytes(folder / "short", "AWX");
  EXPECT_THAT(open(folder / "short").what(), HasSubstr("is not an armwright journal"));
}

TEST(Journal, AppendAfterCloseIsABug) {
  const TemporaryFolder folder;
  JournalContent content;
  Journal journal(folder / "journal", content);
  journal.close();
  EXPECT_THROW(journal.append(make_record(0)), std::logic_error);
  journal.close();  // harmless
  expect_first_records(read_journal(folder / "journal"), 0);
}

}  // namespace
}  // namespace armwright
