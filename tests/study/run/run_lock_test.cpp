#include "study/run/run_lock.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <optional>
#include <string>

#include "base/error.hpp"
#include "study/journal_test_support.hpp"

namespace armwright {
namespace {

using journal_testing::catch_error;
using journal_testing::read_bytes;

using journal_testing::write_bytes;
using ::testing::HasSubstr;

std::string this_process() {
  char host[256] = {};
  ::gethostname(host, sizeof host - 1);
  return "process " + std::to_string(::getpid()) + " on " + host;
}

TEST(RunLock, RefusesASecondHolderAndNamesTheFirst) {
  const TemporaryFolder folder;
  const RunLock lock{Folder(folder.path())};
  const Error error = catch_error([&] { const RunLock second{Folder(folder.path())}; });
  EXPECT_EQ(error.kind(), ErrorKind::busy);
  EXPECT_EQ(error.what(), folder.path().string() + " is in use by " + this_process() +
                              "; wait for it, stop it, or use --out/--new for another folder");
  // The refused attempt has not changed the file.
  EXPECT_EQ(read_bytes(folder / "lock"), this_process() + "\n");
}

TEST(RunLock, EndsWithItsScopeAndConcernsOneFolder) {
  const TemporaryFolder folder;
  const TemporaryFolder other;
  const RunLock elsewhere{Folder(other.path())};
  for (int i = 0; i < 2; ++i) {
    EXPECT_NO_THROW(const RunLock lock(Folder(folder.path())));
  }
}

TEST(RunLock, RefusesAnotherProcessUntilThatIsKilled) {
  const TemporaryFolder folder;
  int locked[2];
  ASSERT_EQ(::pipe(locked), 0);
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    const RunLock lock{Folder(folder.path())};
    if (::write(locked[1], "+", 1) != 1) {
      ::_exit(1);
    }
    while (true) {
      ::pause();
    }
  }
  char sign = 0;
  ::close(locked[1]);
  ASSERT_EQ(::read(locked[0], &sign, 1), 1);
  ::close(locked[0]);
  const Error error = catch_error([&] { const RunLock lock{Folder(folder.path())}; });
  ::kill(child, SIGKILL);
  ASSERT_EQ(::waitpid(child, nullptr, 0), child);
  EXPECT_EQ(error.kind(), ErrorKind::busy);
  EXPECT_THAT(error.what(), HasSubstr(" is in use by process " + std::to_string(child) + " on "));
  const RunLock lock{Folder(folder.path())};  // free at once
  EXPECT_EQ(read_bytes(folder / "lock"), this_process() + "\n");
}

// A program that is started meanwhile, for instance an external optimizer, must not keep the lock.
TEST(RunLock, IsNotInheritedByPrograms) {
  const TemporaryFolder folder;
  std::optional<RunLock> lock(Folder(folder.path()));
  int input[2];
  int output[2];
  ASSERT_EQ(::pipe(input), 0);
  ASSERT_EQ(::pipe(output), 0);
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    ::dup2(input[0], 0);
    ::dup2(output[1], 1);
    ::close(input[1]);
    ::execlp("sh", "sh", "-c", "echo started; read line", static_cast<char*>(nullptr));
    ::_exit(127);
  }
  char sign = 0;
  ASSERT_EQ(::read(output[0], &sign, 1), 1);  // the program runs, so exec has happened
  lock.reset();
  EXPECT_NO_THROW(lock.emplace(Folder(folder.path())));
  ASSERT_EQ(::write(input[1], "\n", 1), 1);
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
  for (const int fd : {input[0], input[1], output[0], output[1]}) {
    ::close(fd);
  }
}

TEST(RunLock, ShowsNoControlCharactersOfTheFile) {
  const TemporaryFolder folder;
  const RunLock lock{Folder(folder.path())};
  write_bytes(folder / "lock", "\x1b[31mred\nsecond line");
  const Error error = catch_error([&] { const RunLock second{Folder(folder.path())}; });
  EXPECT_THAT(error.what(), HasSubstr(" is in use by ?[31mred; wait"));
  write_bytes(folder / "lock", "");  // the holder has not written its name yet
  const Error early = catch_error([&] { const RunLock second{Folder(folder.path())}; });
  EXPECT_THAT(early.what(), HasSubstr(" is in use by another process; wait"));
}

TEST(RunLock, SaysWhyThereCanBeNone) {
  const TemporaryFolder folder;
  const auto missing = folder / "missing";
  const Error error = catch_error([&] { const RunLock lock{Folder(missing)}; });
  EXPECT_EQ(error.kind(), ErrorKind::io);
  EXPECT_EQ(error.what(),
            missing.string() + ": cannot open this folder: No such file or directory");
}

}  // namespace
}  // namespace armwright
