// Tests disks that fail or are full. The run ends with exit code 74 and a message that names the
// file and the reason. It loses no evaluation that was on the disk, and resumes from there when
// there is room again.
#include <sys/mount.h>

#include <cerrno>
#include <cstring>

#include "faults/support.hpp"

namespace armwright::faults {
namespace {

using Fault = FailingFiles::Fault;

struct Way {
  const char* name;
  const char* call;
  Fault fault;
  int error;
  std::vector<bool> begins = {false, true};  // false: at the start of a run, true: in the middle
};

void PrintTo(const Way& way, std::ostream* out) {
  *out << way.name;
}

// The system's reason, or SQLite's text for it.
auto gives_the_reason(int error) {
  return AnyOf(HasSubstr(std::strerror(error)), HasSubstr("disk I/O error"),
               HasSubstr("database or disk is full"), HasSubstr("unable to open database file"),
               HasSubstr("attempt to write a readonly database"));
}

class FailingDisk : public testing::TestWithParam<Way> {
 protected:
  void SetUp() override {
    std::filesystem::create_directory(runs_);
    ASSERT_EQ(run(make_run("runs/whole")).exit_code, 0);
    whole_ = read_journal(runs_ / "whole/journal");
    // A kill in the middle of a record leaves this.
    std::filesystem::create_directory(runs_ / "half");
    for (const char* file : {"manifest.json", "journal", "lock"}) {
      std::filesystem::copy(runs_ / "whole" / file, runs_ / "half" / file);
    }
    const auto journal = runs_ / "half/journal";
    std::filesystem::resize_file(journal, get_size(journal) / 2);
    half_ = read_journal(journal);
    ASSERT_GT(half_.training.size(), 10u);
    ASSERT_GT(half_.torn_bytes, 0u);
  }

  Outcome run(const Words& words, const Environment& environment = {}) {
    return run_program(folder_.path(), words, environment);
  }

  // Whether the fault happened: the run may have fewer calls of this kind.
  bool try_at(std::uint64_t at, bool from_half) {
    const std::string out = "runs/" + std::to_string(at) + (from_half ? "-half" : "");
    SCOPED_TRACE(out);
    if (from_half) {
      std::filesystem::copy(runs_ / "half", folder_ / out);
    }
    FailingFiles files(runs_, GetParam().call);
    const Outcome faulty =
        run(make_run(out), files.make_environment(GetParam().fault, at, GetParam().error));
    if (files.count() < at) {
      EXPECT_EQ(faulty.exit_code, 0) << faulty.err;
      return false;
    }
    if (faulty.exit_code != 0) {
      EXPECT_EQ(faulty.exit_code, 74) << faulty.err;
      EXPECT_THAT(faulty.err,
                  AllOf(HasSubstr("armwright: error: runs/"), gives_the_reason(GetParam().error)));
      ++told_;
    } else {
      ++survived_;
    }
    if (std::filesystem::exists(folder_ / out / "journal")) {
      const JournalContent kept = read_journal(folder_ / out / "journal");
      expect_part_of(kept, whole_);
      if (from_half) {
        expect_part_of(half_, kept);
      }
    }
    const Outcome resumed = run(make_run(out));
    EXPECT_EQ(resumed.exit_code, 0) << resumed.err;
    expect_same_run(runs_ / "whole", folder_ / out);
    return true;
  }

  TemporaryFolder folder_;
  const std::filesystem::path runs_ = folder_ / "runs";
  JournalContent whole_;
  JournalContent half_;
  int told_ = 0;
  int survived_ = 0;
};

TEST_P(FailingDisk, EveryCallInTurn) {
  for (const bool from_half : GetParam().begins) {
    for (std::uint64_t at = 1; try_at(at, from_half); at += sample_or_all(3, 1)) {
      ASSERT_FALSE(HasFailure());
    }
  }
  EXPECT_GT(told_, 0) << "no failure was ever told";
  // No failure to write or rename a file may go unnoticed. Errors from closing a file that was only
  // read, and from syncing a folder, are ignored.
  const std::string call = GetParam().call;
  if (call == "write" || call == "rename" || call == "fdatasync" || call == "ftruncate") {
    EXPECT_EQ(survived_, 0);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Calls, FailingDisk,
    testing::Values(Way{"WriteOnceNoSpace", "write", Fault::once, ENOSPC},
                    Way{"WriteForEverInputOutput", "write", Fault::for_ever, EIO},
                    Way{"WriteForEverNoSpace", "write", Fault::for_ever, ENOSPC, {false}},
                    Way{"WriteOnceInputOutput", "write", Fault::once, EIO, {true}},
                    Way{"FsyncOnce", "fsync", Fault::once, EIO},
                    Way{"FsyncForEver", "fsync", Fault::for_ever, ENOSPC},
                    Way{"FdatasyncOnce", "fdatasync", Fault::once, EIO},
                    Way{"FdatasyncForEver", "fdatasync", Fault::for_ever, ENOSPC},
                    Way{"OpenOnce", "open", Fault::once, EIO},
                    Way{"OpenForEver", "open", Fault::for_ever, ENOSPC},
                    Way{"RenameOnce", "rename", Fault::once, EIO},
                    Way{"RenameForEver", "rename", Fault::for_ever, ENOSPC},
                    Way{"TruncateOnce", "ftruncate", Fault::once, EIO},
                    Way{"TruncateForEver", "ftruncate", Fault::for_ever, ENOSPC},
                    Way{"CloseOnce", "close", Fault::once, EIO},
                    Way{"CloseForEver", "close", Fault::for_ever, ENOSPC}),
    [](const auto& test) { return test.param.name; });

class Disk : public testing::Test {
 protected:
  Outcome run(const Words& words, const Environment& environment = {}) {
    return run_program(folder_.path(), words, environment);
  }
  TemporaryFolder folder_;
};

// Mounts a file system of a given size on a folder, and unmounts it at the end.
class SmallDisk {
 public:
  SmallDisk(const std::filesystem::path& folder, const std::string& size) : folder_(folder) {
    std::filesystem::create_directories(folder);
    is_there_ = ::mount("none", folder.c_str(), "tmpfs", 0, ("size=" + size).c_str()) == 0;
  }
  ~SmallDisk() {
    if (is_there_) {
      ::umount2(folder_.c_str(), MNT_DETACH);
    }
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;
  bool is_there() const { return is_there_; }

 private:
  std::filesystem::path folder_;
  bool is_there_ = false;
};

// A real full disk, on which a file leaves only some pages free: from too few for the manifest to
// too few for the last page of SQLite's tables.
TEST_F(Disk, FullAtEveryPageAndThenWithRoomAgain) {
  const SmallDisk disk(folder_ / "disk", "2m");
  if (!disk.is_there()) {
    GTEST_SKIP() << "mounting a small file system is not permitted here";
  }
  ASSERT_EQ(run(make_run("whole")).exit_code, 0);
  int full = 0;
  bool is_large_enough = false;
  const int step = sample_or_all(2, 1);
  for (int pages = 0; !is_large_enough; pages += step * (pages < 12 ? 1 : 5)) {
    ASSERT_LT(pages, 400);
    SCOPED_TRACE(std::to_string(pages) + " pages left");
    std::ofstream filler(folder_ / "disk/filler", std::ios::binary);
    while (filler.write(std::string(4096, 'x').data(), 4096).flush()) {
    }
    filler.close();
    constexpr std::uintmax_t kPage_bytes = 4096;
    std::filesystem::resize_file(
        folder_ / "disk/filler",
        get_size(folder_ / "disk/filler") / kPage_bytes * kPage_bytes - kPage_bytes * pages);
    const Outcome outcome = run(make_run("disk/run"));
    is_large_enough = outcome.exit_code == 0;
    if (!is_large_enough) {
      EXPECT_EQ(outcome.exit_code, 74) << outcome.err;
      EXPECT_THAT(outcome.err,
                  AllOf(HasSubstr("armwright: error: disk/run"), gives_the_reason(ENOSPC)));
      ++full;
    }
    std::filesystem::remove(folder_ / "disk/filler");
    const Outcome resumed = run(make_run("disk/run"));
    EXPECT_EQ(resumed.exit_code, 0) << resumed.err;
    expect_same_run(folder_ / "whole", folder_ / "disk/run");
    std::filesystem::remove_all(folder_ / "disk/run");
    ASSERT_FALSE(HasFailure());
  }
  EXPECT_GT(full, sample_or_all(5, 10));
}

TEST_F(Disk, AComparisonOnOneThatFails) {
  std::filesystem::create_directory(folder_ / "runs");
  const auto make = [](const std::string& out) {
    return Words{"compare",     "--problems", "sphere", "--optimizers", "ga", "--replicates",
                 "2",           "--budget",   "100",    "--jobs",       "2",  "--out",
                 "runs/" + out, "--quiet"};
  };
  ASSERT_EQ(run(make("whole")).exit_code, 0);
  int told = 0;
  FailingFiles files(folder_ / "runs", "write");
  for (std::uint64_t at = 1;; at += sample_or_all(7, 3)) {
    SCOPED_TRACE(at);
    const std::string out = std::to_string(at);
    const Outcome faulty = run(make(out), files.make_environment(Fault::for_ever, at, ENOSPC));
    if (files.count() < at) {
      EXPECT_EQ(faulty.exit_code, 0) << faulty.err;
      break;
    }
    EXPECT_EQ(faulty.exit_code, 74) << faulty.err;
    EXPECT_THAT(faulty.err, AllOf(HasSubstr("armwright: error: runs/"), gives_the_reason(ENOSPC)));
    ++told;
    const Outcome resumed = run(make(out));
    EXPECT_EQ(resumed.exit_code, 0) << resumed.err;
    EXPECT_EQ(read_study(folder_ / "runs/whole"), read_study(folder_ / "runs" / out));
    ASSERT_FALSE(HasFailure());
  }
  EXPECT_GT(told, 5);
}

TEST_F(Disk, FullBelowTheStandardStreams) {
  ASSERT_EQ(run(make_run("whole")).exit_code, 0);
  const Outcome out = run(make_run("out"), {{}, "/dev/full"});
  EXPECT_EQ(out.exit_code, 74);
  EXPECT_THAT(out.err, HasSubstr("standard output: cannot write it: No space left on device"));
  expect_same_run(folder_ / "whole",
                  folder_ / "out");  // the run is complete, and only the printing failed
  const Outcome err = run(make_run("err"), after_shell("exec 2>/dev/full"));
  EXPECT_EQ(err.exit_code, 0);
  expect_same_run(folder_ / "whole", folder_ / "err");
}

// Otherwise the first file that is opened would get the number of a closed stream, and would
// receive the printed text.
TEST_F(Disk, ClosedStandardStreamsAreNoFileOfTheRun) {
  ASSERT_EQ(run(make_run("whole")).exit_code, 0);
  for (const auto& [streams, code] :
       std::vector<std::pair<std::string, int>>{{">&-", 74}, {"<&- >&- 2>&-", 74}, {"2>&-", 0}}) {
    SCOPED_TRACE(streams);
    const Outcome outcome = run(make_run("closed"), after_shell("exec " + streams));
    EXPECT_EQ(outcome.exit_code, code);
    if (streams == ">&-") {
      EXPECT_THAT(outcome.err, HasSubstr("standard output: cannot write it: Bad file descriptor"));
    }
    expect_same_run(folder_ / "whole", folder_ / "closed");
    std::filesystem::remove_all(folder_ / "closed");
  }
  // An external optimizer still gets its own streams.
  const Outcome plugin =
      run({"optimize", "sphere", "--optimizer", "exec:python3 " + get_script("good.py"), "--budget",
           "20", "--out", "plugin"},
          after_shell("exec <&- 2>&-"));
  EXPECT_EQ(plugin.exit_code, 0);
}

}  // namespace
}  // namespace armwright::faults
