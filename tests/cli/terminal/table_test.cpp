#include "cli/terminal/table.hpp"

#include <gmock/gmock.h>

namespace armwright {
namespace {

using testing::ElementsAre;

TEST(WrapWords, KeepsToTheWidth) {
  EXPECT_THAT(wrap_words("one two three", 7), ElementsAre("one two", "three"));
  EXPECT_THAT(wrap_words("one two three", 6), ElementsAre("one", "two", "three"));
  EXPECT_THAT(wrap_words("one two three", 13), ElementsAre("one two three"));
  EXPECT_THAT(wrap_words("", 5), ElementsAre(""));
}

TEST(WrapWords, ALongerWordHasItsOwnLine) {
  EXPECT_THAT(wrap_words("a rhododendron b", 4), ElementsAre("a", "rhododendron", "b"));
}

TEST(WrapWords, CountsCharactersNotBytes) {
  EXPECT_THAT(wrap_words("äöü äöü", 7), ElementsAre("äöü äöü"));
}

TEST(Table, CellsOfTheWidestColumnThatMayGoOnBelow) {
  Table table({{"name", false}, {"meaning", false, true}});
  table.add_row({"a", "a sentence that is much longer than the others"});
  table.add_row({"bc", "short"});
  EXPECT_EQ(table.format(Style(false), 0, 30),
            "name  meaning\n"
            "a     a sentence that is much\n"
            "      longer than the others\n"
            "bc    short\n");
  EXPECT_EQ(table.format(Style(false), 2, 32),
            "  name  meaning\n"
            "  a     a sentence that is much\n"
            "        longer than the others\n"
            "  bc    short\n");
}

TEST(Table, IsOneLineARowWhereThereIsRoom) {
  Table table({{"", false}, {"", false, true}});
  table.add_row({"a", "a sentence that is much longer than the others"});
  EXPECT_EQ(table.format(Style(false)), "a  a sentence that is much longer than the others\n");
}

TEST(Table, WhatMayNotWrapIsNeverCut) {
  Table table({{"", false}, {"number"}});
  table.add_row({"a name that is long and stays", "1"});
  EXPECT_EQ(table.format(Style(false), 0, 10),
            "                               number\n"
            "a name that is long and stays       1\n");
}

}  // namespace
}  // namespace armwright
