#include "process/output_log.hpp"

#include <gmock/gmock.h>
#include <unistd.h>

#include <fstream>
#include <sstream>

#include "base/expect_error.hpp"
#include "base/temporary_folder.hpp"

namespace armwright {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using Begin = OutputLog::Begin;

std::string read_log(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

class OutputLogTest : public testing::Test {
 protected:
  TemporaryFolder folder_;
  std::filesystem::path file_ = folder_ / "log";
};

TEST_F(OutputLogTest, WithoutAWordThereIsNoFileAndNoneOfAnEarlierRun) {
  std::ofstream(file_) << "of an earlier run";
  OutputLog log(file_, Begin::anew);
  EXPECT_FALSE(std::filesystem::exists(file_));
  EXPECT_THAT(log.last_lines(), IsEmpty());
}

TEST_F(OutputLogTest, WhatIsAddedIsThereAtOnce) {
  OutputLog log(file_, Begin::anew);
  log.add("one\n");
  EXPECT_EQ(read_log(file_), "one\n");
  log.add("two");
  EXPECT_EQ(read_log(file_), "one\ntwo");
}

TEST_F(OutputLogTest, BehindWhatIsThere) {
  std::ofstream(file_) << "before;";
  { OutputLog(file_, Begin::behind_what_is_there).add("after"); }
  EXPECT_EQ(read_log(file_), "before;after");
}

TEST_F(OutputLogTest, OfMuchTheBeginningAndTheEndAreKept) {
  constexpr std::size_t kHead = OutputLog::kHeadBytes;
  constexpr std::size_t kTail = OutputLog::kTailBytes;
  {
    OutputLog log(file_, Begin::anew);
    for (std::size_t i = 0; i < kHead + 5 * kTail; i += 1000) {
      log.add(std::string(1000, i < kHead ? 'a' : 'b'));
    }
    log.add("the end");
    EXPECT_EQ(std::filesystem::file_size(file_), kHead);
  }
  const std::string text = read_log(file_);
  const std::size_t printed = (kHead + 5 * kTail + 999) / 1000 * 1000 + 7;
  const std::string note =
      "\n[armwright: " + std::to_string(printed - kHead - kTail) + " bytes are left out here]\n";
  EXPECT_EQ(text.size(), kHead + note.size() + kTail);
  EXPECT_EQ(text.substr(kHead, note.size()), note);
  EXPECT_EQ(text.substr(text.size() - 8), "bthe end");
}

TEST_F(OutputLogTest, ALittleOverTheBeginningIsWhole) {
  const std::string printed = std::string(OutputLog::kHeadBytes - 3, 'x') + "abcdefgh";
  { OutputLog(file_, Begin::anew).add(printed); }
  EXPECT_EQ(read_log(file_), printed);
}

TEST_F(OutputLogTest, LastLinesAreFewShortAndFitForATerminal) {
  OutputLog log;
  for (int i = 0; i < 100; ++i) {
    log.add("line " + std::to_string(i) + "\n\n");
  }
  log.add("\033[31mred" + std::string(1000, 'x'));
  const auto lines = log.last_lines();
  ASSERT_EQ(lines.size(), 10u);
  EXPECT_EQ(lines.front(), "line 91");
  EXPECT_EQ(lines.back(), "?[31mred" + std::string(292, 'x'));
  EXPECT_EQ(describe_printed({"a", "b"}), "; the last that it printed:\n  a\n  b");
  EXPECT_EQ(describe_printed({}), "");
}

TEST_F(OutputLogTest, AFileThatCannotBeWrittenIsNamed) {
  EXPECT_THAT(error_of(ErrorKind::io, [] { OutputLog("/none/x", Begin::behind_what_is_there); }),
              HasSubstr("/none/x"));
  EXPECT_THAT(error_of(ErrorKind::io, [] { OutputLog("/none/x", Begin::anew).add("x"); }),
              HasSubstr("/none: cannot open this folder"));
}

TEST_F(OutputLogTest, APipeIsReadToItsEndAndNeverWaitedFor) {
  OutputLog log;
  OutputPipe pipe(log);
  pipe.take_available();
  ASSERT_EQ(write(pipe.child_end(), "hello\n", 6), 6);
  pipe.take_available();
  EXPECT_THAT(log.last_lines(), ElementsAre("hello"));
  EXPECT_GE(pipe.get(), 0);
  pipe.close_child_end();
  pipe.take_available();
  EXPECT_EQ(pipe.get(), -1);
}

}  // namespace
}  // namespace armwright
