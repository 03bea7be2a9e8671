// The parts of a page that show what a run kept of a winner without an arm.
#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string_view>

#include "base/expect_error.hpp"
#include "base/file.hpp"
#include "base/folder.hpp"
#include "base/folder_checksums.hpp"
#include "base/temporary_folder.hpp"
#include "report/page/run_parts.hpp"
#include "study/journal/journal.hpp"
#include "study/run/run_folder.hpp"
#include "study/run/winner_record.hpp"

namespace armwright {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using namespace std::string_view_literals;

class RunWinner : public testing::Test {
 protected:
  // Writes a file that the problem left for the winner, with its checksum.
  void keep(const std::string& name, std::string_view bytes) {
    const std::pair<std::string, std::string> file(name, bytes);
    FolderChecksums checksums(Folder::make(folder_.path(), folder_.path()));
    checksums.write({&file, 1});
    checksums.save();
  }
  void keep_file(const std::string& name, std::string_view bytes) {
    keep(kWinnerFiles + name, bytes);
  }
  // Returns the page's part, and the notes in notes_.
  json make_part() {
    RecordedRun run;
    run.folder = folder_.path();
    json page = {{"record", nullptr}, {"files", json::array()}};
    notes_.clear();
    add_winner_record(run, page, notes_);
    return page;
  }
  std::string find_type(const std::string& name, std::string_view bytes) {
    keep_file(name, bytes);
    const json page = make_part();
    for (const json& file : page["files"]) {
      if (file["name"] == name) {
        return file["type"];
      }
    }
    return "no such file";
  }

  const TemporaryFolder folder_;
  std::vector<std::string> notes_;
};

TEST_F(RunWinner, TheContentOfAnImageDecidesItsType) {
  EXPECT_EQ(find_type("a.dat", "\x89PNG\r\n\x1a\nmore"sv), "image/png");
  EXPECT_EQ(find_type("b.png", "\xff\xd8\xff\xe0more"sv), "image/jpeg");
  EXPECT_EQ(find_type("c.txt", "<svg xmlns='http://www.w3.org/2000/svg'/>"), "image/svg+xml");
  EXPECT_EQ(find_type("d.svg", "<?xml version='1.0'?>\n<svg/>"), "image/svg+xml");
  EXPECT_EQ(find_type("e.svg", "<?xml version='1.0'?>" + std::string(1000, ' ') + "<svg/>"), "");
  EXPECT_EQ(find_type("f.png", "no image"), "");
  EXPECT_EQ(find_type("g.html", "<html><script>alert(1)</script>"), "");
  EXPECT_EQ(find_type("h.png", ""), "");
}

TEST_F(RunWinner, ACsvFileIsTextAndOthersAreBase64) {
  keep_file("curve.csv", "t,x\n0,1\n");
  keep_file("note.bin", "abc");
  EXPECT_EQ(find_type("binary.csv", "t\0x"sv), "");
  const json page = make_part();
  ASSERT_THAT(page["files"], SizeIs(3));
  EXPECT_EQ(page["files"][1]["text"], "t,x\n0,1\n");
  EXPECT_EQ(page["files"][1]["type"], "text/csv");
  EXPECT_EQ(page["files"][1]["base64"], "");
  EXPECT_TRUE(page["files"][2]["text"].is_null());
  EXPECT_EQ(page["files"][2]["base64"], "YWJj");
  EXPECT_EQ(page["files"][2]["bytes"], 3);
  EXPECT_TRUE(page["record"].is_null());
  EXPECT_THAT(notes_, IsEmpty());
}

TEST_F(RunWinner, TheRecordIsShownAndOtherFilesOfTheRunAreNot) {
  keep(kWinnerRecord, "time [s],speed [rad/s]\n0,1\n1,2\n");
  keep("result.json", "{}");
  const json page = make_part();
  EXPECT_EQ(page["record"], "time [s],speed [rad/s]\n0,1\n1,2\n");
  EXPECT_THAT(page["files"], IsEmpty());
}

TEST_F(RunWinner, FilesBeyondSixteenMebibytesTogetherAreNamedAndLeftOut) {
  constexpr std::size_t kHalf_bytes = std::size_t{8} << 20;
  keep_file("a.bin", std::string(kHalf_bytes, 'a'));
  keep_file("b.bin", std::string(kHalf_bytes + 1, 'b'));
  keep_file("c.bin", std::string(kHalf_bytes, 'c'));
  const json page = make_part();
  ASSERT_THAT(page["files"], SizeIs(2));
  EXPECT_EQ(page["files"][1]["name"], "c.bin");
  EXPECT_THAT(notes_, ElementsAre("winner-files/b.bin is left out, because the winner's files have "
                                  "more than 16 MiB together."));
}

TEST_F(RunWinner, AChangedFileIsRefusedAndAMissingOneIsNamed) {
  keep_file("curve.csv", "t,x\n0,1\n");
  write_file_atomically(folder_ / kWinnerFiles / "curve.csv", "t,x\n0,2\n");
  EXPECT_THAT(error_of(ErrorKind::bad_data, [&] { make_part(); }),
              HasSubstr("curve.csv: was changed after it was written"));
  std::filesystem::remove(folder_ / kWinnerFiles / "curve.csv");
  EXPECT_THAT(make_part()["files"], IsEmpty());
  EXPECT_THAT(notes_, ElementsAre("winner-files/curve.csv is missing; the command that began the "
                                  "run makes it again."));
}

TEST_F(RunWinner, ReasonsOfFailuresAreCountedCutAndPrintable) {
  RecordedRun run;
  {
    JournalContent recorded;
    Journal journal(Folder::make(folder_.path(), folder_.path()), "journal", recorded);
    std::uint64_t index = 0;
    const auto append = [&](EvaluationStatus status, const std::string& reason) {
      EvaluationRecord record;
      record.index = index++;
      record.x = {1};
      record.cases = {CaseRole::training, "train/1", {0}};
      record.evaluation.status = status;
      record.evaluation.reason = reason;
      journal.append(record);
    };
    append(EvaluationStatus::failed, "red\x1b[31m");
    append(EvaluationStatus::failed, std::string(600, 'x'));
    append(EvaluationStatus::timed_out, "");
    append(EvaluationStatus::timed_out, "");
    append(EvaluationStatus::abandoned, "lost a race");
    append(EvaluationStatus::ok, "");
    for (int i = 0; i < 60; ++i) {
      append(EvaluationStatus::diverged, "joint " + std::to_string(i));
    }
    journal.close();
  }
  run.journal = read_journal(folder_ / "journal");
  const json reasons = make_failure_reasons(run);
  EXPECT_THAT(reasons, SizeIs(50));
  EXPECT_EQ(reasons[0], json({{"reason", to_string(EvaluationStatus::timed_out)}, {"count", 2}}));
  for (const json& one : reasons) {
    const std::string reason = one["reason"];
    EXPECT_LE(reason.size(), 500U);
    EXPECT_EQ(reason.find('\x1b'), std::string::npos);
    EXPECT_NE(reason, "lost a race");
  }
}

}  // namespace
}  // namespace armwright
