// Tests what the journal keeps when the process is killed, the disk fails or the system grants no
// threads.
#include <signal.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <functional>
#include <thread>

#include "study/journal/journal.hpp"
#include "study/journal_test_support.hpp"
#include "wait_until.hpp"

namespace {
std::atomic<int> sync_count = 0;
std::atomic<int> sync_error = 0;      // the error of the next syncs
std::atomic<bool> sync_held = false;  // syncs block until this is false
}  // namespace

// Replaces the C library's function in this program. There is no other way to observe a sync or to
// let it fail.
extern "C" int fdatasync(int fd) {
  ++sync_count;
  while (sync_held) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  if (sync_error != 0) {
    errno = sync_error;
    return -1;
  }
  return static_cast<int>(::syscall(SYS_fdatasync, fd));
}

namespace armwright {
namespace {

using namespace journal_testing;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

// Keeps files of this process from growing beyond `bytes` as long as it lives: writes are cut
// short, then fail with EFBIG. A full disk does the same with ENOSPC.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    old_handler_ = ::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit = {bytes, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    ::signal(SIGXFSZ, old_handler_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit before_{};
  sighandler_t old_handler_ = SIG_DFL;
};

void expect_write_error(const Error& error, const std::filesystem::path& file) {
  EXPECT_EQ(error.kind(), ErrorKind::io);
  EXPECT_THAT(error.what(), StartsWith(file.string() + ": cannot write it: File too large; once"));
}

TEST(JournalFaults, RecordsReachTheSystemWithoutFlush) {
  const TemporaryFolder folder;
  const auto file = folder / "journal";
  JournalContent content;
  Journal journal(file, content);
  // append() itself writes only if the last write is 5 ms ago, so most of these records wait for
  // the background thread.
  for (std::uint64_t i = 0; i < 50; ++i) {
    journal.append(make_record(i));
  }
  EXPECT_TRUE(wait_until([&] { return read_journal(file).training.size() == 50; }));
  // Repeats it after the background thread has gone to sleep.
  for (std::uint64_t i = 50; i < 100; ++i) {
    journal.append(make_record(i));
  }
  EXPECT_TRUE(wait_until([&] { return read_journal(file).training.size() == 100; }));
  expect_first_records(read_journal(file), 100);
}

TEST(JournalFaults, RecordsReachTheDiskInTheBackgroundAndAtClose) {
  const TemporaryFolder folder;
  JournalContent content;
  Journal journal(folder / "journal", content);
  for (std::uint64_t i = 0; i < 2; ++i) {
    const int before = sync_count;
    journal.append(make_record(i));
    EXPECT_TRUE(wait_until([&] { return sync_count > before; })) << "record " << i;
  }
  const int before = sync_count;
  journal.append(make_record(2));
  journal.close();
  EXPECT_GT(sync_count, before);
}

TEST(JournalFaults, ADiskThatCannotSyncIsTold) {
  const TemporaryFolder folder;
  for (const bool closing : {false, true}) {
    const auto file = folder / (closing ? "closing" : "background");
    JournalContent content;
    Journal journal(file, content);
    sync_error = EIO;
    journal.append(make_record(0));
    std::string message;
    const auto told = [&](const std::function<void()>& action) {
      try {
        action();
      } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::io);
        message = error.what();
      }
      return !message.empty();
    };
    if (closing) {
      told([&] { journal.close(); });
    } else {
      // Appends all the time, so that the buffer holds records when the error comes.
      wait_until([&] { return told([&] { journal.append(make_record(1)); }); });
    }
    sync_error = 0;
    EXPECT_THAT(message,
                StartsWith(file.string() + ": cannot sync it to the disk: Input/output error"));
  }
}

// Both tests need a sync of the background thread that hangs, as on a busy disk.
TEST(JournalFaults, RecordsReachTheSystemDuringASlowSyncAndItsErrorIsTold) {
  const TemporaryFolder folder;
  const auto file = folder / "journal";
  JournalContent content;
  Journal journal(file, content);
  sync_held = true;
  sync_error = EIO;
  const int before = sync_count;
  journal.append(make_record(0));
  EXPECT_TRUE(wait_until([&] { return sync_count > before; }));
  for (std::uint64_t i = 1; i < 50; ++i) {
    journal.append(make_record(i));
  }
  EXPECT_TRUE(wait_until([&] { return read_journal(file).training.size() == 50; }));

  // Records in the buffer at the time of the error must not keep the writing thread, and with it
  // the lock, busy.
  for (std::uint64_t i = 50; i < 60; ++i) {
    journal.append(make_record(i));
  }
  sync_held = false;
  std::string message;
  EXPECT_TRUE(wait_until([&] {
    try {
      journal.append(make_record(60));
    } catch (const Error& error) {
      message = error.what();
    }
    return !message.empty();
  }));
  sync_error = 0;
  EXPECT_THAT(message, HasSubstr("cannot sync it to the disk: Input/output error"));
  // The writing thread has run by now. If it were caught in a loop, this would never return.
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_EQ(catch_error([&] { journal.flush(); }).what(), message);
}

TEST(JournalFaults, AFileSystemWithoutSyncIsAccepted) {
  const TemporaryFolder folder;
  sync_error = EINVAL;  // the error of such file systems
  write_journal(folder / "journal", 2);
  sync_error = 0;
  expect_first_records(read_journal(folder / "journal"), 2);
}

TEST(JournalFaults, WhatWasFlushedSurvivesSigkill) {
  for (const std::size_t kill_after : {0, 1, 2, 7, 50, 333, 1000}) {
    SCOPED_TRACE("killed after " + std::to_string(kill_after) + " acknowledged records");
    const TemporaryFolder folder;
    const auto file = folder / "journal";
    int acknowledged[2];
    ASSERT_EQ(::pipe(acknowledged), 0);
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      JournalContent content;
      Journal journal(file, content);
      const auto tell = [&] {
        if (::write(acknowledged[1], "+", 1) != 1) {
          ::_exit(1);
        }
      };
      tell();  // the journal is open
      for (std::uint64_t i = 0;; ++i) {
        journal.append(make_record(i));
        journal.flush();
        tell();
      }
    }
    ::close(acknowledged[1]);
    char sign = 0;
    std::size_t count = 0;
    while (count < kill_after + 1 && ::read(acknowledged[0], &sign, 1) == 1) {
      ++count;
    }
    ASSERT_EQ(count, kill_after + 1) << "the child ended early";
    ::kill(child, SIGKILL);
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFSIGNALED(status));
    while (::read(acknowledged[0], &sign, 1) == 1) {
      ++count;
    }
    ::close(acknowledged[0]);
    JournalContent content;
    Journal journal(file, content);
    ASSERT_GE(content.training.size(), count - 1);
    expect_first_records(content, content.training.size());
    journal.append(make_record(content.training.size()));
    journal.close();
    expect_first_records(read_journal(file), content.training.size() + 1);
  }
}

// The disk fills up at each byte of a journal of three records, which are flushed one by one or
// together.
TEST(JournalFaults, AFullDiskLosesNothingThatWasWrittenWhole) {
  const TemporaryFolder folder;
  const auto ends = write_journal(folder / "whole", 3);
  for (const bool flush_each : {true, false}) {
    for (std::size_t limit = ends.front(); limit < ends.back(); ++limit) {
      SCOPED_TRACE("limit " + std::to_string(limit));
      const auto file = folder / (std::to_string(limit) + (flush_each ? "-each" : "-once"));
      std::size_t whole = 0;
      while (ends[whole + 1] <= limit) {
        ++whole;
      }
      JournalContent content;
      Journal journal(file, content);
      std::size_t flushed = 0;
      const Error error = catch_error([&] {
        const FileSizeLimit full(limit);
        for (std::uint64_t i = 0; i < 3; ++i) {
          journal.append(make_record(i));
          if (flush_each) {
            journal.flush();
            flushed = i + 1;
          }
        }
        journal.flush();
      });
      expect_write_error(error, file);
      EXPECT_EQ(flushed, flush_each ? whole : 0);
      EXPECT_EQ(std::filesystem::file_size(file), ends[whole]);
      // There is room again, but no record may follow the lost one.
      for (const std::function<void()>& action : std::vector<std::function<void()>>{
               [&] { journal.append(make_record(3)); }, [&] { journal.append(EndRecord{}); },
               [&] { journal.flush(); }, [&] { journal.close(); }}) {
        expect_write_error(catch_error(action), file);
      }
      const JournalContent kept = read_journal(file);
      expect_first_records(kept, whole);
      EXPECT_EQ(kept.torn_bytes, 0);
    }
  }
}

TEST(JournalFaults, AnErrorIsToldWithoutAFlush) {
  const TemporaryFolder folder;
  const auto file = folder / "journal";
  JournalContent content;
  Journal journal(file, content);
  const FileSizeLimit full(std::filesystem::file_size(file));
  std::string message;
  EXPECT_TRUE(wait_until([&] {
    try {
      journal.append(make_record(0));
    } catch (const Error& error) {
      message = error.what();
    }
    return !message.empty();
  }));
  EXPECT_THAT(message, StartsWith(file.string() + ": cannot write it: File too large"));
  expect_write_error(catch_error([&] { journal.flush(); }), file);
}

TEST(JournalFaults, AFullDiskWhileTheFileIsMade) {
  const TemporaryFolder folder;
  for (const rlim_t limit : {0, 5}) {
    const auto file = folder / ("journal-" + std::to_string(limit));
    const Error error = catch_error([&] {
      const FileSizeLimit full(limit);
      JournalContent content;
      const Journal journal(file, content);
    });
    EXPECT_EQ(error.kind(), ErrorKind::io);
    EXPECT_EQ(error.what(), file.string() + ": cannot write it: File too large");
    JournalContent content;
    Journal journal(file, content);  // with room again
    EXPECT_EQ(content.torn_bytes, limit);
    journal.append(make_record(0));
    journal.close();
    expect_first_records(read_journal(file), 1);
  }
}

// Two faults at once: a kill has left a torn end, and there is no room to save it.
TEST(JournalFaults, ATornEndThatCannotBeSavedIsNotCutOff) {
  const TemporaryFolder folder;
  const auto file = folder / "journal";
  write_journal(file, 2);
  const std::string bytes = read_bytes(file) + "a torn end";
  write_bytes(file, bytes);
  const Error error = catch_error([&] {
    const FileSizeLimit full(4);
    JournalContent content;
    const Journal journal(file, content);
  });
  EXPECT_EQ(error.kind(), ErrorKind::io);
  EXPECT_EQ(error.what(), file.string() +
                              ".torn-1: cannot save the torn end of the journal in it: File too "
                              "large");
  EXPECT_EQ(read_bytes(file), bytes);
  EXPECT_FALSE(std::filesystem::exists(folder / "journal.torn-1"));
  JournalContent content;
  const Journal journal(file, content);
  EXPECT_EQ(content.torn_bytes, 10);
}

TEST(JournalFaults, ADeletedFileIsNotWrittenInSilence) {
  const TemporaryFolder folder;
  const auto file = folder / "journal";
  JournalContent content;
  Journal journal(file, content);
  journal.append(make_record(0));
  journal.flush();
  std::filesystem::remove(file);
  const Error error = catch_error([&] {
    journal.append(make_record(1));
    journal.flush();
  });
  EXPECT_EQ(error.kind(), ErrorKind::io);
  EXPECT_EQ(error.what(), file.string() + ": was deleted while the run was writing it");
}

// Runs in a child process that may start no more threads. Root is exempt from that limit, so the
// child changes its user first.
TEST(JournalFaults, WithoutThreadsEveryRecordIsWrittenAtOnce) {
  const TemporaryFolder folder;
  std::filesystem::permissions(folder.path(), std::filesystem::perms::all);
  const auto file = folder / "journal";
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    const rlimit limit = {0, 0};
    if ((::getuid() == 0 && ::setuid(65534) != 0) || ::setrlimit(RLIMIT_NPROC, &limit) != 0) {
      ::_exit(2);
    }
    try {
      std::thread([] {}).join();
      ::_exit(3);  // the system does not apply the limit
    } catch (const std::system_error&) {
      // expected
    }
    JournalContent content;
    Journal journal(file, content);
    for (std::uint64_t i = 0; i < 20; ++i) {
      journal.append(make_record(i));
    }
    ::_exit(0);  // neither flush() nor close()
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status));
  if (WEXITSTATUS(status) == 3) {
    GTEST_SKIP() << "this system grants threads beyond RLIMIT_NPROC";
  }
  ASSERT_EQ(WEXITSTATUS(status), 0);
  expect_first_records(read_journal(file), 20);
}

}  // namespace
}  // namespace armwright
