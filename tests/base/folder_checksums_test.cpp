// Checks the list of checksums of a folder: what it covers, in which order it is written, and what
// readers refuse.

#include "base/folder_checksums.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "base/expect_error.hpp"
#include "base/file.hpp"
#include "base/hash.hpp"
#include "base/temporary_folder.hpp"

namespace armwright {
namespace {

using testing::HasSubstr;

constexpr std::size_t kMost_bytes = 1 << 20;

class FolderChecksumsTest : public testing::Test {
 protected:
  std::filesystem::path path(const std::string& name) const { return folder_.path() / name; }
  std::string read(const std::string& name) const { return read_file(path(name), kMost_bytes); }
  void write(const std::vector<std::pair<std::string, std::string>>& files) const {
    FolderChecksums checksums(folder_.path());
    checksums.write(files);
    checksums.save();
  }

  TemporaryFolder folder_;
};

TEST_F(FolderChecksumsTest, TheListIsThatOfSha256sum) {
  write({{"b", "two"}, {"a", "one"}});
  EXPECT_EQ(read(kChecksumFile),
            calc_sha256_hex("one") + "  a\n" + calc_sha256_hex("two") + "  b\n");
  const std::string command =
      "cd '" + folder_.path().string() + "' && sha256sum --quiet -c SHA256SUMS";
  EXPECT_EQ(std::system(command.c_str()), 0);
}

TEST_F(FolderChecksumsTest, AChangedFileIsRefusedByName) {
  write({{"a", "one"}, {"b", "two"}});
  write_file_atomically(path("a"), "One");
  const std::string message =
      error_of(ErrorKind::bad_data, [&] { read_checked_file(path("a"), kMost_bytes); });
  EXPECT_THAT(message, HasSubstr(path("a").string() +
                                 ": was changed after it was written (its "
                                 "SHA-256 is " +
                                 calc_sha256_hex("One").substr(0, 16)));
  EXPECT_THAT(message, HasSubstr("check the folder with 'armwright doctor " +
                                 folder_.path().string() + "'"));
  EXPECT_EQ(read_checked_file(path("b"), kMost_bytes), "two");
}

TEST_F(FolderChecksumsTest, WithoutALineAFileIsNotCovered) {
  write({{"a", "one"}});
  write_file_atomically(path("c"), "three");
  EXPECT_EQ(read_checked_file(path("c"), kMost_bytes), "three");
  std::filesystem::remove(path(kChecksumFile));
  write_file_atomically(path("a"), "One");
  EXPECT_EQ(read_checked_file(path("a"), kMost_bytes), "One");
}

TEST_F(FolderChecksumsTest, AFileThatChangesLosesItsLineBefore) {
  write({{"a", "one"}, {"b", "two"}});
  FolderChecksums checksums(folder_.path());
  checksums.write(std::vector<std::pair<std::string, std::string>>{{"a", "one"}, {"b", "Two"}});
  // A kill before save() leaves this list: b is not covered, and a still is.
  EXPECT_EQ(read(kChecksumFile), calc_sha256_hex("one") + "  a\n");
  checksums.save();
  EXPECT_EQ(read(kChecksumFile),
            calc_sha256_hex("one") + "  a\n" + calc_sha256_hex("Two") + "  b\n");
}

TEST_F(FolderChecksumsTest, AReaderAcceptsAFileThatIsReplacedMeanwhile) {
  write({{"a", "one"}});
  const FolderChecksums before(folder_.path());
  write({{"a", "two"}});
  EXPECT_EQ(before.read("a", kMost_bytes), "two");
}

TEST_F(FolderChecksumsTest, AMissingFileIsFoundByACheckAlone) {
  write({{"a", "one"}});
  std::filesystem::remove(path("a"));
  const FolderChecksums checksums(folder_.path());
  EXPECT_THAT(error_of(ErrorKind::bad_data, [&] { checksums.check("a"); }),
              HasSubstr("is missing, and SHA256SUMS lists it"));
  EXPECT_NO_THROW(checksums.check("c"));
}

TEST_F(FolderChecksumsTest, ALargeFileIsComparedInPieces) {
  const std::string large(1 << 20, 'x');
  write({{"a", large}});
  EXPECT_EQ(FolderChecksums(folder_.path()).find_change("a"), "");
  write_file_atomically(path("a"), large + "y");
  EXPECT_THAT(FolderChecksums(folder_.path()).find_change("a"), HasSubstr("was changed"));
}

TEST_F(FolderChecksumsTest, AListThatArmwrightDidNotWriteIsRefused) {
  const std::string sha256 = calc_sha256_hex("one");
  const struct {
    std::string text;
    const char* why;
  } lists[] = {
      {sha256 + "  a", "it is cut short"},
      {sha256 + " *a\n", "it is not a SHA-256, two spaces and a name"},
      {"A" + sha256.substr(1) + "  a\n", "it is not a SHA-256, two spaces and a name"},
      {sha256 + "  ../a\n", "its name is not that of a file in this folder"},
      {sha256 + "  /etc/passwd\n", "its name is not that of a file in this folder"},
      {sha256 + "  a/../../b\n", "its name is not that of a file in this folder"},
      {sha256 + "  b\n" + sha256 + "  a\n", "its name does not follow that of the line before"},
      {sha256 + "  a\n" + sha256 + "  a\n", "its name does not follow that of the line before"},
  };
  for (const auto& [text, why] : lists) {
    write_file_atomically(path(kChecksumFile), text);
    EXPECT_THAT(error_of(ErrorKind::bad_data, [&] { FolderChecksums{folder_.path()}; }),
                HasSubstr(why))
        << text;
  }
}

}  // namespace
}  // namespace armwright
