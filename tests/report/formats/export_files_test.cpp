#include "report/formats/export_files.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <vector>

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
    PartialFolder target(check_export_folder(folder / "out/"));
    write_output_file(target.path() / "deep/er/file", "content");
    EXPECT_FALSE(std::filesystem::exists(folder / "out"));
    EXPECT_THAT(folder.list(), ElementsAre("out.partial-1"));
    put_in_place(target);
  }
  EXPECT_THAT(folder.list(), ElementsAre("out"));
  EXPECT_EQ(read_file(folder / "out/deep/er/file", 100), "content");
}

TEST(ExportFolder, LeavesNothingOfWhatWasNotFinished) {
  TemporaryFolder folder;
  {
    const PartialFolder target(check_export_folder(folder / "out"));
    write_output_file(target.path() / "file", "content");
  }
  EXPECT_THAT(folder.list(), IsEmpty());
}

TEST(ExportFolder, TakesAnEmptyFolderAndNothingElse) {
  TemporaryFolder folder;
  std::filesystem::create_directory(folder / "empty");
  PartialFolder empty(check_export_folder(folder / "empty"));
  put_in_place(empty);
  std::filesystem::create_directory(folder / "full");
  std::ofstream(folder / "full/file") << "mine";
  std::filesystem::create_symlink("nowhere", folder / "link");
  for (const char* name : {"full", "full/file", "link"}) {
    try {
      check_export_folder(folder / name);
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
  PartialFolder target(check_export_folder(folder / "out"));
  EXPECT_EQ(target.path(), folder / "out.partial-2");
  put_in_place(target);
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

TEST(FileNames, KeepWhatEverySystemBears) {
  EXPECT_EQ(escape_file_name("q1-complex_2.5"), "q1-complex_2.5");
  EXPECT_EQ(escape_file_name("nlopt:bobyqa, 'x' \"y\" 50%"), "nlopt_bobyqa___x___y__50_");
  EXPECT_EQ(escape_file_name("a/b\\c\n"), "a_b_c_");
}

TEST(FileNames, LeaveNoFolderAndAreNeverHiddenOrFlags) {
  EXPECT_EQ(escape_file_name("../../etc"), "_._.._etc");
  EXPECT_EQ(escape_file_name(".."), "_.");
  EXPECT_EQ(escape_file_name("."), "_");
  EXPECT_EQ(escape_file_name("-rf"), "_rf");
  EXPECT_EQ(escape_file_name(""), "unnamed");
}

TEST(FileNames, HaveOneMarkForACharacterOfManyBytes) {
  EXPECT_EQ(escape_file_name("Müller"), "M_ller");
  EXPECT_EQ(escape_file_name("日本"), "__");
  EXPECT_EQ(escape_file_name("a\xFF"
                             "b"),
            "a_b");
}

TEST(FileNames, AreBounded) {
  EXPECT_EQ(escape_file_name(std::string(1000, 'a')).size(), 80u);
}

TEST(FileNames, DifferWhereNamesDoEvenWhereCaseDoesNotCount) {
  const std::vector<std::string> names = {"a b", "a/b", "A:b", "a_b-2", "a b"};
  const auto files = make_file_names(names);
  EXPECT_EQ(files.at("a b"), "a_b");
  EXPECT_EQ(files.at("a/b"), "a_b-2");
  EXPECT_EQ(files.at("A:b"), "A_b-3");
  EXPECT_EQ(files.at("a_b-2"), "a_b-2-2");
}

TEST(ColumnNames, AreWordsThatBeginWithALetter) {
  EXPECT_EQ(escape_column_name("peak effort (N m)"), "peak_effort__N_m_");
  EXPECT_EQ(escape_column_name("joint_1.p"), "joint_1_p");
  EXPECT_EQ(escape_column_name("95th percentile"), "c_95th_percentile");
  EXPECT_EQ(escape_column_name("µ"), "c__");
  EXPECT_EQ(escape_column_name(""), "c_");
}

}  // namespace
}  // namespace armwright
