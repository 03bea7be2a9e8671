#include "cli/terminal/markdown.hpp"

#include <gtest/gtest.h>

namespace armwright {
namespace {

TEST(Markdown, IsShownAsItIs) {
  EXPECT_EQ(escape_markdown("a|b"), "a\\|b");
  EXPECT_EQ(escape_markdown("f < *g* [1] `x` \\"), "f \\< \\*g\\* \\[1\\] \\`x\\` \\\\");
  EXPECT_EQ(escape_markdown("direct_l_rand, _x, y_"), "direct_l_rand, \\_x, y\\_");
  EXPECT_EQ(escape_markdown("one\ntwo\x1b"), "one?two?");
}

TEST(Markdown, CodeStaysInItsCell) {
  EXPECT_EQ(format_code("a|b"), "`a\\|b`");
  EXPECT_EQ(format_code("`x`"), "\\`x\\`");
  EXPECT_EQ(format_code(""), "(empty)");
}

}  // namespace
}  // namespace armwright
