// A copy is complete or absent: on a full disk, after a kill at any moment, and when stopped.
#include "study/survey/folder_copy.hpp"

#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "study/journal_test_support.hpp"

namespace armwright {
namespace {

using namespace journal_testing;
using testing::HasSubstr;

class FolderCopyTest : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directory(folder_ / "source");
    write_bytes(folder_ / "source" / "a", std::string(3000, 'a'));
    write_bytes(folder_ / "source" / "b\nb", std::string(9000, 'b'));
  }
  void fill(FolderCopy& copy) {
    copy.make_folder("inner");
    copy.add(folder_ / "source" / "a", "a");
    copy.add(folder_ / "source" / "b\nb", "inner/b\nb");
  }
  void make_copy() {
    FolderCopy copy(folder_ / "copy", stop_);
    fill(copy);
    copy.put_in_place();
  }

  TemporaryFolder folder_;
  StopSignal stop_;
};

TEST_F(FolderCopyTest, IsWhole) {
  std::filesystem::create_symlink("nowhere", folder_ / "source" / "link");
  FolderCopy copy(folder_ / "copy/", stop_);
  fill(copy);
  EXPECT_TRUE(copy.add(folder_ / "source" / "link", "link"));
  EXPECT_EQ(folder_.list(), (std::vector<std::string>{"copy.partial-1", "source"}));
  copy.put_in_place();
  EXPECT_EQ(folder_.list(), (std::vector<std::string>{"copy", "source"}));
  EXPECT_EQ(read_bytes(folder_ / "copy" / "a"), std::string(3000, 'a'));
  EXPECT_EQ(read_bytes(folder_ / "copy" / "inner" / "b\nb"), std::string(9000, 'b'));
  EXPECT_EQ(std::filesystem::read_symlink(folder_ / "copy" / "link"), "nowhere");
}

TEST_F(FolderCopyTest, LeavesOutWhatIsNoFile) {
  ASSERT_EQ(::mkfifo((folder_ / "source" / "pipe").c_str(), 0600), 0);
  FolderCopy copy(folder_ / "copy", stop_);
  EXPECT_FALSE(copy.add(folder_ / "source" / "pipe", "pipe"));
}

TEST_F(FolderCopyTest, OverwritesNothing) {
  std::filesystem::create_directory(folder_ / "copy");
  const Error error = catch_error([&] { make_copy(); });
  EXPECT_EQ(error.kind(), ErrorKind::usage);
  EXPECT_THAT(error.what(), HasSubstr("is there already"));
  std::filesystem::remove(folder_ / "copy");
  FolderCopy late(folder_ / "copy", stop_);
  fill(late);
  std::filesystem::create_directory(folder_ / "copy");
  EXPECT_THAT(catch_error([&] { late.put_in_place(); }).what(), HasSubstr("is there already"));
  EXPECT_TRUE(std::filesystem::is_empty(folder_ / "copy"));
}

TEST_F(FolderCopyTest, WhereNothingMoreCanBeWrittenNothingIsLeft) {
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto old_handler = ::signal(SIGXFSZ, SIG_IGN);
  for (const rlim_t limit : {0, 1, 2999, 3000, 8999}) {
    const rlimit low{limit, before.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &low);
    const Error error = catch_error([&] { make_copy(); });
    ::setrlimit(RLIMIT_FSIZE, &before);
    EXPECT_EQ(error.kind(), ErrorKind::io);
    EXPECT_THAT(error.what(), HasSubstr("File too large"));
    EXPECT_EQ(folder_.list(), std::vector<std::string>{"source"}) << limit;
  }
  ::signal(SIGXFSZ, old_handler);
}

TEST_F(FolderCopyTest, AStopLeavesNothing) {
  stop_.request(StopReason::interrupted);
  EXPECT_THROW(make_copy(), WorkStopped);
  EXPECT_EQ(folder_.list(), std::vector<std::string>{"source"});
}

TEST_F(FolderCopyTest, AfterAKillTheCopyIsWholeOrNotThereAndCanBeMade) {
  for (int delay_us = 0; delay_us < 4000; delay_us += 200) {
    const pid_t child = ::fork();
    if (child == 0) {
      make_copy();
      ::_exit(0);
    }
    ::usleep(static_cast<useconds_t>(delay_us));
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    if (!std::filesystem::exists(folder_ / "copy")) {
      make_copy();
    }
    EXPECT_EQ(read_bytes(folder_ / "copy" / "a").size(), 3000u);
    EXPECT_EQ(read_bytes(folder_ / "copy" / "inner" / "b\nb").size(), 9000u);
    EXPECT_EQ(read_bytes(folder_ / "source" / "a"), std::string(3000, 'a'));
    std::filesystem::remove_all(folder_ / "copy");
  }
}

}  // namespace
}  // namespace armwright
