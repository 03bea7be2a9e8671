#include "report/formats/export_files.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace armwright {
namespace {

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
