// Tests that writing in a folder follows no link, and what the errors say.
#include "base/folder.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <functional>
#include <thread>

#include "base/expect_error.hpp"
#include "base/file.hpp"
#include "base/temporary_folder.hpp"

namespace armwright {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::AnyOf;
using testing::HasSubstr;
using testing::StartsWith;

constexpr const char* kPrecious = "precious";

class FolderTest : public testing::Test {
 protected:
  FolderTest() { write_file_atomically(victim_, kPrecious); }
  void expect_unharmed() const { EXPECT_EQ(read_file(victim_, 100), kPrecious); }

  const TemporaryFolder temporary_;
  const fs::path victim_ = temporary_ / "victim";
  const Folder store_ = Folder::make(temporary_ / "store", temporary_ / "store");
};

TEST_F(FolderTest, ANewFileTakesThePlaceOfAPlantedLink) {
  for (const fs::path& target : {victim_, temporary_ / "missing"}) {
    fs::create_symlink(target, store_.path() / "a.txt.new");
    write_file_atomically(store_, "a.txt", "new");
    EXPECT_EQ(read_file(store_.path() / "a.txt", 100), "new");
    EXPECT_FALSE(fs::is_symlink(store_.path() / "a.txt"));
    EXPECT_FALSE(fs::exists(fs::symlink_status(store_.path() / "a.txt.new")));
  }
  fs::create_hard_link(victim_, store_.path() / "a.txt.new");
  write_file_atomically(store_, "a.txt", "newer");
  EXPECT_EQ(read_file(store_.path() / "a.txt", 100), "newer");
  expect_unharmed();
  EXPECT_FALSE(fs::exists(temporary_ / "missing"));
}

TEST_F(FolderTest, ALinkInThePlaceOfTheFileItselfIsReplaced) {
  fs::create_symlink(victim_, store_.path() / "a.txt");
  write_file_atomically(store_.path() / "a.txt", "new");
  EXPECT_FALSE(fs::is_symlink(store_.path() / "a.txt"));
  EXPECT_EQ(read_file(store_.path() / "a.txt", 100), "new");
  expect_unharmed();
}

// The other thread plants links as fast as it can. Each write succeeds or names the file.
TEST_F(FolderTest, NoLinkPlantedDuringAWriteIsFollowed) {
  constexpr int kWrites = 100;
  std::atomic<bool> ends = false;
  std::thread planter([&] {
    while (!ends) {
      for (const char* name : {"a.txt.new", "a.txt"}) {
        ::unlink((store_.path() / name).c_str());
        ::symlink(victim_.c_str(), (store_.path() / name).c_str());
      }
    }
  });
  for (int i = 0; i < kWrites; ++i) {
    try {
      write_file_atomically(store_, "a.txt", "new");
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), StartsWith((store_.path() / "a.txt").string()));
    }
  }
  ends = true;
  planter.join();
  expect_unharmed();
  write_file_atomically(store_, "a.txt", "last");
  EXPECT_EQ(read_file(store_.path() / "a.txt", 100), "last");
}

TEST_F(FolderTest, AFileThatIsOpenedAgainIsNeitherALinkNorAPipe) {
  const auto open = [&] { store_.open("lock", O_RDWR | O_CREAT); };
  const auto lock = store_.path() / "lock";
  fs::create_symlink(victim_, lock);
  EXPECT_EQ(error_of(ErrorKind::bad_data, open),
            lock.string() +
                ": is a symbolic link, and armwright writes only regular files that it "
                "made itself. Remove it, or choose another folder with --out");
  fs::remove(lock);
  fs::create_symlink(temporary_ / "missing", lock);
  EXPECT_THAT(error_of(ErrorKind::bad_data, open), HasSubstr("lock: is a symbolic link"));
  fs::remove(lock);
  ASSERT_EQ(::mkfifo(lock.c_str(), 0600), 0);
  EXPECT_THAT(error_of(ErrorKind::bad_data, open), HasSubstr("lock: is a named pipe"));
  fs::remove(lock);
  fs::create_hard_link(victim_, lock);
  EXPECT_THAT(error_of(ErrorKind::bad_data, open), HasSubstr("lock: has 2 names (hard links)"));
  fs::remove(lock);
  open();
  open();
  expect_unharmed();
  EXPECT_FALSE(fs::exists(temporary_ / "missing"));
}

TEST_F(FolderTest, LinksAreFollowedToTheRootAndNotBelowIt) {
  fs::create_directory(temporary_ / "disk");
  fs::create_symlink("disk", temporary_ / "results");
  const auto root = temporary_ / "results" / "study";
  const Folder cells = Folder::make(root / "cells" / "p", root);
  EXPECT_EQ(cells.path(), root / "cells" / "p");
  write_file_atomically(cells, "a.txt", "new");
  EXPECT_TRUE(fs::exists(temporary_ / "disk/study/cells/p/a.txt"));

  fs::create_directory(temporary_ / "elsewhere");
  fs::create_symlink(temporary_ / "elsewhere", root / "tables");
  for (const auto& path : {root / "tables", root / "tables" / "inner"}) {
    EXPECT_THAT(
        error_of(ErrorKind::bad_data, [&] { Folder::make(path, root); }),
        AllOf(StartsWith((root / "tables").string() + ": is a symbolic link, and must be a folder"),
              HasSubstr("--out")));
  }
  write_file_atomically(root / "final", "");
  EXPECT_THAT(error_of(ErrorKind::bad_data, [&] { Folder::make(root / "final" / "p", root); }),
              StartsWith((root / "final").string() + ": is a file, and must be a folder"));
  EXPECT_TRUE(fs::is_empty(temporary_ / "elsewhere"));
  EXPECT_THROW(Folder::make(temporary_ / "outside", root), std::logic_error);
}

TEST_F(FolderTest, AnOpenFolderStaysTheSameFolder) {
  fs::rename(store_.path(), temporary_ / "moved");
  fs::create_directory_symlink(temporary_.path(), store_.path());
  write_file_atomically(store_, "victim", "new");
  EXPECT_EQ(read_file(temporary_ / "moved/victim", 100), "new");
  expect_unharmed();
}

TEST_F(FolderTest, APipeIsRefusedAtOnceUnlessItIsAnInput) {
  const auto pipe = temporary_ / "manifest.json";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_EQ(error_of(ErrorKind::bad_data, [&] { read_file(pipe, 100); }),
            pipe.string() + ": is a named pipe; it must be a regular file");
  std::thread writer([&] { std::ofstream(pipe) << "text"; });
  EXPECT_EQ(read_input(pipe, 100), "text");
  writer.join();
  EXPECT_THAT(error_of(ErrorKind::bad_data, [] { read_file("/dev/null", 100); }),
              HasSubstr("is a device"));
}

// Runs the checks in a child without the rights of root, which could read everything.
void as_ordinary_user(const std::function<void()>& checks) {
  const pid_t child = ::fork();
  if (child == 0) {
    constexpr uid_t kNobody = 65534;
    if (::getuid() == 0 && ::setuid(kNobody) != 0) {
      ::_exit(77);
    }
    checks();
    ::_exit(testing::Test::HasFailure() ? 1 : 0);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0) << "the lines above say what failed in the child";
}

TEST_F(FolderTest, MissingRightsAreSaidInPlainWords) {
  fs::permissions(temporary_.path(), fs::perms::all);
  fs::create_directory(temporary_ / "closed");
  write_file_atomically(temporary_ / "closed/file", "");
  fs::permissions(temporary_ / "closed", fs::perms::none);
  fs::permissions(victim_, fs::perms::none);
  as_ordinary_user([&] {
    const auto file = temporary_ / "closed/file";
    for (const auto& look : {path_exists, regular_file_exists, folder_exists}) {
      EXPECT_EQ(error_of(ErrorKind::io, [&] { look(file); }),
                file.string() + ": cannot look for it: Permission denied");
    }
    EXPECT_EQ(error_of(ErrorKind::io, [&] { list_folder(temporary_ / "closed"); }),
              (temporary_ / "closed").string() + ": cannot list it: Permission denied");
    EXPECT_EQ(error_of(ErrorKind::io, [&] { check_readable(victim_); }),
              victim_.string() + ": cannot read it: Permission denied");
  });
  fs::permissions(temporary_ / "closed", fs::perms::owner_all);
  EXPECT_FALSE(path_exists(temporary_ / "missing/file"));
  EXPECT_FALSE(path_exists(victim_ / "below a file"));
}

TEST_F(FolderTest, ListsWhatIsThereInOrder) {
  Folder::make(store_.path() / "b" / "c", store_.path());
  write_file_atomically(store_, "a", "");
  const auto& at = store_.path();
  EXPECT_EQ(list_folder(at), (std::vector<fs::path>{at / "a", at / "b"}));
  EXPECT_EQ(list_tree(at), (std::vector<fs::path>{at / "a", at / "b", at / "b" / "c"}));
}

}  // namespace
}  // namespace armwright
