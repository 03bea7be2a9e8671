#include "base/file.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "base/expect_error.hpp"
#include "base/temporary_folder.hpp"

namespace armwright {
namespace {

TEST(File, WritesAndReadsBackEveryByte) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "a.bin";
  std::string content(100000, '\0');
  for (std::size_t i = 0; i < content.size(); ++i) {
    content[i] = static_cast<char>(i * 31);
  }
  write_file_atomically(path, content);
  EXPECT_EQ(read_file(path, content.size()), content);
  write_file_atomically(path, "");
  EXPECT_EQ(read_file(path, 0), "");
}

TEST(File, LeavesNothingBesideTheWrittenFile) {
  const TemporaryFolder folder;
  write_file_atomically(folder.path() / "a.txt", "old");
  write_file_atomically(folder.path() / "a.txt", "new");
  EXPECT_EQ(read_file(folder.path() / "a.txt", 10), "new");
  EXPECT_EQ(folder.list(), std::vector<std::string>{"a.txt"});
}

TEST(File, ReplacesAFileInsteadOfWritingIntoIt) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "a.txt";
  write_file_atomically(path, "the old content");
  std::ifstream reader(path);  // a reader that opened the old file keeps all of it
  write_file_atomically(path, "new");
  std::string line;
  std::getline(reader, line);
  EXPECT_EQ(line, "the old content");
}

TEST(File, AFailedWriteLeavesTheTargetAloneAndCleansUp) {
  const TemporaryFolder folder;
  const auto target = folder.path() / "target";
  std::filesystem::create_directory(target);
  const std::string message =
      error_of(ErrorKind::io, [&] { write_file_atomically(target, "text"); });
  EXPECT_EQ(message, target.string() + ": cannot put it in place: Is a directory");
  EXPECT_EQ(folder.list(), std::vector<std::string>{"target"});
}

TEST(File, NamesAMissingFolder) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "missing" / "a.txt";
  EXPECT_EQ(error_of(ErrorKind::io, [&] { write_file_atomically(path, "text"); }),
            path.parent_path().string() + ": cannot open this folder: No such file or directory");
  EXPECT_EQ(error_of(ErrorKind::io, [&] { read_file(path, 10); }),
            path.string() + ": cannot open it: No such file or directory");
}

TEST(File, SaysThatAFolderIsNoFile) {
  const TemporaryFolder folder;
  EXPECT_EQ(error_of(ErrorKind::io, [&] { read_file(folder.path(), 10); }),
            folder.path().string() + ": cannot read it: Is a directory");
}

TEST(File, RefusesMoreThanTheLimit) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "a.txt";
  write_file_atomically(path, "12345");
  EXPECT_EQ(read_file(path, 5), "12345");
  EXPECT_EQ(error_of(ErrorKind::bad_data, [&] { read_file(path, 4); }),
            path.string() + ": is larger than the limit of 4 bytes for such a file");
}

TEST(File, MakesFoldersAndSaysWhyItCannot) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "a" / "b";
  make_folder(path);
  make_folder(path);
  EXPECT_TRUE(std::filesystem::is_directory(path));
  write_file_atomically(folder.path() / "file", "");
  const auto blocked = folder.path() / "file" / "c";
  EXPECT_EQ(error_of(ErrorKind::io, [&] { make_folder(blocked); }),
            blocked.string() + ": cannot create this folder: Not a directory");
  EXPECT_EQ(error_of(ErrorKind::io, [&] { make_folder(folder.path() / "file"); }),
            (folder.path() / "file").string() + ": cannot create this folder: Not a directory");
}

}  // namespace
}  // namespace armwright
