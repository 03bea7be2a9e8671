#include "report/formats/export_files.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/temporary_folder.hpp"

namespace armwright {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(ExportFolder, IsThereWholeOrNotAtAll) {
  TemporaryFolder folder;
  {
    ExportFolder target(folder / "out/");
    write_output_file(target.path() / "deep/er/file", "content");
    EXPECT_FALSE(std::filesystem::exists(folder / "out"));
    EXPECT_THAT(folder.list(), ElementsAre("out.partial-1"));
    target.put_in_place();
  }
  EXPECT_THAT(folder.list(), ElementsAre("out"));
  EXPECT_EQ(read_file(folder / "out/deep/er/file", 100), "content");
}

TEST(ExportFolder, LeavesNothingOfWhatWasNotFinished) {
  TemporaryFolder folder;
  {
    const ExportFolder target(folder / "out");
    write_output_file(target.path() / "file", "content");
  }
  EXPECT_THAT(folder.list(), IsEmpty());
}

TEST(ExportFolder, TakesAnEmptyFolderAndNothingElse) {
  TemporaryFolder folder;
  std::filesystem::create_directory(folder / "empty");
  ExportFolder(folder / "empty").put_in_place();
  std::filesystem::create_directory(folder / "full");
  std::ofstream(folder / "full/file") << "mine";
  std::filesystem::create_symlink("nowhere", folder / "link");
  for (const char* name : {"full", "full/file", "link"}) {
    try {
      const ExportFolder target(folder / name);
      ADD_FAILURE() << name;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::usage);
      EXPECT_THAT(error.what(), HasSubstr("choose another folder with --out"));
    }
  }
  EXPECT_THAT(folder.list(), ElementsAre("empty", "full", "link"));
}

TEST(ExportFolder, PassesByWhatAKillHasLeft) {
  TemporaryFolder folder;
  std::filesystem::create_directory(folder / "out.partial-1");
  ExportFolder target(folder / "out");
  EXPECT_EQ(target.path(), folder / "out.partial-2");
  target.put_in_place();
  EXPECT_THAT(folder.list(), ElementsAre("out", "out.partial-1"));
}

TEST(OutputFile, SaysWhyItCannotBeWritten) {
  TemporaryFolder folder;
  write_output_file(folder / "file", "");
  try {
    const OutputFile again(folder / "file");
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::io);
    EXPECT_THAT(error.what(), HasSubstr("cannot write it: File exists"));
  }
}

}  // namespace
}  // namespace armwright
