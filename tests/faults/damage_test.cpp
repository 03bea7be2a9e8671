// Tests stored files that are torn, damaged or left over, and faults during their repair.
#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>

#include "faults/support.hpp"

namespace armwright::faults {
namespace {

namespace fs = std::filesystem;
using Fault = FailingFiles::Fault;

class Damage : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directory(folder_ / "runs");
    ASSERT_EQ(run(make_run("whole")).exit_code, 0);
  }

  Outcome run(const Words& words, const Environment& environment = {}) {
    return run_program(folder_.path(), words, environment);
  }
  // Makes a run as a kill leaves it: with manifest and journal, without derived files.
  fs::path copy_journal(const std::string& name, std::uintmax_t bytes) {
    fs::create_directories(folder_ / name);
    for (const char* file : {"manifest.json", "journal"}) {
      fs::copy(folder_ / "whole" / file, folder_ / name / file);
    }
    fs::resize_file(folder_ / name / "journal", bytes);
    return folder_ / name / "journal";
  }
  void copy_whole(const std::string& name) {
    fs::remove_all(folder_ / name);
    fs::copy(folder_ / "whole", folder_ / name);
  }

  TemporaryFolder folder_;
};

// The bytes behind the last whole record are cut off, kept in a file and reported. Then the run is
// completed.
TEST_F(Damage, AJournalTruncatedAtEveryPageAndAroundARecordIsMended) {
  const auto size = get_size(folder_ / "whole/journal");
  constexpr std::uintmax_t kPage_bytes = 4096;
  std::vector<std::uintmax_t> lengths;
  for (std::uintmax_t length = 0; length < size; length += sample_or_all(2, 1) * kPage_bytes) {
    lengths.push_back(length);
  }
  const std::uintmax_t record_bytes =
      (size - 8) / read_journal(folder_ / "whole/journal").training.size();
  for (std::uintmax_t length = size - record_bytes; length < size; length += sample_or_all(31, 9)) {
    lengths.push_back(length);
  }
  ASSERT_GT(lengths.size(), 10u);
  for (const std::uintmax_t length : lengths) {
    SCOPED_TRACE(length);
    const auto journal = copy_journal("torn", length);
    const std::uint64_t torn = read_journal(journal).torn_bytes;
    const std::string end = read_text(journal).substr(length - torn);
    const Outcome outcome = run(make_run("torn"));
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    if (torn > 0) {
      EXPECT_THAT(outcome.err, HasSubstr("torn/journal: cut " + std::to_string(torn) +
                                         " bytes of an unfinished record off the end"));
      EXPECT_EQ(read_text(folder_ / "torn/journal.torn-1"), end);
    }
    expect_same_run(folder_ / "whole", folder_ / "torn");
    fs::remove_all(folder_ / "torn");
  }
}

// Cuts the smallest possible journal, that of a run on a function, in all its records.
// study.Journal.EveryTruncationLeavesTheWholeRecords cuts one at every byte, without the program.
TEST_F(Damage, ASmallJournalTruncatedInEveryRecordIsMended) {
  const auto make = [](const std::string& out) {
    return Words{"optimize",    "sphere", "--set",    "function.dimension=2",
                 "--optimizer", "random", "--budget", "2",
                 "--out",       out,      "--quiet"};
  };
  ASSERT_TRUE(has_ended(run(make("small"))));
  const auto size = get_size(folder_ / "small/journal");
  ASSERT_LT(size, 1500u);
  // These steps are prime to the sizes of fields and records, so that the cuts fall differently in
  // each.
  for (std::uintmax_t length = 0; length < size; length += sample_or_all(41, 13)) {
    SCOPED_TRACE(length);
    fs::create_directory(folder_ / "torn");
    for (const char* file : {"manifest.json", "journal"}) {
      fs::copy(folder_ / "small" / file, folder_ / "torn" / file);
    }
    fs::resize_file(folder_ / "torn/journal", length);
    const Outcome outcome = run(make("torn"));
    ASSERT_TRUE(has_ended(outcome)) << outcome.err;
    ASSERT_EQ(read_text(folder_ / "small/result.json"), read_text(folder_ / "torn/result.json"));
    fs::remove_all(folder_ / "torn");
  }
}

// A changed byte in the last record is a torn end. Anywhere else the run is refused, the message
// names the place, and no file is changed.
TEST_F(Damage, AChangedByteOfTheJournalIsNamedByItsPlace) {
  const std::string whole = read_text(folder_ / "whole/journal");
  const std::size_t record =
      (whole.size() - 8) / (read_journal(folder_ / "whole/journal").training.size() + 10);
  std::vector<std::size_t> offsets = {0, 7};
  for (const std::size_t begin : {std::size_t{8}, whole.size() / 2, whole.size() - 4 * record}) {
    for (std::size_t i = 0; i < record; i += sample_or_all(61, 23)) {
      offsets.push_back(begin + i);
    }
  }
  int refused = 0;
  for (const std::size_t offset : offsets) {
    SCOPED_TRACE(offset);
    const auto journal = copy_journal("damaged", whole.size());
    flip_byte(journal, offset);
    const std::string damaged = read_text(journal);
    const Outcome outcome = run(make_run("damaged"));
    EXPECT_EQ(outcome.exit_code, 4) << outcome.err;
    EXPECT_THAT(outcome.err,
                AllOf(HasSubstr("error: damaged/journal: "), HasSubstr("left untouched")));
    if (offset >= 8) {
      EXPECT_THAT(outcome.err, AllOf(HasSubstr(" at byte "), HasSubstr(" is damaged (")));
    }
    EXPECT_EQ(read_text(journal), damaged);
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_ / "damaged"), {}),
              3);  // the third one is the lock
    ++refused;
    fs::remove_all(folder_ / "damaged");
  }
  EXPECT_GT(refused, sample_or_all(15, 20));
  // If the last byte of the file has changed, its record is evaluated again.
  const auto journal = copy_journal("end", whole.size());
  flip_byte(journal, whole.size() - 1);
  const Outcome outcome = run(make_run("end"));
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  expect_same_run(folder_ / "whole", folder_ / "end");
}

// Damaged derived files are rebuilt, or the message names them and says how to rebuild them.
// Crashes or careless edits can cause each of these damages.
TEST_F(Damage, DerivedFilesAreRebuiltOrNamed) {
  for (const char* name : {"result.json", "manifest.json"}) {
    const std::string text = read_text(folder_ / "whole" / name);
    const std::vector<std::string> damages = {"",
                                              text.substr(0, text.size() / 2),
                                              "[]",
                                              "null",
                                              "\xff\xfe",
                                              std::string(100'000, '['),
                                              "{}",
                                              "{\"format\": 99}",
                                              std::string(text.size(), '\0'),
                                              text + text};
    for (const std::string& damage : damages) {
      SCOPED_TRACE(std::string(name) + ": " + damage.substr(0, 20));
      copy_whole("damaged");
      write_text(folder_ / "damaged" / name, damage);
      for (const Words& command : {make_run("damaged"), Words{"show", "damaged"}}) {
        const Outcome outcome = run(command);
        if (outcome.exit_code == 0 && command.front() == "show") {
          continue;  // this command does not read the whole manifest
        }
        EXPECT_EQ(outcome.exit_code, 4) << outcome.err;
        EXPECT_THAT(outcome.err, HasSubstr(std::string("error: damaged/") + name + ":"));
      }
    }
  }
  // After the user has removed it, as the message advises, it is rebuilt from the journal.
  copy_whole("rebuilt");
  fs::remove(folder_ / "rebuilt/result.json");
  for (const char* file : {"results.sqlite", "winner.toml", "convergence.csv"}) {
    write_text(folder_ / "rebuilt" / file, "damaged");
  }
  ASSERT_EQ(run(make_run("rebuilt")).exit_code, 0);
  expect_same_run(folder_ / "whole", folder_ / "rebuilt");
  EXPECT_THAT(read_text(folder_ / "rebuilt/results.sqlite"), StartsWith("SQLite format 3"));
}

TEST_F(Damage, FilesOfAStudyAreNamed) {
  const Words command = {"compare", "--problems", "sphere", "--optimizers", "ga",    "--replicates",
                         "2",       "--budget",   "60",     "--out",        "study", "--quiet"};
  ASSERT_EQ(run(command).exit_code, 0);
  const auto tables = read_study(folder_ / "study");
  const std::string cell = "study/cells/sphere/ga/r01/";
  for (const std::string& file : {std::string("study/study.toml"), cell + "cell.json",
                                  std::string("study/problems/sphere.json")}) {
    const std::string text = read_text(folder_ / file);
    for (const std::string& damage :
         {std::string(), text.substr(0, text.size() / 2), std::string("{}"), std::string("\0\0", 2),
          std::string("a = \"\xff\"")}) {
      SCOPED_TRACE(file + ": " + damage.substr(0, 20));
      write_text(folder_ / file, damage);
      const Outcome outcome = run(command);
      if (file.ends_with("sphere.json") && outcome.exit_code == 0) {
        EXPECT_EQ(read_text(folder_ / file), text);  // written again
        continue;
      }
      EXPECT_THAT(outcome.exit_code, AnyOf(2, 4)) << outcome.err;
      EXPECT_THAT(outcome.err, HasSubstr(fs::path(file).stem().string()));
    }
    write_text(folder_ / file, text);
  }
  // The tables and the result are always written again.
  for (const std::string& file : {std::string("result.json"), std::string("tables/cells.csv")}) {
    write_text(folder_ / "study" / file, "damaged");
  }
  EXPECT_EQ(run(command).exit_code, 0);
  EXPECT_EQ(read_study(folder_ / "study"), tables);
}

// A power cut or a kill leaves such files: locks of others, half-written files, earlier torn ends.
TEST_F(Damage, WhatIsLeftOverIsInNobodysWay) {
  const auto journal = copy_journal("left", get_size(folder_ / "whole/journal") / 2);
  write_text(folder_ / "left/lock", std::string(5000, '\xff') + "process 1 on \x1b[31m");
  write_text(folder_ / "left/journal.torn-1", "an earlier one");
  write_text(folder_ / "left/journal.torn-2", "another");
  for (const char* file : {"manifest.json.new", "result.json.new", "results.sqlite.new",
                           "convergence.csv.new", "winner.toml.new"}) {
    write_text(folder_ / "left" / file, "half a fi");
  }
  const std::string end =
      read_text(journal).substr(get_size(journal) - read_journal(journal).torn_bytes);
  const Outcome outcome = run(make_run("left"));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(read_text(folder_ / "left/journal.torn-1"), "an earlier one");
  EXPECT_EQ(read_text(folder_ / "left/journal.torn-3"), end);
  fs::remove(folder_ / "left/manifest.json.new");  // stays until a manifest is written
  expect_same_run(folder_ / "whole", folder_ / "left");
}

TEST_F(Damage, ACorruptedLockNamesNobodyAndLocksAllTheSame) {
  copy_journal("locked", get_size(folder_ / "whole/journal") / 2);
  write_text(folder_ / "locked/lock", "\x1b[31m\xff\n");
  const int fd = ::open((folder_ / "locked/lock").c_str(), O_RDWR);
  ASSERT_EQ(::flock(fd, LOCK_EX), 0);
  const Outcome outcome = run(make_run("locked"));
  EXPECT_EQ(outcome.exit_code, 5);
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("locked is in use by ?[31m?"), Not(HasSubstr("\x1b"))));
  ::close(fd);
  EXPECT_EQ(run(make_run("locked")).exit_code, 0);
  fs::remove(folder_ / "locked/lock");
  fs::create_directory(folder_ / "locked/lock");
  const Outcome folder = run(make_run("locked"));
  EXPECT_EQ(folder.exit_code, 74);
  EXPECT_THAT(folder.err, HasSubstr("locked/lock: cannot open it: Is a directory"));
}

// Tests a second fault during the repair of the first. A resume that begins with a torn end is
// killed at every write, sync, truncation and rename. The next resume must succeed.
TEST_F(Damage, KillsDuringTheMendingAreMendedAsWell) {
  const auto half = get_size(folder_ / "whole/journal") / 2;
  for (const char* call : {"write", "ftruncate", "fdatasync", "rename", "open"}) {
    FailingFiles files(folder_ / "runs", call);
    for (std::uint64_t at = 1;; at += sample_or_all(3, 1)) {
      SCOPED_TRACE(call + std::to_string(at));
      copy_journal("runs/run", half);
      const Outcome killed = run(make_run("runs/run"), files.make_environment(Fault::kill, at, 0));
      if (killed.exit_code == 0) {
        EXPECT_GT(at, 1u);
        fs::remove_all(folder_ / "runs/run");
        break;
      }
      ASSERT_EQ(killed.exit_code, -SIGKILL);
      const Outcome resumed = run(make_run("runs/run"));
      ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
      expect_same_run(folder_ / "whole", folder_ / "runs/run");
      fs::remove_all(folder_ / "runs/run");
      ASSERT_FALSE(HasFailure());
    }
  }
}

// Without room to save the torn end it is not cut off.
TEST_F(Damage, AFullDiskDuringTheMendingLosesNothing) {
  copy_journal("runs/run", get_size(folder_ / "whole/journal") / 2);
  const std::string before = read_text(folder_ / "runs/run/journal");
  // The first write is the lock, the second one the torn end.
  FailingFiles files(folder_ / "runs", "write");
  const Outcome outcome =
      run(make_run("runs/run"), files.make_environment(Fault::for_ever, 2, ENOSPC));
  EXPECT_EQ(outcome.exit_code, 74);
  EXPECT_THAT(outcome.err, HasSubstr("runs/run/journal.torn-1: cannot save the torn end of the "
                                     "journal in it: No space left on device"));
  EXPECT_EQ(read_text(folder_ / "runs/run/journal"), before);
  EXPECT_FALSE(fs::exists(folder_ / "runs/run/journal.torn-1"));
  ASSERT_EQ(run(make_run("runs/run")).exit_code, 0);
  expect_same_run(folder_ / "whole", folder_ / "runs/run");
}

}  // namespace
}  // namespace armwright::faults
